// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/checks/report.h"

namespace slamdb {
namespace {

constexpr std::array kWorstFirst{Severity::kError, Severity::kWarning, Severity::kNote};

// "1 error, 2 warnings, 530 notes"; kinds without any are left out.
std::string Totals(const CheckReport& report) {
  std::string text;
  for (const Severity severity : kWorstFirst)
    if (const std::uint64_t count = report.Count(severity); count > 0)
      text += (text.empty() ? "" : ", ") + detail::Counted(count, ToString(severity));
  return text;
}

// What is broken and where, and what comes of it. What should hold is in the catalogue.
void AppendResult(const RuleResult& result, std::size_t shown, std::string& text) {
  text += detail::Concat("\n  ", result.severity, " ", result.id);
  if (result.count > 1) text += detail::Concat(" (", detail::Thousands(result.count), ")");
  text += "\n";
  shown = std::min(shown, result.findings.size());
  for (std::size_t i = 0; i < shown; ++i)
    text += detail::Concat("      ", ToString(result.findings[i].place), ": ", result.findings[i].message, "\n");
  if (result.count > shown)
    text += detail::Concat("      ... and ", detail::Thousands(result.count - shown), " more\n");
  if (!result.consequence.empty()) text += detail::Concat("    ORB-SLAM3 ", result.consequence, "\n");
}

void AppendFile(const CheckedFile& file, const TextReportOptions& options, std::string& text) {
  if (!file.failure.empty()) {
    text +=
        detail::Concat(detail::Visible(file.name), ": ", Verdict(file), "\n\n  ", detail::Visible(file.failure), "\n");
    return;
  }
  text += detail::Concat(detail::Visible(file.name), ": ", Verdict(file), " (",
                         detail::Counted(file.report.checked.size(), "rule"), " checked)\n");
  for (const Severity severity : kWorstFirst) {
    if (severity == Severity::kNote && !options.show_notes) continue;
    for (const RuleResult& result : file.report.results)
      if (result.severity == severity) AppendResult(result, options.shown_per_rule, text);
  }
}

bool IsBroken(const CheckedFile& file) {
  return !file.failure.empty() || file.report.Count(Severity::kError) + file.report.Count(Severity::kWarning) > 0;
}

bool IsSound(const CheckedFile& file) { return file.failure.empty() && file.report.ok(); }

class TextReporter : public CheckReporter {
 public:
  TextReporter(Sink sink, const TextReportOptions& options) : sink_(std::move(sink)), options_(options) {}

  void Add(const CheckedFile& file) override {
    ++files_;
    if (!file.failure.empty()) ++unreadable_;
    if (IsSound(file))
      ++sound_;
    else
      failed_ += detail::Concat("  ", detail::Visible(file.name), ": ", Verdict(file), "\n");
    if (options_.only_broken && !IsBroken(file)) return;
    std::string text = told_ ? "\n" : "";
    AppendFile(file, options_, text);
    sink_(text);
    told_ = true;
  }
  // Of several, how many failed, and which.
  void End() override {
    if (files_ < 2 || (options_.only_broken && !told_)) return;
    std::string text = detail::Concat("\n", detail::Thousands(files_), " atlases: ", detail::Thousands(sound_),
                                      " sound, ", detail::Thousands(files_ - sound_ - unreadable_), " not sound");
    if (unreadable_ > 0) text += detail::Concat(", ", detail::Thousands(unreadable_), " not readable");
    sink_(detail::Concat(text, "\n", failed_));
  }

 private:
  const Sink sink_;
  const TextReportOptions options_;
  std::size_t files_ = 0, sound_ = 0, unreadable_ = 0;
  bool told_ = false;
  std::string failed_;  // a line for each
};

}  // namespace

std::string Verdict(const CheckedFile& file) {
  if (!file.failure.empty()) return "not readable";
  const std::string totals = Totals(file.report);
  if (!file.report.ok()) return totals + ": not sound";
  return totals.empty() ? "sound" : "sound, " + totals;
}

std::unique_ptr<CheckReporter> MakeTextReporter(CheckReporter::Sink sink, const TextReportOptions& options) {
  return std::make_unique<TextReporter>(std::move(sink), options);
}

std::string TextReport(std::span<const CheckedFile> files, const TextReportOptions& options) {
  std::string text;
  TextReporter reporter([&](std::string_view piece) { text += piece; }, options);
  for (const CheckedFile& file : files) reporter.Add(file);
  reporter.End();
  return text;
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
