// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slamdb/align/detail/camera_pose.h"
#include "slamdb/align/detail/known_map.h"
#include "slamdb/align/detail/map_views.h"
#include "slamdb/model/picture_features.h"

namespace slamdb::detail {

// A picture that is looked for. Refers to its features.
struct PictureQuery {
  View view;                          // whose pose is what it is searched with
  std::vector<Eigen::Vector3d> rays;  // of its keypoints, unit length
};
// nullopt when the camera does not project.
std::optional<PictureQuery> MakeQuery(const PictureFeatures& features);

// Points that some views see, each once, in order of the views. Those that are not known are left out, and so is the
// view that the map is without.
std::vector<std::uint32_t> PointsSeenBy(const KnownMap& known, std::span<const std::uint32_t> views);

// Keypoints and points that are each other's most alike, with no rival that is nearly as alike; the surest first. A
// point is what any of the views saw of it. Who lies where the best one lies is no rival, but the same thing once more.
std::vector<PictureMatch> MatchPicture(const PictureQuery& query, const KnownMap& known,
                                       std::span<const std::uint32_t> views);

// Points found in the picture near where the pose of its view says that they are. Each keypoint and each point is in
// one match at most. `radius`: pixels at octave 0.
std::vector<PictureMatch> SearchPicture(const PictureQuery& query, const KnownMap& known,
                                        std::span<const std::uint32_t> points, double radius);

}  // namespace slamdb::detail
