// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/statistics.h"

namespace slamdb {

struct BundleOptions {
  // The keyframes that may move; other keyframes that see the same points are fixed. None: all of the map.
  std::optional<std::vector<KeyFrameId>> keyframes;
  bool fix_poses = false;   // only points move
  bool fix_points = false;  // only keyframes move
  int iterations = 50;      // at most, in each of two rounds
  int threads = 0;          // 0: every core; Ceres itself runs on one, so that the result is the same for any number
  Progress progress;        // may be empty
};

// What held the map where it is.
enum class Gauge {
  kKeyFrame,          // the initial keyframe: its whole pose
  kKeyFrameAndScale,  // that, and the root mean square distance of the other cameras from it: the map has no scale
  kHeading,           // where the initial keyframe is and its heading; its tilt is what gravity says
  kNeighbours,        // keyframes that were not to move
  kPoints,            // they were not to move
};

// `keyframe`, `keyframe-and-scale`, `heading`, `neighbours`, `points`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(Gauge gauge);

struct BundleReport {
  std::uint64_t keyframes = 0, points = 0;  // that could move
  std::uint64_t fixed_keyframes = 0;        // that see the same points
  Gauge gauge = Gauge::kKeyFrame;
  std::uint64_t observations = 0;    // that hold, a pair of fisheye cameras counting twice
  std::uint64_t with_depth = 0;      // of these, of three numbers: stereo or depth
  std::uint64_t inertial_links = 0;  // between keyframes in a row
  std::uint64_t dropped = 0;         // observations that do not fit: erased from point and keyframe
  std::uint64_t removed_points = 0;  // that were left with too few by that
  // Of the observations that stay: robust cost, and reprojection errors in pixels.
  double cost_before = 0, cost_after = 0;
  Distribution error_before, error_after;
  int iterations = 0;
  bool converged = false;
  std::string solver;                 // `dense-schur`, `sparse-schur`, `iterative-schur`, `sparse-cholesky`
  std::vector<std::string> warnings;  // what was left out, one sentence each
};

// Bundle adjustment of a map, in place: the poses and points with the least reprojection error, each in standard
// deviations of its keypoint's octave, with Huber's loss as in ORB-SLAM3 (chi-square 5.991 for two numbers, 7.815 for
// three with stereo or depth). Fisheye pairs are measured in both pictures.
//
// In a map whose IMU is initialised, keyframes in a row are tied by what it measured between them: velocities and
// biases are estimated too, and gravity stays along -z.
//
// Two rounds: after the first, observations beyond those limits or behind their camera are left out; after the second
// all are judged again, and those that do not fit are erased from point and keyframe. A point that loses some goes
// where ORB-SLAM3 would cull it (MapPoint::EraseObservation). Keyframes without observations follow their parent,
// points without enough their reference keyframe.
//
// Viewing directions, distance ranges, positions of bodies, velocities and what is corrected of biases follow.
// Covisibility, descriptors, merge scales and landmarks stay as recorded. A keyframe that did not move keeps its bytes.
// Deterministic: the same for any number of threads.
//
// Throws Error, and then changes nothing:
//   kUnsupported  this slamdb was built without Ceres
//   kNotFound     the atlas has no such map, or the map no such keyframe
//   kUsage        nothing may move
// Cost: a few dozen steps, each linear in the observations and up to cubic in the keyframes that move.
// After Triggs et al., Bundle Adjustment - A Modern Synthesis, 2000; Forster et al., TRO 2017; Campos et al., TRO 2021.
SLAMDB_EXPORT BundleReport AdjustBundle(Atlas& atlas, MapId map, const BundleOptions& options = {});

// The keyframes at a seam: given ones, and of each the `neighbours` that it shares most points with, by id.
// Without any, those with merge or loop edges.
//
// Throws Error (kNotFound): the map has no such keyframe.
// Cost: linear in the observations.
[[nodiscard]] SLAMDB_EXPORT std::vector<KeyFrameId> SeamKeyFrames(const Map& map,
                                                                  std::span<const KeyFrameId> given = {},
                                                                  std::size_t neighbours = 25);

// Whether this slamdb was built with Ceres, which everything here needs.
[[nodiscard]] SLAMDB_EXPORT bool CanOptimize();

}  // namespace slamdb
