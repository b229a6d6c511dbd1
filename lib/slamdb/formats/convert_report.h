// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/base/report_files.h"
#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// What went from one atlas into another: PutPoses.
struct PutInto {
  std::uint64_t keyframes = 0, points = 0;
  double largest_shift = 0;  // of a camera, the map's units
};

// What a conversion wrote, or would write.
struct ConvertReport {
  std::string format;                                      // of the output, by its id
  std::optional<std::uint64_t> maps;                       // none from trajectory to trajectory
  std::uint64_t keyframes = 0, points = 0, landmarks = 0;  // keyframes: or poses
  std::optional<std::uint64_t> bytes;                      // of the output's file, where it is known
  std::optional<PutInto> put;                              // none when the output is the input's atlas
  std::vector<std::string> warnings, losses;

  // The warnings and losses among them, and of an export how much it holds.
  SLAMDB_EXPORT void Add(const Notices& notices);
};

// Of an atlas that is written whole.
[[nodiscard]] SLAMDB_EXPORT ConvertReport ConvertReportOf(const Atlas& atlas, const Format& format);

// Why ORB-SLAM3 could not use an atlas that was made of another program's file, and what to do; empty when it can: its
// good keypoints and points need ORB's descriptors.
[[nodiscard]] SLAMDB_EXPORT std::string WhyNoUseToOrbslam3(const Atlas& atlas);

// As schema/convert.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const ConvertReport& report, const ReportFiles& files = {});

}  // namespace slamdb
