// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/optimize.h"

#include <gmock/gmock.h>

#include "tests/optimize/shaken.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;

Atlas ThreeMaps() {
  return SynthesizeAtlas({.sensor = Sensor::kRgbd, .maps = 3, .keyframes = 8, .points = 150, .features = 120});
}

PoseConstraint BetweenFirstTwo(const Map& map) {
  const Rigid3f between =
      map.keyframes[0].camera_from_world.Normalized() * map.keyframes[1].camera_from_world.Normalized().Inverse();
  return {map.keyframes[0].id,
          map.keyframes[1].id,
          {1, between.rotation.cast<double>().normalized(), between.translation.cast<double>()}};
}

TEST(OptimizeMaps, OptimisesAllOrThoseThatAreNamed) {
  Atlas atlas = ThreeMaps();
  EXPECT_EQ(OptimizeMaps(atlas).maps.size(), 3U);
  atlas = ThreeMaps();
  const Atlas before = atlas;
  const OptimizeReport report = OptimizeMaps(atlas, {.maps = {atlas.maps[1].id}});
  ASSERT_EQ(report.maps.size(), 1U);
  EXPECT_EQ(report.maps[0].map, before.maps[1].id);
  EXPECT_EQ(atlas.maps[0].points[0].position, before.maps[0].points[0].position);
  EXPECT_NE(atlas.maps[1].points[0].position, before.maps[1].points[0].position);
}

TEST(OptimizeMaps, GivesEachMapItsConstraints) {
  Atlas atlas = ThreeMaps();
  const OptimizeReport report =
      OptimizeMaps(atlas, {.method = OptimizeMethod::kPoseGraph, .constraints = {BetweenFirstTwo(atlas.maps[2])}});
  EXPECT_FALSE(report.maps[0].pose_graph);
  ASSERT_TRUE(report.maps[2].pose_graph);
  EXPECT_EQ(report.maps[2].pose_graph->constraints, 1U);
  EXPECT_FALSE(report.maps[2].bundle);
}

TEST(OptimizeMaps, AdjustsASeamWhereThereIsOne) {
  Atlas atlas = ThreeMaps();
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) {
      keyframe.loop_edges.clear();
      keyframe.merge_edges.clear();
    }
  atlas.maps[1].keyframes[2].merge_edges.push_back(atlas.maps[1].keyframes[6].id);
  const OptimizeReport report = OptimizeMaps(atlas, {.method = OptimizeMethod::kSeam});
  EXPECT_FALSE(report.maps[0].bundle);
  ASSERT_TRUE(report.maps[1].bundle);
  EXPECT_GT(report.maps[1].bundle->keyframes, 0U);
}

TEST(OptimizeMaps, RefusesWhatMakesNoSense) {
  Atlas atlas = ThreeMaps();
  const Atlas before = atlas;
  const auto kind_of = [&](const OptimizeOptions& options) { return KindOf([&] { OptimizeMaps(atlas, options); }); };
  EXPECT_EQ(kind_of({.method = OptimizeMethod::kPoseGraph}), ErrorKind::kUsage);
  EXPECT_EQ(kind_of({.fix_poses = true, .fix_points = true}), ErrorKind::kUsage);
  EXPECT_EQ(kind_of({.iterations = 0}), ErrorKind::kUsage);
  EXPECT_EQ(kind_of({.maps = {MapId(99)}}), ErrorKind::kNotFound);
  EXPECT_EQ(
      kind_of(
          {.method = OptimizeMethod::kPoseGraph, .constraints = {BetweenFirstTwo(atlas.maps[2])}, .fix_points = true}),
      ErrorKind::kUsage);
  EXPECT_EQ(kind_of({.maps = {atlas.maps[0].id}, .constraints = {BetweenFirstTwo(atlas.maps[2])}}),
            ErrorKind::kNotFound);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

TEST(OptimizeMaps, SaysInJsonWhatItDid) {
  Atlas atlas = ThreeMaps();
  const std::string json = ToJson(OptimizeMaps(atlas), {.input = "a.osa", .output = "b.osa"});
  EXPECT_THAT(json, HasSubstr("\"report\": \"slamdb-optimize-2\""));
  EXPECT_THAT(json, HasSubstr("\"held_by\": \"keyframe\""));
}

}  // namespace
}  // namespace slamdb::testing
