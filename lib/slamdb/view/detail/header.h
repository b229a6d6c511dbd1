// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/checks/check.h"
#include "slamdb/model/statistics.h"
#include "slamdb/view/detail/scene.h"

namespace slamdb::view {

// A rule that found something, as the check tells of it.
struct BrokenRule {
  std::string id, title, consequence;
  Severity severity = Severity::kNote;
  std::uint64_t count = 0;  // of all its findings in all atlases, also of those that are left out
};

// A finding of a check and where it is on the page.
struct PlacedFinding {
  std::size_t rule = 0;         // of PlacedFindings::rules
  std::string place, text, id;  // place: as the check prints it
  std::string_view kind;        // keyframe, point, camera, map, atlas
  std::size_t atlas = 0;
  std::int64_t map = -1, row = -1;  // of the scene; -1: none
};

struct PlacedFindings {
  std::vector<BrokenRule> rules;        // errors first
  std::vector<PlacedFinding> findings;  // in the order of the rules
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
