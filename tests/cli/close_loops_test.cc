// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/close_loops.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "slamdb/formats/formats.h"
#include "tests/align/bent.h"
#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class CloseLoopsVerb : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!CanOptimize()) GTEST_SKIP() << "needs Ceres";
  }
  std::string In(const std::string& name) const { return folder_ / name; }
  std::string Write(const Bend& bend) const {
    WriteAtlas(MakeMissedLoop(Sensor::kRgbd, bend), Location(In("in.osa")));
    return In("in.osa");
  }

  const TemporaryFolder folder_;
};

TEST_F(CloseLoopsVerb, ClosesAndLeavesTheInput) {
  const std::string input = Write({.radians = 0.1, .shift = 0.4});
  const std::string before = ReadWholeFile(input);
  const ProcessResult result = RunSlamdb({"close-loops", input, "-o", In("out.osa")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("  missed: kf "));
  EXPECT_THAT(result.out, HasSubstr("  closed by "));
  EXPECT_THAT(result.out, HasSubstr("  adjusted "));
  EXPECT_EQ(ReadWholeFile(input), before);
  EXPECT_EQ(RunSlamdb({"check", In("out.osa")}).exit_code, 0);
  EXPECT_THAT(RunSlamdb({"close-loops", In("out.osa"), "--dry-run"}).out, HasSubstr("no loop to close\n"));
}

TEST_F(CloseLoopsVerb, SaysItInJson) {
  const std::string input = Write({.radians = 0.1, .shift = 0.4});
  const ProcessResult result = RunSlamdb({"close-loops", input, "--dry-run", "--json", "--optimize", "pose-graph"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "close-loops.schema.json"), "");
  EXPECT_TRUE(report.at("output").is_null());
  EXPECT_GT(report.at("closed"), 0);
  const json& map = report.at("maps").at(0);
  EXPECT_TRUE(map.at("bundle").is_null());
  EXPECT_LT(map.at("pose_graph").at("after").at("cost"), map.at("pose_graph").at("before").at("cost"));
  EXPECT_EQ(map.at("loops").at(0).at("verdict"), "missed");
}

TEST_F(CloseLoopsVerb, WritesTheInputWhereThereIsNothingToClose) {
  const std::string input = Write({});
  const ProcessResult result = RunSlamdb({"close-loops", input, In("out.osa"), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "close-loops.schema.json"), "");
  EXPECT_EQ(report.at("closed"), 0);
  EXPECT_EQ(report.at("maps").at(0).at("loops").at(0).at("verdict"), "closed");
  EXPECT_EQ(ReadWholeFile(In("out.osa")), ReadWholeFile(input));
}

TEST_F(CloseLoopsVerb, RefusesWhatMakesNoSense) {
  const std::string input = Write({});
  EXPECT_EQ(RunSlamdb({"close-loops", input, In("a.osa"), "--optimize", "best"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"close-loops", input}).exit_code, 2);
  const ProcessResult result = RunSlamdb({"close-loops", input, In("a.osa"), "--map", "7"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("there is no map 7"));
}

}  // namespace
}  // namespace slamdb::testing
