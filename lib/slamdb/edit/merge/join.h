// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/edit/merge/fuse.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/similarity.h"

namespace slamdb {

// Two keyframes that were taken at one place: one of the first map, one of the second.
struct KeyFramePair {
  KeyFrameId first, second;
  friend bool operator==(const KeyFramePair&, const KeyFramePair&) = default;
};

// A place in the coordinates of both maps.
struct PlacePair {
  Eigen::Vector3d first, second;
};

struct JoinOptions {
  MapId first, second;                            // the second is moved into the first
  std::optional<Similarity3d> first_from_second;  // without it, it is solved from anchors and places
  std::vector<KeyFramePair> anchors;              // by their camera centres
  std::vector<PlacePair> places;
  std::vector<KeyFramePair> merge_edges;   // further pairs that see the same, for a merge edge each; need not be there
  std::optional<bool> with_scale;          // when solved; by default only when one of the maps is monocular without IMU
  std::optional<double> outlier_distance;  // anchors that lie farther apart are left out; units of the first map
  bool force = false;                      // join also what makes the result wrong: a scale that is not the other's
  std::optional<FuseOptions> fuse;         // fuse what both maps have; threads and progress are those of the join
  int threads = 0;                         // 0: every core
  Progress progress;                       // may be empty
};

// How well anchors and places fit the transform; first those, then these.
struct AnchorFit {
  std::vector<double> residuals;  // first map's units
  std::vector<std::uint8_t> inliers;
  double rms = 0, max = 0;  // of the inliers
};

struct JoinReport {
  MapId first, second;  // the second is gone
  Similarity3d first_from_second;
  std::optional<AnchorFit> fit;             // when the transform was solved
  KeyFramePair link;                        // joined by a merge edge and in the spanning tree; none without keyframes
  double link_distance = 0;                 // between their camera centres after the move
  std::uint64_t keyframes = 0, points = 0;  // that changed map
  bool left_inertial = false;               // one map was inertial, the other not: the result is not
  std::vector<std::string> warnings;     // what does not go together (IMU and its state, stereo and monocular, scale,
                                         // cameras), a poor fit, maps far apart, and TransformWarnings of the second
  std::optional<FuseReport> fused;       // points, where both maps have some
  std::uint64_t landmarks = 0;           // that changed map
  std::uint64_t fused_landmarks = 0;     // of those: went into landmarks of the same thing
  std::optional<FuseAlikeReport> alike;  // how those of maps without points were compared
};

// Moves the second map into the world frame of the first and makes one map of both, as ORB-SLAM3's merge does but for
// what docs/merge.md names.
// Entities keep their ids and origin maps; the first map keeps its id, its root and its origins.
// The second spanning tree is turned round so that it hangs, by the linked keyframe, on the linked keyframe of the
// first; both get a merge edge and may not be culled.
// The linked pair is the anchor that fits best.
// Without anchors it is the pair of keyframes that look at most of the same: close to each other for the depth of the
// scene, and in the same direction.
// Landmarks of the second map come along.
// Those of equal ids, and those of points that are fused, become one (landmarks.h).
//
// Maps of landmarks alone are joined, too: without a transform and anchors they are taken to be in one frame, and
// fusing compares the landmarks themselves (FuseAlikeLandmarks). There is no link where a map has no keyframes.
//
// Throws Error, and then changes nothing:
//   kUsage        both maps are one, there is nothing to solve the transform from, or the transform is none
//   kNotPossible  one map is metric and the other of arbitrary scale, and the transform has none; a map or a keyframe
//   is not there, a map is empty, ids are there more than once, lists hold null
//                 pointers or repetitions, or the transform cannot be solved
// Cost: linear, in place (the pair is sought among at most a few thousand keyframes of each map); the result is the
// same for any number of threads.
SLAMDB_EXPORT JoinReport JoinMaps(Atlas& atlas, const JoinOptions& options);

}  // namespace slamdb
