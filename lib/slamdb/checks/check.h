// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/checks/finding.h"
#include "slamdb/export.h"
#include "slamdb/model/index.h"
#include "slamdb/model/statistics.h"

namespace slamdb {

namespace detail {
class Observers;
}

struct CheckOptions;

// What a rule looks at. Safe to share between threads.
struct Subject {
  const Atlas& atlas;
  const AtlasIndex& index;
  const detail::Observers* observers;  // one for each map
  const AtlasStatistics& statistics;
  const CheckOptions& options;
};

// A repair: changes an atlas so that its rule finds nothing, as far as that can be done without inventing data.
// Returns how much it changed.
// Doing it again changes nothing, and a sound atlas stays as it is.
struct Fix {
  std::string_view name;  // with a verb in it; empty: the rule has no repair
  std::size_t (*apply)(Atlas&) = nullptr;
  std::string_view unfixable = {};  // why there is no repair, or what it cannot repair
  explicit operator bool() const { return apply != nullptr; }
};

// One invariant of a sound atlas.
struct Rule {
  std::string_view id;  // kebab-case, stable, never reused
  Severity severity;
  std::string_view title;        // the invariant that holds
  std::string_view consequence;  // what ORB-SLAM3 does when it does not hold
  void (*check)(const Subject&, Findings&);
  Fix fix;
};

// The catalogue, in repair order: what a later rule relies on is repaired before it.
[[nodiscard]] SLAMDB_EXPORT std::span<const Rule> ReadRules();

// null when there is none.
[[nodiscard]] SLAMDB_EXPORT const Rule* FindRule(std::string_view id);

// A number that an atlas must reach, or must not exceed.
struct Gate {
  std::string_view id;            // "min-keyframes"
  std::string_view measure_name;  // "keyframes": of the number in reports, the same for both bounds
  std::string_view title;         // "keyframes in the atlas"
  bool is_minimum;
  double (*measure)(const AtlasStatistics&);
};
[[nodiscard]] SLAMDB_EXPORT std::span<const Gate> ReadGates();

// A gate's findings go by "gate-" and its id.
[[nodiscard]] SLAMDB_EXPORT std::string GateRuleId(std::string_view gate);

struct GateLimit {
  std::string gate;
  double limit = 0;
};

struct CheckOptions {
  std::vector<std::string> ignore, note, warn, error;  // rule ids whose severity is not the catalogue's; the last wins
  bool strict = false;                                 // warnings count as errors
  std::optional<std::uint64_t> vocabulary_words;  // of the vocabulary that bags of words refer to, when it is known
  std::size_t max_findings = 100;                 // kept of each rule; all are counted
  std::vector<GateLimit> gates;
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty
};

// What one rule or gate found.
struct RuleResult {
  std::string id;  // of the rule, or of the gate
  Severity severity = Severity::kNote;
  std::string title, consequence;
  std::string fix;  // name of the repair, or empty
  std::uint64_t count = 0;
  std::vector<Finding> findings;  // the first of them
};

struct CheckReport {
  std::vector<RuleResult> results;   // rules with findings, in catalogue order, then gates not passed
  std::vector<std::string> checked;  // ids of all rules and gates that were held against the atlas, in that order
  AtlasStatistics statistics;

  SLAMDB_EXPORT std::uint64_t Count(Severity severity) const;
  bool ok() const { return Count(Severity::kError) == 0; }
};

// Holds every rule that is not ignored against the atlas, several at a time. The atlas may hold anything.
//
// Throws Error (kUsage), before the work, when the options name an unknown rule or gate.
// Cost: linear but for pairs of keyframes that share points; the report is the same for any threads. Thread-safe.
[[nodiscard]] SLAMDB_EXPORT CheckReport CheckAtlas(const Atlas& atlas, const CheckOptions& options = {});

}  // namespace slamdb
