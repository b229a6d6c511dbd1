// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slamdb/model/atlas.h"

// The mathematics of a map, once, on plain data: pure functions that synthesize, check, edit and the live classes
// share. Conventions: camera frames have z forward, x right, y down; pixels; metres or map units; float unless said
// otherwise. They follow ORB-SLAM3 v1.0 (Campos et al., TRO 2021). All are thread-safe and none throws.
namespace slamdb {

// Projects a point in the camera frame to pixels. nullopt when z <= 0 for a pinhole, or when the camera has not the
// number of parameters that its model needs.
std::optional<Eigen::Vector2f> Project(const Camera& camera, const Eigen::Vector3f& x_in_camera);

// The viewing ray of a pixel in the camera frame, scaled to z = 1.
Eigen::Vector3f Unproject(const Camera& camera, const Eigen::Vector2f& pixel);

// The camera's centre in the world, and the right camera's for a fisheye stereo pair.
Eigen::Vector3f CameraCenter(const KeyFrame& keyframe);
Eigen::Vector3f RightCameraCenter(const KeyFrame& keyframe);

// world_from_body of a keyframe: with IMU calibration camera_from_world and camera_from_body combined, else the
// camera's.
Rigid3f WorldFromBody(const KeyFrame& keyframe);

// The keypoint that an observation refers to as ORB-SLAM3 reads it: undistorted in one-camera keyframes, as detected in
// fisheye stereo, from the right image when `row` >= left_count. Null when the row is outside the columns.
const Keypoint* ObservedKeypoint(const KeyFrame& keyframe, std::int32_t row);

// How much one observation adds to MapPoint::observation_count: left 1, or 2 with a stereo or depth measurement in a
// keyframe without second camera; right 1 more.
std::int32_t ObservationWeight(const KeyFrame& keyframe, const Observation& observation);

// The number of differing bits, 0 to 256.
int HammingDistance(const Descriptor& a, const Descriptor& b);

// The row of `descriptors` with the least median distance to all (the median is the sorted row's element
// floor((n - 1) / 2), own 0 included); the first of equals. `descriptors` is not empty.
std::size_t MostDistinctiveDescriptor(const std::vector<Descriptor>& descriptors);

// The grid that ORB-SLAM3 makes of keypoints: cell (round((x - min_x) * inverse_cell_width), same for y), in row order;
// keypoints outside the image are in none.
FeatureGrid DeriveGrid(const Column<Keypoint>& keypoints, const ImageBounds& bounds);

// True when `grid` is what DeriveGrid would make, found without making it twice as large in memory.
bool IsDerivedGrid(const FeatureGrid& grid, const Column<Keypoint>& keypoints, const ImageBounds& bounds);

// factor^level by repeated multiplication in float, as ORB-SLAM3 fills its tables.
ScalePyramid DerivePyramid(std::int32_t levels, float factor);

// The distance range of a point seen at `octave` from `distance`: max = distance * factors[octave], min = max over the
// last factor. `octave` is a level of the pyramid.
struct DistanceRange {
  float min = 0, max = 0;
};
DistanceRange DeriveDistanceRange(float distance, std::int32_t octave, const ScalePyramid& pyramid);

}  // namespace slamdb
