// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/formats/export/detail/points.h"
#include "slamdb/formats/format.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/model/colors.h"
#include "slamdb/model/geodetic.h"

namespace slamdb::detail {

// A keyframe, of the trajectory of a map.
struct PlacedKeyFrame {
  const KeyFrameTrajectory* trajectory;
  const TimedPose* pose;
};

// Where the frame of the maps is. Throws Error (kUsage) when the options do not say.
const Geodetic& OriginOf(const Target& target, const WriteOptions& options);

// What of an atlas is shown on the globe. Refers to the atlas.
class Places {
 public:
  // Throws Error (kUsage) when the options have no origin.
  Places(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices);

  Geodetic At(const Eigen::Vector3f& position) const { return frame_.ToGeodetic(position.cast<double>()); }
  const std::vector<KeyFrameTrajectory>& trajectories() const { return trajectories_.maps; }
  const std::vector<PlacedKeyFrame>& keyframes() const { return keyframes_; }  // map after map, in the order of time
  const PointRows& points() const { return points_; }
  const std::vector<std::size_t>& chosen_points() const { return chosen_points_; }  // rows of points(), ascending

  // `14 poses; 3,162 points`, and how many of them where that is not all.
  std::string Summary() const;
  WrittenCounts Counts() const { return {.keyframes = keyframes_.size(), .points = chosen_points_.size()}; }

 private:
  LocalFrame frame_;
  PointRows points_;
  Trajectories trajectories_;
  std::vector<PlacedKeyFrame> keyframes_;
  std::vector<std::size_t> chosen_points_;
};

// Whether the times of a path can be shown as such: all of them dates from the year 1 to 9999, and not all the same.
bool HasTimes(const KeyFrameTrajectory& trajectory);

// Longitude, latitude and altitude, one decimal of a millimetre: `11.571234567,48.150000000,519.2000`.
void AppendPlace(std::string& out, const Geodetic& place);

// `#3f90da`.
std::string HexOf(const Color& color);

}  // namespace slamdb::detail
