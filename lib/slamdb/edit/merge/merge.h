// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/edit/ids/id_map.h"
#include "slamdb/edit/merge/join.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/content.h"

namespace slamdb {

// What becomes of a map that an earlier input has already: the same images and points, whatever their ids.
enum class SameMap {
  kKeepBoth,   // it gets new ids like any other
  kError,      // the merge is refused
  kKeepFirst,  // it is left out
};

struct MergeOptions {
  std::vector<std::string> names;  // of the inputs, for messages and tables; may be shorter than the inputs
  SameMap same_map = SameMap::kKeepBoth;
  bool ignore_vocabulary = false;  // keep the first vocabulary though another input has a different one
  bool force = false;              // that, and JoinOptions::force
  bool id_maps = false;            // fill MergeReport::id_maps
  // Also make one map of two. Ids are those in the inputs: `first` and what goes with it in the first input, `second`
  // in the second, or both in the only one; a map of `none` is the only one with keyframes that there is to choose.
  // Threads and progress are those of the merge.
  std::optional<JoinOptions> join;
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty
};

// What was made of one input.
struct MergedInput {
  std::string name;
  ContentCounts counts;                         // as it came
  std::array<std::uint64_t, kIdKinds> shift{};  // added to its ids (mod 2^64), by IdKind; cameras have their table
  std::vector<IdPair> cameras;                  // old and new ids
  std::uint64_t unified_cameras = 0;            // of them, those that an earlier input has
};

// A map that came twice.
struct MapTwice {
  std::size_t input = 0, first_input = 0;  // rows of the inputs
  MapId map, first_map;                    // ids in these inputs
  bool left_out = false;
};

struct MergeReport {
  std::vector<MergedInput> inputs;
  std::vector<MapTwice> same_maps;
  std::uint64_t dropped_list_entries = 0;  // null pointers and repetitions in lists, which the result does not have
  std::vector<std::string> other_vocabularies;  // names of inputs whose vocabulary is not the first one's
  // Names of inputs whose members of a fork are of another layout than the result's, and how many entities lost such
  // members: theirs, and those of the atlases themselves but the first.
  std::vector<std::string> other_layouts;
  std::uint64_t dropped_members = 0;
  std::vector<std::string> warnings;  // what maps side by side have that does not go together; see JoinReport
  ContentCounts left_out;             // maps left out, and cameras unified
  ContentCounts result;               // counted before joining: the inputs' sum without `left_out`
  std::vector<IdMap> id_maps;         // one for each input; a fused point's new id is the survivor's
  std::optional<JoinReport> join;
};

struct MergeResult {
  Atlas atlas;
  MergeReport report;
};

// Brings the maps of all inputs into one atlas, side by side: nothing is aligned or changed but ids.
// The first input keeps its ids; each later one is shifted as a whole, kind by kind, where the range of its ids meets
// that of those before it.
// Cameras that are the same (model and parameters, within 1e-6 as ORB-SLAM3 compares them) become one.
// Counters end up above all ids.
// The encoding is the first input's, the vocabulary that of the first input that has keyframes, the layout that of the
// first input whose entities have members of a fork. These travel as they are: ids in them are not shifted.
// The inputs are used up: their columns move into the result and are not copied.
// What the result holds is counted and held against the sum of the inputs.
//
// Throws Error:
//   kUsage        there is no input, or it is not clear which two maps to join
//   kNotPossible  vocabularies differ, a map comes twice and SameMap says so, ids would pass LargestId, or maps cannot
//                 be joined (JoinMaps)
//   kInternal     the result does not hold what the inputs do
// Cost: linear; the result is the same for any number of threads.
[[nodiscard]] SLAMDB_EXPORT MergeResult MergeAtlases(std::vector<Atlas> inputs, const MergeOptions& options = {});

// Makes a table of what became of an input's ids say where they are after a join: maps, and points that were fused.
SLAMDB_EXPORT void FollowJoin(const JoinReport& join, IdMap& ids);
// The same of points that were fused.
SLAMDB_EXPORT void FollowFuse(const FuseReport& fused, IdMap& ids);
// Points that were removed since lead nowhere. `gone` ascends.
SLAMDB_EXPORT void FollowRemoval(std::span<const MapPointId> gone, IdMap& ids);

// As schema/merge.schema.json describes it. `output` empty: nothing was written.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const MergeReport& report, const std::string& output = {});

}  // namespace slamdb
