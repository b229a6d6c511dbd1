// SPDX-License-Identifier: BSD-3-Clause
// Quality gates: numbers that an atlas is held against, and nothing else.
#include <numeric>

#include "slamdb/checks/check.h"

namespace slamdb {
namespace {

// The sum of a number over all maps.
template <class Number>
double Sum(const AtlasStatistics& statistics, const Number& number) {
  return std::accumulate(statistics.maps.begin(), statistics.maps.end(), 0.0,
                         [&](double sum, const MapStatistics& map) { return sum + static_cast<double>(number(map)); });
}

// The mean over all maps of what each map has the mean of; 0 when there is nothing.
double Mean(const AtlasStatistics& statistics, Distribution MapStatistics::*distribution) {
  const double count = Sum(statistics, [&](const MapStatistics& map) { return (map.*distribution).count; });
  const double sum = Sum(statistics, [&](const MapStatistics& map) {
    return (map.*distribution).mean * static_cast<double>((map.*distribution).count);
  });
  return count > 0 ? sum / count : 0;
}

double Maps(const AtlasStatistics& statistics) {
  return Sum(statistics, [](const MapStatistics& map) { return map.keyframes > 0 ? 1 : 0; });
}
double KeyFrames(const AtlasStatistics& statistics) {
  return static_cast<double>(statistics.keyframes - statistics.bad_keyframes);
}
double Points(const AtlasStatistics& statistics) {
  return static_cast<double>(statistics.points - statistics.bad_points);
}
double Components(const AtlasStatistics& statistics) {
  return Sum(statistics, [](const MapStatistics& map) { return map.components; });
}
double Duration(const AtlasStatistics& statistics) {
  return Sum(statistics, [](const MapStatistics& map) { return map.end_time - map.begin_time; });
}
double Length(const AtlasStatistics& statistics) { return statistics.trajectory_length; }
double Observers(const AtlasStatistics& statistics) { return Mean(statistics, &MapStatistics::observers); }
double Reprojection(const AtlasStatistics& statistics) { return Mean(statistics, &MapStatistics::reprojection_error); }

constexpr Gate kGates[] = {
    {"min-maps", "maps", "maps with keyframes", true, Maps},
    {"max-maps", "maps", "maps with keyframes", false, Maps},
    {"min-keyframes", "keyframes", "keyframes", true, KeyFrames},
    {"max-keyframes", "keyframes", "keyframes", false, KeyFrames},
    {"min-points", "points", "points", true, Points},
    {"max-points", "points", "points", false, Points},
    {"max-components", "components", "parts that no covisibility connects", false, Components},
    {"min-duration-s", "duration_s", "seconds from first to last keyframe", true, Duration},
    {"min-length", "trajectory_length", "metres, or map units, of trajectory", true, Length},
    {"min-observers", "observers_per_point", "observing keyframes per point on average", true, Observers},
    {"max-reprojection-px", "reprojection_error_px", "pixels of reprojection error on average", false, Reprojection},
};

}  // namespace

std::span<const Gate> ReadGates() { return kGates; }

std::string GateRuleId(std::string_view gate) { return "gate-" + std::string(gate); }

}  // namespace slamdb
