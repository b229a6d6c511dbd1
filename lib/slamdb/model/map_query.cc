// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/map_query.h"

#include <algorithm>

#include "slamdb/model/detail/map_extent.h"

namespace slamdb {
namespace {

bool Meets(const detail::Trajectory& trajectory, const MapQuery::Times& times) {
  return !trajectory.empty && trajectory.begin_time <= times.end && times.begin <= trajectory.end_time;
}

bool HasOneOf(const Map& map, const MapQuery::Ids& ids) {
  return std::ranges::any_of(map.keyframes, [&](const KeyFrame& keyframe) {
    return !keyframe.bad && keyframe.id.value() >= ids.first && keyframe.id.value() <= ids.last;
  });
}

bool HasPointIn(const Map& map, const MapQuery::Ball& ball) {
  const double most = ball.radius * ball.radius;
  const auto inside = [&](const auto& place) {
    return (place.template cast<double>() - ball.center).squaredNorm() <= most;
  };
  return std::ranges::any_of(map.points, [&](const MapPoint& point) { return !point.bad && inside(point.position); }) ||
         std::ranges::any_of(map.landmarks, [&](const Landmark& landmark) { return inside(landmark.mean); });
}

}  // namespace

bool Matches(const Map& map, const MapQuery& query) {
  return (!query.times || Meets(detail::TrajectoryOf(map), *query.times)) &&
         (!query.keyframes || HasOneOf(map, *query.keyframes)) && (!query.near || HasPointIn(map, *query.near));
}

bool Matches(const Atlas& atlas, const MapQuery& query) {
  return query.everything() || std::ranges::any_of(atlas.maps, [&](const Map& map) { return Matches(map, query); });
}

}  // namespace slamdb
