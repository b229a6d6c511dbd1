// SPDX-License-Identifier: BSD-3-Clause
// What lists tell of atlases, and how maps are found by place, time and keyframes.
#include "slamdb/model/summary.h"

#include <gmock/gmock.h>

#include <limits>

#include "slamdb/model/map_query.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;

KeyFrame KeyFrameAt(std::uint64_t id, double time, const Eigen::Vector3f& center) {
  KeyFrame keyframe;
  keyframe.id = KeyFrameId(id);
  keyframe.timestamp = time;
  keyframe.camera_from_world.translation = -center;
  return keyframe;
}

MapPoint PointAt(std::uint64_t id, const Eigen::Vector3f& position) {
  MapPoint point;
  point.id = MapPointId(id);
  point.position = position;
  return point;
}

// Map 0 goes 3 m and then 4 m from second 10 to 13, and has points at (0, 0, 5) and, bad, at (9, 9, 9). Map 1 is later,
// has one keyframe and a landmark.
Atlas TwoMaps() {
  Atlas atlas;
  Map& first = atlas.maps.emplace_back();
  first.id = MapId(0);
  first.keyframes.push_back(KeyFrameAt(2, 13, {3, 4, 0}));
  first.keyframes.push_back(KeyFrameAt(1, 10, {0, 0, 0}));
  first.keyframes.push_back(KeyFrameAt(5, 11, {3, 0, 0}));
  first.points.push_back(PointAt(0, {0, 0, 5}));
  first.points.push_back(PointAt(1, {9, 9, 9}));
  first.points[1].bad = true;
  first.points[0].observations = {{KeyFrameId(1), 0, -1}, {KeyFrameId(2), 0, 4}};
  Map& second = atlas.maps.emplace_back();
  second.id = MapId(1);
  second.keyframes.push_back(KeyFrameAt(40, 100, {0, 0, 0}));
  second.keyframes[0].intrinsics.baseline_fx = 40;
  second.landmarks.emplace_back().mean = {-2, 0, 0};
  return atlas;
}

TEST(Summary, CountsAndMeasures) {
  const AtlasSummary summary = Summarize(TwoMaps());
  EXPECT_EQ(summary.maps, 2U);
  EXPECT_EQ(summary.keyframes, 4U);
  EXPECT_EQ(summary.points, 2U);
  EXPECT_EQ(summary.landmarks, 1U);
  EXPECT_EQ(summary.observations, 2U);
  EXPECT_THAT(summary.sensors, ElementsAre(MapSensor::kMonocular, MapSensor::kStereoOrRgbd));
  EXPECT_FALSE(summary.has_imu);
  EXPECT_FALSE(summary.is_metric) << "the first map has no scale";
  EXPECT_DOUBLE_EQ(summary.trajectory_length, 7);
  EXPECT_DOUBLE_EQ(summary.duration, 3) << "the time between maps does not count";
  EXPECT_DOUBLE_EQ(summary.begin_time.value(), 10);
  EXPECT_DOUBLE_EQ(summary.end_time.value(), 100);
}

TEST(Summary, OfNothing) {
  const AtlasSummary summary = Summarize(Atlas());
  EXPECT_TRUE(summary.sensors.empty());
  EXPECT_FALSE(summary.begin_time || summary.end_time);
  Atlas timeless = TwoMaps();
  for (Map& map : timeless.maps)
    for (KeyFrame& keyframe : map.keyframes) keyframe.timestamp = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Summarize(timeless).begin_time);
}

TEST(Summary, AgreesWithTheStatistics) {
  for (const Sensor sensor : {Sensor::kMonocular, Sensor::kRgbd, Sensor::kFisheyeStereo}) {
    const Atlas atlas = SynthesizeAtlas({.sensor = sensor, .maps = 2, .keyframes = 6, .points = 60, .features = 60});
    const AtlasSummary summary = Summarize(atlas);
    const AtlasStatistics statistics = ComputeStatistics(atlas);
    EXPECT_EQ(summary.keyframes, statistics.keyframes);
    EXPECT_DOUBLE_EQ(summary.trajectory_length, statistics.trajectory_length);
    EXPECT_THAT(summary.sensors, ElementsAre(statistics.maps[0].sensor));
  }
}

bool MatchesTimes(double begin, double end) { return Matches(TwoMaps(), {.times = {{begin, end}}}); }

TEST(MapQuery, TimesMeetTheSpanOfAMap) {
  EXPECT_TRUE(MatchesTimes(12, 12)) << "between two keyframes";
  EXPECT_TRUE(MatchesTimes(10, 10));
  EXPECT_TRUE(MatchesTimes(13, 99));
  EXPECT_TRUE(MatchesTimes(-1e9, 1e9));
  EXPECT_FALSE(MatchesTimes(9, 9.999));
  EXPECT_FALSE(MatchesTimes(13.001, 99)) << "between the maps";
  EXPECT_TRUE(MatchesTimes(100, std::numeric_limits<double>::infinity()));
}

TEST(MapQuery, KeyframesOfIds) {
  const auto matches = [](std::uint64_t first, std::uint64_t last) {
    return Matches(TwoMaps(), {.keyframes = {{first, last}}});
  };
  EXPECT_TRUE(matches(5, 5));
  EXPECT_TRUE(matches(6, 40));
  EXPECT_FALSE(matches(3, 4));
  EXPECT_FALSE(matches(41, std::numeric_limits<std::uint64_t>::max()));
}

TEST(MapQuery, PointsInABall) {
  const auto matches = [](const Eigen::Vector3d& center, double radius) {
    return Matches(TwoMaps(), {.near = {{center, radius}}});
  };
  EXPECT_TRUE(matches({0, 3, 9}, 5)) << "exactly as far";
  EXPECT_FALSE(matches({0, 3, 9}, 4.999));
  EXPECT_FALSE(matches({9, 9, 9}, 1)) << "a bad point";
  EXPECT_TRUE(matches({-2, 0, 0}, 0)) << "a landmark";
}

TEST(MapQuery, OneMapMustMeetEverything) {
  EXPECT_TRUE(Matches(TwoMaps(), {.times = {{100, 100}}, .near = {{{-2, 0, 0}, 1}}}));
  EXPECT_FALSE(Matches(TwoMaps(), {.times = {{100, 100}}, .near = {{{0, 0, 5}, 1}}}));
  EXPECT_TRUE(Matches(Atlas(), {})) << "nothing is asked for";
  EXPECT_FALSE(Matches(Atlas(), {.keyframes = {{0, 9}}}));
}

}  // namespace
}  // namespace slamdb
