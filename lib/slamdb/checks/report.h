// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

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
};

struct TextReportOptions {
  std::size_t shown_per_rule = 5;  // findings of each rule; the rest is counted
  bool show_notes = true;          // otherwise notes are only counted in the totals
  bool note_findings = true;       // otherwise a rule with notes is one line
};

// For people: a paragraph for each rule with findings, errors first, and a line of totals. Without colours.
[[nodiscard]] SLAMDB_EXPORT std::string TextReport(std::span<const CheckedFile> files,
                                                   const TextReportOptions& options = {});

// As schema/check.schema.json describes it. Ids are numbers where 53 bits hold them, and decimal strings beyond.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(std::span<const CheckedFile> files);

// JUnit XML: a suite for each file, a case for each rule and gate.
// Errors are failures; warnings and notes are in the output of their case.
[[nodiscard]] SLAMDB_EXPORT std::string JUnitReport(std::span<const CheckedFile> files);

// SARIF 2.1.0 with rule metadata and logical locations (`map/0/mp/4312`). `version` is the tool's own.
[[nodiscard]] SLAMDB_EXPORT std::string SarifReport(std::span<const CheckedFile> files, const std::string& version);

// The catalogue of rules and gates for people, as JSON (schema/rules.schema.json), and as the tables of docs/checks.md.
[[nodiscard]] SLAMDB_EXPORT std::string TextCatalogue();
[[nodiscard]] SLAMDB_EXPORT std::string JsonCatalogue();
[[nodiscard]] SLAMDB_EXPORT std::string MarkdownCatalogue();

}  // namespace slamdb
