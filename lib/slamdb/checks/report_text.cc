// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/checks/report.h"

namespace slamdb {
namespace {

constexpr std::array kWorstFirst{Severity::kError, Severity::kWarning, Severity::kNote};

std::string Counted(std::uint64_t count, std::string_view noun) {
  return detail::Concat(std::to_string(count), " ", noun, count == 1 ? "" : "s");
}

// "1 error, 2 warnings, 530 notes"; kinds without any are left out, and nothing at all is "sound".
std::string Totals(const CheckReport& report) {
  std::string text;
  for (const Severity severity : kWorstFirst)
    if (const std::uint64_t count = report.Count(severity); count > 0)
      text += (text.empty() ? "" : ", ") + Counted(count, ToString(severity));
  return text.empty() ? "sound" : text;
}

void AppendHead(const RuleResult& result, std::string& text) {
  text += detail::Concat("  ", result.severity, " ", result.id, " (", result.count, "): ", result.title, "\n");
}

void AppendResult(const RuleResult& result, std::size_t shown, std::string& text) {
  text += "\n";
  AppendHead(result, text);
  if (!result.consequence.empty()) text += detail::Concat("    otherwise ORB-SLAM3 ", result.consequence, "\n");
  shown = std::min(shown, result.findings.size());
  for (std::size_t i = 0; i < shown; ++i)
    text += detail::Concat("      ", ToString(result.findings[i].place), ": ", result.findings[i].message, "\n");
  if (result.count > shown) text += detail::Concat("      ... and ", std::to_string(result.count - shown), " more\n");
}

void AppendFile(const CheckedFile& file, const TextReportOptions& options, std::string& text) {
  if (!file.failure.empty()) {
    text += detail::Concat(file.name, ": cannot be checked\n\n  ", file.failure, "\n");
    return;
  }
  text += detail::Concat(file.name, ": ", Totals(file.report), " (", Counted(file.report.checked.size(), "rule"),
                         " checked)\n");
  for (const Severity severity : kWorstFirst) {
    if (severity == Severity::kNote && !options.show_notes) continue;
    const bool brief = severity == Severity::kNote && !options.note_findings;
    if (brief && file.report.Count(severity) > 0) text += "\n";
    for (const RuleResult& result : file.report.results) {
      if (result.severity != severity) continue;
      brief ? AppendHead(result, text) : AppendResult(result, options.shown_per_rule, text);
    }
  }
}

}  // namespace

std::string TextReport(std::span<const CheckedFile> files, const TextReportOptions& options) {
  std::string text;
  std::size_t with_errors = 0, failed = 0;
  for (const CheckedFile& file : files) {
    if (!text.empty()) text += "\n";
    AppendFile(file, options, text);
    if (!file.failure.empty())
      ++failed;
    else if (!file.report.ok())
      ++with_errors;
  }
  if (files.size() < 2) return text;
  text += detail::Concat("\n", std::to_string(files.size()),
                         " files: ", std::to_string(files.size() - with_errors - failed), " without errors, ",
                         std::to_string(with_errors), " with errors");
  if (failed > 0) text += detail::Concat(", ", std::to_string(failed), " not readable");
  return text + "\n";
}

std::string TextCatalogue() {
  std::string text;
  const auto append = [&](std::string_view kind, std::string_view id, std::string_view title) {
    std::string line(kind);
    line.resize(9, ' ');
    line += id;
    line.resize(std::max<std::size_t>(line.size() + 2, 38), ' ');
    text += detail::Concat(line, title, "\n");
  };
  for (const Rule& rule : ReadRules()) append(ToString(rule.severity), rule.id, rule.title);
  for (const Gate& gate : ReadGates())
    append("gate", gate.id, detail::Concat(gate.is_minimum ? "at least so many " : "at most so many ", gate.title));
  return text;
}

std::string MarkdownCatalogue() {
  std::string text =
      "| id | severity | what holds in a sound atlas | otherwise ORB-SLAM3 | repair |\n"
      "|---|---|---|---|---|\n";
  for (const Rule& rule : ReadRules()) {
    const std::string fix = rule.fix ? detail::Concat("`", rule.fix.name, "`") : "";
    text += detail::Concat("| `", rule.id, "` | ", ToString(rule.severity), " | ", rule.title, " | ", rule.consequence,
                           " | ", fix, " |\n");
  }
  text += "\n| gate | passes with |\n|---|---|\n";
  for (const Gate& gate : ReadGates())
    text += detail::Concat("| `", gate.id, "` | ", gate.is_minimum ? "at least N " : "at most N ", gate.title, " |\n");
  return text;
}

}  // namespace slamdb
