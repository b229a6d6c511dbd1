// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

// MRPT's landmarks and ORB-SLAM3's map points are two views of one thing.
// docs/landmarks.md has the table of fields.
//
// Their normals point opposite ways: a landmark's to the cameras, as MRPT's own makers set it, a point's away from
// them. MakeLandmarks, MakePoints and LayLandmarks turn them; everything else leaves each as it is.
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
//   its point's id and position, and the opposite of its normal, of unit length
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
  std::uint64_t moved = 0;     // points of the same id that got position and normal of their landmark
  std::uint64_t added = 0;     // landmarks without one
  std::uint64_t plain = 0;     // of those added: without an ORB descriptor of 32 bytes
  std::uint64_t fused = 0;     // landmarks that had the id of another one of their map
  std::uint64_t renamed = 0;   // landmarks that got another id, because another map has theirs
  std::uint64_t turned = 0;    // landmarks whose normals were those of points, and are turned now
  std::uint64_t unturned = 0;  // that no point tells of, left as they were though others were turned
};

// The way back: moves each map's points to their landmarks of the same id, and adds a point for every other landmark.
// A landmark without normal leaves its point's; otherwise the point's gets the opposite direction, and keeps its
// length. Added points have position, normal and descriptor, and no observations, which no landmark has. They can be
// looked at and exported, but ORB-SLAM3 has no use for them. Landmarks without id, and those whose id another map has,
// get new ones. Landmarks of one map that share an id are fused. A landmark with the normal of its point was made by
// slamdb before it knew MRPT's direction, and is turned first; so are those of the map without a point, when nine
// tenths or more of the others are.
//
// Throws nothing but std::bad_alloc.
// Cost: linear, in place.
SLAMDB_EXPORT MakePointsReport MakePoints(Atlas& atlas);

// As schema/landmarks.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const MakePointsReport& report, const ReportFiles& files = {});

struct LayLandmarksOptions {
  bool add = false;  // landmarks that are not there become points, too
};

struct LayLandmarksReport {
  std::uint64_t moved = 0;     // points that got position and normal of their landmark
  std::uint64_t same = 0;      // of those: which had both already
  std::uint64_t taken = 0;     // landmarks that the atlas has now, instead of older ones of their id or beside them
  std::uint64_t counts = 0;    // of those: seen more or less often, or last at another time, than observations say
  std::uint64_t without = 0;   // points of the atlas that no landmark names
  std::uint64_t added = 0;     // points that were made of landmarks that were not there
  std::uint64_t turned = 0;    // landmarks whose normals were those of points, and are turned now
  std::uint64_t unturned = 0;  // that no point tells of, left as they were though others were turned
  std::vector<LandmarkId> not_there;  // left out: the atlas has no point or landmark of the id, or the id is none
  std::vector<LandmarkId> ambiguous;  // left out: the id is there in several maps, of either side
  std::vector<LandmarkId> infinite;   // left out: at no finite place
};

// Lays landmarks that were made of the points of an atlas, and changed elsewhere, onto that atlas.
// They are matched by id, whatever map they stand in.
// A point gets position and normal as MakePoints says; the map takes the landmark over with all that it holds, for
// times and counts have no place in a point.
// Everything else of the atlas stays as it is: observations, descriptors, distance ranges.
//
// Throws nothing but std::bad_alloc.
// Cost: linear, in place.
SLAMDB_EXPORT LayLandmarksReport LayLandmarks(Atlas& atlas, const Atlas& landmarks,
                                              const LayLandmarksOptions& options = {});

// As schema/landmarks.schema.json describes it. `from` is what the landmarks were read from.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const LayLandmarksReport& report, const ReportFiles& files = {},
                                               const std::string& from = {});

// One landmark out of two of the same thing in one frame, after MRPT's CLandmarksMap::fuseWith.
// The position is the product of the two Gaussians, as there: C = (C1^-1 + C2^-1)^-1 and m = C (C1^-1 m1 + C2^-1 m2).
// A covariance of zero means not known: then the other one's position is taken, or, when neither is known, the mean
// weighted by the counts. Covariances are rounded to the floats of MRPT 2 where both are such floats.
// Id and features are those of `a` unless it has none, as there.
// Three things differ, because `b` need not be what one image shows:
//   counts are added; there `a` is counted once more, which is the same where `b` was seen once
//   the newer time is kept; there it is that of `b`
//   the normal is the mean weighted by the counts, of unit length; there it is that of `a`
[[nodiscard]] SLAMDB_EXPORT Landmark FuseLandmarks(const Landmark& a, const Landmark& b);

struct FuseAlikeOptions {
  int hamming = 50;  // in how many bits binary descriptors at one place may differ; ORB-SLAM3's TH_LOW
  int threads = 0;   // 0: every core
};

struct FuseAlikeReport {
  std::uint64_t fused = 0;     // landmarks that went into another
  std::uint64_t plain = 0;     // of either part: without a descriptor that can be compared
  std::uint64_t unplaced = 0;  // of either part: without covariance, so that nobody knows what is near
  double mean_distance = 0;    // between fused landmarks
  std::vector<std::pair<LandmarkId, LandmarkId>> replaced;  // {gone, survivor} of those with ids, ascending
};

// Fuses landmarks that are there twice: each from row `second` of the list on with the one before that row which is
// most alike, by appearance and position, as MRPT's CLandmarksMap::fuseWith matches them. Alike means above 0.5 in
//   exp(-d^2 / (2 * 4^2)) * exp(-D^2 / (2 s^2))
// where d is the Mahalanobis distance under the sum of both covariances. D is the distance of the descriptors of the
// first features, which are of one type: Euclidean for SIFT with s = 100, as there; in bits for ORB, BLD and LATCH,
// which are never matched there, with an s that lets `hamming` bits pass at one place. Pairs go by likeness, and each
// landmark into one only; there they go by the list, and a better match may find its partner taken. Landmarks that are
// rarely seen are not deleted, as they are there. Landmarks less certain than four times the median are looked for
// within that reach only.
//
// Throws nothing but std::bad_alloc.
// Cost: linear in landmarks and in those within reach along one axis; the result is the same for any number of threads.
SLAMDB_EXPORT FuseAlikeReport FuseAlikeLandmarks(std::vector<Landmark>& landmarks, std::size_t second,
                                                 const FuseAlikeOptions& options = {});

// Takes over landmarks of another map that lie in the same frame.
// Those whose id is there are fused with the first of that id; the others are added in their order.
// Returns how many were fused.
// Ids that two sessions handed out independently must be made disjoint before.
//
// Cost: linear.
SLAMDB_EXPORT std::uint64_t TakeLandmarks(std::vector<Landmark>& into, std::span<const Landmark> from);

}  // namespace slamdb
