// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Transform : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    RunSlamdb({"synthesize", In("a.osa"), "--keyframes", "8", "--points", "150", "--features", "150"});
    RunSlamdb({"convert", In("a.osa"), In("a.txt"), "--to", "tum"});
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string In(const std::string& name) { return *folder_ / name; }

  // Runs on a.osa; with failures no output may be left.
  static ProcessResult Run(std::vector<std::string> arguments, const std::string& output) {
    arguments.insert(arguments.begin(), {"transform", In("a.osa"), In(output)});
    const ProcessResult result = RunSlamdb(arguments);
    if (result.exit_code != 0) {
      EXPECT_FALSE(std::filesystem::exists(In(output))) << output;
    }
    return result;
  }

  static std::unique_ptr<TemporaryFolder> folder_;
};
std::unique_ptr<TemporaryFolder> Transform::folder_;

TEST_F(Transform, ThereAndBackDiffersOnlyByFloatNoise) {
  EXPECT_EQ(Run({"--by", "1 2 3 0 0 0.7071068 0.7071068 2"}, "there.osa").exit_code, 0);
  // The inverse: half the size, a quarter turn back.
  const ProcessResult back =
      RunSlamdb({"transform", In("there.osa"), In("back.osa"), "--by", "-1 0.5 -1.5 0 0 -0.7071068 0.7071068 0.5"});
  EXPECT_EQ(back.exit_code, 0) << back.err;
  EXPECT_EQ(RunSlamdb({"diff", In("a.osa"), In("there.osa"), "--tolerance", "1e-4"}).exit_code, 1);
  const ProcessResult diff = RunSlamdb({"diff", In("a.osa"), In("back.osa"), "--tolerance", "1e-4"});
  EXPECT_EQ(diff.exit_code, 0) << diff.out;
  EXPECT_EQ(RunSlamdb({"check", In("there.osa"), "--strict"}).exit_code, 0);
}

TEST_F(Transform, IdentityWritesTheSameBytes) {
  EXPECT_EQ(Run({"--scale", "1"}, "same.osa").exit_code, 0);
  EXPECT_EQ(ReadWholeFile(In("same.osa")), ReadWholeFile(In("a.osa")));
}

TEST_F(Transform, OntoATrajectoryUndoesAMove) {
  EXPECT_EQ(Run({"--by", "5 -6 7 0.1 0.2 0.3 0.9 3"}, "away.osa").exit_code, 0);
  const ProcessResult onto =
      RunSlamdb({"transform", In("away.osa"), In("onto.osa"), "--onto", In("a.txt"), "--robust", "0.1", "--json"});
  ASSERT_EQ(onto.exit_code, 0) << onto.err;
  const json report = json::parse(onto.out);
  EXPECT_EQ(BreachOf(report, "transform.schema.json"), "");
  EXPECT_EQ(report["maps"][0]["alignment"]["pairs"], 8);
  EXPECT_NEAR(report["maps"][0]["target_from_source"]["scale"], 1.0 / 3, 1e-4);
  EXPECT_LT(report["maps"][0]["alignment"]["residuals"]["max"], 1e-4);
  const ProcessResult diff = RunSlamdb({"diff", In("a.osa"), In("onto.osa"), "--tolerance", "1e-3"});
  EXPECT_EQ(diff.exit_code, 0) << diff.out;
}

TEST_F(Transform, GeoreferenceKeepsItsOriginBesideTheOutput) {
  std::string csv = "timestamp,latitude,longitude,altitude\n";
  // A bent path of fixes, one for each quarter second.
  for (int i = 0; i < 8; ++i) {
    char line[120];
    std::snprintf(line, sizeof line, "%.2f,%.8f,%.8f,%d\n", 1.7e9 + 0.25 * i, 47 + 1e-5 * i * i, 8 + 1e-5 * i, 400);
    csv += line;
  }
  WriteWholeFile(In("gps.csv"), csv);
  const ProcessResult result = Run({"--georeference", In("gps.csv"), "--json"}, "enu.osa");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "transform.schema.json"), "");
  EXPECT_EQ(report["georeference"]["latitude"], 47);
  EXPECT_EQ(json::parse(ReadWholeFile(In("enu.osa.georeference.json")))["georeference"], report["georeference"]);
  EXPECT_THAT(result.err, HasSubstr("enu.osa.georeference.json"));
  // Neither file is replaced unasked.
  EXPECT_EQ(RunSlamdb({"transform", In("a.osa"), In("enu.osa"), "--georeference", In("gps.csv")}).exit_code, 1);
}

TEST_F(Transform, AxesAndGravity) {
  EXPECT_EQ(Run({"--axes", "camera:ros"}, "ros.osa").exit_code, 0);
  const ProcessResult gravity = Run({"--gravity", "cameras", "--json"}, "level.osa");
  ASSERT_EQ(gravity.exit_code, 0) << gravity.err;
  const json report = json::parse(gravity.out);
  EXPECT_EQ(BreachOf(report, "transform.schema.json"), "");
  EXPECT_EQ(report["maps"][0]["upright"]["method"], "cameras");
  const json levelled = json::parse(RunSlamdb({"info", In("level.osa"), "--json"}).out)["maps"][0];
  EXPECT_EQ(levelled["up"], json({0, 0, 1}));
  EXPECT_EQ(levelled["up_method"], "frame");
  EXPECT_THAT(RunSlamdb({"info", In("level.osa")}).out, HasSubstr(", world with z up (by frame)\n"));
  EXPECT_THAT(RunSlamdb({"info", In("a.osa")}).out, HasSubstr(", world with y down (by cameras)\n"));
  EXPECT_THAT(RunSlamdb({"show", In("level.osa"), "kf/1"}).out, HasSubstr(" with z up (by frame)\n"));
}

TEST_F(Transform, BadInputGetsAClearErrorAndNoOutput) {
  const auto expect = [](const std::vector<std::string>& arguments, int code, const char* text) {
    const ProcessResult result = Run(arguments, "none.osa");
    EXPECT_EQ(result.exit_code, code) << arguments[0] << result.out;
    EXPECT_THAT(result.err, HasSubstr(text));
  };
  expect({"--by", "1 2 3"}, 1, "not 3");
  expect({"--by", "0 0 0 0 0 0 0"}, 1, "quaternion");
  expect({"--by", "nowhere.txt"}, 1, "nowhere.txt");
  expect({"--scale", "0"}, 1, "above 0");
  expect({"--scale", "nan"}, 1, "NaN");
  expect({"--axes", "y,x,z"}, 1, "mirror");
  expect({"--gravity", "inertia"}, 1, "IMU");
  expect({"--scale", "2", "--map", "7"}, 1, "no map 7");
  expect({"--onto", In("missing.txt")}, 1, "missing.txt");
  WriteWholeFile(In("later.txt"), "9e8 0 0 0 0 0 0 1\n9.1e8 1 0 0 0 0 0 1\n");
  expect({"--onto", In("later.txt")}, 1, "the map covers");
  WriteWholeFile(In("bad.csv"), "1,2\n");
  expect({"--georeference", In("bad.csv")}, 1, "line 1");
  expect({"--scale", "2", "--axes", "x,y,z"}, 2, "--axes");
  expect({"--json"}, 2, "--by");
  expect({"--scale", "2", "--origin", "1,2"}, 2, "--georeference");
  expect({"--georeference", In("bad.csv"), "--origin", "91,0"}, 2, "a place is");
  expect({"--onto", In("later.txt"), "--time-offset", "nan"}, 2, "a finite number");
}

TEST_F(Transform, DryRunWritesNothing) {
  const ProcessResult result = RunSlamdb({"transform", In("a.osa"), "--scale", "2", "--dry-run"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("scale 2"));
}

TEST_F(Transform, DiffSpeaksForScripts) {
  RunSlamdb({"convert", In("a.osa"), In("store.db")});
  const ProcessResult same = RunSlamdb({"diff", In("a.osa"), In("store.db"), "--summary"});
  EXPECT_EQ(same.exit_code, 0) << same.out;
  EXPECT_EQ(same.out,
            "same maps=-0+0~0 cameras=-0+0~0 keyframes=-0+0~0 points=-0+0~0 links=-0+0~0 fields=0 renumbered=0\n");
  Run({"--scale", "2"}, "twice.osa");
  const ProcessResult different = RunSlamdb({"diff", In("a.osa"), In("twice.osa"), "--json"});
  EXPECT_EQ(different.exit_code, 1);
  const json report = json::parse(different.out);
  EXPECT_EQ(BreachOf(report, "diff.schema.json"), "");
  EXPECT_EQ(report["verdict"], "different");
  EXPECT_NEAR(report["motions"][0]["after_from_before"]["scale"], 2, 1e-5);
  EXPECT_THAT(RunSlamdb({"diff", In("a.osa"), In("twice.osa")}).out, HasSubstr("as a whole: scale 2"));
  EXPECT_EQ(RunSlamdb({"diff", In("a.osa"), In("twice.osa"), "-q"}).out, "");
  // Trouble is 2, as cmp has it.
  EXPECT_EQ(RunSlamdb({"diff", In("a.osa"), In("missing.osa")}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"diff", In("a.osa")}).exit_code, 2);
}

TEST_F(Transform, DiffTellsErrorsFromDifferences) {
  const ProcessResult missing = RunSlamdb({"diff", In("a.osa"), In("missing.osa"), "--summary"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_EQ(missing.out, "");
  EXPECT_THAT(missing.err, HasSubstr("missing.osa"));
  EXPECT_EQ(RunSlamdb({"diff", In("a.osa")}).exit_code, 2);
}

}  // namespace
}  // namespace slamdb::testing
