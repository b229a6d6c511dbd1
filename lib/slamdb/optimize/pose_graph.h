// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/similarity.h"

namespace slamdb {

// What is known of how two keyframes really lie to each other: a loop that was found, a link between joined maps.
struct PoseConstraint {
  KeyFrameId first, second;
  Similarity3d first_from_second;  // of left cameras; its scale is a length of the first per length of the second
  // Of turn (radians), shift (median depths of the scene) and log of the scale. Identity, as in ORB-SLAM3, makes it
  // weigh as an edge of the map.
  Eigen::Matrix<double, 7, 7> information = Eigen::Matrix<double, 7, 7>::Identity();
};

struct PoseGraphOptions {
  std::vector<PoseConstraint> constraints;
  // Keyframes of different ones are tied by constraints alone: how they lie is what is to be found. None: all are of
  // one.
  std::vector<std::vector<KeyFrameId>> sessions;
  int min_weight = 100;  // of covisibility, for an edge
  int iterations = 50;   // at most
  int threads = 0;       // 0: every core; Ceres itself runs on one, so that the result is the same for any number
  Progress progress;     // may be empty
};

// A table in any dialect of schema/tables.md with the columns first, second, tx, ty, tz, qx, qy, qz, qw and, if the
// scale is not 1, scale: where the camera of the second keyframe is in the frame of the first one's.
//
// Throws Error (kDamaged) with line and column; of a file also as reading it does, with its path.
[[nodiscard]] SLAMDB_EXPORT std::vector<PoseConstraint> ParseConstraints(std::string_view csv);
[[nodiscard]] SLAMDB_EXPORT std::vector<PoseConstraint> ReadConstraints(const std::string& path,
                                                                        Notices* notices = nullptr);

// How a keyframe may move.
enum class PoseFreedom {
  kSimilarity,  // rotation, translation, scale: the map has no scale of its own
  kRigid,       // rotation and translation
  kUpright,     // rotation about the vertical and translation: the map knows gravity
};

// `similarity`, `rigid`, `upright`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(PoseFreedom freedom);

struct PoseGraphReport {
  PoseFreedom freedom = PoseFreedom::kRigid;
  std::uint64_t keyframes = 0;  // in the graph
  // Edges of the graph, each counted under the first name that it has.
  std::uint64_t constraints = 0, tree_edges = 0, loop_edges = 0, merge_edges = 0, inertial_edges = 0,
                covisibility_edges = 0;
  // Of the constraints, how far they are from being met: root mean squares.
  struct Gap {
    double translation = 0;  // the map's units
    double degrees = 0;
    double scale = 0;  // log
  };
  Gap gap_before, gap_after;
  double cost_before = 0, cost_after = 0;
  double largest_shift = 0;  // of a camera, the map's units
  int iterations = 0;
  bool converged = false;
};

// Bends a map so that constraints are met: the least change of how neighbours lie to each other, over the essential
// graph of its keyframes (spanning tree, strong covisibility, loop and merge edges, keyframes in a row of an inertial
// map). Edges of the map are measured from the poses as they are, so without constraints nothing moves.
// The initial keyframe stays. Points follow their reference keyframe, and the rest of the map as in AdjustBundle.
// Deterministic: the same for any number of threads.
//
// Throws Error, and then changes nothing:
//   kUnsupported  this slamdb was built without Ceres
//   kNotFound     the atlas has no such map, or the map no keyframe of a constraint
//   kUsage        a constraint is of a keyframe with itself, or not finite
// Cost: a few dozen steps, each about linear in keyframes and edges.
// After Strasdat et al., Scale Drift-Aware Large Scale Monocular SLAM, RSS 2010; Campos et al., TRO 2021.
SLAMDB_EXPORT PoseGraphReport OptimizePoseGraph(Atlas& atlas, MapId map, const PoseGraphOptions& options);

}  // namespace slamdb
