// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string_view>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// The gravity that the inertial data of a map agrees with, m/s^2 in world coordinates, whatever way the map was turned.
// What is left of the change of velocity between keyframes when what the accelerometer felt is taken away (Forster et
// al., TRO 2017, eq. 33).
// nullopt in maps whose IMU is not initialised, or with fewer than two such intervals.
//
// Cost: linear.
[[nodiscard]] SLAMDB_EXPORT std::optional<Eigen::Vector3d> GravityByInertia(const Map& map);

// The opposite direction, of unit length.
[[nodiscard]] SLAMDB_EXPORT std::optional<Eigen::Vector3d> UpByInertia(const Map& map);

enum class UpMethod {
  kAuto,     // by inertia where there is any, else by cameras
  kInertia,  // see above
  kCameras,  // cameras are held level: up is at right angles to the x axes of all, and away from their y axes
  kPath,  // cameras move on level ground: up is the normal of the plane through their centres, away from their y axes
};

// `auto`, `inertia`, `cameras`, `path`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(UpMethod method);

struct Upright {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // in world coordinates, of unit length
  UpMethod method = UpMethod::kAuto;              // that found it, never kAuto
  double spread = 0;   // by cameras: rms of the roll, degrees; by path: rms of the distance to the plane
  double gravity = 0;  // by inertia: its length, m/s^2
  Eigen::Quaterniond target_from_source = Eigen::Quaterniond::Identity();  // the smallest rotation that takes up to +z
};

// Which way is up in a map.
//
// Throws Error (kNotPossible) when the map does not tell: no inertial data, no keyframes, or a path along one line.
// Cost: linear.
[[nodiscard]] SLAMDB_EXPORT Upright FindUp(const Map& map, UpMethod method = UpMethod::kAuto);

}  // namespace slamdb
