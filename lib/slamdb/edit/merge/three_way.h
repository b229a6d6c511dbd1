// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/base/progress.h"
#include "slamdb/checks/finding.h"
#include "slamdb/edit/ids/id_map.h"
#include "slamdb/edit/merge/fuse.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/content.h"

// Two robots load one atlas, the base, continue it, and come back: three atlases of which one is made. The sides are
// called ours, the first, and theirs.
namespace slamdb {

enum class BranchSide { kOurs, kTheirs };

// `ours`, `theirs`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(BranchSide side);

// Where that is which both sides have; what only one has is carried along with the keyframes next to it.
enum class BranchGeometry {
  kOurs,
  kTheirs,
  kAlign,     // what both sides changed of the base, each by how many sightings its change rests on
  kOptimize,  // that, for who adjusts the bundle then: MergeBranches (align/merge_branches.h)
};

// `ours`, `theirs`, `align`, `optimize`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(BranchGeometry geometry);

struct ThreeWayOptions {
  std::array<std::string, 3> names = {"base", "ours", "theirs"};  // for messages and tables
  BranchGeometry geometry = BranchGeometry::kAlign;
  BranchSide prefer = BranchSide::kOurs;            // whose change stands where both changed the same
  std::optional<FuseOptions> fuse = FuseOptions{};  // new points of both sides at one place; none: they stay apart
  bool ignore_vocabulary = false;                   // keep our vocabulary though theirs is a different one
  bool take_containing = true;  // a side that has all new keyframes of the other is the result, as after a merge
  bool id_maps = false;         // fill ThreeWayReport::id_maps
  int threads = 0;              // 0: every core; the result is the same for any number
  Progress progress;            // may be empty
};

// Something that both sides changed, each in another way. Ids are those of the result.
struct BranchConflict {
  Place place;
  std::string_view what;                 // the aspect: `deletion`, `point`, `parent`, `camera`
  BranchSide taken = BranchSide::kOurs;  // whose is in the result; of a deletion: who went on with it, so that it stays
};

// `deleted by theirs, extended by ours: kept`, `parent: that of ours is taken`.
[[nodiscard]] SLAMDB_EXPORT std::string MessageOf(const BranchConflict& conflict);

// What became of everything of one kind that is in any of the three atlases:
//   result = base + added by ours, theirs, both - deleted by ours, theirs, both - fused - dropped
struct BranchLedger {
  std::uint64_t base = 0, ours = 0, theirs = 0;  // in each atlas
  std::uint64_t added_by_ours = 0, added_by_theirs = 0, added_by_both = 0;
  std::uint64_t deleted_by_ours = 0, deleted_by_theirs = 0, deleted_by_both = 0;
  std::uint64_t kept = 0;     // deleted by one side, and in the result all the same: the other went on with it
  std::uint64_t fused = 0;    // points that went into others, and keypoints that would then see one twice
  std::uint64_t dropped = 0;  // led nowhere, or lost against the other side's in a conflict
  std::uint64_t result = 0;

  bool AddsUp() const {
    return base + added_by_ours + added_by_theirs + added_by_both ==
           result + deleted_by_ours + deleted_by_theirs + deleted_by_both + fused + dropped;
  }
  friend bool operator==(const BranchLedger&, const BranchLedger&) = default;
};

// How far a side was bent, so that it fits the result.
struct BranchMotion {
  std::uint64_t common = 0, carried = 0;  // keyframes with a place in the result; others, that went along
  double rms = 0, max = 0;                // of the shifts of the common ones, map units
  bool another_frame = false;             // the side lay in another frame, and was moved as a whole before
};

// One map of the result that both sides had a part in.
struct MergedBranchMap {
  MapId map;
  std::vector<MapId> base, ours, theirs;  // ids as they were in these; several where a side joined maps of the base
  BranchMotion motion_of_ours, motion_of_theirs;
  std::uint64_t recounted = 0;  // keyframes whose covisibility was counted anew
  std::optional<FuseReport> fused;
};

struct ThreeWayReport {
  std::array<std::string, 3> names;                  // base, ours, theirs
  std::array<ContentCounts, 3> counts;               // as they came
  BranchGeometry geometry = BranchGeometry::kAlign;  // as asked for
  std::optional<BranchSide> unchanged;  // this side is the base itself: the result is the other one, as it is
  bool same = false;                    // both sides are one and the same: the result is that
  std::optional<BranchSide> contains;   // this side has all of the other, which it was made of: its geometry stands
  std::array<std::uint64_t, kIdKinds> shift{};  // added to the ids that theirs has made since the base
  std::vector<MergedBranchMap> maps;
  BranchLedger keyframes, points, observations, edges;   // edges: loops and merges, each pair once
  std::vector<std::pair<MapPointId, MapPointId>> fused;  // {gone, survivor}: points of any of the three atlases
  std::vector<MapPointId> dropped_points;  // that no keypoint sees any more: of a conflict, or none saw them before
  std::vector<BranchConflict> conflicts;
  std::uint64_t other_images = 0;          // keyframes of a side with an id of the base, and another image: new ones
  std::uint64_t dangling = 0;              // references of the inputs that led nowhere, and were cut
  std::uint64_t dropped_list_entries = 0;  // as in MergeReport
  std::array<std::uint64_t, 2> dropped_members{};  // of ours and theirs: entities whose members of a fork were left out
  std::vector<std::string> warnings;
  ContentCounts result;
  std::vector<IdMap> id_maps;  // of ours and theirs
};

struct ThreeWayResult {
  Atlas atlas;
  ThreeWayReport report;
};

// Merges two continuations of one atlas.
//
// Identity. Keyframes are one where their image is: time, keypoints and descriptors; of several with one image those
// of equal id. Points are one where their ids are, and a keypoint sees both, or no keypoint of the base is left and the
// first keyframe and frame are the same. What is not in the base gets other ids in theirs, as MergeAtlases shifts them.
//
// Structure, each thing by itself (keyframe, point, keypoint that sees a point, edge, field):
//   changed by one side       as this side has it
//   changed by both alike     so
//   changed by both           a conflict: as `prefer` says
//   deleted by one side       gone, or, where the other went on with it, kept: a conflict
// A keyframe is gone on with where it got observations, edges or children, a point where it got observations.
// Points that a side replaced by others take what the other side added to them along.
// Poses, positions, velocities, biases, viewing directions, distance ranges, descriptors, counts and covisibility are
// no structure: they follow `geometry`, or are computed anew where observations changed.
//
// Maps are paired by the keyframes that they share; maps that one side joined are joined. References that lead nowhere
// are cut and counted. What is in the result is held against all three inputs.
//
// A side that is the base, or the other side again, leaves the other as it is, to the byte; so does, with
// `take_containing`, one of which the other has every new keyframe: it was merged before.
//
// Throws Error:
//   kNotPossible  a side shares no keyframe with the base, or has split a map of it; ids are there more than once;
//                 vocabularies differ; ids would pass LargestId
//   kInternal     the result does not hold what the inputs do
// Cost: linear in the three atlases, but for sorting.
[[nodiscard]] SLAMDB_EXPORT ThreeWayResult MergeThreeWays(Atlas base, Atlas ours, Atlas theirs,
                                                          const ThreeWayOptions& options = {});

// How many keyframes of the base a side does not have, each known by its image, whatever its id.
[[nodiscard]] SLAMDB_EXPORT std::size_t CountMissingKeyframes(const Atlas& base, const Atlas& side, int threads = 0);

// What there is to know besides: warnings, and losses by name.
SLAMDB_EXPORT void TellWarnings(const ThreeWayReport& report, Notices& notices);

// As schema/merge.schema.json describes it. `output` empty: nothing was written.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const ThreeWayReport& report, const std::string& output = {});

}  // namespace slamdb
