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
  // With 0 or 1 kept, the other would add three points to a place that is found by four.
  Atlas atlas = Views({{0, 1, 2, 3, 4, 5, 6}, {0, 1, 2, 3, 7, 8, 9}, {10, 11, 12}}, 13);
  Shrink(atlas, {.target_keyframes = 2, .min_points = 1});
  EXPECT_THAT(Ids(atlas), ElementsAre(0, 2));
}

// All that place 0 sees is kept whoever goes, but only 1 has it all: a camera is found by the points of one keyframe.
TEST(Shrink, CountsPointsOfOneKeyFrame) {
  const std::vector<std::vector<std::uint64_t>> views = {
      {0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 4, 5, 6}, {0, 1, 6, 7, 8, 9}, {2, 3, 7, 8, 9, 10}, {4, 5, 8, 9, 10, 11}};
  Atlas atlas = Views(views, 12);
  Shrink(atlas, {.target_keyframes = 2, .min_points = 3});
  EXPECT_THAT(Ids(atlas), ElementsAre(1, 3));
}

// Sees three points, but has every word that any keyframe has: who shares four fifths with a picture is not tried.
TEST(Shrink, TakesOutWhoStandsInTheWayOfOthers) {
  std::vector<std::vector<std::uint64_t>> views;
  for (std::uint64_t i = 0; i < 6; ++i) {
    views.emplace_back();
    for (std::uint64_t point = 10 * i; point < 10 * i + 30; ++point) views.back().push_back(point);
  }
  views.push_back({0, 1, 2});
  const Atlas plain = Views(views, 80);
  Atlas hidden = plain;
  for (std::uint32_t i = 0; i < 6; ++i) {
    Column<std::uint32_t>&words = hidden.maps[0].keyframes[i].features.bag_of_words.words,
    &all = hidden.maps[0].keyframes[6].features.bag_of_words.words;
    for (std::uint32_t word = 0; word < 40; ++word) {
      words.push_back(30 * i + word);
      if (all.empty() || all.back() < words.back()) all.push_back(words.back());
    }
  }
  // The last one hides the others where little is asked for, too.
  Atlas fewer = hidden;
  Shrink(fewer, {.target_keyframes = 6, .min_points = 5});
  EXPECT_THAT(Ids(fewer), ElementsAre(0, 1, 2, 3, 4, 5));
  Atlas half = hidden;
  Shrink(half, {.target_keyframes = 3, .min_points = 5});
  EXPECT_THAT(Ids(half), ::testing::Not(::testing::Contains(6U)));
}

// What pictures show decides between keyframes that have recorded the same.
TEST(Shrink, CountsWhatPicturesShow) {
  const std::vector<std::vector<std::uint64_t>> views = {{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}};
  for (const std::uint32_t shown : {0U, 4U, 8U}) {
    Atlas atlas = Views(views, 12);
    const PointsShown places(3, {shown, shown + 1, shown + 2, shown + 3, 99});  // 99: there is no such row
    bool looked = false;
    Shrink(atlas, {.target_keyframes = 1, .min_points = 2, .looks = {.before = [&](const Atlas&) {
                                                             looked = true;
                                                             return std::vector<PointsShown>{places};
                                                           }}});
    EXPECT_TRUE(looked);
    EXPECT_THAT(Ids(atlas), ElementsAre(shown / 4));
  }
}

TEST(Shrink, LooksOnlyWhereThereIsAChoice) {
  const Atlas whole = SynthesizeAtlas({.keyframes = 10, .points = 300, .features = 200});
  const auto fails = [](const Atlas&) -> std::vector<PointsShown> { throw Error(ErrorKind::kUsage, "looked"); };
  for (const ShrinkOptions& options :
       {ShrinkOptions{.for_localization = true}, ShrinkOptions{.largest_map = true},
        ShrinkOptions{.target_keyframes = 10}, ShrinkOptions{.target_bytes = FileBytes(whole) + 1000},
        ShrinkOptions{.target_bytes = FileBytes(whole) - 1000}}) {
    Atlas atlas = whole;
    ShrinkOptions looking = options;
    looking.looks.before = fails;
    EXPECT_NO_THROW(Shrink(atlas, looking));
    EXPECT_EQ(KeyFrames(atlas), 10U);
  }
}

// Points that one place alone shows go before keyframes, where bytes are asked for, and its keyframe shows enough
// others.
TEST(Shrink, TakesPointsThatOnePlaceShowsBeforeKeyFrames) {
  std::vector<std::vector<std::uint64_t>> views(4);
  for (std::uint64_t i = 0; i < 3; ++i) {
    for (std::uint64_t point = 0; point < 40; ++point) views[i].push_back(point);
    for (std::uint64_t point = 0; point < 30; ++point) views[i].push_back(40 + 30 * i + point);
  }
  for (std::uint64_t point = 130; point < 160; ++point)
    views[3].push_back(point);  // sees nothing in common with others
  Atlas atlas = Views(views, 160);
  const std::uint64_t target = detail::ArchiveBytes(atlas) - 60 * detail::ArchiveBytes(MapPoint());
  Shrink(atlas, {.target_bytes = target, .min_points = 10});
  EXPECT_THAT(Ids(atlas), ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(atlas.maps[0].points.size(), 70U);
}

// Features that see no point go before any keyframe does, unless the map is to be extended.
TEST(Shrink, TakesWhatLocalizingNeedsNotFirst) {
  for (const SyntheticOptions& kind : SensorKinds()) {
    SCOPED_TRACE(NameOf(kind));
    const Atlas whole = SynthesizeAtlas(kind);
    Atlas preset = whole;
    Shrink(preset, {.for_localization = true});
    Atlas lean = whole, mapping = whole;
    const std::uint64_t target = (FileBytes(preset) + FileBytes(whole)) / 2;
    const ShrinkReport less = Shrink(lean, {.target_bytes = target});
    EXPECT_THAT(lean, EqualsAtlas(preset));
    EXPECT_GT(less.features_dropped, 0U);
    const ShrinkReport whole_keyframes = Shrink(mapping, {.target_bytes = target, .for_mapping = true});
    EXPECT_EQ(whole_keyframes.features_dropped + whole_keyframes.measurements_dropped, 0U);
    EXPECT_LT(KeyFrames(mapping), KeyFrames(whole));
    EXPECT_LE(FileBytes(mapping), target + 1000);
  }
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
  Atlas none = atlas;
  EXPECT_THAT([&] { Shrink(none, {.target_keyframes = 0}); }, ThrowsMessage<Error>(HasSubstr("no keyframe may be")));
  EXPECT_THAT([&] { Shrink(atlas, {.for_localization = true, .for_mapping = true}); },
              ThrowsMessage<Error>(HasSubstr("either for localization or for mapping")));
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

// ---- never less than keyframes at equal distances

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

// How many keyframes see 50 points of one keyframe of a subset that stay, with a border that is settled.
std::uint64_t FoundBy(const Atlas& atlas, const Subset& kept) {
  const AtlasIndex index(atlas);
  std::uint64_t found = 0;
  for (std::size_t map = 0; map < atlas.maps.size(); ++map) {
    const std::size_t count = atlas.maps[map].keyframes.size();
    std::vector<std::vector<std::size_t>> shared(count, std::vector<std::size_t>(count, 0));
    for (std::size_t row = 0; row < atlas.maps[map].points.size(); ++row) {
      if (!kept.maps[map].points[row]) continue;
      const auto& observations = atlas.maps[map].points[row].observations;
      for (const Observation& place : observations)
        for (const Observation& by : observations)
          ++shared.at(index.KeyFrameRow(map, place.keyframe)).at(index.KeyFrameRow(map, by.keyframe));
    }
    for (std::size_t place = 0; place < count; ++place)
      for (std::size_t by = 0; by < count; ++by)
        if (kept.maps[map].keyframes[by] && shared[place][by] >= kPointsToLocalize) {
          ++found;
          break;
        }
  }
  return found;
}

std::uint64_t FoundBy(const Atlas& atlas, const std::vector<EntityRow>& keyframes) {
  Subset kept = Subset::Everything(atlas);
  for (Subset::MapRows& map : kept.maps) std::ranges::fill(map.keyframes, std::uint8_t{0});
  for (const EntityRow& keyframe : keyframes) kept.maps[keyframe.map].keyframes[keyframe.row] = 1;
  SettleBorder(AtlasIndex(atlas), Border::kStrict, kept);
  return FoundBy(atlas, kept);
}

class RealAtlasBudget : public ::testing::TestWithParam<const char*> {};
TEST_P(RealAtlasBudget, FindsNoLessThanEvenlySpacedKeyFrames) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Notices notices;
  const Atlas atlas = ReadOrbslam3(path, {}, notices);
  const std::vector<EntityRow> order = InOrder(atlas);
  std::uint64_t found = 0, found_spaced = 0;  // over all counts
  for (const std::size_t count : {2, 3, 5, 7, 10, 15, 20, 30, 50, 80, 120}) {
    if (count >= order.size()) break;
    std::vector<EntityRow> spaced;
    for (std::size_t i = 0; i < count; ++i) spaced.push_back(order[i * order.size() / count]);
    Atlas small = atlas;
    Shrink(small, {.target_keyframes = count});
    EXPECT_LE(KeyFrames(small), count);
    std::vector<EntityRow> kept;
    for (const EntityRow& keyframe : order)
      for (const Map& map : small.maps)
        if (map.id == atlas.maps[keyframe.map].id &&
            std::ranges::find(map.keyframes, atlas.maps[keyframe.map].keyframes[keyframe.row].id, &KeyFrame::id) !=
                map.keyframes.end())
          kept.push_back(keyframe);
    found += FoundBy(atlas, kept);
    found_spaced += FoundBy(atlas, spaced);
  }
  EXPECT_GE(found, found_spaced);
}
INSTANTIATE_TEST_SUITE_P(Files, RealAtlasBudget, ::testing::ValuesIn(kRealAtlases));

}  // namespace
}  // namespace slamdb::testing
