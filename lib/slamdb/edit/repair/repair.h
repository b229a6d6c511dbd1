// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/checks/check.h"
#include "slamdb/edit/repair/journal.h"

namespace slamdb {

struct RepairOptions {
  std::vector<std::string> rules;      // ids of the rules whose fixes are applied; empty: of every rule
  std::uint64_t vocabulary_words = 0;  // as in CheckOptions
  int threads = 0;                     // 0: every core
  bool journal = true;                 // false saves the copy that it takes
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
  Journal journal;

  bool sound() const;  // no error is left
};

// Applies the fixes of the rules to `atlas`, in catalogue order, again until none of them changes anything. What is
// sound stays as it is, and so does what has no safe fix. TakeBack(report.journal) undoes it bit by bit. Linear for
// each fix that is needed; holds a second copy of the atlas meanwhile when it keeps a journal. The outcome does not
// depend on the number of threads. Throws Error when the options name an unknown rule, or one without a fix.
RepairReport RepairAtlas(Atlas& atlas, const RepairOptions& options = {});

}  // namespace slamdb
