// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/edit/repair/repair.h"

namespace slamdb {

struct RecoverOptions {
  // Another atlas of the same cameras and vocabulary: those that are lost are taken from it.
  const Atlas* rig = nullptr;
  int threads = 0;  // 0: every core
};

struct RecoverReport {
  std::uint64_t dropped_maps = 0;       // without a keyframe or landmark left
  std::uint64_t dropped_keyframes = 0;  // of what was there: what breaks rules that have no repair
  std::uint64_t dropped_points = 0;
  std::uint64_t dropped_landmarks = 0;
  std::vector<CameraId> rebuilt_cameras;  // of which keyframes tell the focal lengths and the centre
  std::vector<CameraId> guessed_lenses;   // of those, fisheye cameras whose lens parameters nothing tells: set to 0
  std::vector<CameraId> taken_cameras;    // from the rig
  std::vector<MapId> rebuilt_maps;        // whose members behind the lists were lost: origins, inertial stage and such
  bool taken_vocabulary = false;          // from the rig
  bool rebuilt_counters = false;
  std::vector<AppliedFix> repairs;  // of what depended on what is lost
  std::vector<Unrepaired> left;     // as in RepairReport

  bool sound() const;  // no error is left
};

// Makes of what was salvaged from a damaged file (formats/salvage.h) an atlas that is sound: cameras, counters and
// members of maps that are lost are found again from the keyframes, references to what is lost are dropped by the
// repairs of the rules, and keyframes and points that break a rule without repair go. In place; a sound atlas stays as
// it is but for what RepairAtlas changes. Deterministic.
RecoverReport RecoverAtlas(Atlas& atlas, const RecoverOptions& options = {});

}  // namespace slamdb
