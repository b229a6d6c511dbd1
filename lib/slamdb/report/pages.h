// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slamdb/base/wording.h"
#include "slamdb/checks/report.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

// Pages of HTML about atlases, each a file that needs nothing else: numbers, plots, findings of a check, gates.
// Names and texts of files are text in them, never markup.
namespace slamdb {

// One atlas in a report, or what could not be read.
struct AtlasReport {
  CheckedFile checked;                 // its name, what was found, or why it could not be read
  std::string page;                    // name of the file of its page, beside the index; empty: it has none
  std::string thumbnail;               // PNG for a light page; empty: none
  std::string dark_thumbnail;          // for a dark one; empty: the same
  std::optional<std::uint64_t> bytes;  // size of its file, or about what it takes in its store
  std::vector<GateLimit> gates;        // that it was held against
};

// Looks at an atlas: checks it, and draws its thumbnail where plots can be drawn.
//
// Throws Error as CheckAtlas does.
// Cost: what CheckAtlas costs; the thumbnail linear.
[[nodiscard]] SLAMDB_EXPORT AtlasReport ReportOn(const Atlas& atlas, const std::string& name,
                                                 const CheckOptions& options = {});

struct ReportPageOptions {
  int threads = 0;  // 0: every core
  Wording wording;  // of findings, and of what to do; may be empty
};

// The page of an atlas.
//
// Throws Error as DrawPlot does.
// Cost: linear.
[[nodiscard]] SLAMDB_EXPORT std::string ReportPage(const Atlas& atlas, const AtlasReport& report,
                                                   const ReportPageOptions& options = {});

// A table of all of them with their thumbnails, which can be sorted and filtered; names lead to the pages.
[[nodiscard]] SLAMDB_EXPORT std::string ReportIndex(std::span<const AtlasReport> reports, const std::string& title);

// As schema/report.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(std::span<const AtlasReport> reports, const std::string& output);

}  // namespace slamdb
