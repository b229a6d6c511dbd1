// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/merge.h"

#include <gmock/gmock.h>

#include "slamdb/edit/ids/renumber.h"
#include "tests/edit/worlds.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const RenumberOptions kDense{
    .kinds = {IdKind::kMap, IdKind::kKeyFrame, IdKind::kPoint, IdKind::kFrame, IdKind::kCamera}};

// The maps of an atlas from `begin` on, as an atlas of their own with dense ids and without counters.
Atlas Part(const Atlas& atlas, std::size_t begin, std::size_t count) {
  Atlas part = atlas;
  part.maps.assign(atlas.maps.begin() + static_cast<std::ptrdiff_t>(begin),
                   atlas.maps.begin() + static_cast<std::ptrdiff_t>(begin + count));
  Renumber(part, kDense);
  part.next_ids = {};
  return part;
}

class MergeWorld : public ::testing::TestWithParam<World> {};
INSTANTIATE_TEST_SUITE_P(All, MergeWorld, ::testing::ValuesIn(kWorlds), NameOfWorld);

TEST_P(MergeWorld, SplittingGivesBackTheParts) {
  const Atlas a = MakeWorld(GetParam(), 2, 1), b = MakeWorld(GetParam(), 1, 2), c = MakeWorld(GetParam(), 1, 3);
  const MergeResult merged = MergeAtlases({a, b, c}, {});
  ASSERT_THAT(merged.atlas.maps, SizeIs(4));
  EXPECT_THAT(Part(merged.atlas, 0, 2), EqualsAtlas(Part(a, 0, 2)));
  EXPECT_THAT(Part(merged.atlas, 2, 1), EqualsAtlas(Part(b, 0, 1)));
  EXPECT_THAT(Part(merged.atlas, 3, 1), EqualsAtlas(Part(c, 0, 1)));
}

TEST_P(MergeWorld, IsSoundAndKeepsTheFirstAsItIs) {
  const Atlas a = MakeWorld(GetParam(), 1, 1), b = MakeWorld(GetParam(), 1, 2);
  const MergeResult merged = MergeAtlases({a, b}, {.threads = 4});
  EXPECT_THAT(TroubleCounts(merged.atlas), IsEmpty());
  EXPECT_THAT(merged.report.same_maps, IsEmpty());
  Atlas first = merged.atlas;
  first.maps.pop_back();
  first.next_ids = a.next_ids;
  EXPECT_THAT(first, EqualsAtlas(a));
  ContentCounts sum = CountContent(a);
  sum += CountContent(b);
  sum -= merged.report.left_out;
  EXPECT_EQ(merged.report.result, sum);
  EXPECT_EQ(CountContent(merged.atlas), sum);
  EXPECT_THAT(MergeAtlases({a, b}, {.threads = 1}).atlas, EqualsAtlas(merged.atlas));
}

// Landmarks without a point have ids of their own.
TEST(Merge, TablesNameLandmarks) {
  Atlas atlas;
  Map& map = atlas.maps.emplace_back();
  map.id = MapId(0);
  map.landmarks.resize(2);
  map.landmarks[0].id = LandmarkId(4);
  const MergeResult merged = MergeAtlases({atlas, atlas}, {.id_maps = true});
  EXPECT_THAT(merged.report.id_maps.at(0)[IdKind::kPoint], ElementsAre(IdPair{4, 4}));
  const LandmarkId moved = merged.atlas.maps.at(1).landmarks.at(0).id;
  EXPECT_NE(moved, LandmarkId(4));
  EXPECT_THAT(merged.report.id_maps.at(1)[IdKind::kPoint], ElementsAre(IdPair{4, moved.value()}));
}

TEST_P(MergeWorld, TablesNameEveryId) {
  const Atlas a = MakeWorld(GetParam(), 1, 1), b = MakeWorld(GetParam(), 1, 2);
  const MergeResult merged = MergeAtlases({a, b}, {.id_maps = true});
  ASSERT_THAT(merged.report.id_maps, SizeIs(2));
  Atlas moved = b;
  ApplyIdMap(moved, merged.report.id_maps[1]);
  const Map &found = merged.atlas.maps[1], &expected = moved.maps[0];
  ASSERT_EQ(found.keyframes.size(), expected.keyframes.size());
  for (std::size_t row = 0; row < found.keyframes.size(); ++row) {
    EXPECT_EQ(found.keyframes[row].id, expected.keyframes[row].id);
    EXPECT_EQ(found.keyframes[row].connections, expected.keyframes[row].connections);
    EXPECT_EQ(found.keyframes[row].features.map_points, expected.keyframes[row].features.map_points);
    EXPECT_EQ(found.keyframes[row].origin_map, expected.keyframes[row].origin_map);
    EXPECT_EQ(found.keyframes[row].camera, expected.keyframes[row].camera);
  }
  for (const IdPair& pair : merged.report.id_maps[0][IdKind::kPoint]) EXPECT_EQ(pair.before, pair.after);
}

Atlas Small(std::uint64_t seed = 1) { return MakeWorld(kWorlds[4], 1, seed); }

// The same map as ORB-SLAM3 would save it again: other ids, other order of the lists.
Atlas SavedAgain(Atlas atlas) {
  Renumber(atlas, {.start = 500});
  std::ranges::reverse(atlas.maps[0].keyframes);
  std::ranges::reverse(atlas.maps[0].points);
  return atlas;
}

TEST(Merge, SameMapTwice) {
  const Atlas a = Small(), again = SavedAgain(a);
  const MergeResult both = MergeAtlases({a, again}, {});
  ASSERT_THAT(both.report.same_maps, SizeIs(1));
  EXPECT_FALSE(both.report.same_maps[0].left_out);
  EXPECT_THAT(both.atlas.maps, SizeIs(2));
  const MergeResult first = MergeAtlases({a, again}, {.same_map = SameMap::kKeepFirst, .id_maps = true});
  EXPECT_TRUE(first.report.same_maps.at(0).left_out);
  EXPECT_THAT(first.atlas.maps, SizeIs(1));
  EXPECT_EQ(first.report.left_out.keyframes, a.maps[0].keyframes.size());
  EXPECT_EQ(first.report.id_maps[1][IdKind::kKeyFrame].at(0).after, kNoId);
  EXPECT_THAT(TroubleCounts(first.atlas), IsEmpty());
  EXPECT_THAT(ErrorOf([&] {
                return MergeAtlases({a, again}, {.names = {"a", "b"}, .same_map = SameMap::kError});
              }),
              HasSubstr("b: its map 500 is map 0 of a again"));
}

TEST(Merge, AMapThatGrewIsAnotherOne) {
  const Atlas a = Small();
  Atlas grown = a;
  grown.maps[0].points[3].position.x() += 0.01F;
  EXPECT_THAT(MergeAtlases({a, grown}, {.same_map = SameMap::kError}).report.same_maps, IsEmpty());
}

TEST(Merge, DifferentVocabulariesAreRefused) {
  const Atlas a = Small(1);
  Atlas b = Small(2);
  b.vocabulary = {"other.txt", "0123456789abcdef0123456789abcdef"};
  EXPECT_THAT(ErrorOf([&] {
                return MergeAtlases({a, b}, {});
              }),
              HasSubstr("input 2: its bags of words are of vocabulary"));
  const MergeResult merged = MergeAtlases({a, b}, {.ignore_vocabulary = true});
  EXPECT_EQ(merged.atlas.vocabulary, a.vocabulary);
  EXPECT_THAT(merged.report.other_vocabularies, SizeIs(1));
}

TEST(Merge, CamerasAreUnifiedOrMoved) {
  const Atlas a = Small(1), same = Small(2);
  Atlas other = Small(3);
  other.cameras[0].parameters[0] += 1;
  const MergeResult merged = MergeAtlases({a, same, other}, {});
  ASSERT_THAT(merged.atlas.cameras, SizeIs(2));
  EXPECT_EQ(merged.report.left_out.cameras, 1U);
  EXPECT_EQ(merged.atlas.maps[1].keyframes[0].camera, a.cameras[0].id);
  EXPECT_EQ(merged.atlas.maps[2].keyframes[0].camera, merged.atlas.cameras[1].id);
  EXPECT_GT(merged.atlas.next_ids.camera, merged.atlas.cameras[1].id.value());
}

TEST(Merge, IdsThatDoNotMeetStay) {
  const Atlas a = Small(1);
  Atlas b = Small(2);
  Renumber(b, {.kinds = kDense.kinds, .offset = 100000});
  const MergeResult merged = MergeAtlases({a, b}, {});
  EXPECT_THAT(merged.report.inputs[1].shift, ::testing::Each(0U));
  EXPECT_EQ(merged.atlas.maps[1].keyframes[0].id, b.maps[0].keyframes[0].id);
}

TEST(Merge, NamesOfTheGoneDoNotMeetTheLiving) {
  const Atlas a = Small(1);
  Atlas b = Small(2);
  Renumber(b, {.kinds = {IdKind::kKeyFrame}, .offset = 1000});
  b.maps[0].points[0].first_keyframe = 3;   // culled long ago
  b.maps[0].points[1].first_keyframe = -1;  // made by a frame
  const MergeResult merged = MergeAtlases({a, b}, {});
  const std::int64_t first = merged.atlas.maps[1].points[0].first_keyframe;
  for (const Map& map : merged.atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) EXPECT_NE(static_cast<std::int64_t>(keyframe.id.value()), first);
  EXPECT_EQ(merged.atlas.maps[1].points[1].first_keyframe, -1);
}

TEST(Merge, DropsWhatListsRepeat) {
  const Atlas a = Small(1);
  Atlas b = Small(2);
  b.repeated_maps.push_back({1, 0, 0});
  const MergeResult merged = MergeAtlases({a, b}, {});
  EXPECT_EQ(merged.report.dropped_list_entries, 1U);
  EXPECT_THAT(merged.atlas.repeated_maps, IsEmpty());
}

TEST(Merge, NothingToMerge) {
  EXPECT_THAT(ErrorOf([] { return MergeAtlases({}, {}); }), HasSubstr("nothing to merge"));
}

}  // namespace
}  // namespace slamdb
