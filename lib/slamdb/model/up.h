// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

// Which way is up in a map: the one rule for all that stands a map upright, or says how it stands.
// No file records it. ORB-SLAM3 has z up in a map with initialised IMU, and in others the frame of the first camera,
// whose y is down only where that camera was held level; either may have been moved since.
namespace slamdb {

// What tells which way is up, the surest first.
enum class UpMethod {
  kInertia,     // the IMU: against the gravity that its data agrees with
  kFrame,       // the map's own frame: cameras hold its z up so nearly that it was levelled, or laid onto the earth
  kCameras,     // cameras are held level: up is at right angles to the x axes of all, and away from their y axes
  kPath,        // cameras move on level ground: up is the normal of the plane through their centres
  kConvention,  // nothing: z in a map with initialised IMU, against y in others
};

// `inertia`, `frame`, `cameras`, `path`, `convention`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(UpMethod method);

struct Up {
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitY();  // of unit length, in the map's world frame
  UpMethod method = UpMethod::kConvention;
  // How far those that tell it are from agreeing, degrees, rms: of the gravity of one interval between keyframes from
  // that of all, of the cameras' x axes from level (their roll), or of the path from its plane. No bound of the error,
  // and 0 of a lone keyframe.
  double spread = 0;
  double gravity = 0;   // by inertia: its length, m/s^2
  double off_path = 0;  // by the path: rms distance of the cameras to the plane; metres, or units of the map
};

// Which way is up, as far as the map tells: by inertia, else by cameras that agree, else by a path that is a plane.
//
// Cameras agree where they roll little and have their upper edges up on average, or look straight down.
// Throws nothing but std::bad_alloc.
// Cost: linear in keyframes. Thread-safe.
[[nodiscard]] SLAMDB_EXPORT Up UpOf(const Map& map);

// The same of maps that are looked at together.
// Where two differ by no more than may be their error, both get that of the surer map, so that what is aligned stays
// so; where `in_one_frame`, all get that of the surest.
[[nodiscard]] SLAMDB_EXPORT std::vector<Up> UpsOf(const std::vector<const Map*>& maps, bool in_one_frame = false);

// Which way is up by one of kInertia, kCameras and kPath, however little they agree; or by what tells it (UpOf), but
// for the map's own frame and convention, as a map that is to be levelled asks.
//
// Throws Error:
//   kNotPossible  the map does not tell: no inertial data, no keyframes, a path along one line
//   kUsage        `method` is another
// Cost: linear in keyframes.
[[nodiscard]] SLAMDB_EXPORT Up FindUp(const Map& map, std::optional<UpMethod> method = {});

// The smallest turn that takes `up` to +z; where `up` is nearly -z, and that turn about any axis, half a turn about x
// and then the smallest.
[[nodiscard]] SLAMDB_EXPORT Eigen::Quaterniond UprightFromMap(const Eigen::Vector3d& up);

// How the map's frame stands, and what says so: `z up (by inertia)`, `y down (by cameras)`, and where no axis is within
// ten degrees of up `up along 0.02 -0.87 0.49 (by cameras)`.
[[nodiscard]] SLAMDB_EXPORT std::string FrameText(const Up& up);

// The axis that a direction is nearest to, and its sign: `x`, `-z`; nullopt where it is more than ten degrees off.
[[nodiscard]] SLAMDB_EXPORT std::optional<std::string> NearAxis(const Eigen::Vector3d& direction);

// The gravity that the inertial data of a map agrees with, m/s^2 in world coordinates, whatever way the map was turned.
// What is left of the change of velocity between keyframes when what the accelerometer felt is taken away (Forster et
// al., TRO 2017, eq. 33).
// nullopt in maps whose IMU is not initialised, or with fewer than two such intervals.
//
// Cost: linear in keyframes.
[[nodiscard]] SLAMDB_EXPORT std::optional<Eigen::Vector3d> GravityByInertia(const Map& map);

}  // namespace slamdb
