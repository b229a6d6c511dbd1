// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/shrink.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "slamdb/base/error.h"
#include "slamdb/edit/part/detail/archive_size.h"
#include "slamdb/edit/part/detail/free_features.h"
#include "tests/edit/soundness.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/equals_atlas.h"

namespace slamdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

std::size_t KeyFrames(const Atlas& atlas) {
  std::size_t count = 0;
  for (const Map& map : atlas.maps) count += map.keyframes.size();
  return count;
}

std::uint64_t FileBytes(Atlas atlas) {
  atlas.encoding = {};
  return EncodeOrbslam3(atlas).size();
}

TEST(ArchiveBytes, IsTheSizeOfTheFile) {
  for (const SyntheticOptions& kind : SensorKinds()) {
    const Atlas atlas = SynthesizeAtlas(kind);
    EXPECT_NEAR(static_cast<double>(detail::ArchiveBytes(atlas)), static_cast<double>(FileBytes(atlas)), 1000)
        << NameOf(kind);
  }
}

// Which keyframes see which points: a map by lists of points.
Atlas Views(const std::vector<std::vector<std::uint64_t>>& views, std::size_t points, bool depth = true) {
  Atlas atlas;
  Map& map = atlas.maps.emplace_back();
  map.id = MapId(0);
  map.first_keyframe = map.initial_keyframe = map.lowest_keyframe = KeyFrameId(0);
  for (std::uint64_t p = 0; p < points; ++p) map.points.emplace_back().id = MapPointId(p);
  for (const std::vector<std::uint64_t>& view : views) {
    KeyFrame& keyframe = map.keyframes.emplace_back();
    keyframe.id = KeyFrameId(map.keyframes.size() - 1);
    for (const std::uint64_t p : view) {
      map.points[p].observations.push_back({keyframe.id, static_cast<std::int32_t>(keyframe.features.count++), -1});
      map.points[p].reference = keyframe.id;
      keyframe.features.map_points.push_back(MapPointId(p));
      keyframe.features.right_x.push_back(depth ? 1 : -1);  // with depth one observer is enough
    }
  }
  return atlas;
}

std::vector<std::uint64_t> Ids(const Atlas& atlas) {
  std::vector<std::uint64_t> ids;
  for (const KeyFrame& keyframe : atlas.maps.at(0).keyframes) ids.push_back(keyframe.id.value());
  return ids;
}

TEST(Coverage, CountsPlacesWithEnoughKeptPoints) {
  const Atlas atlas = Views({{0, 1, 2}, {2, 3}, {4, 5}, {0}}, 6);
  Subset kept = Subset::Everything(atlas);
  kept.maps[0].keyframes = {1, 0, 0, 0};
  const Coverage coverage = MeasureCoverage(AtlasIndex(atlas), kept, 2);
  EXPECT_EQ(coverage.places, 4U);
  EXPECT_EQ(coverage.covered_before, 3U);
  EXPECT_EQ(coverage.covered, 1U);
  EXPECT_EQ(MeasureCoverage(AtlasIndex(atlas), kept, 1).covered, 3U);
}

TEST(Shrink, ChoosesWhatCoversMost) {
  // Two groups of places; 2 sees all of the first, 4 all of the second.
  const std::vector<std::vector<std::uint64_t>> views = {{0, 1}, {1, 2}, {0, 1, 2, 3}, {5, 6}, {5, 6, 7}};
  Atlas atlas = Views(views, 8);
  const ShrinkReport report = Shrink(atlas, {.target_keyframes = 2, .min_points = 2});
  EXPECT_THAT(Ids(atlas), ElementsAre(2, 4));
  EXPECT_EQ(report.coverage.covered, 5U);
  EXPECT_EQ(report.coverage.places, 5U);
  EXPECT_EQ(atlas.maps[0].first_keyframe, KeyFrameId(2));
}

TEST(Shrink, PrefersPlacesThatLackPointsToThoseThatHaveEnough) {
  // With 0 kept, 1 would add two points where places have enough; 2 adds one to a place that has none.
  Atlas atlas = Views({{0, 1, 2, 3}, {0, 1, 4, 5}, {6}}, 7);
  Shrink(atlas, {.target_keyframes = 2, .min_points = 1});
  EXPECT_THAT(Ids(atlas), ElementsAre(0, 2));
}

// Without depth a point that loses observers needs two that stay. The keyframes that see most, 0 and 1, see nothing in
// common; 2 and 3 do.
TEST(Shrink, ChoosesPairsThatSeeInCommonWithoutDepth) {
  const std::vector<std::vector<std::uint64_t>> views = {
      {0, 1, 2, 3, 4, 5}, {6, 7, 8, 9, 10, 11}, {12, 13, 14, 0}, {12, 13, 14, 6}, {1, 2, 3, 7, 8, 9}};
  Atlas atlas = Views(views, 15, /*depth=*/false);
  const ShrinkReport report = Shrink(atlas, {.target_keyframes = 2, .min_points = 3});
  EXPECT_EQ(report.coverage.covered, 2U);
  EXPECT_GE(report.removed.after.points, 3U);
  // The third completes what 0 and 1 have in common with it.
  Atlas more = Views(views, 15, /*depth=*/false);
  EXPECT_EQ(Shrink(more, {.target_keyframes = 3, .min_points = 3}).coverage.covered, 3U);
  EXPECT_THAT(Ids(more), ElementsAre(0, 1, 4));
}

TEST(Shrink, LeavesOutWhatIsBad) {
  Atlas atlas = Views({{0, 1, 2, 3}, {0, 1}, {2, 3}}, 4);
  atlas.maps[0].keyframes[0].bad = true;
  Shrink(atlas, {.target_keyframes = 2, .min_points = 2});
  EXPECT_THAT(Ids(atlas), ElementsAre(1, 2));
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) keyframe.bad = true;
  EXPECT_THAT([&] { Shrink(atlas, {.target_keyframes = 1}); }, ThrowsMessage<Error>(HasSubstr("all are flagged bad")));
}

TEST(Coverage, IsPoorBelowFourFifths) {
  EXPECT_FALSE((Coverage{.places = 12, .covered_before = 10, .covered = 8}.poor()));
  EXPECT_TRUE((Coverage{.places = 12, .covered_before = 10, .covered = 7}.poor()));
  EXPECT_FALSE((Coverage{.places = 12}.poor()));
}

TEST(Shrink, KeepsToTheSize) {
  for (const SyntheticOptions& kind : SensorKinds()) {
    const Atlas atlas = SynthesizeAtlas(kind);
    for (const std::uint64_t percent : {80, 40}) {
      SCOPED_TRACE(NameOf(kind) + " " + std::to_string(percent));
      Atlas small = atlas;
      const std::uint64_t target = FileBytes(atlas) * percent / 100;
      const ShrinkReport report = Shrink(small, {.target_bytes = target});
      EXPECT_LE(FileBytes(small), target + 1000);
      EXPECT_GE(FileBytes(small), target / 2);
      EXPECT_NEAR(static_cast<double>(report.bytes_after), static_cast<double>(FileBytes(small)), 1000);
      EXPECT_THAT(NewTroubles({}, small), IsEmpty());
    }
  }
}

TEST(Shrink, RefusesWhatCannotBe) {
  Atlas atlas = Views({{0, 1}, {1}}, 2);
  EXPECT_THAT([&] { Shrink(atlas, {}); }, ThrowsMessage<Error>(HasSubstr("say how small")));
  EXPECT_THAT([&] { Shrink(atlas, {.target_bytes = 500}); },
              ThrowsMessage<Error>(HasSubstr("below what one keyframe")));
  Atlas empty;
  EXPECT_THAT([&] { Shrink(empty, {.for_localization = true}); }, ThrowsMessage<Error>(HasSubstr("no map")));
}

TEST(Shrink, ForLocalizationKeepsEveryPlace) {
  const TemporaryFolder folder;
  for (const SyntheticOptions& kind : SensorKinds()) {
    SCOPED_TRACE(NameOf(kind));
    Atlas atlas = SynthesizeAtlas(kind), alone = atlas;
    const std::size_t keyframes = KeyFrames(atlas), points = atlas.maps[0].points.size();
    const ShrinkReport report = Shrink(atlas, {.for_localization = true});
    EXPECT_THAT(NewTroubles({}, atlas), IsEmpty());
    EXPECT_EQ(atlas.maps.size(), static_cast<std::size_t>(kind.maps));
    EXPECT_EQ(KeyFrames(atlas), keyframes);
    EXPECT_EQ(atlas.maps[0].points.size(), points);
    EXPECT_GT(report.features_dropped, 0U);
    EXPECT_EQ(report.measurements_dropped > 0, kind.inertial);
    EXPECT_LT(report.bytes_after, report.bytes_before);
    EXPECT_EQ(KeyFramesThatBoostReads(atlas, folder.Path("small.osa")), KeyFrames(atlas));
    Shrink(alone, {.for_localization = true, .threads = 1});
    EXPECT_THAT(alone, EqualsAtlas(atlas));
  }
}

TEST(DropFreeFeatures, TwiceIsOnce) {
  Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kFisheyeStereo, .keyframes = 12, .points = 260, .features = 200});
  EXPECT_GT(detail::DropFreeFeatures(atlas), 0U);
  Atlas again = atlas;
  EXPECT_EQ(detail::DropFreeFeatures(again), 0U);
  EXPECT_THAT(again, EqualsAtlas(atlas));
}

// Cuts twice: all but one map, then all but some keyframes of it.
TEST(Shrink, ReportsWhatBothCutsTook) {
  Atlas atlas =
      SynthesizeAtlas({.sensor = Sensor::kStereo, .maps = 2, .keyframes = 10, .points = 120, .features = 100});
  for (Map& map : atlas.maps) map.landmarks.resize(3);
  const EntityCounts before = CountEntities(atlas);
  const ShrinkReport report = Shrink(atlas, {.target_keyframes = 4, .for_localization = true, .largest_map = true});
  const EntityCounts after = CountEntities(atlas);
  EXPECT_EQ(report.removed.before, before);
  EXPECT_EQ(report.removed.after, after);
  EXPECT_EQ(report.removed.maps, 1U);
  EXPECT_EQ(report.removed.keyframes, before.keyframes - after.keyframes);
  EXPECT_EQ(report.removed.points, before.points - after.points);
  EXPECT_EQ(report.removed.landmarks, 3U);
  EXPECT_EQ(after.landmarks, 3U);
  EXPECT_GT(report.removed.observations, 0U);
}

class RealAtlasShrunk : public ::testing::TestWithParam<const char*> {};
TEST_P(RealAtlasShrunk, IsSoundAndCovers) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Notices notices;
  const Atlas atlas = ReadOrbslam3(path, {}, notices);
  const std::set<std::string> known = Troubles(atlas);
  for (const ShrinkOptions& options :
       {ShrinkOptions{.target_keyframes = KeyFrames(atlas) / 2}, ShrinkOptions{.target_bytes = FileBytes(atlas) / 3},
        ShrinkOptions{.for_localization = true}, ShrinkOptions{.target_keyframes = 10, .for_localization = true}}) {
    Atlas small = atlas;
    const ShrinkReport report = Shrink(small, options);
    EXPECT_THAT(NewTroubles(known, small), IsEmpty());
    EXPECT_NEAR(static_cast<double>(report.bytes_after), static_cast<double>(FileBytes(small)), 2000);
    EXPECT_TRUE(!options.target_bytes || FileBytes(small) <= *options.target_bytes + 1000);
    EXPECT_TRUE(options.target_keyframes.value_or(0) <= 10 ||
                report.coverage.covered * 20 >= report.coverage.covered_before * 19);
  }
}
INSTANTIATE_TEST_SUITE_P(Files, RealAtlasShrunk,
                         ::testing::Values("mono_dist", "stereo_inertial", "fisheye_stereo", "multimap_rgbd"));

// ---- never less than what needs no computing

// A keyframe by the rows of its map and in it, map by map, ascending by id.
std::vector<EntityRow> InOrder(const Atlas& atlas) {
  std::vector<EntityRow> order;
  for (std::uint32_t map = 0; map < atlas.maps.size(); ++map) {
    const auto& keyframes = atlas.maps[map].keyframes;
    const std::size_t first = order.size();
    for (std::uint32_t row = 0; row < keyframes.size(); ++row) order.push_back({map, row});
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(first), order.end(),
              [&](const EntityRow& a, const EntityRow& b) { return keyframes[a.row].id < keyframes[b.row].id; });
  }
  return order;
}

std::uint64_t CoveredBy(const AtlasIndex& index, const std::vector<EntityRow>& keyframes) {
  Subset kept = Subset::Everything(index.atlas());
  for (Subset::MapRows& map : kept.maps) std::ranges::fill(map.keyframes, std::uint8_t{0});
  for (const EntityRow& keyframe : keyframes) kept.maps[keyframe.map].keyframes[keyframe.row] = 1;
  SettleBorder(index, Border::kStrict, kept);
  return MeasureCoverage(index, kept).covered;
}

// What consecutive and evenly spaced keyframes cover at most, of up to 24 beginnings each.
std::uint64_t CoveredWithoutComputing(const AtlasIndex& index, const std::vector<EntityRow>& order, std::size_t count) {
  std::uint64_t most = 0;
  const std::size_t last = order.size() - count;
  for (std::size_t begin = 0; begin <= last; begin += std::max<std::size_t>(last / 24, 1)) {
    const auto from = order.begin() + static_cast<std::ptrdiff_t>(begin);
    most = std::max(most, CoveredBy(index, {from, from + static_cast<std::ptrdiff_t>(count)}));
  }
  std::vector<EntityRow> spread;
  for (std::size_t i = 0; i < count; ++i)
    spread.push_back(order[count == 1 ? 0 : i * (order.size() - 1) / (count - 1)]);
  most = std::max(most, CoveredBy(index, spread));
  const std::size_t step = order.size() / count;
  for (std::size_t begin = 0; begin < step; begin += std::max<std::size_t>(step / 24, 1)) {
    std::vector<EntityRow> cut, stepped;
    for (std::size_t i = 0; i < count; ++i) {
      cut.push_back(order[begin + i * order.size() / count]);
      stepped.push_back(order[begin + i * step]);
    }
    most = std::max({most, CoveredBy(index, cut), CoveredBy(index, stepped)});
  }
  return most;
}

// Of few keyframes no two cover more than the two that are kept, whichever they are.
TEST(Shrink, KeepsTheBestTwoOfFew) {
  const std::string path = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";
  Notices notices;
  const Atlas atlas = ReadOrbslam3(path, {}, notices);
  const AtlasIndex index(atlas);
  const std::vector<EntityRow> order = InOrder(atlas);
  std::uint64_t most = 0;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) most = std::max(most, CoveredBy(index, {order[i], order[j]}));
  Atlas small = atlas;
  EXPECT_EQ(Shrink(small, {.target_keyframes = 2}).coverage.covered, most);
  EXPECT_GE(most, 12U);
}

class RealAtlasBudget : public ::testing::TestWithParam<const char*> {};
TEST_P(RealAtlasBudget, CoversNoLessThanConsecutiveOrEvenlySpacedKeyFrames) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Notices notices;
  const Atlas atlas = ReadOrbslam3(path, {}, notices);
  const AtlasIndex index(atlas);
  const std::vector<EntityRow> order = InOrder(atlas);
  for (const std::size_t count : {1, 2, 3, 4, 5, 7, 10, 15, 20, 30, 50, 80, 120}) {
    if (count >= order.size()) break;
    Atlas small = atlas;
    const Coverage coverage = Shrink(small, {.target_keyframes = count}).coverage;
    EXPECT_EQ(KeyFrames(small), count);
    EXPECT_GE(coverage.covered, CoveredWithoutComputing(index, order, count)) << count << " keyframes";
    EXPECT_EQ(MeasureCoverage(AtlasIndex(small), Subset::Everything(small)).places, count);
  }
}
INSTANTIATE_TEST_SUITE_P(Files, RealAtlasBudget, ::testing::ValuesIn(kRealAtlases));

}  // namespace
}  // namespace slamdb::testing
