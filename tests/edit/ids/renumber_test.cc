// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/ids/renumber.h"

#include <gmock/gmock.h>

#include "slamdb/edit/frame/transform.h"
#include "slamdb/edit/ids/origin.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/model/content.h"
#include "tests/edit/worlds.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StrEq;

const std::vector<IdKind> kAllKinds = {IdKind::kMap, IdKind::kKeyFrame, IdKind::kPoint, IdKind::kFrame,
                                       IdKind::kCamera};

// As a map looks after a while: ids with gaps, and ids of what is gone still named.
Atlas Worn(const World& world) {
  Atlas atlas = MakeWorld(world, 2);
  RenumberOptions apart{.kinds = kAllKinds, .offset = 7};
  Renumber(atlas, apart);
  IdMap gaps;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes)
      gaps[IdKind::kKeyFrame].push_back({keyframe.id.value(), 3 * keyframe.id.value()});
  ApplyIdMap(atlas, gaps);
  Map& map = atlas.maps.front();
  map.points.front().first_keyframe = 2;
  map.points.front().first_frame = 5;
  map.points.back().first_keyframe = -1;
  map.keyframes.back().origin_map = 3;
  map.points[1].origin_map = static_cast<std::uint32_t>(map.id.value());
  map.points[2].origin_map = 2;  // a map that is gone
  map.max_keyframe_id += 4;
  atlas.next_ids.keyframe += 100;
  atlas.next_ids.initial_keyframe = atlas.next_ids.keyframe;
  return atlas;
}

class RenumberWorld : public ::testing::TestWithParam<World> {};
INSTANTIATE_TEST_SUITE_P(All, RenumberWorld, ::testing::ValuesIn(kWorlds), NameOfWorld);

TEST_P(RenumberWorld, UndoGivesTheSameBytes) {
  const Atlas original = Worn(GetParam());
  for (const RenumberOptions& options :
       {RenumberOptions{.kinds = kAllKinds},
        RenumberOptions{.kinds = kAllKinds, .start = 1000, .order = IdOrder::kTime},
        RenumberOptions{.order = IdOrder::kAsIs}, RenumberOptions{.kinds = kAllKinds, .offset = 12345},
        RenumberOptions{.kinds = {IdKind::kKeyFrame}, .offset = -20}}) {
    Atlas atlas = original;
    const IdMap ids = Renumber(atlas, options);
    EXPECT_NE(FirstDifference(atlas, original), "");
    ApplyIdMap(atlas, Inverse(ids), 1);
    EXPECT_THAT(atlas, EqualsAtlas(original));
  }
}

TEST_P(RenumberWorld, DenseIdsLeaveASoundAtlas) {
  Atlas atlas = Worn(GetParam());
  const auto before = ContentHash(atlas.maps.front());
  const auto findings = TroubleCounts(atlas);
  Renumber(atlas, {.kinds = kAllKinds});
  EXPECT_EQ(TroubleCounts(atlas), findings);
  EXPECT_EQ(ContentHash(atlas.maps.front()), before);
  std::uint64_t next = 0;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) EXPECT_EQ(keyframe.id.value(), next++);
  EXPECT_GT(atlas.next_ids.keyframe, next);  // those gone are behind those that are there
  EXPECT_LE(atlas.next_ids.keyframe, next + 3);
}

TEST_P(RenumberWorld, TablesGoThroughCsv) {
  Atlas atlas = Worn(GetParam());
  IdMap ids = Renumber(atlas, {.kinds = kAllKinds, .start = 3});
  ids.input = "a, \"b\".osa";
  EXPECT_THAT(ParseIdMapsCsv(IdMapsToCsv({&ids, 1})), ElementsAre(ids));
}

TEST_P(RenumberWorld, CommutesWithMerge) {
  const Atlas a = MakeWorld(GetParam(), 1, 1);
  Atlas b = MakeWorld(GetParam(), 2, 1);
  for (Map& map : b.maps)
    for (std::size_t i = 0; i < map.points.size(); i += 2)
      map.points[i].origin_map = static_cast<std::uint32_t>(i % 4 / 2);
  Atlas dense_b = b;
  Renumber(dense_b, {.kinds = kAllKinds, .start = 50});
  MergeResult merged = MergeAtlases({a, dense_b}, {}), plain = MergeAtlases({a, b}, {});
  Renumber(merged.atlas, {.kinds = kAllKinds});
  Renumber(plain.atlas, {.kinds = kAllKinds});
  merged.atlas.next_ids = plain.atlas.next_ids;
  EXPECT_THAT(merged.atlas, EqualsAtlas(plain.atlas));
}

TEST_P(RenumberWorld, CommutesWithTransformAndOrigins) {
  const Similarity3d turn{1, Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ())), {1, 2, 3}};
  const RenumberOptions options{.kinds = kAllKinds, .start = 20};
  const auto change = [&](Atlas& atlas) {
    for (Map& map : atlas.maps) TransformMap(map, turn);
    ReassignOrigins(atlas, {.from_map = true});
  };
  Atlas before = MakeWorld(GetParam(), 2), after = before;
  change(before);
  Renumber(before, options);
  Renumber(after, options);
  change(after);
  EXPECT_THAT(before, EqualsAtlas(after));
}

TEST_P(RenumberWorld, CommutesWithTakingAPart) {
  const RenumberOptions options{.kinds = {IdKind::kKeyFrame, IdKind::kPoint}, .offset = 31};
  const auto halve = [&](Atlas& atlas) {
    Subset subset = Subset::Everything(atlas);
    std::fill_n(subset.maps[0].keyframes.begin(), 6, std::uint8_t{0});
    SettleBorder(AtlasIndex(atlas), Border::kStrict, subset);
    KeepSubset(atlas, subset);
  };
  Atlas before = MakeWorld(GetParam(), 1), after = before;
  halve(before);
  Renumber(before, options);
  Renumber(after, options);
  halve(after);
  EXPECT_THAT(before, EqualsAtlas(after));
}

TEST_P(RenumberWorld, AnyPermutationCanBeUndoneAtAnyNumberOfThreads) {
  const Atlas original = MakeWorld(GetParam(), 2);
  IdMap reverse;
  for (const Map& map : original.maps)
    for (const KeyFrame& keyframe : map.keyframes)
      reverse[IdKind::kKeyFrame].push_back({keyframe.id.value(), original.next_ids.keyframe - 1 - keyframe.id.value()});
  Atlas once = original, threaded = original;
  ApplyIdMap(once, reverse, 1);
  ApplyIdMap(threaded, reverse, 4);
  EXPECT_THAT(threaded, EqualsAtlas(once));
  EXPECT_EQ(once.maps[0].keyframes[0].id.value(), original.next_ids.keyframe - 1);
  for (const KeyFrame& keyframe : once.maps[0].keyframes)
    EXPECT_TRUE(std::ranges::is_sorted(keyframe.connections, {}, &Connection::keyframe));
  ApplyIdMap(once, Inverse(reverse));
  EXPECT_THAT(once, EqualsAtlas(original));
}

// The origin of a point goes along with the map that it names; none stays none.
TEST(Renumber, MovesOriginsOfPoints) {
  Atlas atlas = MakeWorld(kWorlds[0], 2);
  atlas.maps[0].points[0].origin_map = 1;
  Renumber(atlas, {.kinds = {IdKind::kMap}, .offset = 10});
  EXPECT_EQ(atlas.maps[0].points[0].origin_map, 11U);
  EXPECT_EQ(atlas.maps[0].points[1].origin_map, MapPoint::kNoOrigin);
}

TEST(Renumber, OrderOfTime) {
  Atlas atlas = MakeWorld(kWorlds[0], 1);
  Map& map = atlas.maps[0];
  std::ranges::reverse(map.keyframes);
  for (KeyFrame& keyframe : map.keyframes) keyframe.timestamp = -keyframe.timestamp;
  const IdMap ids = PlanRenumbering(atlas, {.kinds = {IdKind::kKeyFrame}, .order = IdOrder::kTime});
  const std::uint64_t last = map.keyframes.size() - 1;
  for (const IdPair& pair : ids[IdKind::kKeyFrame]) EXPECT_EQ(pair.after, last - pair.before);
  EXPECT_EQ(ids.counters_after->keyframe, last + 1);
}

TEST(Renumber, RefusesMapsThatDoNotFitAndChangesNothing) {
  const Atlas original = MakeWorld(kWorlds[0], 1);
  const auto apply = [&](const std::vector<IdPair>& pairs) {
    Atlas atlas = original;
    IdMap ids;
    ids[IdKind::kKeyFrame] = pairs;
    const std::string error = ErrorOf([&] { ApplyIdMap(atlas, ids); });
    EXPECT_THAT(atlas, EqualsAtlas(original));
    return error;
  };
  std::vector<IdPair> pairs;
  for (const KeyFrame& keyframe : original.maps[0].keyframes)
    pairs.push_back({keyframe.id.value(), keyframe.id.value()});
  auto twice = pairs;
  twice[1].after = twice[0].after;
  EXPECT_THAT(apply(twice), HasSubstr("twice"));
  twice = pairs;
  twice[1].before = twice[0].before;
  EXPECT_THAT(apply(twice), HasSubstr("twice"));
  auto unknown = pairs;
  unknown.pop_back();
  EXPECT_THAT(apply(unknown), HasSubstr("does not name keyframe"));
  auto left_out = pairs;
  left_out[0].after = kNoId;
  EXPECT_THAT(apply(left_out), HasSubstr("no new id"));
}

TEST(Renumber, RefusesIdsThatAreThereTwice) {
  Atlas atlas = MakeWorld(kWorlds[0], 2);
  atlas.maps[1].keyframes[0].id = atlas.maps[0].keyframes[0].id;
  EXPECT_THAT(ErrorOf([&] { Renumber(atlas, {}); }), HasSubstr("more than once"));
}

TEST(Renumber, RefusesNegativeAndHugeIds) {
  Atlas atlas = MakeWorld(kWorlds[0], 1);
  EXPECT_THAT(ErrorOf([&] { Renumber(atlas, {.offset = -1}); }), HasSubstr("negative"));
  EXPECT_THAT(ErrorOf([&] { Renumber(atlas, {.kinds = {IdKind::kKeyFrame}, .start = std::uint64_t{1} << 31}); }),
              HasSubstr("at most 2147483647"));
}

TEST(IdMapCsv, ReadsWhatAPersonWrites) {
  const auto maps = ParseIdMapsCsv("kind,old,new\r\nkeyframe,3,0\r\nkeyframe,1,5\r\n\r\nmap,0,2\r\n");
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_THAT(maps[0][IdKind::kKeyFrame], ElementsAre(IdPair{1, 5}, IdPair{3, 0}));
  EXPECT_THAT(maps[0][IdKind::kMap], ElementsAre(IdPair{0, 2}));
  EXPECT_FALSE(maps[0].counters_before);
}

TEST(IdMapCsv, ReadsEveryDialect) {
  for (const char* csv : {"\xef\xbb\xbf"
                          "Kind;Old;New\r\nkeyframe;+3;0\r\n",
                          "new\told\tkind\n0\t3\tkeyframe", "# by hand\nkind old new\nkeyframe  3  0\n",
                          "kind, old, new\n\"keyframe\", \"3\", 0\n"}) {
    const auto maps = ParseIdMapsCsv(csv);
    ASSERT_EQ(maps.size(), 1U) << csv;
    EXPECT_THAT(maps[0][IdKind::kKeyFrame], ElementsAre(IdPair{3, 0})) << csv;
  }
}

TEST(IdMapCsv, KeepsAnyName) {
  for (const char* name : {"", "a.osa", " a b\t", "#1.osa", "%1.osa", "a;b", "\"", "a \"b\",\r\nc;d.osa"}) {
    IdMap ids;
    ids.input = name;
    ids[IdKind::kPoint] = {{0, std::uint64_t{1} << 63}};
    EXPECT_THAT(ParseIdMapsCsv(IdMapsToCsv({&ids, 1})), ElementsAre(ids)) << name;
  }
}

TEST(IdMapCsv, NamesTheLineThatIsWrong) {
  const auto error = [](const char* csv) { return ErrorOf([&] { return ParseIdMapsCsv(csv); }); };
  EXPECT_THAT(error("a,b\n"), HasSubstr("line 1: expected the column names"));
  EXPECT_THAT(error("kind,old,new\nkeyframe,1\n"), HasSubstr("line 2: expected 3 cells, found 2"));
  EXPECT_THAT(error("kind,old,new\nkeyframe,1,x\n"), HasSubstr("line 2: expected an id, found 'x'"));
  EXPECT_THAT(error("kind,old,new\nkeyframe,-1,2\n"), HasSubstr("line 2: expected an id, found '-1' in column old"));
  EXPECT_THAT(error("1,2,3\n"), HasSubstr("line 1: expected the column names"));
  EXPECT_THAT(error("kind,old,new\nfish,1,2\n"), HasSubstr("unknown kind 'fish'"));
  EXPECT_THAT(error("kind,old,new\n"), HasSubstr("empty"));
}

// Cut between two lines it is a table, too, of fewer counters.
TEST(IdMapCsv, WithSomeCountersAndNotAllIsRefused) {
  IdMap ids;
  ids[IdKind::kKeyFrame] = {{0, 10}};
  ids.counters_before = ids.counters_after = Counters{.map = 1, .frame = 2, .keyframe = 3};
  std::string table = IdMapsToCsv({&ids, 1});
  const auto fields = CounterFields();
  for (std::size_t left = fields.size() - 1; left > 0; --left) {
    table.erase(table.rfind('\n', table.size() - 2) + 1);
    EXPECT_THAT(ErrorOf([&] { return ParseIdMapsCsv(table); }),
                HasSubstr("and none " + std::string(fields[left].name) + ";"))
        << table;
  }
  table.erase(table.rfind('\n', table.size() - 2) + 1);
  EXPECT_FALSE(ParseIdMapsCsv(table).at(0).counters_before) << "as a person writes it";
}

TEST(IdMapCsv, ChangesTheIdsOfATable) {
  IdMap ids;
  ids[IdKind::kKeyFrame] = {{1, 10}, {2, 20}};
  EXPECT_EQ(ApplyIdMapToCsv("map,id,timestamp,parent,note\n0,1,1.5,,\"a,1\"\n0,2,2.5,1,2\n", ids),
            "map,id,timestamp,parent,note\n0,10,1.5,,\"a,1\"\n0,20,2.5,10,2\n");
  EXPECT_THAT(ErrorOf([&] { return ApplyIdMapToCsv("x,y\n1,2\n", ids); }), HasSubstr("no column of ids"));
}

TEST(IdMapCsv, LeavesAllElseOfATableAsItIs) {
  IdMap ids;
  ids[IdKind::kKeyFrame] = {{1, 10}, {2, 20}};
  EXPECT_EQ(ApplyIdMapToCsv("\xef\xbb\xbf# mine\r\nKeyframe ; note\r\n\r\n 1 ; 1\r\n\"2\";\"2;\n\"\"\"\r\n;1", ids),
            "\xef\xbb\xbf# mine\r\nKeyframe ; note\r\n\r\n 10 ; 1\r\n\"20\";\"2;\n\"\"\"\r\n;1");
  EXPECT_THAT(ErrorOf([&] { return ApplyIdMapToCsv("keyframe,x\n1,2\n3,4\n", ids); }),
              HasSubstr("line 3: keyframe 3 is not in the id map"));
}

}  // namespace
}  // namespace slamdb
