// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/load.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/rows/detail/map_rows.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/sqlite/detail/carried.h"
#include "slamdb/formats/sqlite/detail/list_order.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/past.h"
#include "slamdb/model/detail/packing.h"

namespace slamdb::sqlite {
namespace {

constexpr std::size_t kSlicesPerThread = 4;

// A map of the atlas while it is loaded.
struct MapRows {
  std::int64_t row = 0;
  std::vector<std::int64_t> keyframes, points;
};

// A part of one list, to be read by one thread at a time.
struct Slice {
  std::size_t map = 0;
  bool points = false;
  std::size_t first = 0, count = 0;
};

void LoadOrigins(Database& database, std::int64_t row, Map& map) {
  Statement statement(database, "SELECT keyframe FROM map_origin WHERE map = ?1 ORDER BY position", "table map_origin");
  statement.Bind(1, row);
  while (statement.Step()) map.origins.push_back(FromReference<KeyFrameId>(statement, 0));
}

// The maps without their lists, and which rows those have.
std::vector<MapRows> LoadMaps(Database& database, std::int64_t atlas_row, const Selection& selection, bool whole,
                              Atlas& atlas) {
  std::vector<MapRows> maps;
  for (const std::int64_t row : RowsOfMaps(database, atlas_row)) {
    if (row < 1 || row > 0x7fffffff) throw DamagedRow(database, "map", row);
    Map map = LoadMapHeader(database, atlas_row, row);
    if (selection.map && *selection.map != map.id) continue;
    if (!whole) {  // their positions and rows mean those of the whole lists
      map.repeated_keyframes.clear();
      map.repeated_points.clear();
    }
    atlas.maps.push_back(std::move(map));
    maps.push_back({row, KeyframeRows(database, row, selection), PointRows(database, row, selection)});
  }
  return maps;
}

// A few for each thread, so that they end together; larger where there is more, as statements are prepared for each.
std::vector<Slice> CutSlices(const std::vector<MapRows>& maps, int threads) {
  const auto slices_of_list = kSlicesPerThread * static_cast<std::size_t>(detail::ThreadCount(threads));
  std::vector<Slice> slices;
  const auto cut = [&](std::size_t map, bool points, std::size_t size, std::size_t least, std::size_t most) {
    const std::size_t grain = std::clamp(size / slices_of_list, least, most);
    for (std::size_t first = 0; first < size; first += grain) {
      slices.push_back({map, points, first, std::min(grain, size - first)});
    }
  };
  for (std::size_t i = 0; i < maps.size(); ++i) {
    cut(i, false, maps[i].keyframes.size(), 8, 64);
    cut(i, true, maps[i].points.size(), 512, 4096);
  }
  return slices;
}

template <class Values>
auto Part(Values& values, const Slice& slice) {
  return std::span(values).subspan(slice.first, slice.count);
}

void LoadSlice(Database& database, const Slice& slice, const MapRows& rows, bool with_features, Map& map,
               AtlasHashes::OfMap& hashes) {
  if (slice.points) {
    LoadPoints(database, Part(rows.points, slice), Part(map.points, slice), Part(hashes.points, slice),
               Part(hashes.observations, slice));
  } else {
    LoadKeyframes(database, Part(rows.keyframes, slice), {.features = with_features}, Part(map.keyframes, slice),
                  Part(hashes.keyframes, slice), Part(hashes.links, slice), Part(hashes.features, slice));
  }
}

void LoadLists(Database& database, std::int64_t atlas_row, const ReadOptions& options, const std::vector<MapRows>& maps,
               Atlas& atlas, AtlasHashes& hashes) {
  hashes.maps.resize(maps.size());
  for (std::size_t i = 0; i < maps.size(); ++i) {
    atlas.maps[i].keyframes.resize(maps[i].keyframes.size());
    atlas.maps[i].points.resize(maps[i].points.size());
    AtlasHashes::OfMap& of = hashes.maps[i];
    for (auto* list : {&of.keyframes, &of.links, &of.features}) list->resize(maps[i].keyframes.size());
    for (auto* list : {&of.points, &of.observations}) list->resize(maps[i].points.size());
  }
  const std::vector<Slice> slices = CutSlices(maps, options.threads);
  const std::int64_t revision = database.Integer("SELECT revision FROM atlas WHERE row = " + std::to_string(atlas_row));
  ConnectionPool pool(database.path(), options.of<StoreReadOptions>().lock_timeout, atlas_row, revision);
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<std::size_t> done{0};
  detail::ParallelFor(slices.size(), 1, options.threads, [&](std::size_t begin, std::size_t end) {
    const auto load = [&](Database& connection) {
      for (std::size_t i = begin; i < end; ++i) {
        const Slice& slice = slices[i];
        LoadSlice(connection, slice, maps[slice.map], options.features != FeatureColumns::kNone, atlas.maps[slice.map],
                  hashes.maps[slice.map]);
      }
    };
    done += end - begin;
    if (std::this_thread::get_id() == caller) {
      load(database);
      if (options.progress) options.progress("loading", static_cast<double>(done) / static_cast<double>(slices.size()));
    } else {
      ConnectionPool::Lease lease(pool);
      load(*lease);
    }
  });
}

}  // namespace

void LoadHeader(Database& database, std::int64_t row, Atlas& atlas) {
  // What is salvaged may be of an older version, which has no such column.
  std::string columns = rows::kHeaderColumns;
  if (VersionOf(database) < kFirstVersionWithCarried) columns.replace(columns.rfind("layout"), 6, "NULL");
  Statement statement(database, "SELECT " + columns + " FROM atlas WHERE row = ?1", "table atlas");
  if (!statement.Bind(1, row).Step()) throw SnapshotChanged();
  rows::ReadHeader(statement, atlas);
  atlas.carried = LoadCarried(database, CarriedKind::kAtlas, row);
}

void LoadCameras(Database& database, std::int64_t row, Atlas& atlas) {
  Statement statement(
      database, detail::Concat("SELECT ", rows::kCameraColumns, " FROM camera WHERE atlas = ?1 ORDER BY position"),
      "table camera");
  statement.Bind(1, row);
  CarriedReader carried(database, CarriedKind::kCamera);
  carried.Start(CarriedCameraRow(row, 0), CarriedCameraRow(row, 0xffffffff));
  while (statement.Step()) {
    try {
      atlas.cameras.push_back(rows::ReadCamera(statement));
    } catch (const Error& error) {
      throw Error(error.kind(), database.path(), "table camera", error.problem());
    }
    carried.Read(CarriedCameraRow(row, atlas.cameras.size() - 1), atlas.cameras.back().carried);
  }
}

std::vector<RepeatedEntry> LoadRepeated(Database& database, std::int64_t atlas, const char* list, std::int64_t map) {
  Statement statement(
      database,
      "SELECT position, owner_map, entry FROM repeated_entry WHERE atlas = ?1 AND list = ?2 AND map = ?3 "
      "ORDER BY sequence",
      "table repeated_entry");
  statement.Bind(1, atlas).BindText(2, list).Bind(3, map);
  std::vector<RepeatedEntry> entries;
  while (statement.Step()) entries.push_back(rows::ReadRepeated(statement));
  return entries;
}

std::vector<std::int64_t> RowsOfMaps(Database& database, std::int64_t atlas) {
  Statement statement(database, "SELECT row FROM map WHERE atlas = ?1 ORDER BY position", "table map");
  return statement.Bind(1, atlas).Integers();
}

Map LoadMapHeader(Database& database, std::int64_t atlas, std::int64_t row) {
  Statement statement(database, detail::Concat("SELECT ", rows::kMapColumns, " FROM map WHERE row = ?1"), "table map");
  if (!statement.Bind(1, row).Step()) throw DamagedRow(database, "map", row);
  Map map = rows::ReadMap(statement);
  LoadOrigins(database, row, map);
  map.carried = LoadCarried(database, CarriedKind::kMap, row);
  map.repeated_keyframes = LoadRepeated(database, atlas, "keyframes", row);
  map.repeated_points = LoadRepeated(database, atlas, "points", row);
  RequireSame(database, "map", row, map.id.value(), detail::HashOfHeader(map) == statement.Integer(10));
  return map;
}

std::unique_ptr<Database> ConnectionPool::Take() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      std::unique_ptr<Database> database = std::move(idle_.back());
      idle_.pop_back();
      return database;
    }
  }
  auto database = std::make_unique<Database>(path_, Access::kRead, lock_timeout_);
  database->Execute("BEGIN");
  if (database->Integer("SELECT revision FROM atlas WHERE row = " + std::to_string(atlas_)) != revision_) {
    throw SnapshotChanged();
  }
  return database;
}

void ConnectionPool::Give(std::unique_ptr<Database> database) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(database));
}

Error DamagedRow(Database& database, const char* table, std::int64_t row) {
  return Error(ErrorKind::kDamaged, database.path(), PlaceOf(table, row),
               "differs from its hash: the store is damaged, or was edited by another program");
}

void RequireSame(Database& database, const char* table, std::int64_t row, std::uint64_t id, bool same) {
  if (same) return;
  if (database.edits() == nullptr) throw DamagedRow(database, table, row);
  database.edits()->push_back({table, row, id});
}

namespace {

// An entry of a list that is merged of two.
struct Place {
  bool second = false;
  std::size_t index = 0;
};

// By their rows, which ascend.
std::vector<Place> MergeOrder(std::span<const std::int64_t> first, std::span<const std::int64_t> second) {
  std::vector<Place> order;
  order.reserve(first.size() + second.size());
  std::size_t i = 0, k = 0;
  while (i < first.size() || k < second.size()) {
    const bool from_second = i == first.size() || (k < second.size() && second[k] < first[i]);
    order.push_back({from_second, from_second ? k++ : i++});
  }
  return order;
}

template <class List>
void Merge(std::span<const Place> order, List& first, List& second) {
  List merged;
  merged.reserve(order.size());
  for (const Place& place : order) merged.push_back(std::move((place.second ? second : first)[place.index]));
  first = std::move(merged);
}

// The rows of a map that an earlier revision shares with the newest.
MapRows SharedRows(Database& database, std::int64_t map, const Selection& selection, const PastRows& past) {
  const auto without = [](const std::vector<std::int64_t>& rows, const std::vector<std::int64_t>& others) {
    std::vector<std::int64_t> left;
    std::ranges::set_difference(rows, others, std::back_inserter(left));
    return left;
  };
  return {map, without(KeyframeRows(database, map, selection), past.keyframes),
          without(PointRows(database, map, selection), past.points)};
}

// Loads what an earlier revision shares with the newest, and puts it into the lists of `maps`.
void LoadShared(Database& database, std::int64_t atlas_row, const ReadOptions& options, const PastRows& past,
                std::vector<MapRows>& maps, Atlas& atlas, AtlasHashes& hashes) {
  const std::vector<std::int64_t> now = RowsOfMaps(database, atlas_row);
  std::vector<MapRows> shared_rows;
  for (const MapRows& map : maps)
    shared_rows.push_back(std::ranges::find(now, map.row) == now.end()
                              ? MapRows{map.row, {}, {}}
                              : SharedRows(database, map.row, options.selection, past));
  Atlas shared;
  AtlasHashes shared_hashes;
  shared.maps.resize(maps.size());
  LoadLists(database, atlas_row, options, shared_rows, shared, shared_hashes);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    AtlasHashes::OfMap &of = hashes.maps[i], &of_shared = shared_hashes.maps[i];
    const std::vector<Place> keyframes = MergeOrder(maps[i].keyframes, shared_rows[i].keyframes);
    Merge(keyframes, atlas.maps[i].keyframes, shared.maps[i].keyframes);
    Merge(keyframes, maps[i].keyframes, shared_rows[i].keyframes);
    for (const auto list : {&AtlasHashes::OfMap::keyframes, &AtlasHashes::OfMap::links, &AtlasHashes::OfMap::features})
      Merge(keyframes, of.*list, of_shared.*list);
    const std::vector<Place> points = MergeOrder(maps[i].points, shared_rows[i].points);
    Merge(points, atlas.maps[i].points, shared.maps[i].points);
    Merge(points, maps[i].points, shared_rows[i].points);
    for (const auto list : {&AtlasHashes::OfMap::points, &AtlasHashes::OfMap::observations})
      Merge(points, of.*list, of_shared.*list);
  }
}

// Brings what was read in the order of rows into that of the lists.
void SortLists(Database& database, const std::vector<MapRows>& maps, Atlas& atlas, AtlasHashes& hashes) {
  for (std::size_t i = 0; i < maps.size(); ++i) {
    AtlasHashes::OfMap& of = hashes.maps[i];
    const auto sort = [&](std::string_view list, std::span<const std::int64_t> rows, auto&... lists) {
      const ListOrder order = OrderOf(database, maps[i].row, list);
      try {
        order.Sort(rows, lists...);
      } catch (const Error& error) {
        throw Error(error.kind(), database.path(), PlaceOf("map", maps[i].row),
                    error.problem() + ": the store is damaged");
      }
    };
    sort("keyframe", maps[i].keyframes, atlas.maps[i].keyframes, of.keyframes, of.links, of.features);
    sort("point", maps[i].points, atlas.maps[i].points, of.points, of.observations);
  }
}

// Loads what `database` has of the atlas: all of it, or what an earlier revision does not share with the newest.
std::vector<MapRows> LoadOwn(Database& database, std::int64_t row, const ReadOptions& options, Atlas& atlas,
                             AtlasHashes& hashes) {
  const Selection& selection = options.selection;
  const bool whole = selection.everything();
  LoadHeader(database, row, atlas);
  LoadCameras(database, row, atlas);
  if (whole) {
    atlas.repeated_maps = LoadRepeated(database, row, "maps", 0);
    atlas.repeated_cameras = LoadRepeated(database, row, "cameras", 0);
  }
  std::vector<MapRows> maps = LoadMaps(database, row, selection, whole, atlas);
  LoadLists(database, row, options, maps, atlas, hashes);
  for (std::size_t i = 0; i < maps.size(); ++i)
    LoadLandmarks(database, maps[i].row, selection, atlas.maps[i].landmarks, hashes.maps[i].landmarks);
  return maps;
}

// Where all was read, it has the hash that is stored.
void CheckHash(Database& database, std::int64_t row, const Atlas& atlas, AtlasHashes& hashes) {
  hashes.header = detail::HashOfAtlasHeader(atlas, atlas.encoding);
  for (const Camera& camera : atlas.cameras) hashes.cameras.push_back(detail::HashOf(camera));
  for (std::size_t i = 0; i < atlas.maps.size(); ++i) hashes.maps[i].header = detail::HashOfHeader(atlas.maps[i]);
  if (hashes.Combined() != database.Integer("SELECT hash FROM atlas WHERE row = " + std::to_string(row)))
    throw DamagedRow(database, "atlas", row);
}

}  // namespace

Atlas LoadAtlas(Database& database, std::int64_t row, const ReadOptions& options) {
  Atlas atlas;
  AtlasHashes hashes;
  const std::vector<MapRows> maps = LoadOwn(database, row, options, atlas, hashes);
  SortLists(database, maps, atlas, hashes);
  if (options.selection.everything() && options.features != FeatureColumns::kNone)
    CheckHash(database, row, atlas, hashes);
  return atlas;
}

Atlas LoadPast(Database& database, std::int64_t row, PastRows& past, const ReadOptions& options) {
  Atlas atlas;
  AtlasHashes hashes;
  if (options.selection.box) IndexBoxes(past.rows);
  ReadOptions alone = options;
  alone.threads = 1;  // of a temporary database there is one connection
  std::vector<MapRows> maps = LoadOwn(past.rows, row, alone, atlas, hashes);
  LoadShared(database, row, options, past, maps, atlas, hashes);
  SortLists(past.rows, maps, atlas, hashes);
  if (options.selection.everything() && options.features != FeatureColumns::kNone)
    CheckHash(past.rows, row, atlas, hashes);
  return atlas;
}

}  // namespace slamdb::sqlite
