// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cstdlib>
#include <sstream>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";
const std::string kTinyText = SLAMDB_FIXTURES "/tiny/tiny_text.osa";

// Copies a fixture to where its path is the same on every machine: the name alone.
ProcessResult RunInFolderOf(const std::string& path, const std::string& arguments) {
  const std::filesystem::path file(path);
  return RunProgram({"bash", "-c", "cd \"$1\" && exec \"$0\" " + arguments + " \"$2\"", SLAMDB_COMMAND,
                     file.parent_path().string(), file.filename().string()});
}

// Set SLAMDB_UPDATE_GOLDEN to write the files anew; look at what changed before committing them.
void ExpectGolden(const std::string& found, const std::string& name) {
  const std::string path = std::string(SLAMDB_FIXTURES "/tiny/") + name;
  if (std::getenv("SLAMDB_UPDATE_GOLDEN") != nullptr) WriteWholeFile(path, found);
  EXPECT_EQ(found, ReadWholeFile(path));
}

TEST(Info, TextOfTheTinyAtlas) {
  const ProcessResult result = RunInFolderOf(kTiny, "info");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  ExpectGolden(result.out, "tiny.info.txt");
}

TEST(Info, JsonOfTheTinyAtlas) {
  const ProcessResult result = RunInFolderOf(kTiny, "info --json");
  EXPECT_EQ(result.exit_code, 0);
  ExpectGolden(result.out, "tiny.info.json");
}

TEST(Info, JsonHoldsItsSchema) {
  const TemporaryFolder folder;
  const std::string stored = (folder / "lab.db") + "#tiny", made = folder / "made.osa";
  ASSERT_EQ(RunSlamdb({"convert", kTiny, stored}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"synthesize", made, "--keyframes", "5", "--points", "90", "--sensor", "fisheye"}).exit_code, 0);
  for (const std::string& path : {kTiny, kTinyText, stored, made}) {
    const ProcessResult result = RunSlamdb({"info", "--json", path});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(BreachOf(json::parse(result.out), "info.schema.json"), "") << path;
  }
}

TEST(Info, BinaryAndTextAgree) {
  json binary = json::parse(RunSlamdb({"info", "--json", kTiny}).out);
  json text = json::parse(RunSlamdb({"info", "--json", kTinyText}).out);
  EXPECT_EQ(binary.at("maps"), text.at("maps"));
  EXPECT_EQ(binary.at("totals"), text.at("totals"));
  EXPECT_EQ(binary.at("format"), "orbslam3");
  EXPECT_EQ(text.at("format"), "orbslam3-text");
}

TEST(Info, PartsAddUpToTheFile) {
  const json report = json::parse(RunSlamdb({"info", "--json", kTiny}).out);
  std::uint64_t sum = 0;
  for (const json& part : report.at("parts")) sum += part.at("bytes").get<std::uint64_t>();
  EXPECT_EQ(sum, std::filesystem::file_size(kTiny));
}

TEST(Info, GetPrintsOneValue) {
  const json report = json::parse(RunSlamdb({"info", "--json", kTiny}).out);
  EXPECT_EQ(RunSlamdb({"info", "--get", "maps.0.keyframes", kTiny}).out, report["maps"][0]["keyframes"].dump() + "\n");
  EXPECT_EQ(RunSlamdb({"info", "-g", "vocabulary.name", kTiny}).out,
            report["vocabulary"]["name"].get<std::string>() + "\n");
  EXPECT_EQ(json::parse(RunSlamdb({"info", "--get", "cameras", kTiny}).out), report["cameras"]);
  EXPECT_EQ(RunSlamdb({"info", "--get", "next_ids.keyframe", kTiny}).out, report["next_ids"]["keyframe"].dump() + "\n");
}

TEST(Info, GetOfWhatIsNotThereTellsWhatIs) {
  for (const char* key : {"map.0", "maps.99", "maps.x", "maps.0.keyframes.5", "", ".", "vocabulary.", "next_ids.kf"}) {
    if (*key == '\0') continue;
    const ProcessResult result = RunSlamdb({"info", "--get", key, kTiny});
    EXPECT_EQ(result.exit_code, 1) << key;
    EXPECT_EQ(result.out, "") << key;
    EXPECT_THAT(result.err, HasSubstr(std::string("no value '") + key + "'"));
  }
  EXPECT_THAT(RunSlamdb({"info", "--get", "next_ids.kf", kTiny}).err, HasSubstr("point, frame"));
}

TEST(Info, SeveralFilesKeepTheirOrder) {
  const ProcessResult text = RunSlamdb({"info", kTinyText, kTiny, kTinyText});
  EXPECT_EQ(text.exit_code, 0);
  const std::size_t first = text.out.find(kTinyText), second = text.out.find(kTiny);
  EXPECT_LT(first, second);
  EXPECT_NE(text.out.find(kTinyText, second), std::string::npos);

  std::istringstream lines(RunSlamdb({"info", "--json", kTinyText, kTiny}).out);
  std::vector<std::string> files;
  for (std::string line; std::getline(lines, line);) files.push_back(json::parse(line).at("input"));
  EXPECT_EQ(files, (std::vector<std::string>{kTinyText, kTiny}));
  EXPECT_EQ(RunSlamdb({"info", "--get", "format", kTinyText, kTiny}).out,
            kTinyText + ": orbslam3-text\n" + kTiny + ": orbslam3\n");
}

TEST(Info, ReadsStandardInput) {
  const ProcessResult result = RunSlamdb({"info", "-", "--from", "orbslam3", "--json"}, ReadWholeFile(kTiny));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(json::parse(result.out).at("bytes"), ReadWholeFile(kTiny).size());
}

TEST(Info, SameOutputForAnyNumberOfThreads) {
  const std::string one = RunSlamdb({"info", "--threads", "1", kTiny}).out;
  EXPECT_EQ(one, RunSlamdb({"info", "--threads", "4", kTiny}).out);
}

}  // namespace
}  // namespace slamdb::testing
