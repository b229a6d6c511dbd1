// SPDX-License-Identifier: BSD-3-Clause
// Counts that were made by hand.
#include <gmock/gmock.h>

#include "slamdb/model/statistics.h"
#include "slamdb/plot/detail/panels.h"
#include "tests/plot/worlds.h"

namespace slamdb::plot {
namespace {

using slamdb::testing::AtlasOf;
using slamdb::testing::MapAt;
using slamdb::testing::PointSeenBy;
using ::testing::ElementsAre;
using ::testing::SizeIs;

Map FourKeyFrames() { return MapAt({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}); }

TEST(TrackHistogram, HoldsPointsByTheirObservers) {
  Map map = FourKeyFrames();
  for (const std::uint64_t observers : {0, 1, 2, 2, 3, 40}) map.points.push_back(PointSeenBy(observers));
  map.points.push_back(PointSeenBy(2));
  map.points.back().bad = true;
  const Atlas atlas = AtlasOf(std::move(map));
  const Histogram histogram = TrackHistogram(SceneOf(atlas, {}));
  ASSERT_THAT(histogram.counts, SizeIs(1));
  const auto& counts = histogram.counts[0];
  ASSERT_THAT(counts, SizeIs(33));
  EXPECT_EQ(counts[0], 1);
  EXPECT_EQ(counts[1], 1);
  EXPECT_EQ(counts[2], 2);
  EXPECT_EQ(counts[3], 1);
  EXPECT_EQ(counts[32], 1);
  EXPECT_EQ(Tallest(histogram), 2);
}

TEST(ObservationHistogram, HoldsKeyFramesByTheirPoints) {
  Map map = FourKeyFrames();
  for (int i = 0; i < 3; ++i) map.points.push_back(PointSeenBy(2));  // kf 0 and kf 1 see three points
  map.points.push_back(PointSeenBy(3));                              // and, as kf 2, a fourth one
  map.keyframes[3].bad = true;
  const Atlas atlas = AtlasOf(std::move(map));
  const Scene scene = SceneOf(atlas, {});
  EXPECT_THAT(scene.maps[0].observed, ElementsAre(4, 4, 1, 0));
  const Histogram histogram = ObservationHistogram(scene);
  EXPECT_DOUBLE_EQ(histogram.width, 1);
  EXPECT_THAT(histogram.counts, ElementsAre(ElementsAre(0, 1, 0, 0, 2)));
}

// Of a fisheye pair, those of both cameras.
TEST(ReprojectionErrors, AreThoseOfTheStatistics) {
  for (const Sensor sensor : {Sensor::kMonocular, Sensor::kFisheyeStereo}) {
    const Atlas atlas = SynthesizeAtlas({.sensor = sensor, .keyframes = 8, .points = 300});
    const Scene scene = SceneOf(atlas, {.threads = 2});
    const ImageErrors& errors = scene.errors();
    const MapStatistics statistics = ComputeStatistics(atlas).maps.at(0);
    ASSERT_EQ(errors.samples.size(), statistics.reprojection_error.count);
    double sum = 0;
    for (const auto& sample : errors.samples) sum += sample.error;
    EXPECT_NEAR(sum / static_cast<double>(errors.samples.size()), statistics.reprojection_error.mean, 1e-4);
    EXPECT_GT(errors.image.width, 300);
  }
}

TEST(Gaps, AreFiveTimesTheUsualStepAndASecondAtLeast) {
  Map map = FourKeyFrames();
  std::vector<std::uint32_t> rows{0, 1, 2, 3};
  EXPECT_DOUBLE_EQ(GapOf(map, rows), 5);
  for (std::size_t i = 0; i < 4; ++i) map.keyframes[i].timestamp = 0.01 * static_cast<double>(i);
  EXPECT_DOUBLE_EQ(GapOf(map, rows), 1);
}

TEST(Scene, BreaksThePathAtGapsAndCountsEdgesOnce) {
  Map map = FourKeyFrames();
  map.keyframes[3].timestamp = 500;
  map.keyframes[0].loop_edges = {KeyFrameId(2), KeyFrameId(99)};
  map.keyframes[2].loop_edges = {KeyFrameId(0)};
  const Atlas atlas = AtlasOf(std::move(map));
  const Scene scene = SceneOf(atlas, {});
  const MapScene& shown = scene.maps.at(0);
  EXPECT_TRUE(shown.path[2].follows);
  EXPECT_FALSE(shown.path[3].follows);
  EXPECT_THAT(shown.loops, ElementsAre(std::pair(0U, 2U)));
}

}  // namespace
}  // namespace slamdb::plot
