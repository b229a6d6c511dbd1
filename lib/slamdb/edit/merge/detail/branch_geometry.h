// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "slamdb/edit/frame/detail/states.h"
#include "slamdb/edit/merge/three_way.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/similarity.h"

// Where the keyframes and points of two continuations of a map come to lie in what is made of both. Equal ids are one
// thing in all maps.
namespace slamdb::detail {

// What is left of a map where another one is: of the keyframes that both have, their mean turn and shift, and with
// `with_scale` how much larger the target is. None: they have no keyframe with a pose in common.
std::optional<Similarity3d> MeanMotion(const Map& target, const Map& source, bool with_scale);

// Whether a motion is more than what optimisation does to a map: another frame, or unit.
bool IsAnotherFrame(const Similarity3d& motion, const Map& map);

// How the source lies in the frame of the target, where that is another one.
std::optional<Similarity3d> ToAnotherFrame(const Map& target, const Map& source);

// The motion between two motions of a map.
Similarity3d Halfway(const Similarity3d& one, const Similarity3d& other, const Map& map);

// Where a keyframe is to be.
struct Target {
  PoseState pose;
  double scale = 1;          // lengths there per length of the map here
  Eigen::Vector3d velocity;  // m/s, world
  Vector6d bias;
};
using Targets = std::vector<std::optional<Target>>;  // by row of a map; none: it goes along

// Bends a map so that keyframes are where they are to be. The others go along smoothly, each as the mean of those that
// it is tied to, by how strongly it is; points go with their reference keyframe. What does not move keeps its bytes.
BranchMotion Bend(const Targets& targets, int threads, Map& map);

// Our poses for theirs.
Targets PosesOf(const Map& ours, const Map& theirs);

// What both sides made of the poses of the base, which may be null. What one side alone changed is as this side has it;
// what both did is weighed by how many sightings each has, and adds up as far as these are not those of the base.
// Of keyframes that the base has not, the mean.
struct Reconciled {
  Targets ours, theirs;
};
Reconciled Reconcile(const Map* base, const Map& ours, const Map& theirs);

}  // namespace slamdb::detail
