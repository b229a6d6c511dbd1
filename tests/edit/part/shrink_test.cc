// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/shrink.h"

#include <gmock/gmock.h>

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
Atlas Views(const std::vector<std::vector<std::uint64_t>>& views, std::size_t points) {
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
      keyframe.features.right_x.push_back(1);  // with depth, so that one observer is enough
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
    EXPECT_EQ(atlas.maps.size(), 1U);
    EXPECT_EQ(KeyFrames(atlas), keyframes / static_cast<std::size_t>(kind.maps));
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

// The preset cuts twice: all but one map, then all but some keyframes of it.
TEST(Shrink, ReportsWhatBothCutsTook) {
  Atlas atlas =
      SynthesizeAtlas({.sensor = Sensor::kStereo, .maps = 2, .keyframes = 10, .points = 120, .features = 100});
  for (Map& map : atlas.maps) map.landmarks.resize(3);
  const EntityCounts before = CountEntities(atlas);
  const ShrinkReport report = Shrink(atlas, {.target_keyframes = 4, .for_localization = true});
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

}  // namespace
}  // namespace slamdb::testing
