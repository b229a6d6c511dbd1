// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/synthetic/detail/room.h"

#include <algorithm>
#include <cmath>

#include "slamdb/base/error.h"
#include "slamdb/synthetic/detail/random.h"

namespace slamdb::synthetic {
namespace {

constexpr double kLaps = 1.15;          // with loops: the last part of the way sees the first part again
constexpr double kOpenLap = 0.9;        // without loops
constexpr double kWallDepth = 0.4;      // metres that points stand out of the wall
constexpr double kBob = 0.2;            // metres, up and down
constexpr double kSway = 0.03;          // radians of yaw, pitch and roll each
constexpr double kMargin = 0.1;         // radians at the image border: sway, kImageMargin, the right camera's offset
constexpr double kUsedFeatures = 0.85;  // of the features at most may see points
constexpr double kMostObservers = 40;   // of a point, about, where a keyframe sees enough points all the same
constexpr double kEnoughPoints = 60;    // before a camera

// Where a camera on the inner circle sees the wall under `view` radians off its axis: radians along the circle.
double ArcSeen(double path_radius, double wall_radius, double view) {
  const double sine = path_radius / wall_radius * Sine(view);
  return view - ArcTangent(sine, std::sqrt(1 - sine * sine));
}

// The plan in which every camera surely sees `safe_arc` to either side.
RoomPlan PlanFor(double safe_arc, const SyntheticOptions& options, const Rig& rig) {
  RoomPlan plan;
  // The foremost points, at r = wall - kWallDepth, are at the border of the safe view:
  // r sin(arc) / (r cos(arc) - path) = tan(view), and path = wall - kWallDistance.
  const double view = rig.half_width - kMargin;
  const double c = Cosine(safe_arc) - Sine(safe_arc) * Cosine(view) / Sine(view);
  plan.wall_radius = (kWallDistance - kWallDepth * c) / (1 - c);
  plan.path_radius = plan.wall_radius - kWallDistance;
  plan.visible_arc = std::min(kPi, 1.05 * ArcSeen(plan.path_radius, plan.wall_radius, rig.half_width + kMargin));
  const double least_depth = (plan.wall_radius - kWallDepth) * Cosine(safe_arc) - plan.path_radius;
  // Seen from the side of a fisheye image the wall spans less height than in its middle, hence the cosine.
  const double tilt = (rig.half_height - kMargin) * Cosine(rig.is_fisheye() ? view : 0);
  plan.half_height = least_depth * Sine(tilt) / Cosine(tilt) - kBob;
  plan.safe_distance = Norm({plan.wall_radius * Cosine(safe_arc) - plan.path_radius, plan.wall_radius * Sine(safe_arc),
                             plan.half_height + kBob});
  const double steps = static_cast<double>(std::max<std::size_t>(options.keyframes, 2) - 1);
  plan.step = std::min(2 * kPi * (options.loops ? kLaps : kOpenLap) / steps, 0.85 * safe_arc);
  plan.arc = std::min(2 * kPi, plan.step * steps);
  return plan;
}

double PointsBefore(const RoomPlan& plan, const SyntheticOptions& options) {
  return static_cast<double>(options.points) * std::min(1.0, 2 * plan.visible_arc / plan.arc);
}

}  // namespace

RoomPlan PlanRoom(const SyntheticOptions& options, const Rig& rig) {
  const double rows_per_point = rig.is_fisheye() ? 2 : 1;
  const double capacity = kUsedFeatures * static_cast<double>(options.features) / rows_per_point;
  const double widest = 0.75 * (rig.half_width - kMargin);
  const double keyframes = static_cast<double>(options.keyframes), points = static_cast<double>(options.points);
  double safe_arc = widest;
  if (points > 0) safe_arc = std::min(widest, std::max(kMostObservers / keyframes, kEnoughPoints / points) * kPi);
  RoomPlan plan = PlanFor(safe_arc, options, rig);
  while (PointsBefore(plan, options) > capacity && plan.arc >= 2 * kPi * kOpenLap * 0.999) {
    safe_arc *= 0.95;
    plan = PlanFor(safe_arc, options, rig);
  }
  const double needed = PointsBefore(plan, options);
  if (needed > capacity) {
    const auto features = static_cast<std::size_t>(std::ceil(needed * rows_per_point / kUsedFeatures));
    throw Error(ErrorKind::kUsage, std::to_string(options.keyframes) + " keyframes of " +
                                       std::to_string(options.features) + " features cannot see " +
                                       std::to_string(options.points) + " points twice each; ask for " +
                                       std::to_string(features) + " features, more keyframes or fewer points");
  }
  return plan;
}

Pose Room::RoomFromCamera(double seconds) const {
  const double turn = plan.step / kKeyframeInterval * seconds;
  Eigen::Matrix3d room_from_heading;  // z ahead to the wall, x right, y down
  room_from_heading << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Matrix3d sway =
      Rotation({kSway * Sine(0.9 * seconds), kSway * Sine(1.1 * seconds + 1), kSway * Sine(0.7 * seconds + 2)});
  const Eigen::Matrix3d heading = Rotation({0, 0, turn});
  const Eigen::Vector3d center(plan.path_radius * Cosine(turn), plan.path_radius * Sine(turn),
                               kBob * Sine(1.3 * seconds + 0.5));
  return {Product(Product(heading, room_from_heading), sway), center};
}

Room MakeRoom(const SyntheticOptions& options, const Rig& rig, const RoomPlan& plan, std::uint64_t map) {
  Room room;
  room.plan = plan;
  const Pose room_from_camera = room.RoomFromCamera(0);
  room.world_from_room = options.inertial
                             ? Pose{Eigen::Matrix3d::Identity(), -(room_from_camera * rig.camera_from_body.translation)}
                             : room_from_camera.Inverse();
  room.angles.reserve(options.points);
  room.points.reserve(options.points);
  for (std::size_t i = 0; i < options.points; ++i) {
    Random random({options.seed, map, kPlace, i});
    // One point in each slice of the wall, so that no camera has more before it than planned.
    const double angle = plan.arc * (static_cast<double>(i) + random.Uniform()) / static_cast<double>(options.points);
    const double radius = plan.wall_radius - kWallDepth * random.Uniform();
    room.angles.push_back(angle);
    room.points.push_back({radius * Cosine(angle), radius * Sine(angle), plan.half_height * random.Uniform(-1, 1)});
  }
  return room;
}

}  // namespace slamdb::synthetic
