// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/checks/report.h"

namespace slamdb {
namespace {

// How many bytes the UTF-8 character at the beginning of `text` has; 0: there is none.
std::size_t CharacterLength(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 && first < 0xF5 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 0;
  if (first >= 0xF5 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) return 0;
  return length;
}

std::string_view Entity(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\n':
      return "&#10;";
    default:
      return static_cast<unsigned char>(c) < 0x20 ? "?" : "";
  }
}

// Text for XML 1.0: markup escaped; control characters and bytes that are not UTF-8, which it cannot hold, become '?'.
std::string Escaped(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t length = CharacterLength(text);
    const std::string_view entity = length == 0 ? "?" : Entity(text[0]);
    const std::size_t taken = std::max<std::size_t>(length, 1);
    result += entity.empty() ? text.substr(0, taken) : entity;
    text.remove_prefix(taken);
  }
  return result;
}

std::string Attribute(std::string_view name, std::string_view value) {
  return detail::Concat(" ", name, "=\"", Escaped(value), "\"");
}

const RuleResult* FindResult(const CheckReport& report, const std::string& id) {
  const auto found = std::ranges::find(report.results, id, &RuleResult::id);
  return found == report.results.end() ? nullptr : &*found;
}

std::string Lines(const RuleResult& result) {
  std::string text;
  for (const Finding& finding : result.findings)
    text += detail::Concat(ToString(finding.place), ": ", finding.message, "\n");
  if (result.count > result.findings.size())
    text += detail::Concat("... and ", std::to_string(result.count - result.findings.size()), " more\n");
  if (!result.consequence.empty()) text += detail::Concat("ORB-SLAM3 ", result.consequence, "\n");
  return text;
}

// "3 errors: map 0, kf 7: parent kf 9, which does not exist; and 2 more".
std::string SummaryOf(const RuleResult& result) {
  std::string text =
      detail::Concat(std::to_string(result.count), " ", ToString(result.severity), result.count == 1 ? "" : "s");
  if (result.findings.empty()) return text;
  text += detail::Concat(": ", ToString(result.findings[0].place), ": ", result.findings[0].message);
  if (result.count > 1) text += detail::Concat("; and ", std::to_string(result.count - 1), " more");
  return text;
}

void AppendCase(const CheckedFile& file, const std::string& id, bool with_notes, std::string& xml) {
  xml += detail::Concat("    <testcase", Attribute("classname", file.name), Attribute("name", id));
  const RuleResult* result = FindResult(file.report, id);
  if (result == nullptr || (result->severity == Severity::kNote && !with_notes)) {
    xml += "/>\n";
    return;
  }
  const std::string summary = SummaryOf(*result);
  if (result->severity == Severity::kError)
    xml += detail::Concat(">\n      <failure", Attribute("type", "error"), Attribute("message", summary), ">",
                          Escaped(Lines(*result)), "</failure>\n    </testcase>\n");
  else
    xml += detail::Concat(">\n      <system-out>", Escaped(detail::Concat(summary, "\n", Lines(*result))),
                          "</system-out>\n    </testcase>\n");
}

std::size_t FailedCases(const CheckReport& report) {
  return static_cast<std::size_t>(std::ranges::count(report.results, Severity::kError, &RuleResult::severity));
}

void AppendSuite(const CheckedFile& file, bool with_notes, std::string& xml) {
  const bool read = file.failure.empty();
  xml += detail::Concat("  <testsuite", Attribute("name", file.name),
                        Attribute("tests", std::to_string(read ? file.report.checked.size() : 1)),
                        Attribute("failures", std::to_string(FailedCases(file.report))),
                        Attribute("errors", read ? "0" : "1"), ">\n");
  for (const std::string& id : file.report.checked) AppendCase(file, id, with_notes, xml);
  if (!read)
    xml +=
        detail::Concat("    <testcase", Attribute("classname", file.name), Attribute("name", "read"), ">\n      <error",
                       Attribute("type", "unreadable"), Attribute("message", file.failure), "/>\n    </testcase>\n");
  xml += "  </testsuite>\n";
}

// What is written now and read once, later: in a file that has no name.
class Spool {
 public:
  Spool() : file_(std::tmpfile()) {
    if (file_ == nullptr) throw SystemError(kPlace, "cannot be written to");
  }
  ~Spool() { std::fclose(file_); }
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  void Write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size())
      throw SystemError(kPlace, "cannot be written to");
  }
  void ReadAll(const CheckReporter::Sink& sink) {
    if (std::fflush(file_) != 0) throw SystemError(kPlace, "cannot be written to");
    std::rewind(file_);
    std::string block(std::size_t{1} << 16, '\0');
    while (const std::size_t bytes = std::fread(block.data(), 1, block.size(), file_))
      sink(std::string_view(block.data(), bytes));
    if (std::ferror(file_) != 0) throw SystemError(kPlace, "cannot be read");
  }

 private:
  static constexpr const char* kPlace = "the folder of temporary files";
  std::FILE* file_;
};

class JUnitReporter : public CheckReporter {
 public:
  JUnitReporter(Sink sink, bool with_notes) : sink_(std::move(sink)), with_notes_(with_notes) {}

  void Add(const CheckedFile& file) override {
    const bool read = file.failure.empty();
    tests_ += read ? file.report.checked.size() : 1;
    failures_ += FailedCases(file.report);
    errors_ += read ? 0 : 1;
    std::string suite;
    AppendSuite(file, with_notes_, suite);
    suites_.Write(suite);
  }
  void End() override {
    sink_(detail::Concat("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites", Attribute("name", "slamdb check"),
                         Attribute("tests", std::to_string(tests_)), Attribute("failures", std::to_string(failures_)),
                         Attribute("errors", std::to_string(errors_)), ">\n"));
    suites_.ReadAll(sink_);
    sink_("</testsuites>\n");
  }

 private:
  const Sink sink_;
  const bool with_notes_;
  std::size_t tests_ = 0, failures_ = 0, errors_ = 0;
  Spool suites_;
};

}  // namespace

std::unique_ptr<CheckReporter> MakeJUnitReporter(CheckReporter::Sink sink, bool with_notes) {
  return std::make_unique<JUnitReporter>(std::move(sink), with_notes);
}

std::string JUnitReport(std::span<const CheckedFile> files, bool with_notes) {
  std::string xml;
  JUnitReporter reporter([&](std::string_view piece) { xml += piece; }, with_notes);
  for (const CheckedFile& file : files) reporter.Add(file);
  reporter.End();
  return xml;
}

}  // namespace slamdb
