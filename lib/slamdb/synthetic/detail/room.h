// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "slamdb/model/similarity.h"
#include "slamdb/synthetic/detail/portable.h"
#include "slamdb/synthetic/detail/random.h"
#include "slamdb/synthetic/detail/rig.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb::synthetic {

// How a camera goes round a round room, so that every point is seen at least twice and no keyframe has more points
// before it than features. Room coordinates: z up, origin at the middle of the floor circle at camera height, metres.
// The camera stays kWallDistance off the wall and looks at it; the finer the points, the larger the room.
struct RoomPlan {
  double wall_radius = 0, path_radius = 0;
  double half_height = 0;    // of the wall
  double safe_distance = 0;  // metres; farther points may be too small to be found
  double step = 0;           // radians along the circle from keyframe to keyframe
  double arc = 0;            // radians of wall that carry points, from angle 0
  double visible_arc = 0;    // no camera sees farther to either side, radians

  bool is_closed() const { return arc == 2 * kPi; }
};

inline constexpr double kWallDistance = 4;         // metres
inline constexpr double kKeyframeInterval = 0.25;  // seconds

// Throws Error when the keyframes cannot see all points twice.
RoomPlan PlanRoom(const SyntheticOptions& options, const Rig& rig);

// What place and look of a point are drawn from: points of equal origin look the same.
struct PointOrigin {
  std::uint64_t world = 0, slice = 0;  // of the wall
  std::uint64_t session = 0;           // which alone mapped it, from 1; 0: any

  Random Draw(std::uint64_t seed, Stream stream) const {
    return session == 0 ? Random({seed, world, stream, slice}) : Random({seed, world, stream, slice, session});
  }
};

// The plan with points on its wall: a little inside of it, sorted by angle.
struct Room {
  RoomPlan plan;
  double begin_angle = 0;      // radians about z: where the session begins in the frame that those of a world share
  double phase = 0;            // seconds by which the camera sways otherwise than in other sessions
  double scale = 1;            // map units in a metre
  Pose world_from_room;        // the first camera's frame; with inertial data z up, at the first body
  std::vector<double> angles;  // [0, arc) of the points that the map has
  std::vector<Eigen::Vector3d> points;  // room coordinates
  std::vector<PointOrigin> origins;     // of the points
  std::size_t before = 0;  // points ahead of the first one of the map: seen and not mapped, as those behind
  std::size_t mapped = 0;  // points of the map

  // At any time from -1 s; the first keyframe is at 0. All motion is smooth, for the IMU.
  Pose RoomFromCamera(double seconds) const;
  bool IsMapped(std::size_t point) const { return point >= before && point < before + mapped; }
  Pose WorldFromCamera(double seconds) const { return world_from_room * RoomFromCamera(seconds); }
  // From the frame of the map to the one that all sessions of a world share.
  Similarity3d SharedFromMap() const;
};

Room MakeRoom(const SyntheticOptions& options, const Rig& rig, const RoomPlan& plan, std::uint64_t map);

}  // namespace slamdb::synthetic
