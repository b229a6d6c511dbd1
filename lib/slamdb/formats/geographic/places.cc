// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/geographic/detail/places.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/date_times.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/geographic/options.h"

namespace slamdb::detail {
const Geodetic& OriginOf(const Target& target, const WriteOptions& options) {
  const std::optional<Geodetic>& origin = options.of<GeographicOptions>().origin;
  if (!origin)
    throw Error(ErrorKind::kUsage, target.path, "",
                "places on earth need the origin of the map's frame, east, north and up in metres: "
                "GeographicOptions::origin, which georeferencing finds");
  return *origin;
}

Places::Places(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices)
    : frame_(OriginOf(target, options)),
      points_(atlas, target, options, Positions::kFinite),
      trajectories_(CollectTrajectories(atlas, target, options, notices, Rounded::kIsTaken)) {
  for (const KeyFrameTrajectory& trajectory : trajectories_.maps)
    for (const TimedPose& pose : trajectory.poses) keyframes_.push_back({&trajectory, &pose});
  const std::size_t count = std::min(points_.size(), options.of<GeographicOptions>().most_points);
  chosen_points_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) chosen_points_.push_back(i * points_.size() / count);
  if (options.of<GeographicOptions>().most_points > 0) points_.WarnOfNotFinite(notices);
}

std::string Places::Summary() const {
  std::string text = trajectories_.Summary() + "; " + points_.Summary();
  if (chosen_points_.size() < points_.size()) text += ", of which " + Thousands(chosen_points_.size()) + " are written";
  return text;
}

bool HasTimes(const KeyFrameTrajectory& trajectory) {
  const std::vector<TimedPose>& poses = trajectory.poses;
  return poses.size() > 1 && poses.front().timestamp < poses.back().timestamp &&
         DateTimeText(poses.front().timestamp) && DateTimeText(poses.back().timestamp);
}

void AppendPlace(std::string& out, const Geodetic& place) {
  out += Fixed(place.longitude, 9);
  out += ',';
  out += Fixed(place.latitude, 9);
  out += ',';
  out += Fixed(place.altitude, 4);
}

std::string HexOf(const Color& color) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text = "#";
  for (const std::uint8_t part : color) text.append({kDigits[part >> 4], kDigits[part & 15]});
  return text;
}

}  // namespace slamdb::detail
