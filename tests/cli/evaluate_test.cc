// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::string kAtlas = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";
const std::string kTruth = SLAMDB_FIXTURES "/session_small_a/truth.txt";

class Evaluate : public ::testing::Test {
 protected:
  std::string In(const std::string& name) { return folder_ / name; }
  std::string Write(const std::string& name, const std::string& text) {
    WriteWholeFile(In(name), text);
    return In(name);
  }
  static ProcessResult Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "evaluate");
    return RunSlamdb(arguments);
  }
  static json Report(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const ProcessResult result = Run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    json report = json::parse(result.out, nullptr, false);
    EXPECT_EQ(BreachOf(report, "evaluate.schema.json"), "");
    return report;
  }
  static double Rmse(const std::vector<std::string>& arguments) {
    return Report(arguments)["evaluations"][0]["absolute"]["translation"]["rmse"];
  }

  TemporaryFolder folder_;
};

TEST_F(Evaluate, TellsWhatWasPairedAlignedAndMeasured) {
  const ProcessResult result = Run({kAtlas, kTruth});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out, AllOf(HasSubstr("paired   14 of 14 poses with 601 of the truth"),
                                HasSubstr("aligned  SE3 (rotation, translation) over 14 pairs"),
                                HasSubstr("absolute      m         0.01763"), HasSubstr("over 1 m")));
  EXPECT_THAT(result.out, Not(HasSubstr("|R - I|")));
  EXPECT_THAT(Run({kAtlas, kTruth, "-v"}).out,
              AllOf(HasSubstr("|R - I|"), HasSubstr("sse"), HasSubstr("% of distance")));
  EXPECT_THAT(Run({kAtlas, kTruth, "-q"}).out, IsEmpty());
}

TEST_F(Evaluate, AtlasAndItsTrajectoryHaveTheSameFigures) {
  RunSlamdb({"convert", kAtlas, In("poses.tum")});
  RunSlamdb({"convert", kAtlas, In("maps.db#a")});
  const json atlas = Report({kAtlas, kTruth, "--errors"}), trajectory = Report({In("poses.tum"), kTruth, "--errors"});
  EXPECT_EQ(atlas["evaluations"][0]["absolute"], trajectory["evaluations"][0]["absolute"]);
  EXPECT_EQ(atlas["evaluations"][0]["poses"].size(), 14U);
  EXPECT_EQ(Rmse({In("maps.db#a"), kTruth}), Rmse({kAtlas, kTruth}));
  EXPECT_EQ(atlas["evaluations"][0]["maps"][0], 0);
  EXPECT_THAT(trajectory["evaluations"][0]["maps"], IsEmpty());
  // Map against map, and trajectory against map.
  EXPECT_LT(Rmse({kAtlas, In("maps.db#a")}), 1e-12);
  EXPECT_LT(Rmse({In("poses.tum"), kAtlas, "--align", "none"}), 1e-12);
}

TEST_F(Evaluate, AgreesWithTransformOnto) {
  const ProcessResult onto = RunSlamdb({"transform", kAtlas, "--onto", kTruth, "--dry-run", "--json"});
  ASSERT_EQ(onto.exit_code, 0) << onto.err;
  const json moved = json::parse(onto.out)["maps"][0];
  EXPECT_NEAR(moved["alignment"]["residuals"]["rmse"], Rmse({kAtlas, kTruth}), 1e-7);
  RunSlamdb({"transform", kAtlas, In("there.osa"), "--onto", kTruth});
  EXPECT_NEAR(Rmse({In("there.osa"), kTruth, "--align", "none"}), Rmse({kAtlas, kTruth}), 1e-6)
      << "what was moved there needs no alignment";
}

TEST_F(Evaluate, AgreesWithTransformOntoOnRealAtlases) {
  const char *atlases = std::getenv("SLAMDB_ATLASES"), *meaning = std::getenv("SLAMDB_MEANING");
  if (atlases == nullptr || meaning == nullptr) GTEST_SKIP() << "needs SLAMDB_ATLASES and SLAMDB_MEANING";
  const std::filesystem::path truths = std::filesystem::path(meaning).parent_path() / "ground_truth";
  for (const std::string name : {"session_a", "mono_small", "stereo_inertial", "multimap_rgbd", "fisheye_stereo"}) {
    SCOPED_TRACE(name);
    const std::string atlas = std::string(atlases) + "/" + name + ".osa", truth = truths / (name + "_frames.txt");
    const ProcessResult onto = RunSlamdb({"transform", atlas, "--onto", truth, "--dry-run", "--json"});
    ASSERT_EQ(onto.exit_code, 0) << onto.err;
    const json moved = json::parse(onto.out)["maps"], report = Report({atlas, truth})["evaluations"];
    ASSERT_EQ(report.size(), moved.size());
    for (std::size_t map = 0; map < moved.size(); ++map) {
      const double rmse = report[map]["absolute"]["translation"]["rmse"];
      EXPECT_NEAR(moved[map]["alignment"]["residuals"]["rmse"], rmse, 1e-5 * rmse);
      EXPECT_EQ(moved[map]["alignment"]["pairs"], report[map]["coverage"]["pairs"]);
    }
  }
}

TEST_F(Evaluate, LimitsThatAreBrokenEndWithOne) {
  const ProcessResult broken = Run({kAtlas, kTruth, "--max-ate-rmse", "0.01", "--min-coverage", "99"});
  EXPECT_EQ(broken.exit_code, 1);
  EXPECT_THAT(broken.err, AllOf(HasSubstr("map 0: the absolute error of positions (rmse) is 0.0176"),
                                HasSubstr("above the limit of 0.01 m"), HasSubstr("below the limit of 99%")));
  EXPECT_THAT(broken.out, HasSubstr("absolute")) << "the report is there all the same";
  EXPECT_EQ(Run({kAtlas, kTruth, "--max-ate-rmse", "0.02", "--max-ate", "0.04", "--max-rotation-rmse", "1",
                 "--max-rpe-rmse", "0.03", "--min-paired", "100", "--min-coverage", "60"})
                .exit_code,
            0);
  const ProcessResult data = Run({kAtlas, kTruth, "--max-ate", "0.01", "--json"});
  EXPECT_EQ(data.exit_code, 1);
  EXPECT_EQ(json::parse(data.out)["breaches"].size(), 1U);
  EXPECT_EQ(BreachOf(json::parse(data.out), "evaluate.schema.json"), "");
}

TEST_F(Evaluate, WritesErrorsAndTheAlignedTrajectory) {
  const ProcessResult result = Run({kAtlas, kTruth, "-o", In("errors.csv"), "--aligned", In("aligned.tum")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const std::string csv = ReadWholeFile(In("errors.csv"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 15);
  EXPECT_NEAR(Rmse({In("aligned.tum"), kTruth, "--align", "none"}), Rmse({kAtlas, kTruth}), 1e-12);
  EXPECT_EQ(Run({kAtlas, kTruth, "-o", In("errors.csv")}).exit_code, 1) << "it is there already";
  EXPECT_EQ(Run({kAtlas, kTruth, "-o", In("errors.csv"), "-O"}).exit_code, 0);
  const ProcessResult piped = Run({kAtlas, kTruth, "-o", "-"});
  EXPECT_EQ(piped.out, csv);
  EXPECT_THAT(piped.err, HasSubstr("absolute"));
}

TEST_F(Evaluate, MapsOneByOneOrJoint) {
  RunSlamdb({"synthesize", In("two.osa"), "--maps", "2", "--sensor", "stereo", "--keyframes", "24", "-q"});
  RunSlamdb({"convert", In("two.osa"), In("two.txt"), "--to", "tum", "-q"});
  const json report = Report({In("two.txt"), In("two.osa"), "--reference-map", "0", "--map", "0"});
  EXPECT_EQ(report["evaluations"].size(), 1U);
  EXPECT_LT(report["evaluations"][0]["absolute"]["translation"]["max"], 1e-9);
  const ProcessResult several = Run({In("two.osa"), In("two.osa")});
  EXPECT_EQ(several.exit_code, 1);
  EXPECT_THAT(several.err, AllOf(HasSubstr("must hold one trajectory, not 2"), HasSubstr("--reference-map")));
  EXPECT_THAT(Run({In("two.osa"), In("two.txt"), "--map", "9"}).err, HasSubstr("has no map 9"));
  // The poses of both maps as the truth of both, in the frames that they have.
  std::string poses = ReadWholeFile(In("two.txt"));
  poses.erase(poses.find("# map 1"), std::string("# map 1\n").size());
  Write("both.txt", poses);
  const json joint = Report({In("two.osa"), In("both.txt"), "--joint"});
  EXPECT_EQ(joint["evaluations"][0]["maps"], json({0, 1}));
  EXPECT_LT(joint["evaluations"][0]["absolute"]["translation"]["max"], 1e-9);
  EXPECT_EQ(Report({In("two.osa"), In("both.txt")})["evaluations"].size(), 2U);
}

TEST_F(Evaluate, TheBodyIsThatOfTheImu) {
  RunSlamdb({"synthesize", In("imu.osa"), "--inertial", "--sensor", "stereo", "--keyframes", "20", "-q"});
  RunSlamdb({"convert", In("imu.osa"), In("body.csv"), "--to", "euroc", "--body", "-q"});
  const ProcessResult camera = Run({In("imu.osa"), In("body.csv")});
  EXPECT_EQ(camera.exit_code, 0) << camera.err;
  EXPECT_THAT(camera.err, HasSubstr("--body"));
  RunSlamdb({"convert", In("imu.osa"), In("body.tum"), "--body", "-q"});
  EXPECT_THAT(Run({In("imu.osa"), In("body.tum")}).err, HasSubstr("where the truth is that of the IMU, --body"));
  EXPECT_THAT(Run({kAtlas, kTruth}).err, Not(HasSubstr("--body"))) << "without an IMU";
  EXPECT_LT(Rmse({In("imu.osa"), In("body.csv"), "--body"}), 1e-6);
  EXPECT_THAT(Run({kAtlas, kTruth, "--body"}).err, HasSubstr("no IMU calibration"));
  EXPECT_EQ(Run({kTruth, kTruth, "--body"}).exit_code, 2);
}

TEST_F(Evaluate, ClocksThatDifferAreToldAndSetRight) {
  std::string later = "# shifted\n";
  RunSlamdb({"convert", kAtlas, In("poses.tum")});
  std::istringstream poses(ReadWholeFile(In("poses.tum")));
  for (std::string line; std::getline(poses, line);)
    if (!line.starts_with('#')) later += "2" + line.substr(1) + "\n";  // a billion seconds later
  Write("later.tum", later);
  const ProcessResult apart = Run({In("later.tum"), kTruth});
  EXPECT_EQ(apart.exit_code, 1);
  EXPECT_THAT(apart.err,
              AllOf(HasSubstr("0 of 14 poses have a pose of the truth at their time"),
                    HasSubstr("ahead by -1000000000.000 s"), HasSubstr("--time-offset"), HasSubstr("later.tum")));
  EXPECT_NEAR(Rmse({In("later.tum"), kTruth, "--time-offset=-1000000000"}), Rmse({kAtlas, kTruth}), 1e-6);
}

TEST_F(Evaluate, KittiTrajectoriesWithoutTimesArePairedByTheirPlaces) {
  RunSlamdb({"convert", kTruth, In("truth.kitti"), "--to", "kitti", "-q"});
  std::filesystem::remove(In("truth.kitti.times"));
  EXPECT_LT(Rmse({In("truth.kitti"), In("truth.kitti")}), 1e-12);
  EXPECT_THAT(Run({In("truth.kitti"), In("truth.kitti")}).err, HasSubstr("frame numbers"));
  const ProcessResult mixed = Run({kTruth, In("truth.kitti")});
  EXPECT_EQ(mixed.exit_code, 1);
  EXPECT_THAT(mixed.err, AllOf(HasSubstr("frame numbers"), HasSubstr("--times"), HasSubstr("--by-index")));
  EXPECT_LT(Rmse({kTruth, In("truth.kitti"), "--by-index"}), 1e-6);
}

TEST_F(Evaluate, RefusesWhatMakesNoSense) {
  const auto code = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {kAtlas, kTruth});
    return Run(more).exit_code;
  };
  EXPECT_EQ(code({"--delta", "1 furlong"}), 2);
  EXPECT_EQ(code({"--delta", "0m"}), 2);
  EXPECT_EQ(code({"--align", "affine"}), 2);
  EXPECT_EQ(code({"--errors"}), 2);
  EXPECT_EQ(code({"--max-ate-rmse", "-1"}), 2);
  EXPECT_EQ(code({"--by-index", "--time-offset", "3"}), 2);
  EXPECT_EQ(code({"--time-offset", "nan"}), 2);
  EXPECT_EQ(code({"--by-index"}), 1) << "601 poses and 14";
  EXPECT_EQ(code({"--times", kTruth}), 2) << "the truth is not of KITTI";
  EXPECT_EQ(Run({kAtlas, In("nowhere.txt")}).exit_code, 1);
  EXPECT_EQ(Run({kAtlas}).exit_code, 2);
}

TEST_F(Evaluate, LargeNumbersAreShortAndSaidToBeLarge) {
  const ProcessResult late = Run({kAtlas, kTruth, "--time-offset", "1e300"});
  EXPECT_EQ(late.exit_code, 1);
  EXPECT_THAT(late.err, HasSubstr("1e+300"));
  EXPECT_LT(late.err.size(), 1000U);
  std::string far;
  for (const char* line : {"1 1e300 0 0", "2 0 1e300 0", "3 0 0 1e300"}) far += std::string(line) + " 0 0 0 1\n";
  const ProcessResult large = Run({Write("far.txt", far), In("far.txt")});
  EXPECT_THAT(large.err, HasSubstr("squares overflow"));
}

TEST_F(Evaluate, HostileTrajectoriesAreNoCrash) {
  for (const std::string text : {"", "# nothing\n", "1 2 3\n", "1 0 0 0 0 0 0 1\n", "nan nan nan nan nan nan nan nan\n",
                                 "1 0 0 0 0 0 0 0\n2 0 0 0 0 0 0 0\n3 0 0 0 0 0 0 0\n"}) {
    const ProcessResult result = Run({Write("odd.txt", text), kTruth});
    EXPECT_EQ(result.exit_code, 1) << text;
    EXPECT_THAT(result.err, HasSubstr("odd.txt")) << text;
  }
  // Huge places: squares overflow, and what is no number is told as none.
  std::string far;
  for (int i = 0; i < 5; ++i) far += std::to_string(i) + " 1e300 " + std::to_string(i * i) + "e299 1e300 0 0 0 1\n";
  Write("far.txt", far);
  EXPECT_NE(Run({In("far.txt"), In("far.txt")}).exit_code, 2);
}

}  // namespace
}  // namespace slamdb::testing
