// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/import/detail/complete.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "slamdb/formats/formats.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/edit/soundness.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

// What formats of other programs hold: poses, cameras, keypoints, which point they see, positions.
Atlas Bare(const Atlas& atlas) {
  Atlas bare = atlas;
  bare.next_ids = {};
  for (Map& map : bare.maps) {
    map.initial_keyframe = map.first_keyframe = map.lowest_keyframe = {};
    map.max_keyframe_id = 0;
    map.origins.clear();
    for (KeyFrame& keyframe : map.keyframes) {
      keyframe.connections.clear();
      keyframe.children.clear();
      keyframe.parent = {};
      keyframe.features.grid = keyframe.features.right_grid = {};
      keyframe.features.bag_of_words = {};
      keyframe.features.feature_vector = {};
      keyframe.intrinsics.inverse_fx = keyframe.intrinsics.inverse_fy = 0;
      keyframe.calibration_matrix.setIdentity();
    }
    for (MapPoint& point : map.points) {
      MapPoint left;
      left.id = point.id;
      left.position = point.position;
      left.descriptor_form = MatrixForm::kEmpty;
      point = left;
    }
  }
  return bare;
}

class Complete : public ::testing::TestWithParam<SyntheticOptions> {};

TEST_P(Complete, GivesBackWhatCanBeDerived) {
  const Atlas atlas = SynthesizeAtlas(GetParam());
  for (const int threads : {1, 3}) {
    Atlas bare = Bare(atlas);
    Notices notices;
    detail::CompleteAtlas(bare, "a test", threads, notices);
    for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
      const Map &map = atlas.maps[row], &made = bare.maps[row];
      for (std::size_t i = 0; i < map.points.size(); ++i) {
        EXPECT_EQ(made.points[i].observations, map.points[i].observations);
        EXPECT_EQ(made.points[i].observation_count, map.points[i].observation_count);
        EXPECT_EQ(made.points[i].descriptor, map.points[i].descriptor);
        EXPECT_EQ(made.points[i].reference, map.points[i].reference);
        EXPECT_LT((made.points[i].normal - map.points[i].normal).norm(), 1e-4);
        EXPECT_NEAR(made.points[i].max_distance, map.points[i].max_distance, 1e-3 * map.points[i].max_distance);
      }
      for (std::size_t i = 0; i < map.keyframes.size(); ++i) {
        EXPECT_EQ(made.keyframes[i].features.grid, map.keyframes[i].features.grid);
        EXPECT_EQ(made.keyframes[i].features.right_grid, map.keyframes[i].features.right_grid);
        EXPECT_EQ(made.keyframes[i].intrinsics, map.keyframes[i].intrinsics);
        // ORB-SLAM3 counts a point that both eyes of a fisheye pair see twice; made atlases count it once.
        if (GetParam().sensor != Sensor::kFisheyeStereo) {
          EXPECT_EQ(made.keyframes[i].connections, map.keyframes[i].connections);
        }
      }
      EXPECT_EQ(made.max_keyframe_id, map.max_keyframe_id);
      EXPECT_EQ(made.first_keyframe, map.first_keyframe);
      EXPECT_EQ(made.origins, map.origins);
    }
    EXPECT_THAT(testing::Troubles(bare), IsEmpty());
    const TemporaryFolder folder;
    std::size_t keyframes = 0;
    for (const Map& map : atlas.maps) keyframes += map.keyframes.size();
    EXPECT_EQ(testing::KeyFramesThatBoostReads(bare, folder / "a.osa"), keyframes);
    ASSERT_EQ(notices.items().size(), 1U);
    EXPECT_THAT(notices.items()[0].text, HasSubstr("derived, since a test keeps none: observations of points"));
    EXPECT_THAT(notices.items()[0].text, HasSubstr("bags of words stay empty"));
  }
}

INSTANTIATE_TEST_SUITE_P(Sensors, Complete, ::testing::ValuesIn(testing::SensorKinds()));

TEST(CompleteAtlas, LeavesAWholeOneAsItIs) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 10, .points = 200, .features = 150});
  Atlas whole = atlas;
  Notices notices;
  detail::CompleteAtlas(whole, "a test", 1, notices);
  EXPECT_EQ(EncodeAtlas(whole, {.format = "ndjson"}), EncodeAtlas(atlas, {.format = "ndjson"}));
  EXPECT_THAT(notices.items(), IsEmpty());
}

TEST(CompleteAtlas, MakesSlotsOfObservations) {
  const Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kFisheyeStereo, .keyframes = 10, .points = 200});
  Atlas bare = atlas;
  for (KeyFrame& keyframe : bare.maps[0].keyframes) keyframe.features.map_points.clear();
  Notices notices;
  detail::CompleteAtlas(bare, "a test", 1, notices);
  for (std::size_t i = 0; i < atlas.maps[0].keyframes.size(); ++i)
    EXPECT_EQ(bare.maps[0].keyframes[i].features.map_points, atlas.maps[0].keyframes[i].features.map_points);
}

TEST(CompleteAtlas, FreesKeypointsThatAreOnePointTwice) {
  Atlas atlas = Bare(SynthesizeAtlas({.keyframes = 4, .points = 60, .features = 80}));
  Column<MapPointId>& slots = atlas.maps[0].keyframes[1].features.map_points;
  const auto first = std::ranges::find_if(slots, [](MapPointId id) { return id.has_value(); });
  const auto second = std::find_if(first + 1, slots.end(), [](MapPointId id) { return id.has_value(); });
  *second = *first;
  Notices notices;
  detail::CompleteAtlas(atlas, "a test", 1, notices);
  EXPECT_FALSE(second->has_value());
  EXPECT_THAT(notices.items().front().text, HasSubstr("1 keypoint"));
  EXPECT_THAT(testing::Troubles(atlas), IsEmpty());
}

// Of other programs anything may come.
TEST(CompleteAtlas, BearsWhatMakesNoSense) {
  Atlas atlas = Bare(SynthesizeAtlas({.maps = 2, .keyframes = 6, .points = 80, .features = 100}));
  Map& map = atlas.maps[0];
  map.keyframes[2].features.undistorted[3].x = std::numeric_limits<float>::quiet_NaN();
  map.keyframes[2].features.undistorted[4].x = 3e38F;
  map.keyframes[2].bounds = {};
  map.keyframes[3].id = {};
  map.keyframes[4].features.keypoints.clear();
  map.keyframes[4].features.undistorted.clear();
  map.keyframes[5].features.map_points[0] = MapPointId(std::uint64_t{1} << 60);
  map.points[1].position.setConstant(std::numeric_limits<float>::infinity());
  map.points[2].id = map.points[3].id;
  atlas.maps[1].keyframes.clear();
  Notices notices;
  detail::CompleteAtlas(atlas, "a test", 2, notices);
  EXPECT_LE(map.keyframes[2].bounds.max_x, 1 << 20);
  EXPECT_GT(map.keyframes[2].bounds.max_x, 0);
}

}  // namespace
}  // namespace slamdb
