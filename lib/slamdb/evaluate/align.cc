// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/evaluate/detail/align.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/model/umeyama.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kFewestToSolve = 3;

bool IsSolved(AlignmentKind kind) { return kind != AlignmentKind::kNone && kind != AlignmentKind::kOrigin; }

Similarity3d OntoFirst(const PairedTrajectories& paired) {
  const TrajectoryPose& from = paired.estimate[paired.pairs.front().estimate];
  const TrajectoryPose& to = paired.reference[paired.pairs.front().reference];
  const Eigen::Quaterniond rotation = to.rotation * from.rotation.conjugate();
  return {1, rotation, to.position - rotation * from.position};
}

void Solve(const PairedTrajectories& paired, std::size_t count, AppliedAlignment& alignment) {
  std::vector<Eigen::Vector3d> source, target;
  source.reserve(count);
  target.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    source.push_back(paired.estimate[paired.pairs[i].estimate].position);
    target.push_back(paired.reference[paired.pairs[i].reference].position);
  }
  const bool with_scale = alignment.kind != AlignmentKind::kSe3;
  try {
    const UmeyamaResult fit = SolveUmeyama(source, target, {.with_scale = with_scale, .accept_line = true});
    alignment.reference_from_estimate = fit.target_from_source;
    alignment.on_line = fit.on_line;
  } catch (const Error& error) {
    throw Error(error.kind(), error.problem() + "; EvaluationOptions::alignment can be origin or none");
  }
  alignment.pairs = count;
  if (alignment.kind == AlignmentKind::kScale) {
    alignment.reference_from_estimate = {.scale = alignment.reference_from_estimate.scale};
    alignment.on_line = false;  // whose rotation would be arbitrary
  }
}

}  // namespace

AppliedAlignment Align(PairedTrajectories& paired, AlignmentKind kind, const EvaluationOptions& options) {
  AppliedAlignment alignment{.kind = kind};
  const std::size_t needed = IsSolved(kind) ? kFewestToSolve : 1;
  if (paired.pairs.size() < needed)
    throw Error(ErrorKind::kNotPossible,
                Concat(paired.pairs.size(), " of ", Counted(paired.estimate.size(), "pose"),
                       paired.estimate.size() == 1 ? " has" : " have", " a pose of the truth at their time, but ",
                       needed == 1 ? "one is" : "three are", " needed: ", WhyFewPairs(paired, options)));
  if (kind == AlignmentKind::kNone) return alignment;
  if (IsSolved(kind)) {
    const std::size_t first = options.align_first;
    Solve(paired, first == 0 ? paired.pairs.size() : std::min(first, paired.pairs.size()), alignment);
  } else {
    alignment.reference_from_estimate = OntoFirst(paired);
    alignment.pairs = 1;
  }
  const Similarity3d& move = alignment.reference_from_estimate;
  for (TrajectoryPose& pose : paired.estimate) {
    pose.position = move * pose.position;
    pose.rotation = move.rotation * pose.rotation;
  }
  return alignment;
}

}  // namespace slamdb::detail
