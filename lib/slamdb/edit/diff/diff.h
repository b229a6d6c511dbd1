// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/similarity.h"
#include "slamdb/model/statistics.h"

namespace slamdb {

struct DiffOptions {
  double tolerance = 0;  // numbers a and b are the same when |a - b| <= tolerance * max(1, |a|, |b|)
  int threads = 0;       // 0: every core
  Progress progress;     // may be empty
};

// An entity by its ids.
struct EntityName {
  std::uint64_t map = 0, id = 0;
  friend auto operator<=>(const EntityName&, const EntityName&) = default;
};

// How many entities that both atlases have differ in an aspect (`bag of words`).
struct AspectCount {
  std::string_view aspect;
  std::uint64_t count = 0;
  friend bool operator==(const AspectCount&, const AspectCount&) = default;
};

// Entities of one kind.
struct EntityDiff {
  std::uint64_t before = 0, after = 0;     // all there are
  std::vector<EntityName> removed, added;  // ascending
  std::uint64_t renumbered = 0;            // in both, under another id
  std::uint64_t changed_map = 0;           // in both, in maps that are not the same
  std::uint64_t changed = 0;               // in both, differing in any aspect below
  std::vector<AspectCount> changes;        // aspects in which any differ
};

// References of one kind: observations, edges, slots.
struct LinkDiff {
  std::string_view kind;
  std::uint64_t before = 0, after = 0;
  std::uint64_t removed = 0, added = 0;
  std::uint64_t changed = 0;  // in both, with another weight or keypoint

  bool same() const { return removed == 0 && added == 0 && changed == 0; }
};

// How the entities of a map that is in both have moved.
struct MapMotion {
  MapId before, after;
  std::uint64_t keyframes = 0, points = 0;  // that moved
  Distribution keyframe_distance;           // of the centres that moved, map units
  Distribution keyframe_degrees;            // of their rotations
  Distribution point_distance;              // of the points that moved
  // The similarity that takes the map before to the map after best, and what distances it leaves. None where nothing
  // moved, or where too little is in both.
  std::optional<Similarity3d> after_from_before;
  Distribution rest;

  bool moved() const { return keyframes > 0 || points > 0; }
};

struct FieldDiff {
  std::string field, before, after;
};

struct AtlasDiff {
  EntityDiff maps, cameras, keyframes, points;
  std::vector<LinkDiff> links;       // every kind, differing or not
  std::vector<MapMotion> motions;    // of every map in both
  std::vector<FieldDiff> fields;     // vocabulary, landmarks, and what irregular lists repeat
  std::vector<FieldDiff> numbering;  // counters and largest ids: what renumbering changes besides ids
  std::uint64_t other_ids = 0;       // ids of frames and of culled keyframes that differ
  std::vector<FieldDiff> encoding;   // how the files are written, which is no difference of the atlases

  enum class Verdict { kSame, kRenumbered, kDifferent };
  SLAMDB_EXPORT Verdict verdict() const;
};

// `same`, `renumbered`, `different`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(AtlasDiff::Verdict verdict);

// Leaves of two atlases what both hold where one of them is a point cloud, an atlas of points alone: their points with
// positions, and with ids, maps, normals and distance ranges where the cloud has them. Ids of a cloud that are the
// numbers of its rows are none; the points of both are then numbered by their rows.
// Returns false, and changes nothing, when neither is one, or both hold the same kinds of things.
//
// Cost: linear.
SLAMDB_EXPORT bool KeepWhatCloudsHold(Atlas& before, Atlas& after);

// Compares two atlases by what they mean.
// Entities are recognised by content, whatever their ids: keyframes by descriptors and time, points by descriptor and
// by who observes them where, maps by their keyframes, cameras by their parameters, landmarks by all that they hold, to
// the bit. References are the same when they lead to the same entity.
// What does not count: the order of lists; which NaN a NaN is; the sign of a quaternion; how a matrix stands in its
// file (the flag of a continuous one, the form of an empty one); which entries a list has as null or repeated, beyond
// their number; how many slots of a keyframe hold no point.
// Either atlas may hold anything.
//
// Throws nothing but std::bad_alloc and what the listener to its progress throws.
// Cost: linear; the result is the same for any number of threads. Thread-safe.
[[nodiscard]] SLAMDB_EXPORT AtlasDiff DiffAtlases(const Atlas& before, const Atlas& after,
                                                  const DiffOptions& options = {});

// The names of the two, for a report, and how many ids of what was removed and added it lists.
struct DiffReportOptions {
  std::string before, after;
  std::size_t max_listed = 1000;
};

// As schema/diff.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const AtlasDiff& diff, const DiffReportOptions& options = {});

}  // namespace slamdb
