// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/summary_columns.h"

#include <cmath>

#include "slamdb/base/detail/concat.h"

namespace slamdb::rows {
namespace {

// In the order of their bits in atlas.sensors.
constexpr MapSensor kSensors[] = {MapSensor::kMonocular, MapSensor::kStereoOrRgbd, MapSensor::kFisheyeStereo};

}  // namespace

std::int64_t BitsOf(const std::vector<MapSensor>& sensors) {
  std::int64_t bits = 0;
  for (const MapSensor sensor : sensors)
    for (std::size_t i = 0; i < std::size(kSensors); ++i)
      if (kSensors[i] == sensor) bits |= std::int64_t{1} << i;
  return bits;
}

std::vector<MapSensor> SensorsOf(std::int64_t bits) {
  std::vector<MapSensor> sensors;
  for (std::size_t i = 0; i < std::size(kSensors); ++i)
    if ((bits >> i & 1) != 0) sensors.push_back(kSensors[i]);
  return sensors;
}

std::string ProblemOf(const StoredAtlas& atlas) {
  const auto is_negative = [](std::uint64_t count) { return static_cast<std::int64_t>(count) < 0; };
  if (is_negative(atlas.observations)) return "a negative count of observations";
  if (is_negative(atlas.bytes)) return "a negative size";
  if (!(std::isfinite(atlas.trajectory_length) && atlas.trajectory_length >= 0))
    return detail::Concat("a trajectory of length ", atlas.trajectory_length);
  if (!(std::isfinite(atlas.duration) && atlas.duration >= 0))
    return detail::Concat("a duration of ", atlas.duration, " s");
  if (!std::isfinite(atlas.begin_time.value_or(0)) || !std::isfinite(atlas.end_time.value_or(0)))
    return "a time that is not finite";
  return {};
}

}  // namespace slamdb::rows
