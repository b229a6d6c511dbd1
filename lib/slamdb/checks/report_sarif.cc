// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/checks/report.h"

namespace slamdb {
namespace {

using detail::Json;

constexpr std::string_view kSchema =
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json";

// A path as a relative or file URI: everything but unreserved characters and '/' percent-encoded (RFC 3986).
std::string Uri(std::string_view path) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string uri(path.starts_with('/') ? "file://" : "");
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'Z') || (byte >= 'a' && byte <= 'z') ||
                       std::string_view("-._~/").find(c) != std::string_view::npos;
    if (plain)
      uri += c;
    else
      uri += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return uri;
}

std::string QualifiedName(const Place& place) {
  std::string name;
  const auto append = [&](const char* kind, std::uint64_t id) {
    name += detail::Concat(name.empty() ? "" : "/", kind, "/", std::to_string(id));
  };
  if (place.map) append("map", place.map.value());
  if (place.keyframe) append("kf", place.keyframe.value());
  if (place.feature >= 0) append("feature", static_cast<std::uint64_t>(place.feature));
  if (place.point) append("mp", place.point.value());
  if (place.camera) append("camera", place.camera.value());
  if (place.landmark) append("landmark", place.landmark.value());
  return name.empty() ? "atlas" : name;
}

// Rules of the report itself, behind those of the catalogue and the gates.
constexpr std::string_view kUnreadable = "unreadable", kTruncated = "truncated";

// GitHub shows so many results of a run; the whole file then stays far below the 10 MB that it takes compressed.
constexpr std::size_t kMostResults = 5000;

std::string_view ProblemSeverity(Severity severity) {
  return severity == Severity::kNote ? "recommendation" : ToString(severity);
}

// `broken` says what a finding of the rule means, in a sentence without its full stop.
Json RuleJson(std::string_view id, std::string_view broken, const std::string& text, Severity severity) {
  return {{"id", id},
          {"name", id},
          {"shortDescription", {{"text", broken}}},
          {"fullDescription", {{"text", text}}},
          {"help", {{"text", text}, {"markdown", detail::Concat("**`", id, "`** ", text)}}},
          {"defaultConfiguration", {{"level", ToString(severity)}}},
          {"properties",
           {{"tags", {"slam-map", "orb-slam3"}},
            {"precision", "very-high"},
            {"problem.severity", ProblemSeverity(severity)}}}};
}

Json RulesJson() {
  Json rules = Json::array();
  for (const Rule& rule : ReadRules()) {
    std::string text =
        detail::Concat("In a sound atlas ", rule.title, ". Where that is broken, ORB-SLAM3 ", rule.consequence, ".");
    if (rule.fix) text += detail::Concat(" `slamdb repair` has a repair: ", rule.fix.name, ".");
    rules.push_back(RuleJson(rule.id, detail::Concat("Broken: ", rule.title), text, rule.severity));
  }
  for (const Gate& gate : ReadGates())
    rules.push_back(RuleJson(GateRuleId(gate.id), detail::Concat("Missed: the quality gate ", gate.id),
                             detail::Concat("The gate sets how many ", gate.title, " an atlas must have at ",
                                            gate.is_minimum ? "least" : "most", "; the limit is given with the check."),
                             Severity::kError));
  rules.push_back(RuleJson(kUnreadable, "The file cannot be read as an atlas",
                           "The file is damaged, cut, of another format, or not there. `slamdb recover` saves what is "
                           "whole of a damaged atlas.",
                           Severity::kError));
  rules.push_back(RuleJson(kTruncated, "Not all findings are listed",
                           "All findings are counted, but so many are not listed one by one; `slamdb check` as text or "
                           "JSON tells of each rule how many there are.",
                           Severity::kWarning));
  return rules;
}

std::size_t RuleIndex(const std::string& id) {
  const auto rules = ReadRules();
  const auto rule = std::ranges::find(rules, std::string_view(id), &Rule::id);
  if (rule != rules.end()) return static_cast<std::size_t>(rule - rules.begin());
  const auto gates = ReadGates();
  const auto gate = std::ranges::find_if(gates, [&](const Gate& candidate) { return GateRuleId(candidate.id) == id; });
  return rules.size() + static_cast<std::size_t>(gate - gates.begin()) + (id == kTruncated ? 1 : 0);
}

const std::string& FileOf(const CheckedFile& file) { return file.file.empty() ? file.name : file.file; }

// An atlas has no lines, but GitHub wants some.
Json PhysicalJson(const CheckedFile& file) {
  return {{"artifactLocation", {{"uri", Uri(FileOf(file))}}},
          {"region", {{"startLine", 1}, {"startColumn", 1}, {"endLine", 1}, {"endColumn", 2}}}};
}

// Collects results, the worst first, up to what a code host takes.
class SarifResults {
 public:
  void Add(const CheckedFile& file, const std::string& rule, Severity severity, const std::string& where,
           const std::string& message) {
    if (results_.size() + 1 < kMostResults) return Push(file, rule, severity, where, message);
    if (left_out_++ > 0) return;
    first_left_out_ = &file;
    worst_left_out_ = severity;
  }

  // So many more, behind results that were left out.
  void LeaveOut(std::uint64_t more) { left_out_ += more; }

  Json Take() {
    if (left_out_ > 0)
      Push(*first_left_out_, std::string(kTruncated), worst_left_out_, "atlas",
           detail::Concat(std::to_string(left_out_), " more results are not listed: a code host takes so many."));
    return std::move(results_);
  }

 private:
  // A finding is known again by its rule, file and place, whatever others come and go.
  void Push(const CheckedFile& file, const std::string& rule, Severity severity, const std::string& where,
            const std::string& message) {
    const std::string key = detail::Concat(rule, "\n", file.name, "\n", where);
    const std::string hash = detail::Hex(detail::HashBytes(std::as_bytes(std::span(key.data(), key.size()))));
    results_.push_back(
        {{"ruleId", rule},
         {"ruleIndex", RuleIndex(rule)},
         {"level", ToString(severity)},
         {"message", {{"text", message}}},
         {"locations",
          {{{"physicalLocation", PhysicalJson(file)}, {"logicalLocations", {{{"fullyQualifiedName", where}}}}}}},
         {"partialFingerprints",
          {{"primaryLocationLineHash", detail::Concat(hash, ":", std::to_string(++seen_[hash]))}}}});
  }

  Json results_ = Json::array();
  std::unordered_map<std::string, int> seen_;
  std::uint64_t left_out_ = 0;
  const CheckedFile* first_left_out_ = nullptr;
  Severity worst_left_out_ = Severity::kNote;
};

// A result that is yet to find its place.
struct Waiting {
  CheckedFile file;  // its names
  std::string rule, where, message;
};

// Of each severity as many as a report can have; the others are counted.
class SarifReporter : public CheckReporter {
 public:
  SarifReporter(Sink sink, std::string version, bool with_notes)
      : sink_(std::move(sink)), version_(std::move(version)), with_notes_(with_notes) {}

  void Add(const CheckedFile& file) override {
    if (!file.failure.empty()) return AddUnreadable(file);
    for (const RuleResult& result : file.report.results) {
      if (result.severity == Severity::kNote && !with_notes_) continue;
      for (const Finding& finding : result.findings)
        Add(file, result.id, result.severity, QualifiedName(finding.place),
            detail::Concat(ToString(finding.place), ": ", finding.message, "."));
      if (result.count > result.findings.size())
        Add(file, result.id, result.severity, "atlas",
            detail::Concat(std::to_string(result.count - result.findings.size()), " more findings of rule ", result.id,
                           " are not listed."));
    }
  }
  void End() override {
    const Json driver{{"name", "slamdb"}, {"semanticVersion", version_}, {"rules", RulesJson()}};
    Json run;
    run["tool"] = {{"driver", driver}};
    run["invocations"] = Json::array(
        {{{"executionSuccessful", notifications_.empty()}, {"toolExecutionNotifications", notifications_}}});
    run["columnKind"] = "unicodeCodePoints";
    run["results"] = WorstFirst();
    Json sarif;
    sarif["$schema"] = kSchema;
    sarif["version"] = "2.1.0";
    sarif["runs"] = Json::array({run});
    sink_(detail::JsonText(sarif));
  }

 private:
  struct OfSeverity {
    std::vector<Waiting> first;
    std::uint64_t others = 0;
  };

  void Add(const CheckedFile& file, const std::string& rule, Severity severity, std::string where,
           std::string message) {
    OfSeverity& of = of_[static_cast<std::size_t>(severity)];
    if (of.first.size() == kMostResults)
      ++of.others;
    else
      of.first.push_back({{.name = file.name, .report = {}, .failure = {}, .file = file.file},
                          rule,
                          std::move(where),
                          std::move(message)});
  }
  // Of many they would be a report of their own: as many as there are results.
  void AddUnreadable(const CheckedFile& file) {
    Add(file, std::string(kUnreadable), Severity::kError, "atlas",
        detail::Concat("cannot be read: ", file.failure, "."));
    if (notifications_.size() < kMostResults)
      notifications_.push_back({{"level", "error"},
                                {"message", {{"text", file.failure}}},
                                {"locations", {{{"physicalLocation", PhysicalJson(file)}}}}});
  }
  Json WorstFirst() const {
    SarifResults results;
    for (const Severity severity : {Severity::kError, Severity::kWarning, Severity::kNote}) {
      const OfSeverity& of = of_[static_cast<std::size_t>(severity)];
      for (const Waiting& each : of.first) results.Add(each.file, each.rule, severity, each.where, each.message);
      results.LeaveOut(of.others);
    }
    return results.Take();
  }

  const Sink sink_;
  const std::string version_;
  const bool with_notes_;
  std::array<OfSeverity, 3> of_;
  Json notifications_ = Json::array();
};

}  // namespace

std::unique_ptr<CheckReporter> MakeSarifReporter(CheckReporter::Sink sink, const std::string& version,
                                                 bool with_notes) {
  return std::make_unique<SarifReporter>(std::move(sink), version, with_notes);
}

std::string SarifReport(std::span<const CheckedFile> files, const std::string& version, bool with_notes) {
  std::string text;
  SarifReporter reporter([&](std::string_view piece) { text += piece; }, version, with_notes);
  for (const CheckedFile& file : files) reporter.Add(file);
  reporter.End();
  return text;
}

}  // namespace slamdb
