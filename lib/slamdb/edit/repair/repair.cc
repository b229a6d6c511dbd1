// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/repair/repair.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/words/mend.h"
#include "slamdb/model/digest.h"

namespace slamdb {
namespace {

constexpr int kMostRounds = 16;  // what one fix uncovers another one repairs; two or three rounds are usual

void RequireFixes(const std::vector<std::string>& ids) {
  for (const std::string& id : ids) {
    const Rule* rule = FindRule(id);
    if (rule == nullptr)
      throw Error(ErrorKind::kUsage, detail::Concat("no rule is called '", id, "'; `ReadRules` names all"));
    if (!rule->fix)
      throw Error(ErrorKind::kUsage, detail::Concat("rule '", id, "' has no repair: ", rule->fix.unfixable));
  }
}

bool IsChosen(const RepairOptions& options, std::string_view rule) {
  return options.rules.empty() || std::ranges::find(options.rules, rule) != options.rules.end();
}

CheckReport Check(const Atlas& atlas, const RepairOptions& options) {
  const std::optional<std::uint64_t> words =
      options.vocabulary == nullptr ? options.vocabulary_words : options.vocabulary->word_count;
  return CheckAtlas(atlas, {.vocabulary_words = words, .threads = options.threads});
}

// Words are mended before the rules look, which without a vocabulary can only drop them.
void ApplyVocabulary(const RepairOptions& options, Atlas& atlas, RepairReport& report) {
  constexpr std::string_view kRule = "word-range";
  if (options.vocabulary == nullptr || !IsChosen(options, kRule)) return;
  const Atlas original = options.journal ? atlas : Atlas();
  const MendWordsReport mended = MendWords(
      atlas, {.tree = options.vocabulary, .identity = options.vocabulary_identity, .threads = options.threads});
  if (!mended.changed()) return;
  if (options.journal) AppendChanges(original, atlas, kRule, report.journal);
  const std::uint64_t changes = mended.recomputed.size() + mended.restored_vocabulary;
  const Place place = {.keyframe = mended.recomputed.empty() ? KeyFrameId() : mended.recomputed.front()};
  report.applied.push_back({.rule = std::string(kRule),
                            .fix = "RecomputeWords",
                            .severity = FindRule(kRule)->severity,
                            .title = std::string(FindRule(kRule)->title),
                            .findings = changes,
                            .changes = changes,
                            .first = {place, SentencesOf(mended).front()}});
}

// Applies the fixes of the chosen rules that found something; returns whether any of them changed anything.
// Tells its listener of each rule before it changes anything.
bool ApplyFixes(const CheckReport& check, const RepairOptions& options, detail::Steps& steps, Atlas& atlas,
                RepairReport& report) {
  const std::size_t before = report.applied.size();
  for (const RuleResult& result : check.results) {
    steps.Next();
    const Rule* rule = FindRule(result.id);
    if (!rule->fix || !IsChosen(options, result.id)) continue;
    const Atlas original = options.journal ? atlas : Atlas();
    const std::size_t changes = rule->fix.apply(atlas);
    if (changes == 0) continue;
    if (options.journal) AppendChanges(original, atlas, result.id, report.journal);
    report.applied.push_back({.rule = result.id,
                              .fix = result.fix,
                              .severity = result.severity,
                              .title = result.title,
                              .findings = result.count,
                              .changes = changes,
                              .first = result.findings.front()});
  }
  return report.applied.size() > before;
}

std::string ReasonOf(const Rule& rule, const RepairOptions& options) {
  if (!IsChosen(options, rule.id)) return rule.fix ? "not chosen" : std::string(rule.fix.unfixable);
  if (!rule.fix.unfixable.empty()) return std::string(rule.fix.unfixable);
  return "its repair did not reach it";
}

}  // namespace

bool RepairReport::sound() const {
  return std::ranges::none_of(left, [](const Unrepaired& rule) { return rule.severity == Severity::kError; });
}

RepairReport RepairAtlas(Atlas& atlas, const RepairOptions& options) {
  RequireFixes(options.rules);
  RepairReport report;
  if (options.journal)
    report.journal = {.original = HashWithoutEncoding(atlas, options.threads), .encoding = atlas.encoding};
  ApplyVocabulary(options, atlas, report);
  CheckReport check = Check(atlas, options);
  detail::Steps steps(options.progress, "repairing", check.results.size() + 1);
  for (int round = 0; round < kMostRounds && ApplyFixes(check, options, steps, atlas, report); ++round)
    check = Check(atlas, options);
  steps.Next();
  for (RuleResult& result : check.results)
    report.left.push_back({.rule = result.id,
                           .severity = result.severity,
                           .title = result.title,
                           .findings = result.count,
                           .first = std::move(result.findings.front()),
                           .reason = ReasonOf(*FindRule(result.id), options)});
  if (options.journal)
    report.journal.repaired =
        report.applied.empty() ? report.journal.original : HashWithoutEncoding(atlas, options.threads);
  return report;
}

std::vector<std::string> ErrorsOf(const std::vector<Unrepaired>& left) {
  std::vector<std::string> errors;
  for (const Unrepaired& rule : left)
    if (rule.severity == Severity::kError)
      errors.push_back(rule.rule + ": " + ToString(rule.first.place) + ": " + rule.first.message + "; stays, since " +
                       rule.reason);
  return errors;
}

}  // namespace slamdb
