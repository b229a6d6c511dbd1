// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/index.h"

#include <algorithm>
#include <bit>

namespace slamdb {
namespace {

// Dense as long as the array is not much larger than the entities themselves: ids of real atlases have gaps, up to ten
// ids per surviving map point.
constexpr std::uint64_t kDenseIdsPerRow = 16;
constexpr std::uint64_t kDenseAlways = 4096;

struct IdRange {
  std::uint64_t lowest = MapId::kNone, highest = 0;
  std::size_t count = 0;

  template <class List>
  void Extend(const List& list) {
    for (const auto& entity : list) {
      if (!entity.id) continue;
      lowest = std::min(lowest, entity.id.value());
      highest = std::max(highest, entity.id.value());
      ++count;
    }
  }
  IdTable Table() const { return count == 0 ? IdTable() : IdTable(lowest, highest, count); }
};

// The table of one list. Rows with an id that was there before go to `duplicates`.
template <class List>
IdTable MakeTable(const List& list, std::uint32_t map, std::vector<DuplicateId>& duplicates) {
  IdRange range;
  range.Extend(list);
  IdTable table = range.Table();
  for (std::uint32_t row = 0; row < list.size(); ++row) {
    if (!list[row].id) continue;
    const std::uint32_t before = table.Insert(list[row].id.value(), row);
    if (before != kNoRow) duplicates.push_back({{map, row}, {map, before}});
  }
  return table;
}

// The table id -> first map over all maps. Ids that an earlier map has go to `duplicates`, behind those of the map
// itself.
template <class Tables, class Member>
IdTable MakeMapTable(const std::vector<Map>& maps, const Tables& tables, const Member& list_of, const auto& table_of,
                     std::vector<DuplicateId>& duplicates) {
  IdRange range;
  for (const Map& map : maps) range.Extend(list_of(map));
  IdTable result = range.Table();
  for (std::uint32_t map = 0; map < maps.size(); ++map) {
    const auto& list = list_of(maps[map]);
    for (std::uint32_t row = 0; row < list.size(); ++row) {
      if (!list[row].id) continue;
      const std::uint64_t id = list[row].id.value();
      const std::uint32_t before = result.Insert(id, map);
      if (before != kNoRow && before != map)
        duplicates.push_back({{map, row}, {before, table_of(tables[before]).Find(id)}});
    }
  }
  return result;
}

// Finalizer of MurmurHash3: spreads ids that differ in few bits.
std::uint64_t Mix(std::uint64_t value) {
  value = (value ^ (value >> 33)) * 0xFF51AFD7ED558CCDu;
  value = (value ^ (value >> 33)) * 0xC4CEB9FE1A85EC53u;
  return value ^ (value >> 33);
}

}  // namespace

IdTable::IdTable(std::uint64_t lowest, std::uint64_t highest, std::size_t count) : lowest_(lowest) {
  const std::uint64_t span = highest - lowest;
  if (span < kDenseIdsPerRow * count + kDenseAlways) {
    rows_.assign(span + 1, kNoRow);
  } else {
    const std::size_t places = std::bit_ceil(2 * count + 1);
    keys_.assign(places, 0);
    rows_.assign(places, kNoRow);
  }
}

std::uint32_t IdTable::Insert(std::uint64_t id, std::uint32_t row) {
  const std::size_t place = keys_.empty() ? id - lowest_ : PlaceOf(id);
  const std::uint32_t before = rows_[place];
  if (before != kNoRow) return before;
  if (!keys_.empty()) keys_[place] = id;
  rows_[place] = row;
  return kNoRow;
}

// The place that holds the id, or the free place where it belongs; at most half of the places are taken.
std::size_t IdTable::PlaceOf(std::uint64_t id) const {
  const std::size_t mask = keys_.size() - 1;
  std::size_t place = Mix(id) & mask;
  while (rows_[place] != kNoRow && keys_[place] != id) place = (place + 1) & mask;
  return place;
}

IdTable KeyFrameTable(const Map& map) {
  std::vector<DuplicateId> ignored;
  return MakeTable(map.keyframes, 0, ignored);
}

IdTable PointTable(const Map& map) {
  std::vector<DuplicateId> ignored;
  return MakeTable(map.points, 0, ignored);
}

AtlasIndex::AtlasIndex(const Atlas& atlas) : atlas_(&atlas) {
  maps_.resize(atlas.maps.size());
  for (std::uint32_t map = 0; map < atlas.maps.size(); ++map) {
    maps_[map].keyframes = MakeTable(atlas.maps[map].keyframes, map, duplicate_keyframes_);
    maps_[map].points = MakeTable(atlas.maps[map].points, map, duplicate_points_);
  }
  map_rows_ = MakeTable(atlas.maps, 0, duplicate_maps_);
  camera_rows_ = MakeTable(atlas.cameras, 0, duplicate_cameras_);
  if (atlas.maps.size() < 2) return;
  map_of_keyframe_ = MakeMapTable(
      atlas.maps, maps_, [](const Map& map) -> const auto& { return map.keyframes; },
      [](const MapTables& tables) -> const IdTable& { return tables.keyframes; }, duplicate_keyframes_);
  map_of_point_ = MakeMapTable(
      atlas.maps, maps_, [](const Map& map) -> const auto& { return map.points; },
      [](const MapTables& tables) -> const IdTable& { return tables.points; }, duplicate_points_);
}

EntityRow AtlasIndex::LocateKeyFrame(KeyFrameId id) const {
  if (maps_.empty()) return {};
  const std::uint32_t map = maps_.size() == 1 ? 0 : map_of_keyframe_.Find(id.value());
  return map == kNoRow ? EntityRow{} : EntityRow{map, KeyFrameRow(map, id)};
}

EntityRow AtlasIndex::LocatePoint(MapPointId id) const {
  if (maps_.empty()) return {};
  const std::uint32_t map = maps_.size() == 1 ? 0 : map_of_point_.Find(id.value());
  return map == kNoRow ? EntityRow{} : EntityRow{map, PointRow(map, id)};
}

}  // namespace slamdb
