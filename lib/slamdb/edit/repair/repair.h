// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/checks/check.h"
#include "slamdb/edit/repair/journal.h"
#include "slamdb/export.h"
#include "slamdb/model/vocabulary_tree.h"

namespace slamdb {

struct RepairOptions {
  std::vector<std::string> rules;                 // ids of the rules whose fixes are applied; empty: of every rule
  std::optional<std::uint64_t> vocabulary_words;  // as in CheckOptions
  // The vocabulary that bags of words are of: words that cannot be of it are computed anew, as MendWords does.
  const VocabularyTree* vocabulary = nullptr;
  Vocabulary vocabulary_identity;
  bool journal = true;  // false saves the copy that it takes
  int threads = 0;      // 0: every core
  Progress progress;    // may be empty
};

// One fix, applied.
struct AppliedFix {
  std::string rule, fix;       // its rule's id, its name
  Severity severity;           // of the rule
  std::string title;           // the invariant that holds now
  std::uint64_t findings = 0;  // of the rule before
  std::uint64_t changes = 0;   // what the fix counted
  Finding first;               // of the findings
};

// What is left of a rule, and why.
struct Unrepaired {
  std::string rule;
  Severity severity;
  std::string title;
  std::uint64_t findings = 0;
  Finding first;
  std::string reason;
};

struct RepairReport {
  std::vector<AppliedFix> applied;  // in the order in which they were
  std::vector<Unrepaired> left;     // in catalogue order, notes included
  Journal journal;                  // empty when none was asked for

  SLAMDB_EXPORT bool sound() const;  // no error is left
};

// Applies the fixes of the rules to `atlas`, in catalogue order, again until none of them changes anything.
// What is sound stays as it is, and so does what has no safe fix.
// UndoRepair(atlas, report.journal) undoes it bit by bit; WriteJournal keeps the journal for later.
//
// Throws Error, before anything changes: kUsage, when the options name an unknown rule, or one without a fix;
// kNotPossible, when the words are of another vocabulary than the one that is given.
// Cost: linear for each fix that is needed; holds a second copy of the atlas meanwhile when it keeps a journal. The
// outcome is the same for any number of threads.
SLAMDB_EXPORT RepairReport RepairAtlas(Atlas& atlas, const RepairOptions& options = {});

// Of what a repair has left, the errors: where, what, and why it stays.
[[nodiscard]] SLAMDB_EXPORT std::vector<std::string> ErrorsOf(const std::vector<Unrepaired>& left);

// As schema/repair.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const RepairReport& report, const ReportFiles& files = {});

}  // namespace slamdb
