// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/checks/check.h"

#include <algorithm>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/checks/detail/observers.h"

namespace slamdb {
namespace {

// A rule as this run takes it; no severity: it is left out.
struct PlannedRule {
  const Rule* rule;
  std::optional<Severity> severity;
};

std::vector<PlannedRule> PlanRules(const CheckOptions& options) {
  std::vector<PlannedRule> plan;
  for (const Rule& rule : ReadRules()) plan.push_back({&rule, rule.severity});
  const auto change = [&](const std::vector<std::string>& ids, std::optional<Severity> severity) {
    for (const std::string& id : ids) {
      const auto found = std::ranges::find(plan, std::string_view(id), [](const PlannedRule& p) { return p.rule->id; });
      if (found == plan.end())
        throw Error(ErrorKind::kUsage, detail::Concat("no rule is called '", id, "'; `ReadRules` names all"));
      found->severity = severity;
    }
  };
  change(options.ignore, std::nullopt);
  change(options.note, Severity::kNote);
  change(options.warn, Severity::kWarning);
  change(options.error, Severity::kError);
  std::erase_if(plan, [](const PlannedRule& planned) { return !planned.severity; });
  return plan;
}

const Gate& FindGate(std::string_view id) {
  const auto gates = ReadGates();
  const auto found = std::ranges::find(gates, id, &Gate::id);
  if (found == gates.end()) throw Error(ErrorKind::kUsage, detail::Concat("no quality gate is called '", id, "'"));
  return *found;
}

std::optional<RuleResult> PassGate(const GateLimit& limit, const AtlasStatistics& statistics) {
  const Gate& gate = FindGate(limit.gate);
  const double value = gate.measure(statistics);
  const bool passed = gate.is_minimum ? value >= limit.limit : value <= limit.limit;
  if (passed) return std::nullopt;
  Findings findings(1);
  findings.Add(Place{}, "has ", value, " ", gate.title, gate.is_minimum ? ", fewer than " : ", more than ",
               limit.limit);
  return RuleResult{.id = GateRuleId(gate.id),
                    .severity = Severity::kError,
                    .title = "passes the quality gate " + std::string(gate.id),
                    .consequence = {},
                    .fix = {},
                    .count = 1,
                    .findings = std::move(findings.items())};
}

RuleResult ResultOf(const PlannedRule& planned, bool strict, Findings& findings) {
  const Rule& rule = *planned.rule;
  const bool promoted = strict && planned.severity == Severity::kWarning;
  return {.id = std::string(rule.id),
          .severity = promoted ? Severity::kError : *planned.severity,
          .title = std::string(rule.title),
          .consequence = std::string(rule.consequence),
          .fix = std::string(rule.fix.name),
          .count = findings.count(),
          .findings = std::move(findings.items())};
}

}  // namespace

std::uint64_t CheckReport::Count(Severity severity) const {
  std::uint64_t count = 0;
  for (const RuleResult& result : results)
    if (result.severity == severity) count += result.count;
  return count;
}

// Rules run side by side, each alone on its thread with findings of its own, so that none needs to know of threads and
// the report has one order.
CheckReport CheckAtlas(const Atlas& atlas, const CheckOptions& options) {
  const std::vector<PlannedRule> plan = PlanRules(options);
  for (const GateLimit& limit : options.gates) FindGate(limit.gate);  // before the work

  const AtlasIndex index(atlas);
  CheckReport report;
  for (const PlannedRule& planned : plan) report.checked.emplace_back(planned.rule->id);
  for (const GateLimit& limit : options.gates) report.checked.push_back(GateRuleId(limit.gate));
  report.statistics = ComputeStatistics(atlas, options.threads);
  std::vector<detail::Observers> observers;
  for (std::size_t map = 0; map < atlas.maps.size(); ++map) observers.emplace_back(index, map);
  const Subject subject{atlas, index, observers.data(), report.statistics, options};

  std::vector<Findings> findings(plan.size(), Findings(options.max_findings));
  detail::ParallelFor(plan.size(), 1, options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) plan[i].rule->check(subject, findings[i]);
  });
  detail::Steps(options.progress, "checking", 1).Next();
  for (std::size_t i = 0; i < plan.size(); ++i)
    if (findings[i].count() > 0) report.results.push_back(ResultOf(plan[i], options.strict, findings[i]));
  for (const GateLimit& limit : options.gates)
    if (std::optional<RuleResult> failed = PassGate(limit, report.statistics)) report.results.push_back(*failed);
  return report;
}

}  // namespace slamdb
