// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "slamdb/optimize/bundle_adjustment.h"
#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string kAtlas = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";

class Optimize : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!CanOptimize()) GTEST_SKIP() << "needs Ceres";
  }
  std::string In(const std::string& name) const { return folder_ / name; }
  std::string Constraints(const std::string& rows) const {
    std::ofstream(In("loops.csv")) << "first,second,tx,ty,tz,qx,qy,qz,qw\n" << rows;
    return In("loops.csv");
  }

  const TemporaryFolder folder_;
};

TEST_F(Optimize, TellsWhatItDidAndLeavesTheInput) {
  const std::string before = ReadWholeFile(kAtlas);
  const ProcessResult result = RunSlamdb({"optimize", kAtlas, "-o", In("out.osa")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("map 0\n  adjusted      13 keyframes and 3,162 points; 1 keyframe fixed\n"));
  EXPECT_THAT(result.out, HasSubstr("held by       the initial keyframe\n"));
  EXPECT_EQ(ReadWholeFile(kAtlas), before);
  EXPECT_EQ(RunSlamdb({"check", In("out.osa")}).exit_code, 0);
}

TEST_F(Optimize, SaysItInJson) {
  const ProcessResult result = RunSlamdb({"optimize", kAtlas, "--dry-run", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "optimize.schema.json"), "");
  EXPECT_TRUE(report.at("output").is_null());
  const json& bundle = report.at("maps").at(0).at("bundle");
  EXPECT_EQ(bundle.at("held_by"), "keyframe");
  EXPECT_LT(bundle.at("after").at("cost"), bundle.at("before").at("cost"));
  EXPECT_LT(bundle.at("after").at("reprojection_error_px").at("mean"),
            bundle.at("before").at("reprojection_error_px").at("mean"));
}

TEST_F(Optimize, BendsAMapToConstraints) {
  const std::string loops = Constraints("0,13,-0.5,-0.2,1,0,0,0,1\n");
  const ProcessResult result = RunSlamdb({"optimize", kAtlas, In("out.osa"), "--constraints", loops, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "optimize.schema.json"), "");
  EXPECT_EQ(report.at("method"), "pose-graph");
  const json& graph = report.at("maps").at(0).at("pose_graph");
  EXPECT_EQ(graph.at("edges").at("constraints"), 1);
  EXPECT_LT(graph.at("after").at("cost"), graph.at("before").at("cost"));
  EXPECT_TRUE(report.at("maps").at(0).at("bundle").is_null());
  EXPECT_EQ(RunSlamdb({"check", In("out.osa")}).exit_code, 0);
}

TEST_F(Optimize, WritesNothingWhereThereIsNoSeam) {
  const ProcessResult result = RunSlamdb({"optimize", kAtlas, In("a.osa"), "--method", "seam"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("no seam"));
  EXPECT_FALSE(std::filesystem::exists(In("a.osa")));
}

TEST_F(Optimize, RefusesWhatMakesNoSense) {
  EXPECT_EQ(RunSlamdb({"optimize", kAtlas, In("a.osa"), "--fix-poses", "--fix-points"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"optimize", kAtlas, In("a.osa"), "--iterations", "0"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"optimize", kAtlas, In("a.osa"), "--method", "best"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"optimize", kAtlas, In("a.osa"), "--method", "pose-graph"}).exit_code, 2);
  EXPECT_EQ(
      RunSlamdb({"optimize", kAtlas, In("a.osa"), "--constraints", Constraints("0,1,0,0,0,0,0,0,1\n"), "--fix-poses"})
          .exit_code,
      2);
  const ProcessResult unknown =
      RunSlamdb({"optimize", kAtlas, In("a.osa"), "--constraints", Constraints("0,99,0,0,0,0,0,0,1\n")});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("kf 99"));
  const ProcessResult damaged =
      RunSlamdb({"optimize", kAtlas, In("a.osa"), "--constraints", Constraints("0,1,x,0,0,0,0,0,1\n")});
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_THAT(damaged.err, HasSubstr("loops.csv: line 2: expected a number, found 'x'"));
  EXPECT_EQ(RunSlamdb({"optimize", kAtlas, In("a.osa"), "--map", "7"}).exit_code, 1);
  EXPECT_THAT(folder_.Names(), ::testing::Not(::testing::Contains("a.osa")));
}

TEST_F(Optimize, WarnsWhereItHasNotSettled) {
  const ProcessResult result = RunSlamdb({"optimize", kAtlas, In("out.osa"), "--iterations", "1"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("has not settled; --iterations allows more"));
}

TEST_F(Optimize, GivesTheSameBytesForAnyNumberOfThreads) {
  ASSERT_EQ(RunSlamdb({"optimize", kAtlas, In("one.osa"), "--threads", "1"}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"optimize", kAtlas, In("two.osa"), "--threads", "2"}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(In("one.osa")), ReadWholeFile(In("two.osa")));
}

}  // namespace
}  // namespace slamdb::testing
