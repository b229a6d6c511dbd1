// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/detail/essential_graph.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <set>
#include <utility>

#include "slamdb/base/detail/median.h"
#include "slamdb/base/error.h"
#include "slamdb/model/detail/edges.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/index.h"
#include "slamdb/optimize/detail/find_map.h"

namespace slamdb::detail {
namespace {

using Matrix7d = Eigen::Matrix<double, 7, 7>;

void RequireSense(const PoseConstraint& constraint) {
  const Similarity3d& transform = constraint.first_from_second;
  const std::string pair = ToString(constraint.first) + " and " + ToString(constraint.second);
  if (!IsPose(transform) || !constraint.information.allFinite())
    throw Error(ErrorKind::kUsage, "the constraint between " + pair +
                                       " is no transform: it holds what is not finite, "
                                       "or a scale that is not positive");
  if (constraint.first == constraint.second)
    throw Error(ErrorKind::kUsage, "a constraint is between " + ToString(constraint.first) + " and itself");
}

Similarity3d Between(const MapStates& states, std::uint32_t first, std::uint32_t second) {
  return states.poses[first].WorldFromCamera().Inverse() * states.poses[second].WorldFromCamera();
}

class Collector {
 public:
  Collector(const Map& map, const MapStates& states, const PoseGraphOptions& options, double depth)
      : map_(map), states_(states), rows_(KeyFrameTable(map)), sessions_(map.keyframes.size(), 0) {
    for (std::uint32_t session = 0; session < options.sessions.size(); ++session)
      for (const KeyFrameId keyframe : options.sessions[session])
        if (const std::uint32_t row = rows_.Find(keyframe.value()); row != kNoRow) sessions_[row] = session;
    unit_.setIdentity();
    unit_.diagonal().segment<3>(3).setConstant(1 / depth);
  }

  void AddConstraints(const std::vector<PoseConstraint>& constraints, std::uint64_t& count) {
    for (const PoseConstraint& constraint : constraints) {
      RequireSense(constraint);
      const std::vector<std::uint32_t> ends = RowsOf(map_, std::vector{constraint.first, constraint.second});
      if (!IsPosed(map_.keyframes[ends[0]]) || !IsPosed(map_.keyframes[ends[1]])) continue;
      const Eigen::LLT<Matrix7d> root(constraint.information);
      if (root.info() != Eigen::Success)
        throw Error(ErrorKind::kUsage, "the information of a constraint is not positive definite");
      Similarity3d measured = constraint.first_from_second;
      measured.rotation.normalize();
      edges_.push_back({ends[0], ends[1], measured, Matrix7d(root.matrixU()) * unit_});
      taken_.insert(std::minmax(ends[0], ends[1]));
      ++count;
    }
  }

  // As the map has it, unless there is an edge between the two already, or they are of two sessions.
  void Add(std::uint32_t first, KeyFrameId other, std::uint64_t& count) {
    const std::uint32_t second = rows_.Find(other.value());
    if (second == kNoRow || second == first || !IsPosed(map_.keyframes[second]) || !IsPosed(map_.keyframes[first]))
      return;
    if (sessions_[first] != sessions_[second] || !taken_.insert(std::minmax(first, second)).second) return;
    edges_.push_back({first, second, Between(states_, first, second), unit_});
    ++count;
  }

  std::vector<PoseEdge> Take() { return std::move(edges_); }

 private:
  const Map& map_;
  const MapStates& states_;
  const IdTable rows_;
  std::vector<std::uint32_t> sessions_;  // by row of the keyframes
  Matrix7d unit_;
  std::vector<PoseEdge> edges_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> taken_;
};

}  // namespace

std::vector<PoseEdge> EssentialGraph(const Map& map, const MapStates& states, const PoseGraphOptions& options,
                                     double depth, PoseGraphReport& report) {
  Collector collector(map, states, options, depth);
  collector.AddConstraints(options.constraints, report.constraints);
  const auto count_of = [&](Tie tie) -> std::uint64_t& {
    switch (tie) {
      case Tie::kTree:
        return report.tree_edges;
      case Tie::kLoop:
        return report.loop_edges;
      case Tie::kMerge:
        return report.merge_edges;
      case Tie::kInertial:
        return report.inertial_edges;
      case Tie::kCovisibility:
        break;
    }
    return report.covisibility_edges;
  };
  ForEachTie(map, options.min_weight,
             [&](std::uint32_t row, KeyFrameId other, Tie tie) { collector.Add(row, other, count_of(tie)); });
  return collector.Take();
}

double MedianDepth(const Map& map, const MapStates& states) {
  const IdTable rows = KeyFrameTable(map);
  std::vector<double> depths;
  for (std::size_t row = 0; row < map.points.size(); ++row) {
    const std::uint32_t reference = rows.Find(map.points[row].reference.value());
    if (reference == kNoRow || !IsPlaced(map.points[row]) || !IsPosed(map.keyframes[reference])) continue;
    depths.push_back((states.points[row] - states.poses[reference].Center()).norm());
  }
  const double median = MedianOf(std::move(depths));
  return median > 0 ? median : 1;
}

}  // namespace slamdb::detail
