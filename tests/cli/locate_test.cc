// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Locate : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(RunSlamdb({"synthesize", atlas_, "--sensor", "stereo", "--keyframes", "24", "--points", "1500", "-q"})
                  .exit_code,
              0);
    std::string gray = "P5\n640 480\n255\n";
    gray.resize(gray.size() + 640 * 480, '\x60');
    WriteWholeFile(folder_ / "gray.pgm", gray);
  }
  ProcessResult Run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"locate", atlas_});
    return RunSlamdb(arguments);
  }

  const TemporaryFolder folder_;
  const std::string atlas_ = folder_ / "a.osa";
  const std::string camera_ = "Camera1.fx: 450\nCamera1.fy: 450\nCamera1.cx: 320\nCamera1.cy: 240\n";
};

TEST_F(Locate, BenchmarkTellsHowManyKeyFramesAreFound) {
  const ProcessResult text = Run({"--benchmark"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("of 24 keyframes"));
  const ProcessResult result = Run({"--benchmark", "--most", "8", "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "locate.schema.json"), "");
  EXPECT_EQ(report["pictures"].size(), 8U);
  EXPECT_GE(report["found"], 7);
}

TEST_F(Locate, APictureOfNothingIsNotFound) {
  const ProcessResult result = Run(
      {folder_ / "gray.pgm", "--camera", folder_.Make("camera.yaml", camera_), "-o", folder_ / "poses.tum", "--json"});
  if (result.err.find("built without pictures") != std::string::npos) GTEST_SKIP() << result.err;
  EXPECT_EQ(result.exit_code, 1) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "locate.schema.json"), "");
  EXPECT_EQ(report["pictures"][0]["verdict"], "not-found");
  EXPECT_EQ(ReadWholeFile(folder_ / "poses.tum"), "# timestamp tx ty tz qx qy qz qw\n");
}

TEST_F(Locate, AsksAllAtlasesOfAStore) {
  const std::string store = folder_ / "maps.db";
  for (const char* name : {"a", "b"}) ASSERT_EQ(RunSlamdb({"convert", atlas_, store + "#" + name, "-q"}).exit_code, 0);
  const std::string camera = folder_.Make("camera.yaml", camera_);
  for (const std::vector<std::string>& how : {std::vector<std::string>{}, {"--camera", camera}}) {
    std::vector<std::string> arguments = {"locate", store, folder_ / "gray.pgm", "--json"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    const ProcessResult result = RunSlamdb(arguments);
    if (result.err.find("built without pictures") != std::string::npos) GTEST_SKIP() << result.err;
    EXPECT_EQ(result.exit_code, 1) << result.err;
    const json report = json::parse(result.out);
    EXPECT_EQ(BreachOf(report, "locate.schema.json"), "");
    EXPECT_TRUE(report["pictures"][0]["found_in"].is_null()) << "nothing looks like a gray picture";
  }
  for (const std::vector<std::string>& one_atlas :
       {std::vector<std::string>{"--benchmark"}, {folder_ / "gray.pgm", "--against", folder_ / "gray.pgm"}}) {
    std::vector<std::string> arguments = {"locate", store};
    arguments.insert(arguments.end(), one_atlas.begin(), one_atlas.end());
    const ProcessResult result = RunSlamdb(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("maps.db#NAME"));
  }
}

// A real room: a picture of it, one of another room, and one that is none.
TEST_F(Locate, APictureThatCannotBeReadLeavesTheOthers) {
  const std::string room = SLAMDB_FIXTURES "/room/", broken = folder_.Make("broken.png", "no picture");
  const ProcessResult result =
      RunSlamdb({"locate", room + "corner.osa", room + "a01.jpg", broken, room + "b01.jpg", "--json"});
  if (result.err.find("built without pictures") != std::string::npos) GTEST_SKIP() << result.err;
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr(broken + ": is no picture"));
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "locate.schema.json"), "");
  EXPECT_EQ(report["pictures"][0]["verdict"], "found");
  EXPECT_EQ(report["pictures"][1]["verdict"], "unreadable");
  EXPECT_EQ(report["pictures"][2]["verdict"], "not-found");
}

// It is in no atlas then, whichever was asked.
TEST_F(Locate, AStoreThatIsOfAnotherRoomHasNotTheBestAtlas) {
  const std::string room = SLAMDB_FIXTURES "/room/", store = folder_ / "maps.db";
  ASSERT_EQ(RunSlamdb({"convert", room + "corner.osa", store + "#corner", "-q"}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"convert", atlas_, store + "#made", "-q"}).exit_code, 0);
  const std::vector<std::string> asked = {"locate",         store,      room + "a01.jpg",
                                          room + "b01.jpg", "--camera", room + "camera.yaml"};
  std::vector<std::string> words = asked;
  words.push_back("--json");
  const ProcessResult result = RunSlamdb(words);
  if (result.err.find("built without pictures") != std::string::npos) GTEST_SKIP() << result.err;
  EXPECT_EQ(result.exit_code, 1) << result.err;
  const json report = json::parse(result.out), &here = report["pictures"][0], &elsewhere = report["pictures"][1];
  EXPECT_EQ(BreachOf(report, "locate.schema.json"), "");
  EXPECT_EQ(here["found_in"], "corner");
  EXPECT_EQ(elsewhere["verdict"], "not-found");
  EXPECT_TRUE(elsewhere["found_in"].is_null());
  EXPECT_FALSE(elsewhere["others"].empty()) << "what was asked is told";
  EXPECT_THAT(RunSlamdb(asked).out, HasSubstr(room + "b01.jpg: not-found: "));
}

TEST_F(Locate, SaysWhatIsWrongWithItsInputs) {
  EXPECT_EQ(Run({}).exit_code, 2);
  EXPECT_EQ(Run({"--benchmark", folder_ / "gray.pgm"}).exit_code, 2);
  EXPECT_THAT(Run({folder_ / "none.png"}).err, HasSubstr("none.png"));
  EXPECT_EQ(Run({folder_ / "none.png"}).exit_code, 1);
}

}  // namespace
}  // namespace slamdb::testing
