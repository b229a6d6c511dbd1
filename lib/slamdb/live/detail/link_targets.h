// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <span>

#include "slamdb/live/keyframe.h"
#include "slamdb/live/map_point.h"
#include "slamdb/model/index.h"

// Where the ids of links are looked up: two kinds of tables, one question.
namespace slamdb::live {

// The objects of one map by id: rows of the id tables are rows of the lists. Const and so thread-safe.
struct LinkTargets {
  const IdTable& keyframe_rows;
  const IdTable& point_rows;
  std::span<KeyFrame* const> keyframes;
  std::span<MapPoint* const> points;

  KeyFrame* Find(KeyFrameId id) const {
    const std::uint32_t row = keyframe_rows.Find(id.value());
    return row == kNoRow ? nullptr : keyframes[row];
  }
  MapPoint* Find(MapPointId id) const {
    const std::uint32_t row = point_rows.Find(id.value());
    return row == kNoRow ? nullptr : points[row];
  }
};

// The maps that PostLoad of ORB-SLAM3's classes is given. What is null or of another atlas is not there.
struct IdMaps {
  const std::map<long unsigned int, KeyFrame*>& keyframes;
  const std::map<long unsigned int, MapPoint*>& points;
  const Runtime& runtime;

  KeyFrame* Find(KeyFrameId id) const { return FindIn(keyframes, id.value()); }
  MapPoint* Find(MapPointId id) const { return FindIn(points, id.value()); }

 private:
  template <class Object>
  Object* FindIn(const std::map<long unsigned int, Object*>& objects, std::uint64_t id) const {
    const auto found = objects.find(id);
    return found == objects.end() || found->second == nullptr || !found->second->IsOf(runtime) ? nullptr
                                                                                               : found->second;
  }
};

}  // namespace slamdb::live
