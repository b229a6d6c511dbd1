// SPDX-License-Identifier: BSD-3-Clause
#include "cli/check_options.h"

#include <cmath>
#include <limits>
#include <string>

#include "cli/help/usage.h"
#include "cli/options.h"
#include "cli/values.h"

namespace slamdb::cli {
namespace {

std::string CheckRuleId(const std::string& id) {
  if (FindRule(id) != nullptr) return {};
  std::vector<std::string> ids;
  for (const Rule& rule : ReadRules()) ids.emplace_back(rule.id);
  const std::string meant = MeantInstead(id, ids);
  return "no rule '" + id + "'" + (meant.empty() ? "; `slamdb check --list` shows them" : meant);
}

}  // namespace

void AddRules(CLI::App& verb, CheckOptions& check) {
  constexpr const char* kGroup = "Rules";
  const auto rules = [&](const char* name, std::vector<std::string>& ids, const char* description) {
    verb.add_option(name, ids, description)
        ->type_name("RULE")
        ->allow_extra_args(false)
        ->check(CheckRuleId)
        ->group(kGroup);
  };
  rules("--ignore", check.ignore, "Do not check this rule; may be given several times, as the next ones");
  rules("--note", check.note, "Findings of this rule are notes");
  rules("--warn", check.warn, "Findings of this rule are warnings");
  rules("--error", check.error, "Findings of this rule are errors");
  verb.add_flag("--strict", check.strict, "Warnings count as errors")->group(kGroup);
}

void AddGates(CLI::App& verb, std::vector<double>& limits) {
  const auto gates = ReadGates();
  limits.assign(gates.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < gates.size(); ++i)
    verb.add_option(
            "--" + std::string(gates[i].id), limits[i],
            std::string(gates[i].is_minimum ? "At least" : "At most") + " so many " + std::string(gates[i].title))
        ->type_name("NUMBER")
        ->check(Within(kNonNegative))
        ->group("Quality gates, whose breach is an error");
}

std::vector<GateLimit> GatesOf(const std::vector<double>& limits) {
  std::vector<GateLimit> gates;
  for (std::size_t i = 0; i < limits.size(); ++i)
    if (!std::isnan(limits[i])) gates.push_back({std::string(ReadGates()[i].id), limits[i]});
  return gates;
}

}  // namespace slamdb::cli
