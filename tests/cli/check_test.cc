// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

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
  EXPECT_EQ(json::parse(RunSlamdb({"check", Sound(), "--format", "sarif"}).out).at("version"), "2.1.0");
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
  EXPECT_THAT(result.err, HasSubstr("FILE is required"));
}

TEST_F(Check, SeveralFilesOneFailure) {
  const ProcessResult result = RunSlamdb({"check", Sound(), In("missing.osa"), Sound()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("missing.osa"));
  EXPECT_THAT(result.out, HasSubstr("sound.osa"));
}

TEST_F(Check, VocabularyThatIsNoneIsRefused) {
  WriteWholeFile(In("voc.bin"), "no vocabulary");
  const ProcessResult result = RunSlamdb({"check", Sound(), "--vocabulary", In("voc.bin")});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("voc.bin"));
}

}  // namespace
}  // namespace slamdb::testing
