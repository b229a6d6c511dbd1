// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/synthetic/detail/room.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

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

constexpr double kStrip = 1, kMostLift = 0.3;  // metres: of the wall that a look-alike room copies
constexpr double kSessionPhase = 17;           // seconds

// How often a camera goes round. Sessions share a round, so that their arcs meet only where they should: what the last
// camera sees ends where the first session begins.
double LapsOf(const SyntheticOptions& options, double visible_arc) {
  if (!options.sessions) return options.loops ? kLaps : kOpenLap;
  const double own = options.sessions->look_alike ? 0 : 1 - options.sessions->overlap;
  return std::min(kOpenLap, 1 - visible_arc / (2 * kPi)) / (1 + own * (options.maps - 1));
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
  // Sessions step less, and so may have higher walls: their corners are seen from half as far away.
  const double part = options.sessions ? 0.5 : 1;
  const double least_depth = (plan.wall_radius - kWallDepth) * Cosine(part * safe_arc) - plan.path_radius;
  // Seen from the side of a fisheye image the wall spans less height than in its middle, hence the cosine.
  const double tilt = (rig.half_height - kMargin) * Cosine(rig.is_fisheye() ? part * view : 0);
  plan.half_height = least_depth * Sine(tilt) / Cosine(tilt) - kBob;
  plan.safe_distance = Norm({plan.wall_radius * Cosine(safe_arc) - plan.path_radius, plan.wall_radius * Sine(safe_arc),
                             plan.half_height + kBob});
  const double steps = static_cast<double>(std::max<std::size_t>(options.keyframes, 2) - 1);
  plan.step = std::min(2 * kPi * LapsOf(options, plan.visible_arc) / steps, 0.85 * part * safe_arc);
  plan.arc = std::min(2 * kPi, plan.step * steps);
  return plan;
}

double PointsBefore(const RoomPlan& plan, const SyntheticOptions& options) {
  const double share = 2 * plan.visible_arc / plan.arc;  // sessions see beyond what they map
  return static_cast<double>(options.points) * (options.sessions ? share : std::min(1.0, share));
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
  while (PointsBefore(plan, options) > capacity &&
         plan.arc >= 2 * kPi * std::min(kOpenLap, LapsOf(options, plan.visible_arc)) * 0.999) {
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
  const double turn = plan.step / kKeyframeInterval * seconds, time = seconds + phase;
  Eigen::Matrix3d room_from_heading;  // z ahead to the wall, x right, y down
  room_from_heading << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Matrix3d sway =
      Rotation({kSway * Sine(0.9 * time), kSway * Sine(1.1 * time + 1), kSway * Sine(0.7 * time + 2)});
  const Eigen::Matrix3d heading = Rotation({0, 0, turn});
  const Eigen::Vector3d center(plan.path_radius * Cosine(turn), plan.path_radius * Sine(turn),
                               kBob * Sine(1.3 * time + 0.5));
  return {Product(Product(heading, room_from_heading), sway), center};
}

namespace {

// Log-uniform between 0.1 and 10.
double DrawScale(Random& random) {
  double scale = 0.1, root = 100;
  for (int bit = 0; bit < 16; ++bit) {
    root = std::sqrt(root);
    if (random.Chance(0.5)) scale *= root;
  }
  return scale;
}

// Where the points of a map come from when it is the `map`th session. Slices of the wall are counted from where the
// session begins; below 0 and from the number of points on they are seen and not mapped.
class Session {
 public:
  Session(const SyntheticOptions& options, const RoomPlan& plan, std::uint64_t map) : options_(options), map_(map) {
    const auto points = static_cast<double>(options.points);
    if (!options.sessions->look_alike)
      first_slice_ = std::llround(points * (1 - options.sessions->overlap) * static_cast<double>(map));
    strip_ = std::max<std::int64_t>(1, static_cast<std::int64_t>(points * kStrip / (plan.arc * plan.wall_radius)));
    copied_.resize(options.points / static_cast<std::size_t>(strip_));
    std::iota(copied_.begin(), copied_.end(), std::int64_t{0});
    Random random({options.seed, map, Stream::kStrip});
    for (std::size_t i = copied_.size(); i > 1; --i) std::swap(copied_[i - 1], copied_[random.Below(i)]);
  }

  std::int64_t first_slice() const { return first_slice_; }

  PointOrigin OriginOf(std::int64_t slice) const {
    const SessionOptions& sessions = *options_.sessions;
    const bool is_copy = IsCopy(slice);
    const std::int64_t place = is_copy ? copied_[StripOf(slice)] * strip_ + slice % strip_ : first_slice_ + slice;
    PointOrigin origin{.world = sessions.look_alike && !is_copy ? map_ : 0, .slice = static_cast<std::uint64_t>(place)};
    Random random({options_.seed, map_, kPrivate, static_cast<std::uint64_t>(slice)});
    if (random.Chance(1 - std::sqrt(sessions.common))) origin.session = map_ + 1;
    return origin;
  }

  // Metres by which a point hangs higher than what it is a copy of.
  double LiftOf(std::int64_t slice) const {
    if (!IsCopy(slice)) return 0;
    return Random({options_.seed, map_, Stream::kStrip, StripOf(slice) + 1}).Uniform(-kMostLift, kMostLift);
  }

 private:
  std::size_t StripOf(std::int64_t slice) const { return static_cast<std::size_t>(slice / strip_); }
  bool IsCopy(std::int64_t slice) const {
    return options_.sessions->look_alike && map_ > 0 && slice >= 0 && StripOf(slice) % 2 == 1 &&
           StripOf(slice) < copied_.size();
  }

  const SyntheticOptions& options_;
  const std::uint64_t map_;
  std::int64_t first_slice_ = 0, strip_ = 1;  // slices of a strip
  std::vector<std::int64_t> copied_;          // by strip, the one of the first session
};

void MovePathOf(Room& room, const SyntheticOptions& options, const Session& session, std::uint64_t map) {
  room.begin_angle = room.plan.arc * static_cast<double>(session.first_slice()) / static_cast<double>(options.points);
  room.phase = kSessionPhase * static_cast<double>(map);
  Random random({options.seed, map, kScale});
  if (options.sensor == Sensor::kMonocular && !options.inertial) room.scale = DrawScale(random);
}

// Points on the wall: those of the map, and for a session those that its cameras see ahead of and behind them.
void HangPoints(Room& room, const SyntheticOptions& options, const std::optional<Session>& session, std::uint64_t map) {
  const RoomPlan& plan = room.plan;
  const double slice = plan.arc / static_cast<double>(options.points);  // radians
  if (session) room.before = static_cast<std::size_t>(std::min(plan.visible_arc, kPi - plan.arc / 2) / slice);
  room.mapped = options.points;
  const std::size_t seen = options.points + 2 * room.before;
  room.angles.reserve(seen);
  room.points.reserve(seen);
  room.origins.reserve(seen);
  for (std::size_t i = 0; i < seen; ++i) {
    const std::int64_t place = static_cast<std::int64_t>(i) - static_cast<std::int64_t>(room.before);
    const PointOrigin origin = session ? session->OriginOf(place) : PointOrigin{.world = map, .slice = i};
    Random random = origin.Draw(options.seed, kPlace);
    // One point in each slice of the wall, so that no camera has more before it than planned.
    const double angle =
        plan.arc * (static_cast<double>(place) + random.Uniform()) / static_cast<double>(options.points);
    const double radius = plan.wall_radius - kWallDepth * random.Uniform();
    double height = plan.half_height * random.Uniform(-1, 1);
    if (session) height = std::clamp(height + session->LiftOf(place), -plan.half_height, plan.half_height);
    room.angles.push_back(angle);
    room.points.push_back({radius * Cosine(angle), radius * Sine(angle), height});
    room.origins.push_back(origin);
  }
}

}  // namespace

Similarity3d Room::SharedFromMap() const {
  const Pose shared_from_map = Pose{Rotation({0, 0, begin_angle}), Eigen::Vector3d::Zero()} * world_from_room.Inverse();
  return {1 / scale, Eigen::Quaterniond(shared_from_map.rotation), shared_from_map.translation};
}

Room MakeRoom(const SyntheticOptions& options, const Rig& rig, const RoomPlan& plan, std::uint64_t map) {
  Room room;
  room.plan = plan;
  std::optional<Session> session;
  if (options.sessions && options.points > 0) {
    session.emplace(options, plan, map);
    MovePathOf(room, options, *session, map);
  }
  const Pose room_from_camera = room.RoomFromCamera(0);
  room.world_from_room = options.inertial
                             ? Pose{Eigen::Matrix3d::Identity(), -(room_from_camera * rig.camera_from_body.translation)}
                             : room_from_camera.Inverse();
  HangPoints(room, options, session, map);
  return room;
}

}  // namespace slamdb::synthetic
