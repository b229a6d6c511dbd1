// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// No row: what look-ups answer for an id that is not there.
inline constexpr std::uint32_t kNoRow = ~std::uint32_t{0};

// Look-up id -> row of one list.
// A plain array over [lowest, highest] id where the ids are dense enough, open addressing where they are not.
// The id `none` is never found.
// Of several rows with one id, the first is found.
class SLAMDB_EXPORT IdTable {
 public:
  IdTable() = default;
  // For `count` ids, all in [lowest, highest].
  IdTable(std::uint64_t lowest, std::uint64_t highest, std::size_t count);

  // The row that had this id before, or kNoRow when it is new.
  std::uint32_t Insert(std::uint64_t id, std::uint32_t row);

  std::uint32_t Find(std::uint64_t id) const {
    if (!keys_.empty()) return FindHashed(id);
    const std::uint64_t place = id - lowest_;
    return place < rows_.size() ? rows_[place] : kNoRow;
  }

 private:
  std::size_t PlaceOf(std::uint64_t id) const;
  std::uint32_t FindHashed(std::uint64_t id) const { return rows_[PlaceOf(id)]; }

  std::uint64_t lowest_ = 0;
  std::vector<std::uint64_t> keys_;  // empty: dense
  std::vector<std::uint32_t> rows_;  // kNoRow: nothing here
};

// Id -> row inside one map, for work that needs no look-ups beyond it.
//
// Cost: linear.
SLAMDB_EXPORT IdTable KeyFrameTable(const Map& map);
SLAMDB_EXPORT IdTable PointTable(const Map& map);

// Where an entity is: rows of Atlas::maps and of that map's list.
struct EntityRow {
  std::uint32_t map = kNoRow;
  std::uint32_t row = kNoRow;
  explicit operator bool() const { return row != kNoRow; }
  friend bool operator==(const EntityRow&, const EntityRow&) = default;
};

// An entity whose id another one had before it, in the same map (first.map == again.map) or in an earlier one.
struct DuplicateId {
  EntityRow again, first;
  friend bool operator==(const DuplicateId&, const DuplicateId&) = default;
};

// Look-ups of an atlas by id.
// Refers to the atlas, which must outlive it and keep its lists as they are.
// References of ORB-SLAM3 hold inside one map, hence the look-ups per map.
// Entries that Map::repeated_keyframes and the like stand for are not in it.
//
// No look-up throws.
// Cost: to make, linear in the atlas.
// Const, and so safe to share between threads.
class SLAMDB_EXPORT AtlasIndex {
 public:
  explicit AtlasIndex(const Atlas& atlas);

  const Atlas& atlas() const { return *atlas_; }

  // Inside map `map` (a row of Atlas::maps).
  std::uint32_t KeyFrameRow(std::size_t map, KeyFrameId id) const { return maps_[map].keyframes.Find(id.value()); }
  std::uint32_t PointRow(std::size_t map, MapPointId id) const { return maps_[map].points.Find(id.value()); }
  const KeyFrame* FindKeyFrame(std::size_t map, KeyFrameId id) const {
    const std::uint32_t row = KeyFrameRow(map, id);
    return row == kNoRow ? nullptr : &atlas_->maps[map].keyframes[row];
  }
  const MapPoint* FindPoint(std::size_t map, MapPointId id) const {
    const std::uint32_t row = PointRow(map, id);
    return row == kNoRow ? nullptr : &atlas_->maps[map].points[row];
  }

  // Anywhere in the atlas; the first map that has the id.
  EntityRow LocateKeyFrame(KeyFrameId id) const;
  EntityRow LocatePoint(MapPointId id) const;
  std::uint32_t MapRow(MapId id) const { return map_rows_.Find(id.value()); }
  std::uint32_t CameraRow(CameraId id) const { return camera_rows_.Find(id.value()); }
  const Camera* FindCamera(CameraId id) const {
    const std::uint32_t row = CameraRow(id);
    return row == kNoRow ? nullptr : &atlas_->cameras[row];
  }

  // In the order of the lists, those inside one map first.
  // Of maps and cameras: rows of the atlas's own lists, EntityRow::map is 0.
  std::span<const DuplicateId> duplicate_keyframes() const { return duplicate_keyframes_; }
  std::span<const DuplicateId> duplicate_points() const { return duplicate_points_; }
  std::span<const DuplicateId> duplicate_maps() const { return duplicate_maps_; }
  std::span<const DuplicateId> duplicate_cameras() const { return duplicate_cameras_; }

 private:
  struct MapTables {
    IdTable keyframes, points;
  };

  const Atlas* atlas_;
  std::vector<MapTables> maps_;
  IdTable map_of_keyframe_, map_of_point_;  // id -> row of the first map that has it; unused with one map
  IdTable map_rows_, camera_rows_;
  std::vector<DuplicateId> duplicate_keyframes_, duplicate_points_, duplicate_maps_, duplicate_cameras_;
};

}  // namespace slamdb
