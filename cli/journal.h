// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/edit/repair/journal.h"

// The journal of a repair as a file: docs/repair.md and schema/journal.schema.json describe it.
namespace slamdb::cli {

struct JournalFile {
  std::uint64_t original = 0, repaired = 0;  // HashWithoutEncoding of the atlas before and after
  ArchiveEncoding encoding;                  // how the original was written
  Journal journal;
};

// JSON, one line for each entity. Equal journals give equal text.
std::string JournalText(const JournalFile& file);

// Throws Error when the file is no journal, or of a later version.
JournalFile ReadJournalFile(const std::string& path);

}  // namespace slamdb::cli
