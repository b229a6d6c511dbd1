// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "slamdb/edit/frame/similarity_text.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;

TEST(Synthesize, MakesWhatIsAskedFor) {
  const TemporaryFolder folder;
  const ProcessResult made = RunSlamdb({"synthesize", folder / "made.osa", "--maps", "2", "--keyframes", "6",
                                        "--points", "150", "--features", "200", "--sensor", "rgbd"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto report = nlohmann::json::parse(RunSlamdb({"info", folder / "made.osa", "--json"}).out);
  ASSERT_EQ(report.at("maps").size(), 2U);
  for (const auto& map : report.at("maps")) {
    EXPECT_EQ(map.at("keyframes"), 6);
    EXPECT_LE(map.at("points"), 150);
    EXPECT_EQ(map.at("sensor"), "stereo-or-rgbd");
  }
}

TEST(Synthesize, EverySensorChecksClean) {
  const TemporaryFolder folder;
  for (const char* sensor : {"monocular", "stereo", "rgbd", "fisheye"}) {
    for (const bool inertial : {false, true}) {
      SCOPED_TRACE(std::string(sensor) + (inertial ? " inertial" : ""));
      std::vector<std::string> arguments = {"synthesize", folder / "made.osa", "-O", "--sensor",
                                            sensor,       "--keyframes",       "8",  "--points",
                                            "200",        "--features",        "300"};
      if (inertial) arguments.emplace_back("--inertial");
      const ProcessResult made = RunSlamdb(arguments);
      ASSERT_EQ(made.exit_code, 0) << made.err;
      const ProcessResult checked = RunSlamdb({"check", folder / "made.osa"});
      EXPECT_EQ(checked.exit_code, 0) << checked.out;
    }
  }
}

// What align finds is what --truth wrote.
TEST(Synthesize, SessionsLieAsTheTruthSays) {
  const TemporaryFolder folder;
  const std::string atlas = folder / "two.osa", truth = folder / "truth.txt", found = folder / "found.txt";
  const std::vector<std::string> make = {"synthesize", atlas,      "--maps", "2",       "--overlap",
                                         "0.4",        "--sensor", "rgbd",   "--truth", truth};
  ASSERT_EQ(RunSlamdb(make).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"align", atlas, "--save", found}).exit_code, 0);
  std::ifstream lines(truth);
  std::string first, second;
  std::getline(lines, first);
  std::getline(lines, second);
  const Similarity3d expected = ParseSimilarity(first).Inverse() * ParseSimilarity(second);
  const Similarity3d aligned = ReadSimilarity(found);
  EXPECT_LT(expected.rotation.angularDistance(aligned.rotation), 0.01);
  EXPECT_LT((expected.translation - aligned.translation).norm(), 0.05);
  EXPECT_EQ(RunSlamdb(make).exit_code, 1) << "what is there is kept";
}

TEST(Synthesize, RoomsThatLookAlikeAreNotAligned) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"synthesize", folder / "two.osa", "--maps", "2", "--look-alike", "--sensor", "rgbd"}).exit_code,
            0);
  const ProcessResult aligned = RunSlamdb({"align", folder / "two.osa"});
  EXPECT_EQ(aligned.exit_code, 1);
  EXPECT_THAT(aligned.out, HasSubstr("no-overlap"));
  EXPECT_EQ(RunSlamdb({"synthesize", folder / "x.osa", "--look-alike", "--overlap", "0.5"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"synthesize", folder / "x.osa", "--maps", "2", "--common", "0.5"}).exit_code, 2);
}

TEST(Synthesize, EqualSeedsGiveEqualBytes) {
  const std::vector<std::string> base = {"synthesize", "-", "--to", "orbslam3", "--keyframes", "4", "--points", "60"};
  std::vector<std::string> other = base;
  other.insert(other.end(), {"--seed", "2"});
  const std::string first = RunSlamdb(base).out;
  EXPECT_FALSE(first.empty());
  EXPECT_TRUE(first == RunSlamdb(base).out);
  EXPECT_TRUE(first != RunSlamdb(other).out);
}

TEST(Synthesize, SizeIsAboutWhatWasAskedFor) {
  const TemporaryFolder folder;
  for (const char* sensor : {"monocular", "fisheye"}) {
    const std::string path = (folder / sensor) + ".osa";
    ASSERT_EQ(RunSlamdb({"synthesize", path, "--size", "10MB", "--sensor", sensor}).exit_code, 0);
    EXPECT_GT(std::filesystem::file_size(path), 6'000'000U);
    EXPECT_LT(std::filesystem::file_size(path), 15'000'000U);
  }
}

TEST(Synthesize, RefusesWhatContradictsItself) {
  EXPECT_EQ(RunSlamdb({"synthesize", "x.osa", "--size", "1MB", "--keyframes", "3"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"synthesize", "x.osa", "--sensor", "sonar"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"synthesize"}).exit_code, 2);
}

TEST(Synthesize, DoesNotOverwrite) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "there.osa", "precious");
  const ProcessResult result = RunSlamdb({"synthesize", folder / "there.osa", "--keyframes", "3", "--points", "50"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("--overwrite"));
  EXPECT_EQ(ReadWholeFile(folder / "there.osa"), "precious");
}

}  // namespace
}  // namespace slamdb::testing
