// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "slamdb/base/wording.h"
#include "slamdb/checks/check.h"
#include "slamdb/export.h"
#include "slamdb/many/each.h"
#include "slamdb/report/pages.h"

// Pages about many atlases (report/pages.h), written beside an index.
namespace slamdb {

struct ReportOptions {
  ReadOptions read;    // with the threads and the progress of it all
  CheckOptions check;  // without them
  Wording wording;     // of the pages; may be empty
  std::string output;  // the page of one atlas, or the folder of the pages; empty: the page is not written
  bool overwrite = false;
};

struct Reports {
  std::vector<Outcome<AtlasReport>> outcomes;  // `result` tells of a failure, too
  std::string page;                            // the page of the one atlas, or the index; empty: it could not be read
  std::string written;                         // the path of that; empty: nothing was written

  SLAMDB_EXPORT bool ok() const;  // all could be read, and are sound
};

// Whether that is one atlas that was named itself, which has one page, and needs no folder.
[[nodiscard]] SLAMDB_EXPORT bool IsOneAtlas(std::span<const std::string> named, const AtlasInputs& found);

// Why the pages cannot go there, by its name: several need a folder, and a page is an .html. Empty: they can.
[[nodiscard]] SLAMDB_EXPORT std::string WhyNotReportTo(const std::string& output, bool one_atlas);

// Of one atlas writes a page; of several, or into a folder, a page for each and index.html, which appear together.
// `named`: of what `found` was. One that cannot be read is a row with its error, and does not stop the others.
//
// Throws Error: kNotFound where there is no atlas; kUsage for the output (WhyNotReportTo), and for unknown rules and
// gates; as AtomicFile and AtomicFolder do, before the work where that can be told. Throws what the progress throws.
// Cost: of each, reading it and what ReportOn and ReportPage cost; pages are written as soon as they are made.
[[nodiscard]] SLAMDB_EXPORT Reports WriteReports(std::span<const std::string> named, const AtlasInputs& found,
                                                 const ReportOptions& options);

// As schema/report.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const Reports& reports, const std::string& output);

}  // namespace slamdb
