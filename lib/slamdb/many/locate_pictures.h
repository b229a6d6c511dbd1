// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/align/locate.h"
#include "slamdb/align/locate_report.h"
#include "slamdb/base/notices.h"
#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/pictures/camera_settings.h"

// Picture files, in one map or in all of a store.
namespace slamdb {

struct LocatePicturesOptions {
  std::vector<std::string> pictures;     // as FindPictures takes them
  std::optional<CameraSettings> camera;  // that took them; none: the map's own
  std::int32_t features = 2000;          // that are looked for in a picture
  std::string against;                   // a trajectory of true poses, paired by time; empty: none. Of one atlas alone
  double lock_timeout = 5;               // seconds to wait for a program that holds a store
  int threads = 0;                       // 0: every core
  Progress progress;                     // may be empty
};

// `locator` is of the atlas. A picture that cannot be read is a result like others, and told.
//
// Throws Error where no picture can be read, and as FindPictures and, of `against`, ReadTrajectory do.
[[nodiscard]] SLAMDB_EXPORT LocateReport LocatePictures(const Atlas& atlas, const Locator& locator,
                                                        const LocatePicturesOptions& options, Notices& notices);

// All its atlases are asked, see LocateInStore. Throws Error likewise.
[[nodiscard]] SLAMDB_EXPORT LocateReport LocatePictures(Store& store, const LocatePicturesOptions& options,
                                                        Notices& notices);

// The poses of what was found, as a TUM trajectory; those of several maps, each in a frame of its own, one behind the
// other under a comment.
[[nodiscard]] SLAMDB_EXPORT std::string PosesFound(const LocateReport& report, const Atlas& atlas);

}  // namespace slamdb
