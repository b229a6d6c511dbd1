// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "slamdb/checks/check.h"
#include "slamdb/export.h"

// Check reports as text, for people and for machines.
// Pure functions, thread-safe; equal input gives equal output. They throw nothing but std::bad_alloc.
namespace slamdb {

// One file that was checked, or could not be.
struct CheckedFile {
  std::string name;
  CheckReport report;
  std::string failure;  // why it could not be read; empty: it was
  std::string file;     // that a code host knows, relative where it can be; empty: the name
};

// "sound", "sound, 2 warnings, 120 notes", "1 error, 3 notes: not sound", "not readable".
[[nodiscard]] SLAMDB_EXPORT std::string Verdict(const CheckedFile& file);

struct TextReportOptions {
  std::size_t shown_per_rule = 5;  // findings of each rule; the rest is counted
  bool show_notes = false;         // otherwise notes are only counted
  bool only_broken = false;        // leave out files without errors and warnings
};

// For people, without colours: the verdict on each file with a paragraph for each rule that it breaks, errors first,
// and of several files at the end how many failed and which.
[[nodiscard]] SLAMDB_EXPORT std::string TextReport(std::span<const CheckedFile> files,
                                                   const TextReportOptions& options = {});

// As schema/check.schema.json describes it. Ids are numbers where 53 bits hold them, and decimal strings beyond.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(std::span<const CheckedFile> files);

// JUnit XML: a suite for each file, a case for each rule and gate.
// Errors are failures; warnings, and notes when asked for, are in the output of their case.
// A file that could not be read is a case with an error.
[[nodiscard]] SLAMDB_EXPORT std::string JUnitReport(std::span<const CheckedFile> files, bool with_notes = false);

// SARIF 2.1.0 as GitHub takes it (schema/sarif.schema.json): rule metadata, fingerprints, logical locations
// (`map/0/mp/4312`), a result of rule `unreadable` for each file that could not be read.
// At most 5,000 results, which is what GitHub shows: errors first, then warnings; what was left out is a result itself.
// `version` is the tool's own.
[[nodiscard]] SLAMDB_EXPORT std::string SarifReport(std::span<const CheckedFile> files, const std::string& version,
                                                    bool with_notes = false);

// The same reports of one file after the other, as they are checked: of a file nothing is kept but what the end tells.
// Where that is the number and the verdict of each, a report of ten thousand files takes the memory of one.
//
// Throws what the sink throws.
class SLAMDB_EXPORT CheckReporter {
 public:
  using Sink = std::function<void(std::string_view text)>;  // gets the report, piece by piece

  virtual ~CheckReporter() = default;
  virtual void Add(const CheckedFile& file) = 0;
  virtual void End() = 0;  // once, behind the last file
};
[[nodiscard]] SLAMDB_EXPORT std::unique_ptr<CheckReporter> MakeTextReporter(CheckReporter::Sink sink,
                                                                            const TextReportOptions& options = {});
[[nodiscard]] SLAMDB_EXPORT std::unique_ptr<CheckReporter> MakeJsonReporter(CheckReporter::Sink sink);
// Keeps its text to the end, in a file without a name where there is room for temporary files: its first line has sums.
//
// Throws Error (SystemError) when there is none.
[[nodiscard]] SLAMDB_EXPORT std::unique_ptr<CheckReporter> MakeJUnitReporter(CheckReporter::Sink sink,
                                                                             bool with_notes = false);
[[nodiscard]] SLAMDB_EXPORT std::unique_ptr<CheckReporter> MakeSarifReporter(CheckReporter::Sink sink,
                                                                             const std::string& version,
                                                                             bool with_notes = false);

// The catalogue of rules and gates for people, as JSON (schema/rules.schema.json), and as the tables of docs/checks.md.
[[nodiscard]] SLAMDB_EXPORT std::string TextCatalogue();
[[nodiscard]] SLAMDB_EXPORT std::string JsonCatalogue();
[[nodiscard]] SLAMDB_EXPORT std::string MarkdownCatalogue();

}  // namespace slamdb
