// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/detail/branch_geometry.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "slamdb/edit/merge/detail/mixture.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/rotations.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

constexpr int kSweeps = 50;            // of smoothing
constexpr double kWeightOfEdge = 100;  // of parents, loops and neighbours in time, as of covisibility in ORB-SLAM3
constexpr std::int32_t kLeastCovisibility = 15;

template <class Value>
bool IsSame(const Value& a, const Value& b) {
  return std::memcmp(&a, &b, sizeof(Value)) == 0;
}

// ---- a motion as seven numbers about a centre, small ones of which add up

using Twist = Eigen::Matrix<double, 7, 1>;  // turn (axis and angle), shift of the centre, log of the scale

Twist TwistOf(const Similarity3d& motion, const Eigen::Vector3d& center) {
  Twist twist;
  twist << AxisAngleOf(motion.rotation), motion * center - center, std::log(motion.scale);
  return twist;
}

Similarity3d MotionOf(const Twist& twist, const Eigen::Vector3d& center) {
  Similarity3d motion{std::exp(twist[6]), Turn(twist.head<3>()), Eigen::Vector3d::Zero()};
  motion.translation = center + twist.segment<3>(3) - motion.scale * (motion.rotation * center);
  return motion;
}

// ---- pairs of keyframes

template <class Visit>
void ForEachCommon(const Map& a, const Map& b, const Visit& visit) {
  const IdTable rows = KeyFrameTable(b);
  for (std::uint32_t row = 0; row < a.keyframes.size(); ++row) {
    const std::uint32_t other = rows.Find(a.keyframes[row].id.value());
    if (other != kNoRow && IsPosed(a.keyframes[row]) && IsPosed(b.keyframes[other])) visit(row, other);
  }
}

struct Motion {  // of one keyframe, from the source to the target
  Eigen::Vector3d from, to;
  Eigen::Quaterniond turn;
};

double DepthIn(const KeyFrame& keyframe, const MapPoint& point) {
  const Rigid3f pose = keyframe.camera_from_world.Normalized();
  return static_cast<double>((pose.rotation * point.position + pose.translation).z());
}

// How much larger what a keyframe sees is in one map than in another: the median of the points that it sees in both.
class LocalScales {
 public:
  LocalScales(const Map& target, const Map& source)
      : target_(target), source_(source), free_(HasArbitraryScale(target) && HasArbitraryScale(source)) {
    if (!free_) return;
    target_points_ = PointTable(target);
    source_points_ = PointTable(source);
  }

  double Of(const KeyFrame& target, const KeyFrame& source) const {
    std::vector<double> logs;
    for (const MapPointId id : free_ ? source.features.map_points : Column<MapPointId>()) {
      const std::uint32_t there = target_points_.Find(id.value()), here = source_points_.Find(id.value());
      if (there == kNoRow || here == kNoRow) continue;
      const double larger = DepthIn(target, target_.points[there]), smaller = DepthIn(source, source_.points[here]);
      if (larger > 0 && smaller > 0 && std::isfinite(larger / smaller)) logs.push_back(std::log(larger / smaller));
    }
    if (logs.empty()) return 1;
    std::ranges::sort(logs);  // the same whichever of the two maps is the target: between two in the middle
    return std::exp((logs[(logs.size() - 1) / 2] + logs[logs.size() / 2]) / 2);
  }

 private:
  const Map &target_, &source_;
  const bool free_;
  IdTable target_points_, source_points_;
};

// ---- smoothing

struct Neighbour {
  std::uint32_t row;
  double weight;
};

std::vector<std::vector<Neighbour>> TiesOf(const Map& map) {
  const IdTable rows = KeyFrameTable(map);
  std::vector<std::vector<Neighbour>> ties(map.keyframes.size());
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
    const KeyFrame& keyframe = map.keyframes[row];
    const auto tie = [&](KeyFrameId id, double weight) {
      const std::uint32_t other = rows.Find(id.value());
      if (other == kNoRow || other == row) return;
      ties[row].push_back({other, weight});
      ties[other].push_back({row, weight});
    };
    tie(keyframe.parent, kWeightOfEdge);
    tie(keyframe.previous, kWeightOfEdge);
    for (const KeyFrameId other : keyframe.loop_edges) tie(other, kWeightOfEdge);
    for (const KeyFrameId other : keyframe.merge_edges) tie(other, kWeightOfEdge);
    for (const Connection& connection : keyframe.connections)
      if (connection.weight >= kLeastCovisibility) tie(connection.keyframe, connection.weight);
  }
  return ties;
}

// The mean of the neighbours that have a value; none where none has.
std::optional<Twist> MeanOf(const std::vector<Neighbour>& ties, const std::vector<Twist>& twists,
                            const std::vector<std::uint8_t>& settled) {
  Twist sum = Twist::Zero();
  double weight = 0;
  for (const Neighbour& tie : ties) {
    if (!settled[tie.row]) continue;
    sum += tie.weight * twists[tie.row];
    weight += tie.weight;
  }
  if (weight == 0) return std::nullopt;
  return sum / weight;
}

// Values of rows that are not fixed: first each from those next to it that have one, in rounds outwards, then each as
// the mean of all next to it, again and again.
void Smooth(const Map& map, std::vector<std::uint8_t> settled, std::vector<Twist>& twists) {
  const std::vector<std::vector<Neighbour>> ties = TiesOf(map);
  std::vector<std::uint32_t> loose;
  for (std::uint32_t row = 0; row < settled.size(); ++row)
    if (!settled[row]) loose.push_back(row);
  std::vector<std::uint32_t> waiting = loose;
  for (bool any = true; any;) {
    std::vector<std::uint32_t> reached;
    for (const std::uint32_t row : waiting)
      if (const auto mean = MeanOf(ties[row], twists, settled)) {
        twists[row] = *mean;
        reached.push_back(row);
      }
    for (const std::uint32_t row : reached) settled[row] = 1;
    std::erase_if(waiting, [&](std::uint32_t row) { return settled[row] != 0; });
    any = !reached.empty();
  }
  std::vector<Twist> next = twists;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const std::uint32_t row : loose) next[row] = MeanOf(ties[row], twists, settled).value_or(twists[row]);
    twists.swap(next);
    for (const std::uint32_t row : loose) next[row] = twists[row];
  }
}

Similarity3d MeanOf(const std::vector<Motion>& motions, bool with_scale) {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = from;
  Eigen::Matrix4d turns = Eigen::Matrix4d::Zero();  // the mean of quaternions whatever their signs: Markley, 2007
  for (const Motion& motion : motions) {
    from += motion.from;
    to += motion.to;
    turns += motion.turn.coeffs() * motion.turn.coeffs().transpose();
  }
  from /= static_cast<double>(motions.size());
  to /= static_cast<double>(motions.size());
  double spread_from = 0, spread_to = 0;
  for (const Motion& motion : motions) {
    spread_from += (motion.from - from).squaredNorm();
    spread_to += (motion.to - to).squaredNorm();
  }
  Similarity3d mean;
  if (with_scale && spread_from > 0 && spread_to > 0) mean.scale = std::sqrt(spread_to / spread_from);
  const Eigen::Vector4d coefficients = Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(turns).eigenvectors().col(3);
  mean.rotation = Eigen::Quaterniond(coefficients).normalized();
  mean.translation = to - mean.scale * (mean.rotation * from);
  return mean;
}

double SightingsOf(const KeyFrame& keyframe) {
  return static_cast<double>(
      std::ranges::count_if(keyframe.features.map_points, [](MapPointId point) { return point.has_value(); }));
}

// A sum of what both sides changed, by the evidence that each rests on: that of the base is in both.
template <class Value>
Value Weighed(const Value& by_ours, const Value& by_theirs, double ours, double theirs, double base) {
  const double all = std::max({ours + theirs - base, ours, theirs, 1.0});
  return (ours * by_ours + theirs * by_theirs) / all;
}

template <class Value>
Value MeanOf(const Value& of_ours, const Value& of_theirs, double ours, double theirs) {
  return (ours * of_ours + theirs * of_theirs) / (ours + theirs);
}

// Of a state that is no pose: what one side alone changed, or the mean.
template <class Value>
Value ReconcileState(const Value* base, const Value& ours, const Value& theirs, double seen_by_ours,
                     double seen_by_theirs) {
  if (IsSame(ours, theirs) || (base != nullptr && IsSame(*base, theirs))) return ours;
  if (base != nullptr && IsSame(*base, ours)) return theirs;
  return MeanOf(ours, theirs, seen_by_ours, seen_by_theirs);
}

// One keyframe that both sides have.
class ReconciledPose {
 public:
  ReconciledPose(const PoseState* base, const PoseState& ours, const PoseState& theirs)
      : base_(base), ours_(ours), theirs_(theirs) {}

  PoseState Of(double seen_by_base, double seen_by_ours, double seen_by_theirs) const {
    if (IsSame(ours_.values, theirs_.values) || (base_ != nullptr && IsSame(base_->values, theirs_.values)))
      return ours_;
    if (base_ != nullptr && IsSame(base_->values, ours_.values)) return theirs_;
    PoseState pose;
    if (base_ == nullptr) {
      const Eigen::Vector3d turn = TurnFrom(ours_, theirs_) * (seen_by_theirs / (seen_by_ours + seen_by_theirs));
      pose.SetWorldFromCamera(Turn(turn) * ours_.WorldFromCamera().rotation,
                              MeanOf(ours_.Center(), theirs_.Center(), seen_by_ours, seen_by_theirs));
      return pose;
    }
    const Eigen::Vector3d center = base_->Center();
    const auto weighed = [&](const Eigen::Vector3d& by_ours, const Eigen::Vector3d& by_theirs) {
      return Weighed(by_ours, by_theirs, seen_by_ours, seen_by_theirs, seen_by_base);
    };
    const Eigen::Vector3d turn = weighed(TurnFrom(*base_, ours_), TurnFrom(*base_, theirs_));
    pose.SetWorldFromCamera(Turn(turn) * base_->WorldFromCamera().rotation,
                            center + weighed(ours_.Center() - center, theirs_.Center() - center));
    return pose;
  }

 private:
  static Eigen::Vector3d TurnFrom(const PoseState& from, const PoseState& to) {
    return AxisAngleOf(to.WorldFromCamera().rotation * from.WorldFromCamera().rotation.conjugate());
  }

  const PoseState* base_;
  const PoseState &ours_, &theirs_;
};

// A landmark goes with its point, which goes with its reference keyframe; one without with the keyframe next to it.
void CarryLandmarks(const std::vector<Similarity3d>& motions, Map& map) {
  if (map.landmarks.empty()) return;
  const IdTable rows = KeyFrameTable(map), points = PointTable(map);
  const auto nearest = [&](const Eigen::Vector3d& place) {
    std::uint32_t best = kNoRow;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
      if (!IsPosed(map.keyframes[row])) continue;
      const double distance = (CameraCenter(map.keyframes[row]).cast<double>() - place).squaredNorm();
      if (distance < least) best = row;
      least = std::min(least, distance);
    }
    return best;
  };
  for (Landmark& landmark : map.landmarks) {
    const std::uint32_t point = landmark.is_numbered() ? points.Find(landmark.id.value()) : kNoRow;
    std::uint32_t leader = point == kNoRow ? kNoRow : rows.Find(map.points[point].reference.value());
    if (leader == kNoRow) leader = nearest(landmark.mean);
    if (leader != kNoRow) TransformLandmarks(std::span(&landmark, 1), motions[leader]);
  }
}

}  // namespace

std::optional<Similarity3d> MeanMotion(const Map& target, const Map& source, bool with_scale) {
  const MapStates there(target), here(source);
  std::vector<Motion> motions;
  bool same = true;
  ForEachCommon(source, target, [&](std::uint32_t row, std::uint32_t other) {
    same = same && IsSame(here.poses[row].values, there.poses[other].values);
    motions.push_back(
        {here.poses[row].Center(), there.poses[other].Center(),
         there.poses[other].WorldFromCamera().rotation * here.poses[row].WorldFromCamera().rotation.conjugate()});
  });
  if (motions.empty()) return std::nullopt;
  return same ? Similarity3d() : MeanOf(motions, with_scale);
}

Similarity3d Halfway(const Similarity3d& one, const Similarity3d& other, const Map& map) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  std::size_t count = 0;
  for (const KeyFrame& keyframe : map.keyframes)
    if (IsPosed(keyframe)) center += (CameraCenter(keyframe).cast<double>() - center) / static_cast<double>(++count);
  return MotionOf((TwistOf(one, center) + TwistOf(other, center)) / 2, center);
}

bool IsAnotherFrame(const Similarity3d& motion, const Map& map) {
  constexpr double kMostTurn = 0.1, kMostScale = 0.1, kMostShift = 0.2;  // radians, log, share of the map's extent
  Eigen::AlignedBox3f box;
  for (const KeyFrame& keyframe : map.keyframes)
    if (IsPosed(keyframe)) box.extend(CameraCenter(keyframe));
  if (box.isEmpty()) return false;
  const Eigen::Vector3d center = box.center().cast<double>();
  return AxisAngleOf(motion.rotation).norm() > kMostTurn || std::abs(std::log(motion.scale)) > kMostScale ||
         (motion * center - center).norm() > kMostShift * static_cast<double>(box.diagonal().norm());
}

std::optional<Similarity3d> ToAnotherFrame(const Map& target, const Map& source) {
  const auto mean = MeanMotion(target, source, HasArbitraryScale(target) || HasArbitraryScale(source));
  return mean && IsAnotherFrame(*mean, source) ? mean : std::nullopt;
}

BranchMotion Bend(const Targets& targets, int threads, Map& map) {
  BranchMotion report;
  const MapStates before(map);
  MapStates after = before;
  std::vector<Similarity3d> motions(map.keyframes.size());
  std::vector<std::uint8_t> settled(map.keyframes.size(), 0);
  std::vector<Motion> pairs;
  bool moves = false;
  for (std::size_t row = 0; row < targets.size(); ++row) {
    if (!targets[row]) continue;
    const Target& target = *targets[row];
    settled[row] = 1;
    ++report.common;
    after.velocities[row] = target.velocity;
    after.biases[row] = target.bias;
    const Similarity3d here = before.poses[row].WorldFromCamera();
    Similarity3d there = target.pose.WorldFromCamera();
    pairs.push_back({here.translation, there.translation, there.rotation * here.rotation.conjugate()});
    if (IsSame(target.pose.values, before.poses[row].values) && target.scale == 1) continue;
    moves = true;
    there.scale = target.scale;
    motions[row] = there * here.Inverse();
    after.poses[row] = target.pose;
    const double shift = (there.translation - here.translation).norm();
    report.rms += shift * shift;
    report.max = std::max(report.max, shift);
  }
  if (pairs.empty()) return report;
  report.rms = std::sqrt(report.rms / static_cast<double>(report.common));
  if (moves) {
    const Similarity3d mean = MeanOf(pairs, /*with_scale=*/false);
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (const Motion& pair : pairs) center += pair.to / static_cast<double>(pairs.size());
    std::vector<Twist> twists(motions.size(), Twist::Zero());
    for (std::size_t row = 0; row < motions.size(); ++row)
      if (settled[row]) twists[row] = TwistOf(motions[row] * mean.Inverse(), center);
    Smooth(map, settled, twists);
    for (std::size_t row = 0; row < motions.size(); ++row) {
      if (settled[row] || !IsPosed(map.keyframes[row])) continue;
      ++report.carried;
      motions[row] = MotionOf(twists[row], center) * mean;
      const Similarity3d pose = motions[row] * before.poses[row].WorldFromCamera();
      after.poses[row].SetWorldFromCamera(pose.rotation, pose.translation);
    }
    const Moved moved{std::vector<std::uint8_t>(map.keyframes.size(), 1),
                      std::vector<std::uint8_t>(map.points.size(), 0)};
    CarryAlong(map, moved, motions, after);
    CarryLandmarks(motions, map);
  }
  Record(before, after, threads, map);
  return report;
}

Targets PosesOf(const Map& ours, const Map& theirs) {
  const MapStates states(ours);
  const LocalScales scales(ours, theirs);
  Targets targets(theirs.keyframes.size());
  ForEachCommon(theirs, ours, [&](std::uint32_t row, std::uint32_t other) {
    targets[row] = Target{states.poses[other], scales.Of(ours.keyframes[other], theirs.keyframes[row]),
                          states.velocities[other], states.biases[other]};
  });
  return targets;
}

Reconciled Reconcile(const Map* base, const Map& ours, const Map& theirs) {
  const MapStates our_states(ours), their_states(theirs);
  const std::optional<MapStates> base_states = base ? std::optional<MapStates>(*base) : std::nullopt;
  const IdTable base_rows = base ? KeyFrameTable(*base) : IdTable();
  const LocalScales scales(theirs, ours);
  Reconciled result{Targets(ours.keyframes.size()), Targets(theirs.keyframes.size())};
  ForEachCommon(ours, theirs, [&](std::uint32_t our, std::uint32_t their) {
    const KeyFrame &a = ours.keyframes[our], &b = theirs.keyframes[their];
    std::uint32_t row = base_rows.Find(a.id.value());
    if (row != kNoRow && !IsPosed(base->keyframes[row])) row = kNoRow;
    const double by_base = row == kNoRow ? 0 : SightingsOf(base->keyframes[row]), by_ours = SightingsOf(a) + 1,
                 by_theirs = SightingsOf(b) + 1;
    const auto of_base = [&](const auto& states) { return row == kNoRow ? nullptr : &states[row]; };
    Target target;
    target.pose =
        ReconciledPose(base ? of_base(base_states->poses) : nullptr, our_states.poses[our], their_states.poses[their])
            .Of(by_base, by_ours, by_theirs);
    target.velocity = ReconcileState(base ? of_base(base_states->velocities) : nullptr, our_states.velocities[our],
                                     their_states.velocities[their], by_ours, by_theirs);
    target.bias = ReconcileState(base ? of_base(base_states->biases) : nullptr, our_states.biases[our],
                                 their_states.biases[their], by_ours, by_theirs);
    // Lengths are those of the side whose pose it is, or meet halfway.
    const double larger = scales.Of(b, a);  // theirs per ours
    const double share = IsSame(target.pose.values, our_states.poses[our].values)       ? 0
                         : IsSame(target.pose.values, their_states.poses[their].values) ? 1
                                                                                        : 0.5;
    result.ours[our] = result.theirs[their] = target;
    result.ours[our]->scale = std::pow(larger, share);
    result.theirs[their]->scale = std::pow(larger, share - 1);
  });
  return result;
}

}  // namespace slamdb::detail
