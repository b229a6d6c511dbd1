// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/checks/report.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "slamdb/base/detail/visible.h"
#include "tests/support/corrupt.h"

namespace slamdb {
namespace {

using nlohmann::json;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::uint64_t kHugeId = ~std::uint64_t{0} - 5;

// A file with an error that has more findings than are kept, a warning, a note and a failed gate; one that is sound;
// and one that could not be read. Their names need escaping.
std::vector<CheckedFile> Files() {
  Atlas broken = SoundAtlas(Base::kMonocular);
  for (std::size_t row = 0; row < 4; ++row)
    broken.maps[0].points[row].observations.push_back({KeyFrameId(kHugeId + row), 0, -1});
  broken.maps[0].points[9].id = MapPointId(kHugeId);
  broken.cameras[0].recorded_type = 3;
  broken.maps[0].keyframes[0].merge_scale = 1e30F;
  std::vector<CheckedFile> files;
  files.push_back({"maps/a <\"&\x01'> \xC3\xA9.osa",
                   CheckAtlas(broken, {.max_findings = 2, .gates = {{"min-keyframes", 99}}}), ""});
  files.push_back({"sound.osa", CheckAtlas(SoundAtlas(Base::kRgbd), {}), ""});
  files.push_back({"bad\xFF.osa", {}, "bad.osa: byte 12: not an atlas <& \">"});
  return files;
}

TEST(Verdict, IsSaidFirst) {
  const std::vector<CheckedFile> files = Files();
  EXPECT_EQ(Verdict(files[0]), "6 errors, 3 warnings, 3 notes: not sound");
  EXPECT_EQ(Verdict(files[1]), "sound");
  EXPECT_EQ(Verdict(files[2]), "not readable");
  CheckedFile noted{.name = "noted.osa", .report = files[0].report};
  std::erase_if(noted.report.results, [](const RuleResult& result) { return result.severity == Severity::kError; });
  EXPECT_EQ(Verdict(noted), "sound, 3 warnings, 3 notes");
  const std::string text = TextReport(files);
  EXPECT_EQ(text.substr(0, text.find('\n')), detail::Visible(files[0].name) +
                                                 ": 6 errors, 3 warnings, 3 notes: not sound (" +
                                                 std::to_string(ReadRules().size() + 1) + " rules checked)");
}

TEST(TextReport, GroupsByRuleErrorsFirst) {
  const std::string text = TextReport(Files(), {.shown_per_rule = 1, .show_notes = true});
  EXPECT_THAT(text, HasSubstr("\n  error observation-target (4)\n      map 0, mp "));
  EXPECT_THAT(text, HasSubstr("observed by kf 18446744073709551610, which does not exist\n      ... and 3 more\n"
                              "    ORB-SLAM3 skips the observation"));
  EXPECT_THAT(text, HasSubstr("error gate-min-keyframes\n"));
  EXPECT_THAT(text, HasSubstr("atlas: has 12 keyframes, fewer than 99"));
  EXPECT_THAT(text, HasSubstr("sound.osa: sound ("));
  EXPECT_THAT(text, Not(HasSubstr(FindRule("observation-target")->title))) << "what should hold is not what is broken";
  EXPECT_LT(text.find("gate-min-keyframes"), text.find("warning camera-type"));
  EXPECT_LT(text.find("warning camera-type"), text.find("note uninitialised"));
}

TEST(TextReport, NamesTheFilesThatFailAtTheEnd) {
  const std::string text = TextReport(Files());
  EXPECT_THAT(text, EndsWith("\n3 atlases: 1 sound, 1 not sound, 1 not readable\n  " +
                             detail::Visible(Files()[0].name) + ": 6 errors, 3 warnings, 3 notes: not sound\n  " +
                             detail::Visible(Files()[2].name) + ": not readable\n"));
}

TEST(TextReport, ShowsNotesOnRequestOnly) {
  EXPECT_THAT(TextReport(Files()), Not(HasSubstr("note uninitialised")));
  EXPECT_THAT(TextReport(Files(), {.show_notes = true}), HasSubstr("note uninitialised\n      map 0: "));
}

TEST(TextReport, LeavesOutSoundFilesOnRequest) {
  const std::vector<CheckedFile> files = Files();
  EXPECT_THAT(TextReport(files, {.only_broken = true}), Not(HasSubstr("sound.osa: sound")));
  EXPECT_EQ(TextReport(std::span(files).subspan(1, 1), {.only_broken = true}), "");
}

TEST(CheckReportAsJson, HoldsEverything) {
  const json report = json::parse(ToJson(Files()));
  EXPECT_EQ(report["report"], "slamdb-check-2");
  ASSERT_EQ(report["inputs"].size(), 3u);
  const json& broken = report["inputs"][0];
  EXPECT_EQ(broken["input"], Files()[0].name);
  EXPECT_EQ(broken["sound"], false);
  EXPECT_EQ(broken["severities"]["error"], Files()[0].report.Count(Severity::kError));
  EXPECT_EQ(broken["severities"]["note"], Files()[0].report.Count(Severity::kNote));
  EXPECT_EQ(broken["measures"]["keyframes"], 12);
  bool found = false;
  for (const json& result : broken["results"]) {
    if (result["rule"] != "observation-target") continue;
    found = true;
    EXPECT_EQ(result["severity"], "error");
    EXPECT_EQ(result["count"], 4);
    ASSERT_EQ(result["findings"].size(), 2u);
    EXPECT_EQ(result["findings"][0]["place"]["map"], 0);
    EXPECT_EQ(result["fix"], "EraseDanglingObservations");
  }
  EXPECT_TRUE(found);
  EXPECT_EQ(report["inputs"][1]["sound"], true);
  EXPECT_TRUE(report["inputs"][2].contains("failure"));
}

TEST(CheckReportAsJson, KeepsLargeIdsExact) {
  EXPECT_THAT(ToJson(Files()), HasSubstr("\"point\": \"18446744073709551610\""));
}

// Everything that the schema requires or allows is looked at by hand: a validator is not worth a dependency.
TEST(CheckReportAsJson, HasASchemaThatNamesItsKeys) {
  std::ifstream file(std::string(SLAMDB_FIXTURES) + "/../schema/check.schema.json");
  ASSERT_TRUE(file.is_open());
  const json schema = json::parse(file);
  const json report = json::parse(ToJson(Files()));
  const auto check = [](const json& object, const json& described) {
    for (const auto& [key, value] : object.items()) EXPECT_TRUE(described["properties"].contains(key)) << key;
    for (const json& key : described.value("required", json::array())) EXPECT_TRUE(object.contains(key)) << key;
  };
  check(report, schema);
  const json& definitions = schema["$defs"];
  for (const json& checked : report["inputs"]) {
    check(checked, definitions[checked.contains("failure") ? "failed" : "checked"]);
    if (checked.contains("failure")) continue;
    check(checked["measures"], definitions["measures"]);
    for (const json& result : checked["results"]) {
      check(result, definitions["result"]);
      for (const json& finding : result["findings"]) {
        check(finding, definitions["finding"]);
        check(finding["place"], definitions["place"]);
      }
    }
  }
}

TEST(JUnitReport, EscapesAndCounts) {
  const std::string xml = JUnitReport(Files());
  EXPECT_THAT(xml, HasSubstr("<testsuite name=\"maps/a &lt;&quot;&amp;?'&gt; \xC3\xA9.osa\""));
  EXPECT_THAT(xml, HasSubstr("<failure type=\"error\" message=\"4 errors: map 0, mp "));
  EXPECT_THAT(xml, HasSubstr("which does not exist; and 3 more\">"));
  EXPECT_THAT(
      xml, HasSubstr("<error type=\"unreadable\" message=\"bad.osa: byte 12: not an atlas &lt;&amp; &quot;&gt;\"/>"));
  EXPECT_THAT(xml, HasSubstr("name=\"gate-min-keyframes\">\n      <failure"));
  EXPECT_THAT(xml, HasSubstr("name=\"camera-type\">\n      <system-out>"));
  EXPECT_THAT(xml, Not(HasSubstr("\x01")));
  const auto count = [&](std::string_view piece) {
    std::size_t found = 0;
    for (std::size_t at = xml.find(piece); at != std::string::npos; at = xml.find(piece, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<testcase"), 2 * ReadRules().size() + 2);
  EXPECT_EQ(count("<testsuite "), count("</testsuite>"));
  EXPECT_EQ(count("\xFF"), 0u);
  EXPECT_EQ(count("is uninitialised memory in"), 0u);
  EXPECT_THAT(JUnitReport(Files(), true), HasSubstr("is uninitialised memory in"));
}

TEST(SarifReport, IsSarif) {
  const json sarif = json::parse(SarifReport(Files(), "1.2.3"));
  EXPECT_EQ(sarif["version"], "2.1.0");
  ASSERT_EQ(sarif["runs"].size(), 1u);
  const json& run = sarif["runs"][0];
  const json& rules = run["tool"]["driver"]["rules"];
  EXPECT_EQ(run["tool"]["driver"]["semanticVersion"], "1.2.3");
  EXPECT_EQ(rules.size(), ReadRules().size() + ReadGates().size() + 2);
  ASSERT_FALSE(run["results"].empty());
  std::set<std::string> fingerprints;
  for (const json& result : run["results"]) {
    EXPECT_EQ(rules[result["ruleIndex"].get<std::size_t>()]["id"], result["ruleId"]);
    EXPECT_NE(result["level"], "note");
    EXPECT_TRUE(fingerprints.insert(result["partialFingerprints"]["primaryLocationLineHash"]).second);
    ASSERT_EQ(result["locations"].size(), 1u);
    const json& location = result["locations"][0];
    if (result["ruleId"] != "unreadable") {
      EXPECT_EQ(location["physicalLocation"]["artifactLocation"]["uri"], "maps/a%20%3C%22%26%01%27%3E%20%C3%A9.osa");
    }
    EXPECT_TRUE(location["logicalLocations"][0]["fullyQualifiedName"].is_string());
  }
  const auto unreadable =
      std::ranges::find(run["results"], json("unreadable"), [](const json& result) { return result["ruleId"]; });
  ASSERT_NE(unreadable, run["results"].end());
  EXPECT_EQ((*unreadable)["level"], "error");
  EXPECT_EQ(run["invocations"][0]["executionSuccessful"], false);
  EXPECT_EQ(run["invocations"][0]["toolExecutionNotifications"].size(), 1u);
}

// What GitHub asks of the texts of rules: none empty, none too long, few tags.
TEST(SarifReport, HasTheTextsThatGitHubWants) {
  const json rules = json::parse(SarifReport({}, "1"))["runs"][0]["tool"]["driver"]["rules"];
  for (const json& rule : rules) {
    for (const char* text : {"shortDescription", "fullDescription", "help"}) {
      const std::string value = rule[text]["text"];
      EXPECT_TRUE(!value.empty() && value.size() <= 1024) << rule["id"] << " " << text;
    }
    EXPECT_FALSE(rule["help"]["markdown"].get<std::string>().empty());
    EXPECT_LE(rule["name"].get<std::string>().size(), 255u);
    EXPECT_LE(rule["properties"]["tags"].size(), 10u);
    EXPECT_THAT((std::set<std::string>{"note", "warning", "error"}),
                ::testing::Contains(rule["defaultConfiguration"]["level"].get<std::string>()));
  }
}

TEST(SarifReport, HasNotesOnRequest) {
  EXPECT_THAT(SarifReport(Files(), "1"), Not(HasSubstr("is uninitialised memory in")));
  EXPECT_THAT(SarifReport(Files(), "1", true), HasSubstr("is uninitialised memory in"));
}

TEST(SarifReport, NamesTheFileOfAStore) {
  std::vector<CheckedFile> files = Files();
  files[0].file = "maps.db";
  EXPECT_THAT(SarifReport(files, "1"), HasSubstr("\"uri\": \"maps.db\""));
}

// More than GitHub shows: errors stay, warnings go first, and the last result says how many.
TEST(SarifReport, StaysBelowTheLimitsOfGitHub) {
  std::vector<CheckedFile> files(3);
  for (std::size_t i = 0; i < files.size(); ++i) {
    files[i].name = std::to_string(i) + ".osa";
    for (const Severity severity : {Severity::kWarning, Severity::kError}) {
      RuleResult& result = files[i].report.results.emplace_back();
      result.id = "observation-target";
      result.severity = severity;
      result.count = 1000;
      for (std::uint64_t id = 0; id < 1000; ++id) result.findings.push_back({{.point = MapPointId(id)}, "is broken"});
    }
  }
  const json results = json::parse(SarifReport(files, "1"))["runs"][0]["results"];
  ASSERT_EQ(results.size(), 5000u);
  EXPECT_EQ(std::ranges::count(results, json("error"), [](const json& result) { return result["level"]; }), 3000);
  EXPECT_EQ(results.back()["ruleId"], "truncated");
  EXPECT_EQ(results.back()["level"], "warning");
  EXPECT_THAT(results.back()["message"]["text"].get<std::string>(), HasSubstr("1001 more results are not listed"));
}

TEST(SarifReport, NamesEntities) {
  EXPECT_THAT(SarifReport(Files(), "1"), HasSubstr("\"fullyQualifiedName\": \"map/0/mp/"));
}

TEST(Catalogue, IsListedInFull) {
  const std::string text = TextCatalogue();
  const json list = json::parse(JsonCatalogue());
  for (const Rule& rule : ReadRules()) EXPECT_THAT(text, HasSubstr(std::string(rule.id)));
  EXPECT_EQ(list["rules"].size(), ReadRules().size());
  EXPECT_EQ(list["gates"].size(), ReadGates().size());
}

// When this fails, replace what stands between the marks by what `slamdb check --list --format markdown` prints.
TEST(Catalogue, IsWhatTheDocumentationSays) {
  std::ifstream file(std::string(SLAMDB_FIXTURES) + "/../docs/checks.md");
  ASSERT_TRUE(file.is_open());
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_THAT(text.str(), HasSubstr("<!-- catalogue: begin -->\n" + MarkdownCatalogue() + "<!-- catalogue: end -->\n"));
}

}  // namespace
}  // namespace slamdb
