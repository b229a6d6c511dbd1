// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";

// The lines of `slamdb dump` for one type of entity.
std::vector<json> Dumped(const std::string& type) {
  std::istringstream lines(RunSlamdb({"dump", kTiny}).out);
  std::vector<json> found;
  for (std::string line; std::getline(lines, line);) {
    const json entity = json::parse(line);
    if (entity.at("type") == type) found.push_back(entity);
  }
  return found;
}

TEST(Show, EveryEntityOfTheTinyAtlas) {
  const std::vector<std::pair<std::string, std::string>> kinds = {
      {"keyframe", "kf/"}, {"map_point", "mp/"}, {"camera", "camera/"}, {"map", "map/"}};
  for (const auto& [type, prefix] : kinds) {
    const auto entities = Dumped(type);
    EXPECT_FALSE(entities.empty()) << type;
    for (const json& entity : entities) {
      const std::string name = prefix + entity.at("id").dump();
      const ProcessResult shown = RunSlamdb({"show", kTiny, name, "--json"});
      ASSERT_EQ(shown.exit_code, 0) << name << shown.err;
      EXPECT_EQ(json::parse(shown.out).at("id"), entity.at("id"));
      const ProcessResult text = RunSlamdb({"show", kTiny, name});
      EXPECT_EQ(text.exit_code, 0);
      EXPECT_EQ(text.out.find("null\n\n"), std::string::npos);
    }
  }
}

TEST(Show, TextHasEveryField) {
  const std::string name = "kf/" + Dumped("keyframe").front().at("id").dump();
  const json entity = json::parse(RunSlamdb({"show", kTiny, name, "--json"}).out);
  const std::string text = RunSlamdb({"show", kTiny, name, "--all"}).out;
  for (const auto& [field, value] : entity.items()) EXPECT_THAT(text, HasSubstr(field));
}

TEST(Show, BeginsWithWhereTheCameraIs) {
  const std::string atlas = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";
  const std::string text = RunSlamdb({"show", atlas, "kf/0"}).out;  // at the origin
  EXPECT_EQ(text.find("camera at               0 0 0 m, world of map 0 with y down (by cameras)\n"
                      "camera looks            0 degrees left of z, 2.19 up\n"
                      "taken                   2014-06-24 19:02:59 UTC\n"),
            0U)
      << text.substr(0, 300);
  EXPECT_EQ(RunSlamdb({"show", atlas, "kf/0", "--json"}).out.find("camera at"), std::string::npos);
}

TEST(Show, FoldsWhatDoesNotApply) {
  const std::string atlas = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";
  const std::string text = RunSlamdb({"show", atlas, "kf/5"}).out;
  for (const char* name : {"preintegration", "imu_calibration", "right_camera", "right_grid", "undistorted", "(empty)"})
    EXPECT_EQ(text.find(name), std::string::npos) << name;
  for (const char* name : {"descriptors", "depth", "connections", "bag_of_words"}) EXPECT_THAT(text, HasSubstr(name));
  EXPECT_THAT(text, HasSubstr(" fields folded: of an IMU that is not there, of a second camera, "));
  EXPECT_THAT(text, HasSubstr("; --all shows them)\n"));
  EXPECT_EQ(RunSlamdb({"show", atlas, "kf/5", "--all"}).out.find("folded"), std::string::npos);
}

TEST(Show, OfAnInertialMapFoldsNoImu) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"synthesize", folder / "a.osa", "--sensor", "fisheye", "--inertial", "--keyframes", "4",
                       "--points", "100", "-q"})
                .exit_code,
            0);
  const std::string text = RunSlamdb({"show", folder / "a.osa", "kf/1"}).out;
  for (const char* name : {"preintegration", "imu_calibration", "right_camera", "right_grid"})
    EXPECT_THAT(text, HasSubstr(name));
}

TEST(Show, SeveralEntitiesAreNamed) {
  const ProcessResult result = RunSlamdb({"show", kTiny, "atlas", "map/0"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("atlas\n"));
  EXPECT_THAT(result.out, HasSubstr("map/0\n"));
}

TEST(Show, WhatIsNotThere) {
  for (const char* name : {"kf/999999", "mp/18446744073709551614", "camera/7", "map/5"}) {
    const ProcessResult result = RunSlamdb({"show", kTiny, name});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr(std::string("has no ") + name));
  }
}

TEST(Show, WhatIsNoName) {
  for (const char* name : {"kf", "kf/", "kf/x", "kf/-1", "frame/1", "kf/1/2", "18"}) {
    const ProcessResult result = RunSlamdb({"show", kTiny, name});
    EXPECT_EQ(result.exit_code, 2) << name;
    EXPECT_THAT(result.err, HasSubstr("kf/ID"));
  }
  EXPECT_EQ(RunSlamdb({"show", kTiny}).exit_code, 2);
}

TEST(Dump, EveryLineIsJson) {
  const ProcessResult result = RunSlamdb({"dump", kTiny});
  ASSERT_EQ(result.exit_code, 0);
  std::istringstream lines(result.out);
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line); ++count) EXPECT_TRUE(json::accept(line)) << line;
  EXPECT_GT(count, 4U);
}

TEST(Dump, TablesHaveAHeader) {
  for (const char* format : {"csv", "csv-keyframes", "csv-observations"}) {
    const ProcessResult result = RunSlamdb({"dump", kTiny, "--format", format});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
    EXPECT_THAT(result.out.substr(0, result.out.find('\n')), HasSubstr(",")) << format;
  }
}

TEST(Dump, ToAFileThatIsNotOverwritten) {
  const TemporaryFolder folder;
  const std::string path = folder / "dump.ndjson";
  ASSERT_EQ(RunSlamdb({"dump", kTiny, "-o", path}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(path), RunSlamdb({"dump", kTiny}).out);
  EXPECT_EQ(RunSlamdb({"dump", kTiny, "-o", path}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"dump", kTiny, "-o", path, "-O"}).exit_code, 0);
}

TEST(Dump, OnlyWhatIsSelected) {
  const std::string id = Dumped("keyframe").front().at("id").dump();
  const std::string out = RunSlamdb({"dump", kTiny, "--keyframes", id + ":" + id}).out;
  EXPECT_LT(out.size(), RunSlamdb({"dump", kTiny}).out.size());
}

}  // namespace
}  // namespace slamdb::testing
