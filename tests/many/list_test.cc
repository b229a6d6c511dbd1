// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/list.h"

#include <gmock/gmock.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Atlas Made(std::size_t keyframes, std::size_t points, Sensor sensor = Sensor::kMonocular) {
  return SynthesizeAtlas({.sensor = sensor, .keyframes = keyframes, .points = points, .features = 80});
}

class ListTest : public ::testing::Test {
 protected:
  void SetUp() override {
    small_ = Made(4, 50);
    large_ = Made(9, 30, Sensor::kRgbd);
    WriteAtlas(small_, folder_ / "map2.osa");
    WriteAtlas(large_, folder_ / "map10.osa");
    WriteAtlas(small_, folder_ / "s.db#small", {.sync = false});
    WriteAtlas(large_, folder_ / "s.db#large", {.sync = false});
    folder_.Make("broken.osa", "no archive");
  }

  std::vector<ListedAtlas> List(const std::vector<std::string>& names, const ListOptions& options = {}) const {
    return ListAtlases(FindAtlases(names), options);
  }
  std::vector<ListedAtlas> ListAll(const ListOptions& options = {}) const {
    return List({folder_.path().string()}, options);
  }
  static std::vector<std::string> Names(const std::vector<ListedAtlas>& atlases) {
    std::vector<std::string> names;
    for (const ListedAtlas& atlas : atlases) names.push_back(atlas.name);
    return names;
  }

  TemporaryFolder folder_;
  Atlas small_, large_;
};

// Of the index of names, the first two in each other's place.
void SwapNames(const std::string& store) {
  sqlite3* database = nullptr;
  sqlite3_stmt* statement = nullptr;
  sqlite3_open(store.c_str(), &database);
  const char* const root = "SELECT rootpage FROM sqlite_schema WHERE name = 'sqlite_autoindex_atlas_1'";
  sqlite3_prepare_v2(database, root, -1, &statement, nullptr);
  ASSERT_EQ(sqlite3_step(statement), SQLITE_ROW);
  const auto page = static_cast<std::streamoff>(sqlite3_column_int64(statement, 0));
  sqlite3_finalize(statement);
  sqlite3_close(database);
  constexpr std::streamoff kPageBytes = 8192, kHeaderOfLeaf = 8;
  std::fstream file(store, std::ios::in | std::ios::out | std::ios::binary);
  std::array<char, 4> cells{};  // where the first two are in the page
  file.seekg((page - 1) * kPageBytes + kHeaderOfLeaf).read(cells.data(), cells.size());
  std::rotate(cells.begin(), cells.begin() + 2, cells.end());
  file.seekp((page - 1) * kPageBytes + kHeaderOfLeaf).write(cells.data(), cells.size());
}

TEST_F(ListTest, ADamagedIndexOfNamesLeavesNoAtlasBlank) {
  SwapNames(folder_ / "s.db");
  const std::vector<ListedAtlas> list = List({folder_ / "s.db"});
  ASSERT_THAT(Names(list), ElementsAre("large", "small"));
  EXPECT_EQ(list[0].summary.keyframes, 9U) << list[0].failure;
  EXPECT_EQ(list[1].summary.keyframes, 4U) << list[1].failure;
}

TEST_F(ListTest, FilesAndStoresTellTheSame) {
  const std::vector<ListedAtlas> list = ListAll();
  ASSERT_THAT(Names(list), ElementsAre("broken", "map2", "map10", "large", "small"));
  EXPECT_THAT(list[0].failure, HasSubstr("broken.osa"));
  EXPECT_EQ(list[0].bytes, 10U);
  for (const std::size_t i : {1U, 4U}) {
    EXPECT_EQ(list[i].summary.keyframes, 4U);
    EXPECT_EQ(list[i].summary.points, small_.maps[0].points.size());
    EXPECT_THAT(list[i].summary.sensors, ElementsAre(MapSensor::kMonocular));
    EXPECT_EQ(list[i].summary.trajectory_length, Summarize(small_).trajectory_length);
  }
  EXPECT_EQ(list[1].format, "orbslam3");
  EXPECT_EQ(list[1].bytes, std::filesystem::file_size(folder_ / "map2.osa"));
  EXPECT_EQ(list[1].revision, 0U);
  EXPECT_FALSE(list[1].hash);
  EXPECT_EQ(list[4].format, "store");
  EXPECT_EQ(list[4].input, folder_ / "s.db#small");
  EXPECT_EQ(list[4].revision, 1U);
  EXPECT_EQ(list[4].hash, HashOf(small_));
  for (const ListedAtlas& atlas : list)
    EXPECT_THAT(atlas.saved_at, ::testing::MatchesRegex("20..-..-..T..:..:..Z")) << atlas.name;
}

TEST_F(ListTest, IsTheSameForAnyThreads) {
  ListOptions options{.check = CheckOptions()};
  options.threads = 1;
  const std::string one = ToJson(ListAll(options));
  options.threads = 7;
  EXPECT_EQ(ToJson(ListAll(options)), one);
}

TEST_F(ListTest, OnlyWhatMatches) {
  const auto times = Summarize(large_).end_time;
  ListOptions options{.query = {.times = {{*times, *times}}}};
  EXPECT_THAT(Names(ListAll(options)), ElementsAre("broken", "map10", "large"));
  options.query = {.keyframes = {{1000, 2000}}};
  EXPECT_THAT(Names(ListAll(options)), ElementsAre("broken")) << "what cannot be read may match";
}

TEST_F(ListTest, ChecksWhenAskedFor) {
  large_.maps[0].keyframes[3].id = large_.maps[0].keyframes[2].id;
  WriteAtlas(large_, folder_ / "s.db#large", {.overwrite = true, .sync = false});
  const std::vector<ListedAtlas> list = List({folder_ / "s.db", folder_ / "broken.osa"}, {.check = CheckOptions()});
  EXPECT_FALSE(list[0].ok());
  EXPECT_GT(list[0].findings->errors, 0U);
  EXPECT_THAT(list[0].verdict, HasSubstr("not sound"));
  EXPECT_TRUE(list[1].ok());
  EXPECT_THAT(list[1].verdict, ::testing::StartsWith("sound"));
  EXPECT_EQ(list[2].verdict, "not readable");
  EXPECT_FALSE(list[2].findings);
  EXPECT_FALSE(ListAll()[1].findings) << "not asked for";
}

TEST_F(ListTest, WhatIsNotThereIsAFailureOfItsOwn) {
  const std::vector<ListedAtlas> list =
      List({folder_ / "s.db#nobody", folder_ / "missing.osa", folder_ / "missing.db", folder_ / "s.db#small"});
  EXPECT_THAT(list[0].failure, HasSubstr("no atlas named 'nobody'; it holds large, small"));
  EXPECT_THAT(list[1].failure, HasSubstr("missing.osa"));
  EXPECT_THAT(list[2].failure, HasSubstr("missing.db"));
  EXPECT_EQ(list[3].failure, "");
}

TEST_F(ListTest, WhatIsNoAtlasIsRefused) {
  WriteAtlas(small_, folder_ / "poses.tum");
  EXPECT_THAT(List({folder_ / "poses.tum"})[0].failure, HasSubstr("poses.tum"));
  EXPECT_EQ(List({folder_ / "poses.tum"})[0].summary.keyframes, 0U);
}

TEST_F(ListTest, EndsWhenTheListenerThrows) {
  struct Stop {};
  ListOptions options;
  options.progress = [](std::string_view, double) { throw Stop(); };
  EXPECT_THROW(ListAll(options), Stop);
}

std::vector<std::string> Sorted(std::vector<ListedAtlas> atlases, const std::vector<SortKey>& keys) {
  SortAtlases(atlases, keys);
  std::vector<std::string> names;
  for (const ListedAtlas& atlas : atlases) names.push_back(atlas.name);
  return names;
}

TEST(SortAtlases, ByKeysOneAfterTheOther) {
  std::vector<ListedAtlas> atlases(5);
  const char* names[] = {"m10", "m2", "bad", "late", "none"};
  for (std::size_t i = 0; i < 5; ++i) atlases[i].name = names[i];
  atlases[0].summary.points = 7;
  atlases[1].summary.points = 7;
  atlases[3].summary.points = 9;
  atlases[2].failure = "cannot be read";
  atlases[2].bytes = 1;
  atlases[0].bytes = 5;
  atlases[0].summary.begin_time = 20;
  atlases[3].summary.begin_time = 10;
  EXPECT_THAT(Sorted(atlases, {}), ElementsAre("m10", "m2", "bad", "late", "none"));
  EXPECT_THAT(Sorted(atlases, {{ListKey::kName}}), ElementsAre("bad", "late", "m2", "m10", "none"));
  EXPECT_THAT(Sorted(atlases, {{ListKey::kPoints, true}, {ListKey::kName}}),
              ElementsAre("late", "m2", "m10", "none", "bad"));
  EXPECT_THAT(Sorted(atlases, {{ListKey::kPoints}, {ListKey::kName, true}}),
              ElementsAre("none", "m10", "m2", "late", "bad"));
  EXPECT_THAT(Sorted(atlases, {{ListKey::kDate}}), ElementsAre("late", "m10", "m2", "bad", "none"));
  EXPECT_THAT(Sorted(atlases, {{ListKey::kDate, true}}), ElementsAre("m10", "late", "m2", "bad", "none"));
  EXPECT_THAT(Sorted(atlases, {{ListKey::kSize}}), ElementsAre("bad", "m10", "m2", "late", "none"));
}

}  // namespace
}  // namespace slamdb
