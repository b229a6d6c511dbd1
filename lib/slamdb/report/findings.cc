// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/report/detail/parts.h"

namespace slamdb::report {
namespace {

using detail::Concat;

constexpr std::size_t kShown = 20;  // findings of each rule

void AppendBadge(Html& html, Severity severity) {
  switch (severity) {
    case Severity::kError:
      html << "<span class=\"badge error\">error</span> ";
      break;
    case Severity::kWarning:
      html << "<span class=\"badge warning\">warning</span> ";
      break;
    case Severity::kNote:
      html << "<span class=\"badge note\">note</span> ";
  }
}

// What to do about it.
std::string Advice(const RuleResult& result) {
  if (!result.fix.empty()) return Concat("slamdb repair mends it (", result.fix, ").");
  const Rule* rule = FindRule(result.id);
  if (rule != nullptr && !rule->fix.unfixable.empty()) return Concat("There is no repair: ", rule->fix.unfixable, ".");
  return rule == nullptr ? "A gate: the atlas has too much or too little of it." : "There is no repair for it.";
}

void AppendResult(Html& html, const RuleResult& result, const Wording& wording) {
  html << (result.severity == Severity::kError ? Literal("<details open><summary>") : Literal("<details><summary>"));
  AppendBadge(html, result.severity);
  html << "<code>" << result.id << "</code> " << Concat("\u00d7", detail::Thousands(result.count))
       << " <span class=\"faint\">should be: " << result.title << "</span></summary>";
  if (!result.consequence.empty()) html << "<p>ORB-SLAM3 " << result.consequence << ".</p>";
  html << "<p><strong>What to do:</strong> " << Worded(Advice(result), wording) << "</p><ul>";
  const std::size_t shown = std::min(kShown, result.findings.size());
  for (std::size_t i = 0; i < shown; ++i)
    html << "<li><code>" << ToString(result.findings[i].place)
         << "</code>: " << Worded(result.findings[i].message, wording) << "</li>";
  html << "</ul>";
  if (result.count > shown) html << "<p class=\"faint\">and " << detail::Thousands(result.count - shown) << " more</p>";
  html << "</details>\n";
}

}  // namespace

std::string VerdictWord(const AtlasReport& report) {
  if (!report.checked.failure.empty()) return "not readable";
  return report.checked.report.ok() ? "sound" : "not sound";
}

std::string LengthText(const AtlasStatistics& statistics) {
  const auto metric = std::ranges::count_if(statistics.maps, &MapStatistics::metric);
  return Concat(detail::Rounded(statistics.trajectory_length), metric == std::ssize(statistics.maps) ? " m"
                                                               : metric == 0                         ? " units"
                                                                                                     : " m and units");
}

void AppendVerdict(Html& html, const AtlasReport& report) {
  html << (VerdictWord(report) == "sound" ? Literal("<span class=\"badge good\">")
                                          : Literal("<span class=\"badge error\">"))
       << Verdict(report.checked) << "</span>";
}

void AppendFindings(Html& html, const CheckReport& report, const Wording& wording) {
  html << "<h2>Findings</h2>\n";
  if (report.results.empty())
    html << "<p>None: " << detail::Counted(report.checked.size(), "rule") << " checked.</p>\n";
  for (const Severity severity : {Severity::kError, Severity::kWarning, Severity::kNote})
    for (const RuleResult& result : report.results)
      if (result.severity == severity) AppendResult(html, result, wording);
}

namespace {

std::string MeasureText(double value) {
  const bool is_count = value >= 0 && value < 1e15 && value == std::floor(value);
  return is_count ? detail::Thousands(static_cast<std::uint64_t>(value)) : detail::Digits(value, 6);
}

void AppendMeasure(Html& html, const Gate& gate, const AtlasReport& report) {
  html << "<tr><td>" << std::string(gate.title) << "</td><td class=\"number\">"
       << MeasureText(gate.measure(report.checked.report.statistics)) << "</td>";
}

void AppendGatesAsked(Html& html, const AtlasReport& report) {
  html << "<div class=\"scroll\"><table>\n<tr><th>measure</th><th class=\"number\">value</th>"
          "<th class=\"number\">limit</th><th>verdict</th></tr>\n";
  for (const Gate& gate : ReadGates()) {
    const auto limit = std::ranges::find(report.gates, gate.id, &GateLimit::gate);
    if (limit == report.gates.end()) continue;
    const bool broken = std::ranges::find(report.checked.report.results, GateRuleId(gate.id), &RuleResult::id) !=
                        report.checked.report.results.end();
    AppendMeasure(html, gate, report);
    html << "<td class=\"number\">" << Concat(gate.is_minimum ? "at least " : "at most ", MeasureText(limit->limit))
         << "</td><td>"
         << (broken ? Literal("<span class=\"badge error\">not passed</span>")
                    : Literal("<span class=\"badge good\">passed</span>"))
         << "</td></tr>\n";
  }
  html << "</table></div>\n";
}

// Both bounds of one measure are two gates; without a limit the measure stands once.
bool IsMeasureWithoutLimit(const Gate& gate, const AtlasReport& report) {
  if (std::ranges::find(ReadGates(), gate.measure_name, &Gate::measure_name)->id != gate.id) return false;
  return std::ranges::none_of(report.gates, [&](const GateLimit& limit) {
    const auto found = std::ranges::find(ReadGates(), limit.gate, &Gate::id);
    return found != ReadGates().end() && found->measure_name == gate.measure_name;
  });
}

}  // namespace

void AppendGates(Html& html, const AtlasReport& report) {
  html << "<h2>Gates</h2>\n";
  if (!report.gates.empty()) AppendGatesAsked(html, report);
  html << "<details><summary>measures without a limit</summary><div class=\"scroll\"><table>\n"
          "<tr><th>measure</th><th class=\"number\">value</th></tr>\n";
  for (const Gate& gate : ReadGates()) {
    if (!IsMeasureWithoutLimit(gate, report)) continue;
    AppendMeasure(html, gate, report);
    html << "</tr>\n";
  }
  html << "</table></div></details>\n";
}

}  // namespace slamdb::report
