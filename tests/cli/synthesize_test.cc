// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

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
