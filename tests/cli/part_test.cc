// SPDX-License-Identifier: BSD-3-Clause
// The verbs that keep a part of an atlas, at the process boundary: extract, split, cull, shrink, fragments.
#include <gmock/gmock.h>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

using Words = std::vector<std::string>;

Words With(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

class PartVerbs : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(RunSlamdb({"synthesize", input_, "--maps", "2", "--keyframes", "10", "--points", "200", "--features",
                         "150", "--sensor", "rgbd"})
                  .exit_code,
              0);
  }

  // Runs it, checks what it wrote, and gives its report.
  json Run(const Words& words, const std::string& schema) {
    const std::string before = ReadWholeFile(input_);
    const ProcessResult result = RunSlamdb(With(words, {"--json"}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const bool warned = result.err.starts_with("slamdb: warning: only ");  // of what is covered still
    EXPECT_TRUE(warned || result.err.empty()) << result.err;
    const json report = json::parse(result.out);
    EXPECT_EQ(BreachOf(report, schema), "");
    EXPECT_EQ(ReadWholeFile(input_), before);
    return report;
  }

  void ExpectRefused(const Words& words, const std::string& text, int exit_code = 1) {
    const ProcessResult result = RunSlamdb(words);
    EXPECT_EQ(result.exit_code, exit_code) << result.out;
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_FALSE(std::filesystem::exists(output_));
  }

  void ExpectSound(const std::string& path) {
    const ProcessResult result = RunSlamdb({"check", "-q", "--strict", path});
    EXPECT_EQ(result.exit_code, 0) << result.out;
  }

  const TemporaryFolder folder_;
  const std::string input_ = folder_ / "in.osa", output_ = folder_ / "out.osa";
};

TEST_F(PartVerbs, ExtractWritesAPart) {
  const json report = Run({"extract", input_, output_, "--map", "1", "--every", "2"}, "extract.schema.json");
  EXPECT_EQ(report["before"]["keyframes"], 20);
  EXPECT_EQ(report["after"]["maps"], 1);
  EXPECT_EQ(report["after"]["keyframes"], 5);
  EXPECT_EQ(report["coverage"]["places"], 20);
  ExpectSound(output_);
}

TEST_F(PartVerbs, ExtractRefusesWhatIsNotThere) {
  ExpectRefused({"extract", input_, output_}, "say which part", 2);
  ExpectRefused({"extract", input_, output_, "--map", "7"}, "there is no map 7; there are 0, 1");
  ExpectRefused({"extract", input_, output_, "--keyframe", "3,999"}, "there is no keyframe 999");
  ExpectRefused({"extract", input_, output_, "--time", "0:1"},
                "has no keyframe from 0 s to 1 s; its keyframes are from ");
  ExpectRefused({"extract", input_, output_, "--polygon", "0,0 1,1"}, "three corners or more, found 2");
  ExpectRefused({"extract", input_, output_, "--polygon", "0,0 1"}, "expected corners", 2);
  ExpectRefused({"extract", input_, output_, "--map", "0", "--except", "--border", "complete-points"}, "bring back", 2);
  ExpectRefused({"extract", input_, input_, "--map", "0"}, "is the input");
}

TEST_F(PartVerbs, SplitWritesEveryMap) {
  const json report = Run({"split", input_, output_}, "split.schema.json");
  ASSERT_EQ(report["parts"].size(), 2U);
  for (const json& part : report["parts"]) ExpectSound(part["output"]);
  EXPECT_EQ(report["parts"][1]["output"], folder_ / "out-map-1.osa");
  ExpectRefused({"split", input_, output_}, "is there already");
  const json stored = Run({"split", input_, (folder_ / "lab.db") + "#all", "--by", "component"}, "split.schema.json");
  EXPECT_EQ(stored["parts"][0]["output"], (folder_ / "lab.db") + "#all-map-0-component-1");
  const json planned = Run({"split", input_, "--dry-run", "--by", "session"}, "split.schema.json");
  EXPECT_TRUE(planned["parts"][0]["output"].is_null());
  ExpectRefused({"split", input_, output_, "--min-keyframes", "11"}, "has no map with 11 keyframes");
  ExpectRefused({"split", input_, "-", "--to", "orbslam3"}, "standard output", 2);
}

// A program that is killed while it makes a store leaves a database without tables.
TEST_F(PartVerbs, SplitMakesAStoreOfAnEmptyDatabase) {
  const std::string store = folder_ / "made.db";
  if (RunProgram({"sqlite3", store, "VACUUM"}).exit_code == 127) GTEST_SKIP() << "no sqlite3";
  const json report = Run({"split", input_, store + "#all"}, "split.schema.json");
  EXPECT_EQ(report["parts"].size(), 2U);
}

TEST_F(PartVerbs, CullSaysWhatWent) {
  const json report = Run({"cull", input_, output_, "--redundant", "0.5", "--observers", "1"}, "cull.schema.json");
  EXPECT_GT(report["culled"]["redundant_keyframes"], 0);
  EXPECT_EQ(report["before"]["keyframes"].get<int>() - report["after"]["keyframes"].get<int>(),
            report["culled"]["redundant_keyframes"]);
  ExpectSound(output_);
  std::filesystem::remove(output_);
  Run({"cull", input_, "--dry-run"}, "cull.schema.json");
  ExpectRefused({"cull", input_, output_, "--redundant", "2"}, "between 0 and 1");
  ExpectRefused({"cull", input_}, "the output is missing", 2);
}

TEST_F(PartVerbs, ShrinkKeepsToItsTarget) {
  const json report = Run({"shrink", input_, output_, "--target-mb", "0.5"}, "shrink.schema.json");
  EXPECT_LE(std::filesystem::file_size(output_), 501'000U);
  EXPECT_NEAR(report["bytes"]["after"].get<double>(), static_cast<double>(std::filesystem::file_size(output_)), 1000);
  EXPECT_EQ(report["found"]["places"], report["before"]["keyframes"]);
  EXPECT_LE(report["found"]["after"], report["found"]["places"]);
  ExpectSound(output_);
  std::filesystem::remove(output_);
  const json extendable =
      Run({"shrink", input_, output_, "--target-mb", "0.5", "--for", "mapping"}, "shrink.schema.json");
  EXPECT_EQ(extendable["dropped"]["features"], 0);
  EXPECT_LT(extendable["after"]["keyframes"], report["after"]["keyframes"]);
  std::filesystem::remove(output_);
  EXPECT_TRUE(Run({"shrink", input_, output_, "--for", "localization"}, "shrink.schema.json")["found"].is_null());
  std::filesystem::remove(output_);
  const json small =
      Run({"shrink", input_, output_, "--for", "localization", "--target-keyframes", "4"}, "shrink.schema.json");
  EXPECT_EQ(small["after"]["keyframes"], 4);
  EXPECT_GT(small["dropped"]["features"], 0);
  ExpectSound(output_);
  std::filesystem::remove(output_);
  ExpectRefused({"shrink", input_, output_}, "say how small", 2);
  ExpectRefused({"shrink", input_, output_, "--target-mb", "0.01"}, "below what one keyframe");
}

TEST_F(PartVerbs, FragmentsDropsAndOrders) {
  const json report = Run({"fragments", input_, output_, "--largest", "1"}, "fragments.schema.json");
  EXPECT_EQ(report["order"], json::array({0}));
  EXPECT_FALSE(report["maps"][1]["kept"]);
  ExpectSound(output_);
  std::filesystem::remove(output_);
  ExpectRefused({"fragments", input_, output_, "--min-keyframes", "11"}, "the largest has 10");
}

TEST_F(PartVerbs, TextNamesTheOutput) {
  const ProcessResult result = RunSlamdb({"fragments", input_, output_});
  EXPECT_THAT(result.out, HasSubstr("kept 2 of 2 maps, 20 of 20 keyframes"));
  EXPECT_THAT(result.out, HasSubstr("wrote " + output_));
}

}  // namespace
}  // namespace slamdb::testing
