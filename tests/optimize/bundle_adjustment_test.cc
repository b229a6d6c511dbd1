// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/bundle_adjustment.h"

#include <gmock/gmock.h>

#include "slamdb/base/error.h"
#include "slamdb/checks/check.h"
#include "tests/optimize/shaken.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"

namespace slamdb::testing {
namespace {

using ::testing::IsEmpty;

std::set<std::string> Troubles(const Atlas& atlas) {
  std::set<std::string> troubles;
  for (const RuleResult& result : CheckAtlas(atlas, {}).results)
    if (result.severity != Severity::kNote) troubles.insert(result.id);
  return troubles;
}

class ShakenMap : public ::testing::TestWithParam<OptimizeWorld> {
 protected:
  const Atlas truth_ = MakeTruth(GetParam());
  Atlas atlas_ = truth_;
  Shaker shaker_;
  Map& map() { return atlas_.maps[0]; }
  const Map& truth() const { return truth_.maps[0]; }
  bool has_scale() const { return GetParam().sensor != Sensor::kMonocular || GetParam().inertial; }
};

TEST_P(ShakenMap, ComesBackToItsTruth) {
  shaker_.ShakePoses(map(), 0.01F, 0.03F);
  shaker_.ShakePoints(map(), 0.03F);
  const BundleReport report = AdjustBundle(atlas_, map().id);
  EXPECT_TRUE(report.converged);
  EXPECT_LT(LargestOffset(map(), truth(), !has_scale()), 1e-3);
  EXPECT_GT(report.error_before.mean, 3);
  EXPECT_LT(report.error_after.mean, 0.01);
  EXPECT_LT(report.cost_after, report.cost_before / 1000);
  EXPECT_EQ(report.dropped, 0U);
  EXPECT_EQ(report.removed_points, 0U);
  EXPECT_THAT(Troubles(atlas_), IsEmpty());
}

TEST_P(ShakenMap, IsHeldAsTheReportSays) {
  shaker_.ShakePoses(map(), 0.01F, 0.03F);
  const Rigid3f initial = map().keyframes[0].camera_from_world;
  const BundleReport report = AdjustBundle(atlas_, map().id);
  ASSERT_EQ(map().keyframes[0].id, map().initial_keyframe);
  const Rigid3f& after = map().keyframes[0].camera_from_world;
  if (GetParam().inertial) {
    EXPECT_EQ(report.gauge, Gauge::kHeading);
    EXPECT_LT((after.Center() - initial.Center()).norm(), 1e-5F);
    EXPECT_EQ(report.inertial_links, map().keyframes.size() - 1);
    return;
  }
  EXPECT_EQ(report.gauge, has_scale() ? Gauge::kKeyFrame : Gauge::kKeyFrameAndScale);
  EXPECT_EQ(report.fixed_keyframes, 1U);
  EXPECT_EQ(after.rotation.coeffs(), initial.rotation.coeffs());
  EXPECT_EQ(after.translation, initial.translation);
}

// Viewing directions, distance ranges and IMU positions are those of the truth again.
TEST_P(ShakenMap, HasEverythingElseWithIt) {
  if (!has_scale()) GTEST_SKIP() << "has another scale than its truth";
  shaker_.ShakePoses(map(), 0.01F, 0.03F);
  shaker_.ShakePoints(map(), 0.03F);
  AdjustBundle(atlas_, map().id);
  for (std::size_t row = 0; row < map().points.size(); ++row) {
    const MapPoint &point = map().points[row], &should = truth().points[row];
    EXPECT_LT((point.normal - should.normal).norm(), 0.01F) << row;
    EXPECT_NEAR(point.max_distance, should.max_distance, 0.01F * should.max_distance) << row;
    EXPECT_NEAR(point.min_distance, should.min_distance, 0.01F * should.min_distance) << row;
    EXPECT_EQ(point.descriptor, should.descriptor);
  }
  for (std::size_t row = 0; row < map().keyframes.size(); ++row) {
    EXPECT_LT((map().keyframes[row].body_position - truth().keyframes[row].body_position).norm(), 1e-3F);
    EXPECT_LT((map().keyframes[row].velocity - truth().keyframes[row].velocity).norm(), 0.02F);
    EXPECT_EQ(map().keyframes[row].connections, truth().keyframes[row].connections);
    EXPECT_EQ(map().keyframes[row].merge_scale, truth().keyframes[row].merge_scale);
  }
}

TEST_P(ShakenMap, KeepsPosesThatAreFixed) {
  shaker_.ShakePoints(map(), 0.05F);
  const BundleReport report = AdjustBundle(atlas_, map().id, {.fix_poses = true});
  EXPECT_EQ(report.keyframes, 0U);
  EXPECT_EQ(LargestOffset(map(), truth()), 0);
  EXPECT_LT(report.error_after.mean, 0.01);
}

TEST_P(ShakenMap, KeepsPointsThatAreFixed) {
  shaker_.ShakePoses(map(), 0.01F, 0.03F);
  const BundleReport report = AdjustBundle(atlas_, map().id, {.fix_points = true});
  EXPECT_EQ(report.points, 0U);
  EXPECT_EQ(report.gauge, Gauge::kPoints);
  EXPECT_LT(LargestOffset(map(), truth()), 1e-3);
  for (std::size_t row = 0; row < map().points.size(); ++row)
    EXPECT_EQ(map().points[row].position, truth().points[row].position);
}

TEST_P(ShakenMap, GivesTheSameBytesForAnyNumberOfThreads) {
  shaker_.ShakePoses(map(), 0.01F, 0.03F);
  Atlas other = atlas_;
  AdjustBundle(atlas_, map().id, {.threads = 1});
  AdjustBundle(other, map().id, {.threads = 2});
  EXPECT_THAT(other, EqualsAtlas(atlas_));
}

INSTANTIATE_TEST_SUITE_P(Sensors, ShakenMap, ::testing::ValuesIn(kOptimizeWorlds),
                         [](const auto& each) { return std::string(each.param.name); });

Atlas RgbdTruth(std::size_t keyframes = 12) { return MakeTruth({"", Sensor::kRgbd, false}, keyframes); }

// The keypoint that an observation refers to, wherever it is kept.
void MoveKeypoint(KeyFrame& keyframe, std::int32_t row, float pixels) {
  Features& features = keyframe.features;
  const auto at = static_cast<std::size_t>(row);
  features.undistorted[at].x += pixels;
  features.keypoints[at].x += pixels;
  if (features.right_x[at] >= 0) features.right_x[at] += pixels;
  features.grid = DeriveGrid(features.undistorted, keyframe.bounds);
}

TEST(AdjustBundle, DropsWhatDoesNotFitOnBothSides) {
  Atlas atlas = RgbdTruth(40);
  Map& map = atlas.maps[0];
  struct Wrong {
    std::size_t point;
    KeyFrameId keyframe;
    std::int32_t row;
  };
  std::vector<Wrong> wrongs;
  for (std::size_t row = 0; row < map.points.size() && wrongs.size() < 10; ++row) {
    if (map.points[row].observations.size() < 6) continue;
    const Observation seen = map.points[row].observations[2];
    KeyFrame& keyframe = *std::ranges::find(map.keyframes, seen.keyframe, &KeyFrame::id);
    MoveKeypoint(keyframe, seen.left, 40);
    wrongs.push_back({row, seen.keyframe, seen.left});
  }
  ASSERT_EQ(wrongs.size(), 10U);
  const Map before = map;
  const BundleReport report = AdjustBundle(atlas, map.id);
  EXPECT_EQ(report.dropped, 10U);
  EXPECT_EQ(report.removed_points, 0U);
  EXPECT_LT(report.error_after.mean, 0.01);
  for (const Wrong& wrong : wrongs) {
    const MapPoint& point = map.points[wrong.point];
    const KeyFrame& keyframe = *std::ranges::find(map.keyframes, wrong.keyframe, &KeyFrame::id);
    EXPECT_EQ(std::ranges::count(point.observations, wrong.keyframe, &Observation::keyframe), 0);
    EXPECT_EQ(point.observation_count, before.points[wrong.point].observation_count -
                                           ObservationWeight(keyframe, {wrong.keyframe, wrong.row, -1}));
    EXPECT_FALSE(keyframe.features.map_points[static_cast<std::size_t>(wrong.row)]);
  }
  EXPECT_THAT(Troubles(atlas), IsEmpty());
}

TEST(AdjustBundle, RemovesPointsThatAreLeftWithTooFew) {
  Atlas atlas = MakeTruth({"", Sensor::kMonocular, false});
  Map& map = atlas.maps[0];
  const auto found = std::ranges::find_if(map.points, [](const MapPoint& p) { return p.observations.size() == 3; });
  ASSERT_NE(found, map.points.end());
  const MapPointId id = found->id;
  const Observation seen = found->observations[1];
  MoveKeypoint(*std::ranges::find(map.keyframes, seen.keyframe, &KeyFrame::id), seen.left, 60);
  const std::size_t points = map.points.size();
  const BundleReport report = AdjustBundle(atlas, map.id);
  EXPECT_EQ(report.removed_points, 1U);
  EXPECT_EQ(atlas.maps[0].points.size(), points - 1);
  EXPECT_EQ(std::ranges::count(atlas.maps[0].points, id, &MapPoint::id), 0);
  EXPECT_THAT(Troubles(atlas), IsEmpty());
}

TEST(AdjustBundle, GivesAPointAnotherReferenceWhereItsOwnIsDropped) {
  Atlas atlas = RgbdTruth(40);
  Map& map = atlas.maps[0];
  const auto found = std::ranges::find_if(map.points, [](const MapPoint& p) { return p.observations.size() > 5; });
  ASSERT_NE(found, map.points.end());
  const auto seen = std::ranges::find(found->observations, found->reference, &Observation::keyframe);
  const KeyFrameId reference = found->reference;
  MoveKeypoint(*std::ranges::find(map.keyframes, reference, &KeyFrame::id), seen->left, 60);
  AdjustBundle(atlas, map.id);
  EXPECT_NE(found->reference, reference);
  EXPECT_EQ(found->reference, std::ranges::min(found->observations, {}, &Observation::keyframe).keyframe);
}

TEST(AdjustBundle, MovesTheKeyframesThatItIsGivenAndNoOthers) {
  Atlas atlas = RgbdTruth();
  Map& map = atlas.maps[0];
  const Map truth = map;
  Shaker shaker;
  shaker.ShakePoses(map, 0.01F, 0.03F);
  const std::vector<KeyFrameId> seam = {map.keyframes[4].id, map.keyframes[5].id};
  for (std::size_t row = 0; row < map.keyframes.size(); ++row)
    if (row != 4 && row != 5) map.keyframes[row].camera_from_world = truth.keyframes[row].camera_from_world;
  const Map before = map;
  const BundleReport report = AdjustBundle(atlas, map.id, {.keyframes = seam});
  EXPECT_EQ(report.keyframes, 2U);
  EXPECT_GT(report.fixed_keyframes, 2U);
  EXPECT_EQ(report.gauge, Gauge::kNeighbours);
  EXPECT_LT(LargestOffset(map, truth), 1e-3);
  for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
    if (row == 4 || row == 5) continue;
    EXPECT_EQ(map.keyframes[row].camera_from_world.translation, before.keyframes[row].camera_from_world.translation);
  }
}

// A keyframe that sees nothing goes with its parent, a point that one keyframe sees with that.
TEST(AdjustBundle, TakesAlongWhatIsNotMeasured) {
  Atlas atlas = MakeTruth({"", Sensor::kMonocular, false});
  Map& map = atlas.maps[0];
  KeyFrame& blind = map.keyframes.back();
  for (MapPoint& point : map.points)
    std::erase_if(point.observations, [&](const Observation& seen) { return seen.keyframe == blind.id; });
  ASSERT_TRUE(blind.parent);
  MapPoint& lonely = map.points[0];
  lonely.observations.resize(1);
  lonely.reference = lonely.observations[0].keyframe;
  const auto find = [&](KeyFrameId id) -> KeyFrame& { return *std::ranges::find(map.keyframes, id, &KeyFrame::id); };
  Shaker shaker;
  shaker.ShakePoses(map, 0.01F, 0.03F);
  const Rigid3f relative = blind.camera_from_world * find(blind.parent).camera_from_world.Inverse();
  const Eigen::Vector3f seen = find(lonely.reference).camera_from_world * lonely.position;
  AdjustBundle(atlas, map.id);
  const Rigid3f after = blind.camera_from_world * find(blind.parent).camera_from_world.Inverse();
  EXPECT_LT((after.translation - relative.translation).norm(), 1e-4F);
  EXPECT_LT((find(lonely.reference).camera_from_world * lonely.position - seen).norm(), 1e-4F);
}

TEST(AdjustBundle, ChangesNothingWhereThereIsNothingToMove) {
  Atlas atlas = RgbdTruth();
  atlas.maps[0].points.clear();
  const Atlas before = atlas;
  const BundleReport report = AdjustBundle(atlas, atlas.maps[0].id);
  EXPECT_EQ(report.observations, 0U);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

TEST(AdjustBundle, RefusesWhatMakesNoSense) {
  Atlas atlas = RgbdTruth();
  const Atlas before = atlas;
  const MapId map = atlas.maps[0].id;
  EXPECT_EQ(KindOf([&] { AdjustBundle(atlas, map, {.fix_poses = true, .fix_points = true}); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { AdjustBundle(atlas, MapId(77)); }), ErrorKind::kNotFound);
  EXPECT_EQ(KindOf([&] { AdjustBundle(atlas, map, {.keyframes = std::vector{KeyFrameId(777)}}); }),
            ErrorKind::kNotFound);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

TEST(AdjustBundle, IsCancelledByItsListener) {
  Atlas atlas = RgbdTruth();
  Shaker().ShakePoints(atlas.maps[0], 0.05F);
  const Atlas before = atlas;
  struct Cancelled {};
  int calls = 0;
  const BundleOptions options{.progress = [&](std::string_view, double) {
    if (++calls == 2) throw Cancelled();
  }};
  EXPECT_THROW(AdjustBundle(atlas, atlas.maps[0].id, options), Cancelled);
  EXPECT_EQ(calls, 2);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

}  // namespace
}  // namespace slamdb::testing
