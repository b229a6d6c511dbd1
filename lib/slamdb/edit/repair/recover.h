// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/edit/repair/repair.h"
#include "slamdb/edit/words/mend.h"
#include "slamdb/export.h"
#include "slamdb/model/salvage.h"

namespace slamdb {

struct RecoverOptions {
  // Another atlas of the same cameras and vocabulary: those that are lost are taken from it.
  const Atlas* rig = nullptr;
  // The vocabulary that bags of words are of: words that cannot be of it are computed anew. Without it those in doubt
  // are dropped.
  const VocabularyTree* vocabulary = nullptr;
  Vocabulary vocabulary_identity;
  // Make points anew that keyframes see and no map holds, where two views or a depth allow. RecoverSalvage does so
  // where bytes are damaged only: what a whole file refers to in vain was culled, and what is not in a store whose
  // edits are accepted was deleted.
  bool triangulate = true;
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty
};

struct RecoverReport {
  std::uint64_t dropped_maps = 0;       // without a keyframe or landmark left
  std::uint64_t dropped_keyframes = 0;  // of what was there: what breaks rules that have no repair
  std::uint64_t dropped_points = 0;
  std::uint64_t dropped_landmarks = 0;
  std::vector<CameraId> rebuilt_cameras;  // of which keyframes tell the focal lengths and the centre
  std::vector<CameraId> guessed_cameras;  // of which they do not: right cameras, taken for alike to the left ones
  std::vector<CameraId> guessed_models;   // of the rebuilt, those taken for pinhole cameras that may be fisheye ones
  std::vector<CameraId> guessed_lenses;   // fisheye cameras whose lens parameters nothing tells: set to 0
  std::vector<CameraId> taken_cameras;    // from the rig
  std::vector<MapId> rebuilt_maps;        // whose members behind the lists were lost: origins, inertial stage and such
  bool taken_vocabulary = false;          // from the rig
  bool rebuilt_counters = false;
  std::vector<MapPointId> triangulated_points;  // made anew from the slots of keyframes, by map and id
  MendWordsReport words;                        // bags that were in doubt
  std::vector<AppliedFix> repairs;              // of what depended on what is lost
  std::vector<Unrepaired> left;                 // as in RepairReport

  SLAMDB_EXPORT bool sound() const;      // no error is left, as a check of the result found
  SLAMDB_EXPORT bool pointless() const;  // the only error left is that no keyframe sees a point: poses and features are
};

// Makes of an atlas of which parts are lost one that is sound.
// Cameras, counters and members of maps that are lost are found again from the keyframes, points are triangulated from
// what keyframes saw of them, unless the lens is unknown, references to what is lost
// are dropped by the repairs of the rules, and keyframes and points that break a rule without repair go. A sound atlas
// stays as it is but for what RepairAtlas changes. Keyframes of which no point is left stay, as the start of points to
// be triangulated; that they see none is an error without a repair.
//
// Throws Error (kNotPossible) when the words are of another vocabulary than the one that is given, std::bad_alloc, and
// what the listener to its progress throws.
// Cost: linear for each repair, in place; the result is the same for any number of threads.
SLAMDB_EXPORT RecoverReport RecoverAtlas(Atlas& atlas, const RecoverOptions& options = {});

// What became of a damaged file.
struct SalvageReport {
  std::vector<std::string> damage;                  // as in Salvage; empty: the file is whole
  std::vector<std::string> accepted;                // as in Salvage: edited rows of a store, taken as they are
  SalvagedList maps, keyframes, points, landmarks;  // read: in the result, points made anew not counted
  std::vector<std::string> losses;                  // what is lost or was found again in another way, one sentence each
  RecoverReport recovery;

  std::string undone;  // as in Salvage

  bool untouched = false;  // the file was whole and sound, and the atlas is as it was read

  bool whole() const { return damage.empty(); }
};

// Makes of what was salvaged from a damaged file (formats/salvage.h) an atlas that is sound, and says what is lost.
// Of a file that is whole and sound, has words of its vocabulary and refers to nothing that is not there, nothing
// changes.
//
// Throws Error (kDamaged) when no keyframe and no landmark could be read whole.
// Cost: as RecoverAtlas.
SLAMDB_EXPORT SalvageReport RecoverSalvage(Salvage& salvage, const RecoverOptions& options = {});

// As schema/recover.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const SalvageReport& report, const ReportFiles& files = {});

}  // namespace slamdb
