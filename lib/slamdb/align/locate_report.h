// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/align/locate.h"
#include "slamdb/base/progress.h"
#include "slamdb/export.h"

namespace slamdb {

// How far a pose is from the truth.
struct PoseError {
  double position = 0;  // units of the truth, as a rule metres
  double rotation_degrees = 0;
};

// Where a picture is in an atlas of a store.
struct AtlasLocalization {
  std::string atlas;  // its name there
  Localization localization;
};

// A picture, or a keyframe that was left out, and where it was found.
struct LocatedPicture {
  std::string name;  // of the file, or `kf 12`
  double timestamp = 0;
  Localization localization;
  std::optional<PoseError> error;         // where it was found and the truth is known
  std::string atlas;                      // of a store that was asked whole: the one that it was found in best
  std::vector<AtlasLocalization> others;  // and those that were asked besides, the surest first
};

struct SLAMDB_EXPORT LocateReport {
  std::vector<LocatedPicture> pictures;
  std::vector<std::string> not_asked;  // atlases of a store that was asked whole, and why: `lab: ...`

  std::uint64_t found() const;
  // Over those with a known error; nullopt when there is none.
  std::optional<PoseError> MedianError() const;
  std::optional<PoseError> LargestError() const;
};

struct LocateBenchmarkOptions {
  std::uint64_t most_keyframes = 500;  // that are left out in turn, at equal steps
  int threads = 0;                     // 0: every core
  Progress progress;                   // may be empty
};

// How good the maps of an atlas are for finding oneself in them: each keyframe is left out in turn and located by its
// own recorded features (Locator::LocateLeftOut). Its error is to the pose that the map has for it. `atlas`: that the
// locator was made of. The result is the same for any number of threads. Cost: Locator::Locate for every keyframe that
// is asked for.
[[nodiscard]] SLAMDB_EXPORT LocateReport BenchmarkLocating(const Locator& locator, const Atlas& atlas,
                                                           const LocateBenchmarkOptions& options = {});

// As schema/locate.schema.json describes it. `input`: the atlas.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const LocateReport& report, const std::string& input);

}  // namespace slamdb
