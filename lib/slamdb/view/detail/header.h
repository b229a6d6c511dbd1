// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/checks/check.h"
#include "slamdb/model/statistics.h"
#include "slamdb/view/detail/scene.h"

namespace slamdb::view {

// A finding of a check and where it is on the page.
struct PlacedFinding {
  std::string rule, text, id;
  Severity severity = Severity::kNote;
  std::string_view kind;  // keyframe, point, camera, map, atlas
  std::size_t atlas = 0;
  std::int64_t map = -1, row = -1;  // of the scene; -1: none
};

struct PlacedFindings {
  std::vector<PlacedFinding> findings;  // errors first
  std::uint64_t left_out = 0;
};

// `reports` are of the scene's atlases, in their order. What is less severe than `least` is passed over.
PlacedFindings PlaceFindings(const Scene& scene, const std::vector<CheckReport>& reports, Severity least);

// All that the page is told beside the columns.
struct Header {
  const ViewOptions& options;
  std::string title;
  std::uint64_t fixed_part = 0;
  std::vector<AtlasStatistics> statistics;  // of each atlas
  PlacedFindings findings;
  std::optional<SceneDiff> diff;
  double error_max = 0, origin_of_time = 0;
  std::vector<std::string> left_out;
};

// The JSON of the block `header`.
std::string HeaderJson(const Scene& scene, const Header& header);

}  // namespace slamdb::view
