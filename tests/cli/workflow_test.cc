// SPDX-License-Identifier: BSD-3-Clause
// Runs the steps of the workflow in docs/checks.md as a CI server does, with the slamdb that was built.
#include <gmock/gmock.h>

#include <filesystem>
#include <sstream>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

// The scripts of its `run:` keys, on one line or as a block.
std::vector<std::string> StepsOf(const std::string& page) {
  std::vector<std::string> steps;
  std::istringstream text(page.substr(page.find("# .github/workflows/maps.yml")));
  std::size_t block = 0;  // the indentation of the block's key; 0: outside
  for (std::string line; std::getline(text, line) && !line.starts_with("```");) {
    const std::size_t indent = line.find_first_not_of(' ');
    if (block > 0 && indent != std::string::npos && indent > block) {
      steps.back() += line.substr(indent) + "\n";
      continue;
    }
    block = 0;
    const std::size_t key = line.find("run: ");
    if (key == std::string::npos || key != line.find_first_not_of(" -")) continue;
    const std::string script = line.substr(key + 5);
    if (script == "|") block = key;
    steps.push_back(script == "|" ? "" : script);
  }
  return steps;
}

class Workflow : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "bin");
    fs::create_directories(folder_ / "maps");
    fs::create_symlink(SLAMDB_COMMAND, folder_ / "bin/slamdb");
    steps_ = StepsOf(ReadWholeFile(SLAMDB_SCHEMAS "/../docs/checks.md"));
    ASSERT_EQ(steps_.size(), 3U);
  }

  // As GitHub runs a step: by a shell that stops at the first failure, in the folder of the repository.
  ProcessResult Run(const std::string& step) const {
    return RunProgram({"bash", "-e", "-c", "cd '" + folder_.path().string() + "'; PATH=\"$PWD/bin:$PATH\"; " + step});
  }

  void Take(const std::string& fixture) const {
    fs::copy_file(fs::path(SLAMDB_FIXTURES) / fixture, fs::path(folder_ / "maps") / fs::path(fixture).filename());
  }

  const TemporaryFolder folder_;
  std::vector<std::string> steps_;
};

// What fetches and builds is run by hand of `.ci/run`; here: that it names what is there.
TEST_F(Workflow, InstallsWhatIsThere) {
  const fs::path root = fs::path(SLAMDB_SCHEMAS) / "..";
  EXPECT_THAT(steps_[0], HasSubstr("git clone --depth 1 \"$SLAMDB_SOURCE\" /opt/slamdb\n"));
  EXPECT_THAT(steps_[0], HasSubstr("\n/opt/slamdb/cmake/build.sh release slamdb_manual\n"));
  EXPECT_TRUE(fs::exists(root / "cmake/build.sh"));
  EXPECT_THAT(ReadWholeFile((root / "CMakePresets.json").string()), HasSubstr("\"release\""));
  EXPECT_EQ(RunProgram({"bash", "-n", "-c", steps_[0]}).exit_code, 0);
}

TEST_F(Workflow, PassesSoundMaps) {
  Take("session_small_a/session_small_a.osa");
  for (const std::string& step : {steps_[1], steps_[2]}) {
    const ProcessResult result = Run(step);
    EXPECT_EQ(result.exit_code, 0) << step << "\n" << result.out << result.err;
  }
  const json sarif = json::parse(ReadWholeFile(folder_ / "maps.sarif"));
  EXPECT_EQ(BreachOf(sarif, "sarif.schema.json"), "");
  EXPECT_TRUE(sarif["runs"][0]["results"].empty());
  EXPECT_THAT(ReadWholeFile(folder_ / "maps.xml"), HasSubstr("failures=\"0\" errors=\"0\""));
}

TEST_F(Workflow, StopsBrokenMapsAndReportsThem) {
  Take("session_small_a/session_small_a.osa");
  Take("mono_small_twice/mono_small_twice.osa");
  WriteWholeFile(folder_ / "maps/pointer.osa", "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n");
  EXPECT_EQ(Run(steps_[1]).exit_code, 1);
  EXPECT_EQ(Run(steps_[2]).exit_code, 1);
  const json sarif = json::parse(ReadWholeFile(folder_ / "maps.sarif"));
  EXPECT_EQ(BreachOf(sarif, "sarif.schema.json"), "");
  std::set<std::string> found;
  for (const json& result : sarif["runs"][0]["results"])
    found.insert(result["ruleId"].get<std::string>() + " " +
                 result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"].get<std::string>());
  EXPECT_THAT(found,
              ::testing::IsSupersetOf({"map-listed-once maps/mono_small_twice.osa", "unreadable maps/pointer.osa"}));
  EXPECT_THAT(ReadWholeFile(folder_ / "maps.xml"), HasSubstr("errors=\"1\""));
}

}  // namespace
}  // namespace slamdb::testing
