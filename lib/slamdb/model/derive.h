// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

// The mathematics of a map, once, on plain data: pure functions that synthesize, check, edit and the live classes
// share.
//
// Frames: of cameras, z forward, x right, y down.
// Units: pixels; metres or map units; float unless said otherwise.
// None throws.
// Thread-safe.
// After ORB-SLAM3 v1.0 (Campos et al., TRO 2021).
namespace slamdb {

// Projects a point in the camera frame to pixels.
// nullopt when z <= 0 for a pinhole, or when the camera has not the number of parameters that its model needs.
SLAMDB_EXPORT std::optional<Eigen::Vector2f> Project(const Camera& camera, const Eigen::Vector3f& x_in_camera);

// The viewing ray of a pixel in the camera frame, scaled to z = 1.
SLAMDB_EXPORT Eigen::Vector3f Unproject(const Camera& camera, const Eigen::Vector2f& pixel);

// The camera's centre in the world, and the right camera's for a fisheye stereo pair.
SLAMDB_EXPORT Eigen::Vector3f CameraCenter(const KeyFrame& keyframe);
SLAMDB_EXPORT Eigen::Vector3f RightCameraCenter(const KeyFrame& keyframe);

// right camera_from_world of a fisheye stereo pair.
SLAMDB_EXPORT Rigid3f RightCameraFromWorld(const KeyFrame& keyframe);

// world_from_body of a keyframe.
// With IMU calibration camera_from_world and camera_from_body combined, else the camera's.
SLAMDB_EXPORT Rigid3f WorldFromBody(const KeyFrame& keyframe);

// The keypoint that an observation refers to as ORB-SLAM3 reads it: undistorted in one-camera keyframes, as detected in
// fisheye stereo, from the right image when `row` >= left_count.
// Null when the row is outside the columns.
SLAMDB_EXPORT const Keypoint* ObservedKeypoint(const Features& features, std::int32_t row);
inline const Keypoint* ObservedKeypoint(const KeyFrame& keyframe, std::int32_t row) {
  return ObservedKeypoint(keyframe.features, row);
}

// The position in the camera frame of a keypoint with depth, by pinhole intrinsics from the keypoint as detected.
// What ORB-SLAM3 does for rectified stereo and depth cameras, whose images have no distortion.
// nullopt when it has no depth.
SLAMDB_EXPORT std::optional<Eigen::Vector3f> UnprojectDepth(const Features& features, const Intrinsics& intrinsics,
                                                            std::int32_t row);

// Whether a place is inside the undistorted image: [min, max).
SLAMDB_EXPORT bool IsInsideImage(const ImageBounds& bounds, float x, float y);

// The rows of keypoints less than `radius` pixels in x and in y from a place, found through their grid, cell by cell.
SLAMDB_EXPORT std::vector<std::size_t> KeypointsInArea(const Column<Keypoint>& keypoints, const FeatureGrid& grid,
                                                       const ImageBounds& bounds, float x, float y, float radius);

// How much one observation adds to MapPoint::observation_count.
// Left 1, or 2 with a stereo or depth measurement in a keyframe without second camera; right 1 more.
SLAMDB_EXPORT std::int32_t ObservationWeight(const Features& features, bool has_second_camera,
                                             const Observation& observation);
inline std::int32_t ObservationWeight(const KeyFrame& keyframe, const Observation& observation) {
  return ObservationWeight(keyframe.features, keyframe.right_camera.has_value(), observation);
}

// The number of differing bits, 0 to 256.
SLAMDB_EXPORT int HammingDistance(const Descriptor& a, const Descriptor& b);

// The row of `descriptors` with the least median distance to all; the first of equals.
// The median is the sorted row's element floor((n - 1) / 2), own 0 included.
//
// Requires: `descriptors` is not empty.
SLAMDB_EXPORT std::size_t MostDistinctiveDescriptor(const std::vector<Descriptor>& descriptors);

// The grid that ORB-SLAM3 makes of keypoints: cell (round((x - min_x) * inverse_cell_width), same for y), in row order.
// Keypoints outside the image are in none.
SLAMDB_EXPORT FeatureGrid DeriveGrid(const Column<Keypoint>& keypoints, const ImageBounds& bounds);

// True when `grid` is what DeriveGrid would make. What is made to tell is no larger than the grid.
SLAMDB_EXPORT bool IsDerivedGrid(const FeatureGrid& grid, const Column<Keypoint>& keypoints, const ImageBounds& bounds);

// factor^level by repeated multiplication in float, as ORB-SLAM3 fills its tables.
SLAMDB_EXPORT ScalePyramid DerivePyramid(std::int32_t levels, float factor);

// The distance range of a point seen at `octave` from `distance`: max = distance * factors[octave], min = max over the
// last factor.
//
// Requires: `octave` is a level of the pyramid.
struct DistanceRange {
  float min = 0, max = 0;
};
SLAMDB_EXPORT DistanceRange DeriveDistanceRange(float distance, std::int32_t octave, const ScalePyramid& pyramid);

// How far beyond its distance range a point is still looked for: from 0.8 min to 1.2 max.
inline constexpr float kNearMargin = 0.8F, kFarMargin = 1.2F;

// The octave at which a point of that max distance should appear from `distance`, within the pyramid's levels:
// ceil(log(max / distance) / log_factor).
SLAMDB_EXPORT std::int32_t PredictScale(float max_distance, float distance, const ScalePyramid& pyramid);

// The mean of the unit vectors from the camera centres to the point: not a unit vector itself.
// Summed in the order given.
// Zero when there are no centres.
SLAMDB_EXPORT Eigen::Vector3f MeanViewingDirection(const Eigen::Vector3f& position,
                                                   std::span<const Eigen::Vector3f> centers);

}  // namespace slamdb
