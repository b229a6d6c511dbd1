// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <unordered_map>

#include "slamdb/model/atlas.h"

// The parts of the census of meaning.h.
namespace slamdb {

// A counter for each irregularity.
using CensusCounts = std::map<std::string, std::int64_t>;

// Look-ups within one map.
struct CensusLookup {
  explicit CensusLookup(const Map& map) {
    for (const KeyFrame& keyframe : map.keyframes) keyframes[keyframe.id] = &keyframe;
    for (const MapPoint& point : map.points) points[point.id] = &point;
  }
  const KeyFrame* Find(KeyFrameId id) const {
    const auto found = keyframes.find(id);
    return found == keyframes.end() ? nullptr : found->second;
  }
  const MapPoint* Find(MapPointId id) const {
    const auto found = points.find(id);
    return found == points.end() ? nullptr : found->second;
  }
  std::unordered_map<KeyFrameId, const KeyFrame*> keyframes;
  std::unordered_map<MapPointId, const MapPoint*> points;
};

// By keyframe: how many points it shares with each other one.
using SharedPoints = std::map<KeyFrameId, std::map<KeyFrameId, std::int32_t>>;
SharedPoints CountSharedPoints(const Map& map);

// Adds what is to say of one point. `histogram` is of the recorded minus the computed number of observations.
void CensusPoint(const CensusLookup& lookup, const MapPoint& point, CensusCounts& counts, nlohmann::json& histogram);

// Adds what is to say of one keyframe. `shared` is its row of SharedPoints.
void CensusKeyFrame(const Atlas& atlas, const CensusLookup& lookup, const KeyFrame& keyframe,
                    std::map<KeyFrameId, std::int32_t>& shared, CensusCounts& counts);

}  // namespace slamdb
