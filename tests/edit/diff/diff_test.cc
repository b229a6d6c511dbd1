// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/diff/diff.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "slamdb/edit/frame/transform.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Verdict = AtlasDiff::Verdict;

Atlas Small(Sensor sensor, bool inertial = false, int maps = 2, std::uint64_t seed = 1) {
  SyntheticOptions options;
  options.sensor = sensor;
  options.inertial = inertial;
  options.maps = maps;
  options.keyframes = 8;
  options.points = 150;
  options.features = 200;
  options.seed = seed;
  return SynthesizeAtlas(options);
}

const LinkDiff& LinksOf(const AtlasDiff& diff, std::string_view kind) {
  for (const LinkDiff& link : diff.links)
    if (link.kind == kind) return link;
  throw std::runtime_error("no such kind");
}

// Every id of every field by +offset, the lists turned round: the same atlas to anyone but a byte comparer.
Atlas Renumbered(Atlas atlas) {
  const auto keyframe = [](KeyFrameId& id) { id = id ? KeyFrameId(id.value() + 1000) : id; };
  const auto point_id = [](MapPointId& id) { id = id ? MapPointId(id.value() + 7777) : id; };
  for (Camera& camera : atlas.cameras) camera.id = CameraId(camera.id.value() + 10);
  for (Map& map : atlas.maps) {
    map.id = MapId(map.id.value() + 5);
    for (KeyFrameId* id : {&map.initial_keyframe, &map.first_keyframe, &map.lowest_keyframe}) keyframe(*id);
    for (KeyFrameId& id : map.origins) keyframe(id);
    map.max_keyframe_id += 1000;
    for (KeyFrame& each : map.keyframes) {
      for (KeyFrameId* id : {&each.id, &each.parent, &each.previous, &each.next}) keyframe(*id);
      for (Column<KeyFrameId>* list : {&each.children, &each.loop_edges, &each.merge_edges})
        for (KeyFrameId& id : *list) keyframe(id);
      for (Connection& connection : each.connections) keyframe(connection.keyframe);
      for (MapPointId& id : each.features.map_points) point_id(id);
      each.camera = CameraId(each.camera.value() + 10);
      if (each.right_camera) each.right_camera = CameraId(each.right_camera.value() + 10);
      each.origin_map += 5;
      each.frame_id += 3;
    }
    for (MapPoint& each : map.points) {
      point_id(each.id);
      point_id(each.replaced_by);
      keyframe(each.reference);
      for (Observation& observation : each.observations) keyframe(observation.keyframe);
      if (each.first_keyframe >= 0) each.first_keyframe += 1000;
    }
    std::ranges::reverse(map.keyframes);
    std::ranges::reverse(map.points);
  }
  std::ranges::reverse(atlas.maps);
  atlas.next_ids.keyframe += 1000;
  return atlas;
}

class DiffOf : public ::testing::TestWithParam<std::pair<Sensor, bool>> {
 protected:
  const Atlas atlas_ = Small(GetParam().first, GetParam().second);
};

TEST_P(DiffOf, ItselfIsEmpty) {
  const AtlasDiff diff = DiffAtlases(atlas_, atlas_, {});
  EXPECT_EQ(diff.verdict(), Verdict::kSame);
  EXPECT_EQ(diff.keyframes.before, 16U);
  EXPECT_EQ(diff.points.after, 300U);
  EXPECT_GT(LinksOf(diff, "observations").before, 600U);
  EXPECT_EQ(LinksOf(diff, "observations").before, LinksOf(diff, "observations").after);
  EXPECT_THAT(diff.encoding, IsEmpty());
  for (const MapMotion& motion : diff.motions) EXPECT_FALSE(motion.moved());
}

TEST_P(DiffOf, RenumberedIsOnlyThat) {
  const AtlasDiff diff = DiffAtlases(atlas_, Renumbered(atlas_), {});
  EXPECT_EQ(diff.verdict(), Verdict::kRenumbered);
  EXPECT_EQ(diff.maps.renumbered, 2U);
  EXPECT_EQ(diff.keyframes.renumbered, 16U);
  EXPECT_EQ(diff.points.renumbered, 300U);
  EXPECT_EQ(diff.cameras.renumbered, atlas_.cameras.size());
  EXPECT_EQ(diff.keyframes.changed + diff.points.changed + diff.maps.changed, 0U);
  EXPECT_GE(diff.other_ids, 16U);
}

TEST_P(DiffOf, MotionOfAWholeMapIsFound) {
  Atlas moved = Renumbered(atlas_);
  const Similarity3d move{2, Eigen::Quaterniond(0.5, 0.1, -0.4, 0.7).normalized(), {1, -2, 30}};
  TransformMap(moved.maps[0], move);  // map 1 before it was renumbered and turned round
  const AtlasDiff diff = DiffAtlases(atlas_, moved, {});
  EXPECT_EQ(diff.verdict(), Verdict::kDifferent);
  EXPECT_EQ(diff.keyframes.changed, 8U);
  EXPECT_EQ(diff.points.changed, 150U);
  EXPECT_THAT(diff.links, ::testing::Each(::testing::Property(&LinkDiff::same, true)));
  ASSERT_EQ(diff.motions.size(), 2U);
  EXPECT_FALSE(diff.motions[0].moved());
  const MapMotion& motion = diff.motions[1];
  EXPECT_EQ(motion.keyframes, 8U);
  EXPECT_EQ(motion.points, 150U);
  ASSERT_TRUE(motion.after_from_before);
  EXPECT_NEAR(motion.after_from_before->scale, 2, 1e-5);
  EXPECT_LT(motion.after_from_before->rotation.angularDistance(move.rotation), 1e-5);
  EXPECT_LT(motion.rest.max, 1e-4);
}

TEST_P(DiffOf, ThereAndBackIsTheSameWithinTolerance) {
  Atlas back = atlas_;
  const Similarity3d move{1.7, Eigen::Quaterniond(0.5, 0.1, -0.4, 0.7).normalized(), {1, -2, 3}};
  TransformMap(back.maps[0], move);
  TransformMap(back.maps[0], move.Inverse());
  EXPECT_EQ(DiffAtlases(atlas_, back, {}).verdict(), Verdict::kDifferent);
  EXPECT_EQ(DiffAtlases(atlas_, back, {.tolerance = 2e-5}).verdict(), Verdict::kSame);
}

TEST_P(DiffOf, ThreadsDoNotMatter) {
  const Atlas other = Renumbered(atlas_);
  const AtlasDiff one = DiffAtlases(atlas_, other, {.threads = 1}), many = DiffAtlases(atlas_, other, {.threads = 4});
  EXPECT_EQ(one.points.renumbered, many.points.renumbered);
  EXPECT_EQ(one.other_ids, many.other_ids);
  EXPECT_EQ(one.verdict(), many.verdict());
}

INSTANTIATE_TEST_SUITE_P(Sensors, DiffOf,
                         ::testing::Values(std::pair(Sensor::kMonocular, false), std::pair(Sensor::kRgbd, false),
                                           std::pair(Sensor::kFisheyeStereo, false), std::pair(Sensor::kStereo, true)));

class Diff : public ::testing::Test {
 protected:
  AtlasDiff Run() const { return DiffAtlases(before_, after_, {}); }

  const Atlas before_ = Small(Sensor::kRgbd, false, 1);
  Atlas after_ = before_;
  Map& map_ = after_.maps[0];
};

TEST_F(Diff, RemovedPointTakesItsObservations) {
  const MapPoint gone = map_.points[10];
  map_.points.erase(map_.points.begin() + 10);
  const AtlasDiff diff = Run();
  EXPECT_THAT(diff.points.removed, ElementsAre(EntityName{0, gone.id.value()}));
  EXPECT_THAT(diff.points.added, IsEmpty());
  EXPECT_EQ(LinksOf(diff, "observations").removed, gone.observations.size());
  EXPECT_EQ(LinksOf(diff, "slots").changed, gone.observations.size());  // they lead nowhere now
  EXPECT_EQ(diff.keyframes.changed, 0U);
}

TEST_F(Diff, AddedKeyFrameTakesItsEdges) {
  const AtlasDiff diff = DiffAtlases(
      [&] {
        Atlas smaller = before_;
        smaller.maps[0].keyframes.pop_back();
        return smaller;
      }(),
      before_, {});
  EXPECT_THAT(diff.keyframes.added, ElementsAre(EntityName{0, before_.maps[0].keyframes.back().id.value()}));
  EXPECT_EQ(LinksOf(diff, "parents").added, 1U);
}

TEST_F(Diff, PointThatLostAnObserverIsStillKnown) {
  MapPoint& point = map_.points[3];
  point.id = MapPointId(99999);
  point.descriptor.fill(0xAA);
  point.observations.pop_back();
  point.observation_count -= 2;
  const AtlasDiff diff = Run();
  EXPECT_THAT(diff.points.removed, IsEmpty());
  EXPECT_EQ(diff.points.renumbered, 1U);
  EXPECT_THAT(diff.points.changes, ElementsAre(AspectCount{"descriptor", 1}, AspectCount{"observation count", 1}));
  EXPECT_EQ(LinksOf(diff, "observations").removed, 1U);
}

TEST_F(Diff, EdgesAndKeypointsOfObservations) {
  map_.keyframes[2].connections[0].weight += 1;
  map_.keyframes[3].loop_edges.push_back(map_.keyframes[0].id);
  map_.keyframes[4].parent =
      map_.keyframes[0].id == map_.keyframes[4].parent ? map_.keyframes[1].id : map_.keyframes[0].id;
  map_.points[0].observations[0].left += 1;
  const AtlasDiff diff = Run();
  EXPECT_EQ(LinksOf(diff, "covisibility").changed, 1U);
  EXPECT_EQ(LinksOf(diff, "loop edges").added, 1U);
  EXPECT_EQ(LinksOf(diff, "parents").changed, 1U);
  EXPECT_EQ(LinksOf(diff, "observations").changed, 1U);
}

TEST_F(Diff, AspectsByName) {
  map_.keyframes[0].timestamp += 1;
  map_.keyframes[1].features.bag_of_words.weights[0] += 1;
  map_.keyframes[2].intrinsics.fx += 1;
  map_.keyframes[3].velocity.x() += 1;
  map_.keyframes[4].features.depth[0] += 1;
  map_.keyframes[5].origin_map = 9;
  map_.keyframes[6].not_erase = true;
  map_.imu_ba1 = true;
  after_.cameras[0].parameters[0] += 1;
  after_.vocabulary.name = "other.txt";
  const AtlasDiff diff = Run();
  for (const char* aspect :
       {"time", "bag of words", "camera and calibration", "inertial data", "features", "origin map", "flags and state"})
    EXPECT_THAT(diff.keyframes.changes, Contains(AspectCount{aspect, 1})) << aspect;
  EXPECT_THAT(diff.maps.changes, ElementsAre(AspectCount{"inertial flags", 1}));
  EXPECT_THAT(diff.cameras.changes, ElementsAre(AspectCount{"parameters", 1}));
  ASSERT_EQ(diff.fields.size(), 1U);
  EXPECT_EQ(diff.fields[0].field, "vocabulary");
}

TEST_F(Diff, NansAndSignsOfZeroAreNoDifference) {
  Atlas before = before_;
  before.maps[0].keyframes[0].body_position.setConstant(std::numeric_limits<float>::quiet_NaN());
  before.maps[0].keyframes[0].merge_scale = 0.0F;
  after_ = before;
  map_.keyframes[0].body_position.setConstant(-std::nanf("0x123"));
  map_.keyframes[0].merge_scale = -0.0F;
  map_.keyframes[0].camera_from_world.rotation.coeffs() *= -1;
  EXPECT_EQ(DiffAtlases(before, after_, {}).verdict(), Verdict::kSame);
}

TEST_F(Diff, EncodingIsToldAndDoesNotCount) {
  after_.encoding.text = true;
  const AtlasDiff diff = Run();
  EXPECT_EQ(diff.verdict(), Verdict::kSame);
  ASSERT_EQ(diff.encoding.size(), 1U);
  EXPECT_EQ(diff.encoding[0].after, "text");
}

// Sessions that begin at the same second have nothing in common but their times and ids.
TEST_F(Diff, OtherSessionsAreOther) {
  const AtlasDiff diff = DiffAtlases(before_, Small(Sensor::kRgbd, false, 1, 77), {});
  EXPECT_EQ(diff.keyframes.removed.size(), 8U);
  EXPECT_EQ(diff.keyframes.added.size(), 8U);
  EXPECT_EQ(diff.maps.removed.size(), 1U);
  EXPECT_EQ(diff.points.removed.size(), 150U);
}

TEST_F(Diff, KeyFramesWithoutDescriptorsGoByTime) {
  for (KeyFrame& keyframe : map_.keyframes) keyframe.features = Features{};
  map_.points.clear();
  const AtlasDiff diff = Run();
  EXPECT_THAT(diff.keyframes.removed, IsEmpty());
  EXPECT_EQ(diff.points.removed.size(), 150U);
}

// Drops the first features of a keyframe, and moves up the rows of those that are left.
void DropFeatures(Map& map, KeyFrame& keyframe, int count) {
  Features& features = keyframe.features;
  const auto drop = [count](auto& column) { column.erase(column.begin(), column.begin() + count); };
  drop(features.keypoints);
  drop(features.undistorted);
  drop(features.right_x);
  drop(features.depth);
  drop(features.descriptors);
  drop(features.map_points);
  features.count -= count;
  for (MapPoint& point : map.points)
    for (Observation& observation : point.observations)
      if (observation.keyframe == keyframe.id) observation.left -= count;
  for (MapPoint& point : map.points)
    std::erase_if(point.observations,
                  [&](const Observation& each) { return each.keyframe == keyframe.id && each.left < 0; });
}

std::size_t Slots(const KeyFrame& keyframe, int count) {
  const auto& slots = keyframe.features.map_points;
  return static_cast<std::size_t>(
      std::count_if(slots.begin(), slots.begin() + count, [](MapPointId id) { return id.has_value(); }));
}

TEST_F(Diff, KeyFramesThatLostFeaturesAreTheSame) {
  constexpr int kDropped = 120;
  const std::size_t slots = Slots(map_.keyframes[2], kDropped);
  DropFeatures(map_, map_.keyframes[2], kDropped);
  const AtlasDiff diff = Run();
  EXPECT_THAT(diff.keyframes.removed, IsEmpty());
  EXPECT_THAT(diff.keyframes.added, IsEmpty());
  EXPECT_THAT(diff.keyframes.changes, ElementsAre(AspectCount{"features lost", 1}));
  EXPECT_THAT(diff.points.removed, IsEmpty());
  EXPECT_EQ(LinksOf(diff, "slots").removed, slots);
  EXPECT_EQ(LinksOf(diff, "slots").changed, 0U) << "rows move up together";
  EXPECT_EQ(LinksOf(diff, "observations").changed, 0U);
  EXPECT_EQ(LinksOf(diff, "observations").added, 0U);
}

// Whatever they lost: known by their id, time and pose, and moved by what is left of them.
TEST_F(Diff, KeyFramesThatLostAllFeaturesAreTheSameWhereTheyStand) {
  DropFeatures(map_, map_.keyframes[1], map_.keyframes[1].features.count);
  DropFeatures(map_, map_.keyframes[3], 50);
  map_.keyframes[3].camera_from_world.translation.x() += 1;
  const AtlasDiff diff = Run();
  EXPECT_THAT(diff.keyframes.removed, IsEmpty());
  EXPECT_THAT(diff.keyframes.changes, ElementsAre(AspectCount{"pose", 1}, AspectCount{"features lost", 2}));
}

TEST_F(Diff, DamageDoesNotMatter) {
  map_.points[0].observations[0].keyframe = KeyFrameId(123456);
  map_.points[1].id = map_.points[2].id;
  map_.keyframes[0].id = map_.keyframes[1].id;
  map_.keyframes[2].parent = KeyFrameId(98765);
  EXPECT_EQ(DiffAtlases(after_, after_, {}).verdict(), Verdict::kSame);
  EXPECT_EQ(DiffAtlases(before_, Atlas{}, {}).keyframes.removed.size(), 8U);
  EXPECT_EQ(DiffAtlases(Atlas{}, Atlas{}, {}).verdict(), Verdict::kSame);
}

}  // namespace
}  // namespace slamdb
