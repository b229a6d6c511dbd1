// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "slamdb/model/atlas.h"
#include "slamdb/model/similarity.h"

namespace slamdb::detail {

// camera_from_world as the optimiser moves it: one block of numbers.
struct PoseState {
  std::array<double, 7> values{0, 0, 0, 1, 0, 0, 0};  // quaternion x y z w, translation

  Eigen::Map<Eigen::Quaterniond> rotation() { return Eigen::Map<Eigen::Quaterniond>(values.data()); }
  Eigen::Map<const Eigen::Quaterniond> rotation() const { return Eigen::Map<const Eigen::Quaterniond>(values.data()); }
  Eigen::Map<Eigen::Vector3d> translation() { return Eigen::Map<Eigen::Vector3d>(values.data() + 4); }
  Eigen::Map<const Eigen::Vector3d> translation() const { return Eigen::Map<const Eigen::Vector3d>(values.data() + 4); }
  Eigen::Vector3d Center() const { return -(rotation().conjugate() * translation()); }
  Similarity3d WorldFromCamera() const { return {1, rotation().conjugate(), Center()}; }
  void SetWorldFromCamera(const Eigen::Quaterniond& world_from_camera, const Eigen::Vector3d& center) {
    rotation() = world_from_camera.conjugate();
    translation() = -(rotation() * center);
  }
};

using Vector6d = Eigen::Matrix<double, 6, 1>;

// One flag for each row: 1, the optimiser moves it.
struct Moved {
  std::vector<std::uint8_t> keyframes, points;
};

// What of a map moves in optimisation, in double; by row of its lists.
struct MapStates {
  std::vector<PoseState> poses;
  std::vector<Eigen::Vector3d> velocities;  // m/s, world
  std::vector<Vector6d> biases;             // gyroscope, accelerometer
  std::vector<Eigen::Vector3d> points;

  explicit MapStates(const Map& map);

  // Moves what is flagged as a similarity moves the world.
  void Move(const Similarity3d& target_from_source, const Moved& moved);
};

// Good, and with a pose that can be: finite, a rotation that is one.
bool IsPosed(const KeyFrame& keyframe);
// Good, and somewhere.
bool IsPlaced(const MapPoint& point);

// How the world about each keyframe has moved: world_after_from_world_before.
std::vector<Similarity3d> MotionsOf(const MapStates& before, const MapStates& after);

// What was not optimised follows what was: a keyframe its parent, a point its reference keyframe, or the first of its
// observers. `motions` by row of the keyframes; those of keyframes that follow are set.
void CarryAlong(const Map& map, const Moved& moved, std::vector<Similarity3d>& motions, MapStates& states);

// Records what changed between two states: poses, positions of bodies, velocities and biases of keyframes; positions,
// viewing directions and distance ranges of points, also of points that stayed but are seen from elsewhere.
// What did not change keeps its bytes.
void Record(const MapStates& before, const MapStates& after, int threads, Map& map);

}  // namespace slamdb::detail
