// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/summary.h"

#include <algorithm>

#include "slamdb/model/detail/map_extent.h"
#include "slamdb/model/sensor.h"

namespace slamdb {
namespace {

void Extend(AtlasSummary& summary, const detail::Trajectory& trajectory) {
  if (trajectory.empty) return;
  summary.trajectory_length += trajectory.length;
  summary.duration += trajectory.end_time - trajectory.begin_time;
  summary.begin_time = std::min(summary.begin_time.value_or(trajectory.begin_time), trajectory.begin_time);
  summary.end_time = std::max(summary.end_time.value_or(trajectory.end_time), trajectory.end_time);
}

}  // namespace

AtlasSummary Summarize(const Atlas& atlas) {
  AtlasSummary summary{.maps = atlas.maps.size()};
  for (const Map& map : atlas.maps) {
    summary.keyframes += map.keyframes.size();
    summary.points += map.points.size();
    summary.landmarks += map.landmarks.size();
    for (const MapPoint& point : map.points) summary.observations += point.observations.size();
    const MapSensor sensor = SensorOf(map);
    if (sensor != MapSensor::kUnknown) summary.sensors.push_back(sensor);
    summary.has_imu = summary.has_imu || HasImu(map);
    summary.is_metric = summary.is_metric && IsMetric(map);
    Extend(summary, detail::TrajectoryOf(map));
  }
  std::ranges::sort(summary.sensors);
  summary.sensors.erase(std::unique(summary.sensors.begin(), summary.sensors.end()), summary.sensors.end());
  return summary;
}

}  // namespace slamdb
