// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

// MRPT's landmarks and ORB-SLAM3's map points are two views of one thing.
// docs/landmarks.md has the table of fields.
namespace slamdb {

struct MakeLandmarksOptions {
  double pixel_sigma = 1;  // standard deviation of a keypoint at octave 0, pixels: covariance.h
  int threads = 0;         // 0: every core
  Progress progress;       // may be empty
};

struct MakeLandmarksReport {
  std::uint64_t landmarks = 0;
  std::uint64_t undetermined = 0;  // of those: covariance 0, because the observations do not determine it
  std::uint64_t bad = 0;           // points flagged bad, of which none was made
};

// Gives every map a landmark for each of its good points, in their order, in place of those of the same id.
// Landmarks of no point stay behind them.
// A landmark has
//   its point's id, position and unit normal
//   the covariance that the observations give it, rounded to the floats that MRPT 2 keeps
//   how many keyframes observe it, and when the last of them did
//   one ORB feature: the keypoint of the reference keyframe with the point's descriptor
//
// Throws Error (kUsage), before anything changes, when the sigma is not above 0.
// Cost: linear, in place; the result is the same for any number of threads.
SLAMDB_EXPORT MakeLandmarksReport MakeLandmarks(Atlas& atlas, const MakeLandmarksOptions& options = {});

// As schema/landmarks.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const MakeLandmarksReport& report, const ReportFiles& files = {});

struct MakePointsReport {
  std::uint64_t moved = 0;    // points of the same id that got position and normal of their landmark
  std::uint64_t added = 0;    // landmarks without one
  std::uint64_t plain = 0;    // of those added: without an ORB descriptor of 32 bytes
  std::uint64_t fused = 0;    // landmarks that had the id of another one of their map
  std::uint64_t renamed = 0;  // landmarks that got another id, because another map has theirs
};

// The way back: moves each map's points to their landmarks of the same id, and adds a point for every other landmark.
// Added points have position, normal and descriptor, and no observations, which no landmark has.
// They can be looked at and exported, but ORB-SLAM3 has no use for them.
// Landmarks without id, and those whose id another map has, get new ones.
// Landmarks of one map that share an id are fused.
//
// Throws nothing but std::bad_alloc.
// Cost: linear, in place.
SLAMDB_EXPORT MakePointsReport MakePoints(Atlas& atlas);

// As schema/landmarks.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const MakePointsReport& report, const ReportFiles& files = {});

// One landmark out of two of the same thing in one frame.
// The position is the product of the two Gaussians: C = (C1^-1 + C2^-1)^-1 and m = C (C1^-1 m1 + C2^-1 m2).
// A covariance of zero means not known: then the other one's position is taken, or, when neither is known, the mean
// weighted by the counts.
// Counts are added, and the newest time is kept.
// The normal is the mean weighted by the counts, of unit length.
// Id and features are those of `a` unless it has none.
//
// After MRPT's CLandmarksMap::fuseWith.
[[nodiscard]] SLAMDB_EXPORT Landmark FuseLandmarks(const Landmark& a, const Landmark& b);

// Takes over landmarks of another map that lie in the same frame.
// Those whose id is there are fused with the first of that id; the others are added in their order.
// Returns how many were fused.
// Ids that two sessions handed out independently must be made disjoint before.
//
// Cost: linear.
SLAMDB_EXPORT std::uint64_t TakeLandmarks(std::vector<Landmark>& into, std::span<const Landmark> from);

}  // namespace slamdb
