// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>

#include "slamdb/model/atlas.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb::testing {

// A camera that looks along z at each of the places, a second apart, ids from 0.
inline Map MapAt(std::initializer_list<Eigen::Vector3f> places) {
  Map map;
  map.id = MapId(0);
  for (const Eigen::Vector3f& place : places) {
    KeyFrame keyframe;
    keyframe.id = KeyFrameId(map.keyframes.size());
    keyframe.timestamp = 100 + static_cast<double>(map.keyframes.size());
    keyframe.camera_from_world.translation = -place;
    map.keyframes.push_back(keyframe);
  }
  return map;
}

// A point that so many of the first keyframes of a map see.
inline MapPoint PointSeenBy(std::uint64_t keyframes, const Eigen::Vector3f& position = {0, 0, 1}) {
  MapPoint point;
  point.position = position;
  for (std::uint64_t id = 0; id < keyframes; ++id)
    point.observations.push_back({.keyframe = KeyFrameId(id), .left = 0});
  return point;
}

inline Atlas AtlasOf(Map map) {
  Atlas atlas;
  atlas.maps.push_back(std::move(map));
  return atlas;
}

}  // namespace slamdb::testing
