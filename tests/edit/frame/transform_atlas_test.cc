// SPDX-License-Identifier: BSD-3-Clause
// Every way to say where maps go, and that nothing moves when one of them does not tell.
#include "slamdb/edit/frame/transform_atlas.h"

#include <gmock/gmock.h>

#include "slamdb/model/derive.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

Atlas TwoMaps() { return SynthesizeAtlas({.sensor = Sensor::kRgbd, .maps = 2, .keyframes = 8, .points = 100}); }

// Where the cameras of a map go by a transform, with their times.
std::vector<TimedPosition> Moved(const Map& map, const Similarity3d& transform) {
  std::vector<TimedPosition> positions;
  for (const KeyFrame& keyframe : map.keyframes)
    positions.push_back({keyframe.timestamp, transform * CameraCenter(keyframe).cast<double>()});
  return positions;
}

void ExpectAt(const Map& map, const std::vector<TimedPosition>& positions, double tolerance) {
  ASSERT_THAT(map.keyframes, SizeIs(positions.size()));
  for (std::size_t row = 0; row < positions.size(); ++row)
    EXPECT_LT((CameraCenter(map.keyframes[row]).cast<double>() - positions[row].position).norm(), tolerance);
}

const Similarity3d kSomewhere{1, Eigen::Quaterniond(0.5, -0.3, 0.7, 0.2).normalized(), {3, -20, 7.5}};

TEST(TransformAtlas, MovesAllMapsAlike) {
  const Atlas before = TwoMaps();
  Atlas atlas = before;
  const TransformReport report = TransformAtlas(atlas, {.to = kSomewhere});
  ASSERT_THAT(report.maps, SizeIs(2));
  for (std::size_t row = 0; row < 2; ++row) {
    EXPECT_EQ(report.maps[row].map, before.maps[row].id);
    ExpectAt(atlas.maps[row], Moved(before.maps[row], kSomewhere), 1e-4);
  }
  Atlas same = before;
  TransformAtlas(same);
  EXPECT_THAT(same, EqualsAtlas(before));
}

TEST(TransformAtlas, MovesOnlyTheMapsAskedFor) {
  const Atlas before = TwoMaps();
  Atlas atlas = before;
  const TransformReport report = TransformAtlas(atlas, {.to = kSomewhere, .maps = {before.maps[1].id}});
  ASSERT_THAT(report.maps, SizeIs(1));
  ExpectAt(atlas.maps[1], Moved(before.maps[1], kSomewhere), 1e-4);
  atlas.maps[1] = before.maps[1];
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

TEST(TransformAtlas, LaysMapsOntoATrajectory) {
  const Atlas before = TwoMaps();
  const std::vector<TimedPosition> there = Moved(before.maps[0], {2, kSomewhere.rotation, kSomewhere.translation});
  Atlas atlas = before;
  const OntoTrajectory onto{.reference = there, .fit = {.with_scale = true}};
  const TransformReport report = TransformAtlas(atlas, {.to = onto, .maps = {before.maps[0].id}});
  EXPECT_NEAR(report.maps[0].target_from_source.scale, 2, 1e-4);
  ASSERT_TRUE(report.maps[0].alignment);
  EXPECT_EQ(report.maps[0].alignment->inliers, before.maps[0].keyframes.size());
  ExpectAt(atlas.maps[0], there, 1e-3);
  // Depths have the scale fixed unless it is asked for.
  atlas = before;
  EXPECT_EQ(TransformAtlas(atlas, {.to = OntoTrajectory{.reference = there}, .maps = {before.maps[0].id}})
                .maps[0]
                .target_from_source.scale,
            1);
}

TEST(TransformAtlas, LaysMapsOntoTheEarth) {
  const Atlas before = TwoMaps();
  const LocalFrame frame({48.1, 11.6, 520});
  const std::vector<TimedPosition> there = Moved(before.maps[0], kSomewhere);
  OntoEarth earth{.origin = frame.origin()};
  for (const TimedPosition& position : there)
    earth.fixes.push_back({position.timestamp, frame.ToGeodetic(position.position)});
  Atlas atlas = before;
  const TransformReport report = TransformAtlas(atlas, {.to = earth, .maps = {before.maps[0].id}});
  EXPECT_EQ(report.origin, frame.origin());
  ExpectAt(atlas.maps[0], there, 1e-3);
  EXPECT_THAT(ToJson(report, {.input = "a.osa", .output = "b.osa"}), HasSubstr("\"latitude\": 48.1"));
  atlas = before;
  earth.origin.reset();
  EXPECT_EQ(TransformAtlas(atlas, {.to = earth, .maps = {before.maps[0].id}}).origin, earth.fixes[0].place);
}

TEST(TransformAtlas, StandsMapsUpright) {
  Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kStereo, .inertial = true, .keyframes = 12, .points = 100});
  TransformMap(atlas.maps[0], {.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()))});
  const TransformReport report = TransformAtlas(atlas, {.to = TurnUpright{}});
  ASSERT_TRUE(report.maps[0].up);
  EXPECT_EQ(report.maps[0].up->method, UpMethod::kInertia);
  EXPECT_GT(UpOf(atlas.maps[0]).direction.z(), 0.999);
}

TEST(TransformAtlas, MovesNothingWhenItRefuses) {
  const Atlas before = TwoMaps();
  Atlas atlas = before;
  const auto kind = [&](const TransformOptions& options) { return KindOf([&] { TransformAtlas(atlas, options); }); };
  EXPECT_EQ(kind({.to = Similarity3d{.scale = -1}}), ErrorKind::kUsage);
  EXPECT_EQ(kind({.to = OntoEarth{}}), ErrorKind::kUsage);
  EXPECT_EQ(kind({.to = kSomewhere, .maps = {MapId(77)}}), ErrorKind::kNotPossible);
  // The first map finds its way; the second does not, and so neither moves.
  for (KeyFrame& keyframe : atlas.maps[1].keyframes) keyframe.timestamp += 1e6;
  const Atlas apart = atlas;
  EXPECT_EQ(kind({.to = OntoTrajectory{.reference = Moved(before.maps[0], kSomewhere)}}), ErrorKind::kNotPossible);
  EXPECT_THAT(atlas, EqualsAtlas(apart));
  Atlas empty;
  EXPECT_EQ(KindOf([&] { TransformAtlas(empty, {.to = kSomewhere}); }), ErrorKind::kNotPossible);
}

}  // namespace
}  // namespace slamdb
