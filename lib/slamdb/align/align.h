// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/similarity.h"

namespace slamdb {

enum class AlignmentVerdict {
  kAligned,    // sure enough to join the maps
  kDoubtful,   // something agrees, but it could be a look-alike, or the patch is too small to tell
  kNoOverlap,  // nothing agrees, or what does is contradicted by the pictures
};

// `aligned`, `doubtful`, `no-overlap`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(AlignmentVerdict verdict);

// One of the maps of an atlas. Refers to the atlas.
struct MapRef {
  const Atlas* atlas;
  std::size_t map;  // row of Atlas::maps
};

struct AlignOptions {
  bool own_vocabulary = false;  // do not trust the recorded bags of words to be of one vocabulary, though the names are
  int threads = 0;              // 0: every core
  Progress progress;            // may be empty
};

// Two keyframes that see the same, one of each map.
struct AlignedPair {
  KeyFrameId first, second;
  std::uint64_t inliers = 0;       // points of both that agree
  Similarity3d first_from_second;  // of left cameras, by these points alone; its scale is a length of the first map per
                                   // length of the second
};

// A point of each map that are the same thing.
struct MatchedPoints {
  MapPointId first, second;
  float error = 0;  // reprojection in the worse of the two pictures, in sigmas of its keypoint
};

// What the verdict rests on.
struct AlignmentEvidence {
  bool own_vocabulary = false;       // the maps share none: one was trained on them
  std::uint64_t candidates = 0;      // pairs of keyframes that were compared
  std::uint64_t agreeing = 0;        // of them, that agree with the transform
  std::uint64_t keyframes = 0;       // different keyframes of the second map in these
  std::uint64_t contradicting = 0;   // pairs that agree, among themselves, on the best other transform
  std::uint64_t points = 0;          // different points of the second map that were matched
  double extent = 0;                 // of the matched patch, across its second axis, in median depths of the first map
  double found_share = 0;            // of what pictures of one map must see of the other, in the better direction
  double cell_share = 0;             // of the parts of these pictures, those in which something was found
  double front_share = 0;            // of these points, those in front of what the picture sees
  std::uint64_t views = 0;           // pictures of both maps that should see enough of the other to tell
  std::uint64_t agreeing_views = 0;  // that find a fifth of it
  double overlap = 0;                // share of the second map's keyframes with a near view in the first
  double rms = 0;  // reprojection of matched points in the other map's pictures, in sigmas of keypoints
};

// How the second of two maps lies in the first.
struct Alignment {
  AlignmentVerdict verdict = AlignmentVerdict::kNoOverlap;
  std::string reason;  // one sentence: what decided
  // The best transform; none when nothing agreed.
  std::optional<Similarity3d> first_from_second;
  bool scale_is_free = false;  // one of the maps has no scale of its own
  // Covariance of a small motion of the second map about `center`: rotation vector (radians), translation (first map's
  // units), log of the scale. Given the maps as they are: what they are bent by themselves is not in it.
  Eigen::Matrix<double, 7, 7> covariance = Eigen::Matrix<double, 7, 7>::Zero();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of the matched points, in the first map
  AlignmentEvidence evidence;
  std::vector<AlignedPair> pairs;      // that agree, most inliers first
  std::vector<MatchedPoints> matches;  // a point may be in several: maps hold many things twice
};

// Standard deviations of an alignment, given the maps as they are.
struct AlignmentPrecision {
  double rotation_degrees = 0;  // about the axis about which it is least known
  double translation = 0;       // likewise, of the middle of what both maps see; first map's units
  double scale = 0;             // as a share of it; 0 where the scale is not free
};
[[nodiscard]] SLAMDB_EXPORT AlignmentPrecision PrecisionOf(const Alignment& alignment);

// Finds how two maps lie to each other that nobody aligned, from what their files hold: poses, keypoints, descriptors,
// bags of words, points and cameras.
// Places are recognised by bags of words, matched and verified one by one; what many agree on is refined over all
// matches, and then the pictures of each map are held against the points of the other.
// The maps may be of one atlas. Their scales may differ where one of them is monocular without IMU.
// Deterministic: the result is the same for any number of threads.
//
// Maps without descriptors, as those of trajectories, do not overlap: the reason says so.
// Cost: below linear in the pairs of keyframes: about three comparisons for each keyframe of the second map at most.
// After ORB-SLAM3's map merging (Campos et al., TRO 2021), with the verification that offline allows.
[[nodiscard]] SLAMDB_EXPORT Alignment AlignMaps(MapRef first, MapRef second, const AlignOptions& options = {});

}  // namespace slamdb
