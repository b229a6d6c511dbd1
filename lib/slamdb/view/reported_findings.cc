// SPDX-License-Identifier: BSD-3-Clause
// What a report in JSON found: a check its findings, a merge of two continuations its conflicts.
#include <algorithm>
#include <string_view>
#include <unordered_map>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/checks/detail/json.h"
#include "slamdb/view/page.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Json;

constexpr std::string_view kWanted = "a report of a check or a merge";

// Conflicts of one aspect are those of one rule.
std::vector<RuleResult> ConflictsOf(const Json& conflicts) {
  std::vector<RuleResult> results;
  std::unordered_map<std::string, std::size_t> rows;  // by aspect
  detail::ForEachItem(conflicts, "branches.conflicts", [&](const Json& conflict) {
    const std::string& aspect = conflict.at("aspect").get_ref<const std::string&>();
    const auto [row, is_new] = rows.emplace(aspect, results.size());
    if (is_new)
      results.push_back({.id = Concat("conflict: ", aspect),
                         .severity = Severity::kWarning,
                         .title = aspect == "deletion"
                                      ? "deleted by one side, extended by the other: kept"
                                      : Concat("both sides changed the ", aspect, ", each in another way")});
    ++results[row->second].count;
    results[row->second].findings.push_back(detail::FindingOf(conflict));
  });
  return results;
}

std::vector<RuleResult> ChecksOf(const Json& inputs, const std::string& input) {
  const Json* found = nullptr;
  std::string names;
  detail::ForEachItem(inputs, "inputs", [&](const Json& each) {
    const std::string& name = each.at("input").get_ref<const std::string&>();
    if (found == nullptr && (name == input || inputs.size() == 1)) found = &each;
    names += Concat(names.empty() ? "" : ", ", name);
  });
  if (found == nullptr)
    throw Error(ErrorKind::kNotFound, Concat("has no findings of '", input, "'; it has those of ", names));
  CheckedFile checked;
  detail::InPart(Concat("inputs[", found - &inputs.front(), "]"), [&] { checked = detail::CheckedFileOf(*found); });
  if (!checked.failure.empty())
    throw Error(ErrorKind::kNotFound,
                Concat("says of ", checked.name, " that it could not be read: ", checked.failure));
  return checked.report.results;
}

// Whether it is a report of that verb, and of this version of its names.
bool IsReportOf(const Json& report, std::string_view verb) {
  return report.at("report") == detail::ReportHead(verb).at("report");
}

}  // namespace

std::vector<RuleResult> ParseFindings(std::string_view json, const std::string& input) {
  try {
    const Json report = Json::parse(json);
    if (IsReportOf(report, "check")) return ChecksOf(report.at("inputs"), input);
    if (!IsReportOf(report, "merge"))
      throw Error(ErrorKind::kUsage, Concat("is ", detail::Dumped(report.at("report")), ", and not ", kWanted,
                                            " of this version of slamdb"));
    if (!report.contains("branches"))
      throw Error(ErrorKind::kNotFound, "tells of a merge without a base, which has no conflicts");
    return ConflictsOf(report.at("branches").at("conflicts"));
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::kDamaged, Concat("is not ", kWanted, ": ", error.what()));
  }
}

std::vector<RuleResult> ReadFindings(const std::string& path, const std::string& input) {
  const auto parse = [&](std::string_view json) { return ParseFindings(json, input); };
  return detail::ParseFile(path, kWanted, parse, {"report"});
}

}  // namespace slamdb
