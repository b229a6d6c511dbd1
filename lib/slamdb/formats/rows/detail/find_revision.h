// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/rows/detail/revision_names.h"
#include "slamdb/formats/rows/revisions.h"

// What NAME@WHICH means in a store (revisions.h).
namespace slamdb::rows {

// What a database tells of its atlases and their revisions.
class RevisionCatalog {
 public:
  virtual ~RevisionCatalog() = default;
  virtual const std::string& path() const = 0;

  virtual std::vector<std::string> Names() = 0;  // of all atlases, ascending
  virtual std::optional<Named> Newest(std::string_view name) = 0;

  // Of an atlas, by its row.
  virtual std::vector<std::int64_t> Numbers(std::int64_t atlas) = 0;  // ascending
  virtual bool HasNumber(std::int64_t atlas, std::int64_t number) = 0;
  // The last one that was saved by then; `time`: as Which::by.
  virtual std::optional<std::int64_t> LastBy(std::int64_t atlas, const std::string& time) = 0;
  virtual std::optional<std::int64_t> Tagged(std::int64_t atlas, std::string_view tag) = 0;
  virtual std::vector<std::string> Tags(std::int64_t atlas) = 0;  // ascending
};

// Of an atlas that is called `text`, the newest; otherwise what stands behind its last @.
// Throws Error: kNotFound naming the atlases or revisions that there are; kUsage a date that is none.
Named FindRevision(RevisionCatalog& catalog, std::string_view text);
// By its number. Throws Error likewise.
Named FindRevision(RevisionCatalog& catalog, const RevisionName& revision);

}  // namespace slamdb::rows
