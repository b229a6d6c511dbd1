// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "slamdb/formats/formats.h"
#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";

class Check : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    RunSlamdb({"synthesize", Sound(), "--keyframes", "8", "--points", "200", "--features", "200"});
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::string Sound() { return *folder_ / "sound.osa"; }
  static std::string In(const std::string& name) { return *folder_ / name; }

  static std::unique_ptr<TemporaryFolder> folder_;
};
std::unique_ptr<TemporaryFolder> Check::folder_;

TEST_F(Check, SoundAtlasExitsZero) {
  const ProcessResult result = RunSlamdb({"check", Sound()});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
}

TEST_F(Check, GateThatIsMissedExitsOne) {
  EXPECT_EQ(RunSlamdb({"check", Sound(), "--min-keyframes", "8", "--max-maps", "1"}).exit_code, 0);
  const ProcessResult missed = RunSlamdb({"check", Sound(), "--min-keyframes", "9"});
  EXPECT_EQ(missed.exit_code, 1);
  EXPECT_THAT(missed.out, HasSubstr("min-keyframes"));
  EXPECT_EQ(RunSlamdb({"check", Sound(), "--max-reprojection-px", "0.0001"}).exit_code, 1);
}

TEST_F(Check, FormatsForPrograms) {
  const json report = json::parse(RunSlamdb({"check", Sound(), "--json"}).out);
  EXPECT_EQ(BreachOf(report, "check.schema.json"), "");
  EXPECT_EQ(RunSlamdb({"check", Sound(), "--format", "json"}).out, RunSlamdb({"check", Sound(), "--json"}).out);
  EXPECT_EQ(BreachOf(json::parse(RunSlamdb({"check", Sound(), "--format", "sarif"}).out), "sarif.schema.json"), "");
  EXPECT_THAT(RunSlamdb({"check", Sound(), "--format", "junit"}).out, HasSubstr("<testsuite"));
}

TEST_F(Check, ReportGoesToAFile) {
  const std::string path = In("report.json");
  const ProcessResult result = RunSlamdb({"check", Sound(), "--json", "-o", path});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(json::accept(ReadWholeFile(path)));
  EXPECT_EQ(RunSlamdb({"check", Sound(), "--json", "-o", path}).exit_code, 1);
}

TEST_F(Check, ListsItsRules) {
  const ProcessResult text = RunSlamdb({"check", "--list"});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_THAT(text.out, HasSubstr("observation-target"));
  EXPECT_EQ(BreachOf(json::parse(RunSlamdb({"check", "--list", "--json"}).out), "rules.schema.json"), "");
}

TEST_F(Check, PrintsTheTableOfItsPage) {
  const ProcessResult table = RunSlamdb({"check", "--list", "--format", "markdown"});
  EXPECT_EQ(table.exit_code, 0);
  EXPECT_THAT(ReadWholeFile(SLAMDB_SCHEMAS "/../docs/checks.md"),
              HasSubstr("<!-- catalogue: begin -->\n" + table.out + "<!-- catalogue: end -->\n"));
  // The example at the top of the page, with the number of rules in it.
  const std::string file = "/mono_small_twice/mono_small_twice.osa";
  const std::string report = RunSlamdb({"check", SLAMDB_FIXTURES + file}).out;
  const std::string first_line = report.substr(report.find(file), report.find('\n') - report.find(file) + 1);
  EXPECT_THAT(ReadWholeFile(SLAMDB_SCHEMAS "/../docs/checks.md"), HasSubstr("\nfixtures" + first_line));
  EXPECT_EQ(RunSlamdb({"check", Sound(), "--format", "markdown"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"check", "--list", "--format", "sarif"}).exit_code, 2);
}

TEST_F(Check, SeveritiesAreTheUsers) {
  const ProcessResult strict = RunSlamdb({"check", Sound(), "--ignore", "observation-target", "--warn", "point-bad",
                                          "--error", "slot-target", "--note", "map-not-empty", Sound()});
  EXPECT_EQ(strict.exit_code, 0) << strict.out;
}

TEST_F(Check, UnknownRuleIsAUsageError) {
  const ProcessResult result = RunSlamdb({"check", Sound(), "--ignore", "observation-tarjet"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("did you mean 'observation-target'?"));
}

TEST_F(Check, NeedsAFile) {
  const ProcessResult result = RunSlamdb({"check"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("FILE is missing"));
}

TEST_F(Check, SeveralFilesOneFailure) {
  const ProcessResult result = RunSlamdb({"check", Sound(), In("missing.osa"), Sound()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.out, HasSubstr("missing.osa: cannot open"));
  EXPECT_THAT(result.out, HasSubstr("sound.osa"));
}

TEST_F(Check, SaysTheVerdictFirstAndNamesWhatFails) {
  const std::string twice = SLAMDB_FIXTURES "/mono_small_twice/mono_small_twice.osa";
  const ProcessResult one = RunSlamdb({"check", twice});
  EXPECT_EQ(one.exit_code, 1);
  EXPECT_THAT(one.out, StartsWith(twice + ": 1 error, 876 notes: not sound ("));
  EXPECT_THAT(one.out,
              HasSubstr("\n  error map-listed-once\n      map 0: entry 1 of the map list is this map again\n"));
  EXPECT_THAT(one.out, Not(HasSubstr("note ")));
  EXPECT_THAT(RunSlamdb({"check", twice, "-v"}).out, HasSubstr("\n  note observation-slot (100)\n      map 0, mp "));
  const ProcessResult three = RunSlamdb({"check", Sound(), twice, In("missing.osa")});
  EXPECT_THAT(three.out, HasSubstr("\n3 atlases: 1 sound, 1 not sound, 1 not readable\n  " + twice +
                                   ": 1 error, 876 notes: not sound\n  " + In("missing.osa") + ": not readable\n"));
  EXPECT_EQ(RunSlamdb({"check", Sound(), "--quiet"}).out, "");
  EXPECT_THAT(RunSlamdb({"check", Sound(), twice, "--quiet"}).out, StartsWith(twice));
}

// A file that is none is a result in every format, and the others are checked all the same.
TEST_F(Check, AnUnreadableFileIsAResult) {
  WriteWholeFile(In("none.osa"), "no atlas");
  WriteWholeFile(In("empty.osa"), "");
  const auto report = [&](const char* format) {
    const ProcessResult result =
        RunSlamdb({"check", In("none.osa"), In("empty.osa"), In("missing.osa"), Sound(), "--format", format});
    EXPECT_EQ(result.exit_code, 1);
    return result.out;
  };
  const json sarif = json::parse(report("sarif"));
  EXPECT_EQ(BreachOf(sarif, "sarif.schema.json"), "");
  ASSERT_EQ(sarif["runs"][0]["results"].size(), 3U);
  for (const json& result : sarif["runs"][0]["results"]) EXPECT_EQ(result["ruleId"], "unreadable");
  const json inputs = json::parse(report("json"))["inputs"];
  ASSERT_EQ(inputs.size(), 4U);
  EXPECT_TRUE(inputs[0].contains("failure"));
  EXPECT_EQ(inputs[3]["sound"], true);
  const std::string junit = report("junit");
  EXPECT_THAT(junit, HasSubstr("tests=\"" + std::to_string(inputs[3]["checked"].size() + 3) +
                               "\" failures=\"0\" errors=\"3\""));
}

TEST_F(Check, SarifHasPathsThatACodeHostKnows) {
  const std::string store = In("maps of.db");
  ASSERT_EQ(RunSlamdb({"convert", SLAMDB_FIXTURES "/mono_small_twice/mono_small_twice.osa", store + "#hall"}).exit_code,
            0);
  const std::string before = std::filesystem::current_path();
  std::filesystem::current_path(std::filesystem::path(store).parent_path());
  std::filesystem::create_symlink("maps of.db", In("link.db"));
  std::string uris;
  for (const std::string& input : {store + "#hall", std::string("./maps of.db#hall"), std::string("link.db")}) {
    const json sarif = json::parse(RunSlamdb({"check", input, "--format", "sarif", "-v"}).out);
    EXPECT_EQ(BreachOf(sarif, "sarif.schema.json"), "");
    uris += sarif["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
                .get<std::string>() +
            "\n";
  }
  std::filesystem::current_path(before);
  EXPECT_EQ(uris, "maps%20of.db\nmaps%20of.db\nmaps%20of.db\n");
}

TEST_F(Check, AnAtlasOfAnotherVocabularyIsRefused) {
  const std::string given = SLAMDB_FIXTURES "/vocabulary/small.txt";
  const ProcessResult result =
      RunSlamdb({"check", SLAMDB_FIXTURES "/session_small_a/session_small_a.osa", "--vocabulary", given});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.out + result.err, HasSubstr("its words are of another vocabulary, 'labvoc.txt'"));
  EXPECT_THAT(result.out + result.err, Not(HasSubstr("word-range")));
  ASSERT_EQ(RunSlamdb({"synthesize", In("same.osa"), "--vocabulary", given}).exit_code, 0);
  Atlas atlas = ReadAtlas(In("same.osa"));
  atlas.vocabulary.checksum = std::string(32, '0');  // the same words, of a file with other line ends
  WriteAtlas(atlas, In("resaved.osa"));
  EXPECT_EQ(RunSlamdb({"check", In("resaved.osa"), "--vocabulary", given}).exit_code, 0);
}

TEST_F(Check, SaysWhatIsGivenForAVocabulary) {
  WriteWholeFile(In("pointer.txt"), "version https://git-lfs.github.com/spec/v1\noid sha256:" + std::string(64, 'a') +
                                        "\nsize 145250924\n");
  WriteWholeFile(In("page.txt"), "<!DOCTYPE html>\n<html><body>404</body></html>\n");
  for (const auto& [file, says] : {std::pair(In("pointer.txt"), "Git LFS"), std::pair(In("page.txt"), "page"),
                                   std::pair(Sound(), "this is an atlas of ORB-SLAM3")}) {
    const ProcessResult result = RunSlamdb({"check", Sound(), "--vocabulary", file});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr(says));
  }
}

TEST_F(Check, VocabularyThatIsNoneIsRefused) {
  WriteWholeFile(In("voc.bin"), "no vocabulary");
  const ProcessResult result = RunSlamdb({"check", Sound(), "--vocabulary", In("voc.bin")});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("voc.bin"));
}

}  // namespace
}  // namespace slamdb::testing
