// SPDX-License-Identifier: BSD-3-Clause
// Id maps as files of either kind.
#include <gmock/gmock.h>

#include "slamdb/edit/ids/renumber.h"
#include "tests/support/kind_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

// Two inputs: one with counters, an id above 2^53 and one that is not in the result.
std::vector<IdMap> TwoInputs() {
  IdMap a{.input = "a.osa"}, b{.input = "b.osa"};
  a[IdKind::kKeyFrame] = {{0, 10}, {7, 3}};
  a[IdKind::kPoint] = {{5, (std::uint64_t{1} << 53) + 1}, {6, kNoId}};
  a.counters_before = Counters{.map = 1, .frame = 2, .keyframe = 3, .map_point = 4, .camera = 5, .initial_keyframe = 6};
  a.counters_after =
      Counters{.map = 11, .frame = 12, .keyframe = 13, .map_point = 14, .camera = 15, .initial_keyframe = 16};
  b[IdKind::kMap] = {{0, 1}};
  return {a, b};
}

TEST(IdMapFile, IsTheSameInBothKinds) {
  const TemporaryFolder folder;
  const std::vector<IdMap> maps = TwoInputs();
  for (const char* name : {"ids.csv", "ids.json"}) {
    WriteIdMaps(maps, folder.Path(name));
    EXPECT_EQ(ReadFile(folder.Path(name)), IdMapsToText(maps, name));
    EXPECT_THAT(ReadIdMaps(folder.Path(name)), ElementsAreArray(maps)) << name;
  }
  EXPECT_THAT(ReadFile(folder.Path("ids.json")), HasSubstr("[5,\"9007199254740993\"],[6,null]"));
  EXPECT_THAT(ReadFile(folder.Path("ids.csv")), HasSubstr("a.osa,point,6,\n"));
}

TEST(IdMapFile, ReadsJsonOfEarlierVersions) {
  const auto maps = ParseIdMapsJson(R"({"inputs":[{"input":"","ids":{"point":[[5,9007199254740993],[6,null]]}}]})");
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_THAT(maps[0][IdKind::kPoint], ElementsAre(IdPair{5, 9007199254740993U}, IdPair{6, kNoId}));
}

TEST(IdMapFile, GivesTheIdsOfOneInput) {
  const TemporaryFolder folder;
  const std::string several = folder.Path("several.json"), one = folder.Path("one.csv");
  const std::vector<IdMap> maps = TwoInputs();
  WriteIdMaps(maps, several);
  WriteIdMaps({&maps[1], 1}, one);
  EXPECT_EQ(ReadIdMap(several, "b.osa"), maps[1]);
  EXPECT_EQ(ReadIdMap(one), maps[1]);
  EXPECT_EQ(KindOf([&] { return ReadIdMap(several); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { return ReadIdMap(several, "c.osa"); }), ErrorKind::kNotFound);
  EXPECT_EQ(KindOf([&] { return ReadIdMap(one, "c.osa"); }), ErrorKind::kNotFound);
}

TEST(IdMapFile, RefusesNumbersThatAreNoIds) {
  for (const char* pair : {"[5,-2]", "[5,1.5]", "[5,1e300]", "[5,6,7]", "[5]", "[5,\"x\"]", "[null,5]", "[5,true]"}) {
    const std::string json = std::string(R"({"inputs":[{"input":"","ids":{"point":[)") + pair + "]}}]}";
    EXPECT_EQ(KindOf([&] { return ParseIdMapsJson(json); }), ErrorKind::kDamaged) << pair;
  }
}

// The largest number of 32 bits means none in an .osa file: a camera of that id would be lost.
TEST(IdMapFile, HandsOutNoIdThatMeansNone) {
  IdMap ids;
  ids[IdKind::kCamera] = {{0, 0xffffffff}};
  Atlas atlas;
  atlas.cameras.push_back({.id = CameraId(0)});
  EXPECT_EQ(KindOf([&] { ApplyIdMap(atlas, ids); }), ErrorKind::kUsage);
  EXPECT_EQ(atlas.cameras[0].id, CameraId(0));
}

// A cell that is no id would stay an old one between new ones.
TEST(IdMapFile, ATableOfOtherCellsIsRefused) {
  IdMap ids;
  ids[IdKind::kKeyFrame] = {{4, 104}, {5, 105}};
  EXPECT_EQ(ApplyIdMapToCsv("keyframe,parent\n5,4\n4,\n", ids), "keyframe,parent\n105,104\n104,\n");
  EXPECT_EQ(KindOf([&] { return ApplyIdMapToCsv("keyframe,parent\n5,4.0\n", ids); }), ErrorKind::kDamaged);
  EXPECT_EQ(KindOf([&] { return ApplyIdMapToCsv("keyframe,parent\n5,foo\n", ids); }), ErrorKind::kDamaged);
}

TEST(IdMapFile, RefusesWhatIsNone) {
  const TemporaryFolder folder;
  EXPECT_EQ(KindOf([&] { return ReadIdMaps(folder.Path("none.json")); }), ErrorKind::kNotFound);
  EXPECT_EQ(KindOf([&] { return ReadIdMaps(folder.Make("a.csv", "x,y\n1,2\n")); }), ErrorKind::kDamaged);
  for (const char* json :
       {"{", "[]", R"({"inputs":[]})", R"({"inputs":[{"input":"a"}]})", R"({"inputs":[{"ids":{"moon":[[1,2]]}}]})",
        R"({"inputs":[{"ids":{"map":[["1x",2]]}}]})", R"({"inputs":[{"ids":{"map":[[1]]}}]})",
        R"({"inputs":[{"ids":{},"counters":{"next_map":[1,2]}}]})"})
    EXPECT_EQ(KindOf([&] { return ParseIdMapsJson(json); }), ErrorKind::kDamaged) << json;
  const std::vector<IdMap> maps = TwoInputs();
  const std::string there = folder.Make("there.json", "");
  EXPECT_EQ(KindOf([&] { WriteIdMaps(maps, there); }), ErrorKind::kAlreadyExists);
}

TEST(RenumberReport, CountsEachKind) {
  const RenumberReport report = SummaryOf(TwoInputs()[0]);
  ASSERT_EQ(report.kinds.size(), 2U);
  EXPECT_EQ(report.kinds[0].kind, IdKind::kKeyFrame);
  EXPECT_EQ(report.kinds[0].ids, 2U);
  EXPECT_EQ(report.kinds[0].changed, 2U);
  EXPECT_EQ(report.kinds[0].first, 3U);
  EXPECT_EQ(report.kinds[0].last, 10U);
  EXPECT_EQ(report.kinds[1].first, (std::uint64_t{1} << 53) + 1);
  IdMap gone;
  gone[IdKind::kPoint] = {{1, kNoId}};
  EXPECT_THAT(ToJson(SummaryOf(gone), {.input = "a", .output = "b"}), HasSubstr("\"first\": null"));
}

}  // namespace
}  // namespace slamdb
