// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/pose_graph.h"

#include <gmock/gmock.h>

#include <numbers>

#include "slamdb/model/up.h"
#include "tests/optimize/shaken.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"

namespace slamdb::testing {
namespace {

Similarity3d WorldFromCamera(const KeyFrame& keyframe) {
  const Rigid3f& pose = keyframe.camera_from_world;
  return {1, pose.rotation.cast<double>().normalized().conjugate(), pose.Center().cast<double>()};
}

// How keyframes at two rows of a map lie to each other.
PoseConstraint Between(const Map& map, std::size_t first, std::size_t second) {
  return {map.keyframes[first].id, map.keyframes[second].id,
          WorldFromCamera(map.keyframes[first]).Inverse() * WorldFromCamera(map.keyframes[second])};
}

// Bends a map: each keyframe a little more than the one before, and what it is the reference of with it.
void Drift(Map& map, double radians, double length, double growth) {
  for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
    KeyFrame& keyframe = map.keyframes[row];
    const auto much = static_cast<double>(row);
    const Similarity3d before = WorldFromCamera(keyframe);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(much * radians, Eigen::Vector3d::UnitZ()));
    const Similarity3d after{
        std::pow(growth, much), turn * before.rotation,
        std::pow(growth, much / 2) * (turn * before.translation) + Eigen::Vector3d(much * length, 0, 0)};
    const Similarity3d motion = after * before.Inverse();
    for (MapPoint& point : map.points)
      if (point.reference == keyframe.id) point.position = (motion * point.position.cast<double>()).cast<float>();
    keyframe.camera_from_world.rotation = Quaternionf(after.rotation.conjugate().cast<float>());
    keyframe.camera_from_world.translation = -(after.rotation.conjugate() * after.translation).cast<float>();
  }
}

class DriftedMap : public ::testing::TestWithParam<OptimizeWorld> {
 protected:
  const Atlas truth_ = MakeTruth(GetParam(), 24);
  Atlas atlas_ = truth_;
  Map& map() { return atlas_.maps[0]; }
  const Map& truth() const { return truth_.maps[0]; }
};

TEST_P(DriftedMap, ClosesItsLoop) {
  const bool has_scale = GetParam().sensor != Sensor::kMonocular || GetParam().inertial;
  Drift(map(), 0.003, 0.01, has_scale ? 1 : 0.99);
  const double before = LargestOffset(map(), truth(), true);
  PoseConstraint loop = Between(truth(), 0, 23);
  if (!has_scale) loop.first_from_second.scale = std::pow(0.99, -23);
  const Rigid3f initial = map().keyframes[0].camera_from_world;
  const PoseGraphReport report = OptimizePoseGraph(atlas_, map().id, {.constraints = {loop}});
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.freedom, GetParam().inertial ? PoseFreedom::kUpright
                            : has_scale         ? PoseFreedom::kRigid
                                                : PoseFreedom::kSimilarity);
  EXPECT_EQ(report.constraints, 1U);
  EXPECT_GT(report.tree_edges, 15U);
  EXPECT_LT(report.gap_after.translation, report.gap_before.translation / 3);
  EXPECT_LT(report.gap_after.degrees, report.gap_before.degrees / 2);
  EXPECT_LT(report.cost_after, report.cost_before);
  EXPECT_LT(LargestOffset(map(), truth(), true), before / 2);
  EXPECT_EQ(map().keyframes[0].camera_from_world.translation, initial.translation);
  if (GetParam().inertial) {
    EXPECT_GT(FindUp(map(), UpMethod::kInertia).direction.z(), std::cos(0.002));
  }
}

// Points are seen by their reference keyframe where they were.
TEST_P(DriftedMap, TakesPointsAlong) {
  Drift(map(), 0.003, 0.01, 1);
  const auto seen = [](const Map& map, const MapPoint& point) {
    const KeyFrame& keyframe = *std::ranges::find(map.keyframes, point.reference, &KeyFrame::id);
    return Eigen::Vector3f((keyframe.camera_from_world * point.position).normalized());
  };
  const Map before = map();
  OptimizePoseGraph(atlas_, map().id, {.constraints = {Between(truth(), 0, 23)}});
  for (std::size_t row = 0; row < map().points.size(); ++row)
    EXPECT_LT((seen(map(), map().points[row]) - seen(before, before.points[row])).norm(), 1e-4F);
}

TEST_P(DriftedMap, GivesTheSameBytesForAnyNumberOfThreads) {
  Drift(map(), 0.003, 0.01, 1);
  Atlas other = atlas_;
  const std::vector constraints = {Between(truth(), 0, 23), Between(truth(), 1, 22)};
  OptimizePoseGraph(atlas_, map().id, {.constraints = constraints, .threads = 1});
  OptimizePoseGraph(other, map().id, {.constraints = constraints, .threads = 2});
  EXPECT_THAT(other, EqualsAtlas(atlas_));
}

INSTANTIATE_TEST_SUITE_P(Sensors, DriftedMap,
                         ::testing::Values(kOptimizeWorlds[0], kOptimizeWorlds[3], kOptimizeWorlds[4],
                                           kOptimizeWorlds[5]),
                         [](const auto& each) { return std::string(each.param.name); });

// A constraint alone ties two sessions: what the map says of how they lie does not hold against it.
TEST(OptimizePoseGraph, MovesASessionAsAWhole) {
  const Atlas truth = MakeTruth({"", Sensor::kRgbd, false});
  const Map& map = truth.maps[0];
  PoseConstraint apart = Between(map, 5, 6);
  apart.first_from_second.translation += Eigen::Vector3d(0.2, 0, 0);
  PoseGraphOptions options{.constraints = {apart}, .min_weight = 1};
  Atlas held = truth, moved = truth;
  EXPECT_GT(OptimizePoseGraph(held, map.id, options).gap_after.translation, 0.01);
  options.sessions.resize(2);
  for (std::size_t row = 0; row < map.keyframes.size(); ++row)
    options.sessions[row <= 5 ? 0 : 1].push_back(map.keyframes[row].id);
  EXPECT_LT(OptimizePoseGraph(moved, map.id, options).gap_after.translation, 1e-4);
  for (std::size_t row = 7; row < map.keyframes.size(); ++row) {
    const Similarity3d is = Between(moved.maps[0], 6, row).first_from_second;
    EXPECT_LT((is.translation - Between(map, 6, row).first_from_second.translation).norm(), 1e-3);
  }
}

TEST(OptimizePoseGraph, ChangesNothingWithoutConstraints) {
  Atlas atlas = MakeTruth({"", Sensor::kRgbd, false});
  const Atlas before = atlas;
  const PoseGraphReport report = OptimizePoseGraph(atlas, atlas.maps[0].id, {});
  EXPECT_EQ(report.keyframes, 12U);
  EXPECT_EQ(report.largest_shift, 0);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

// Three keyframes in a row, 1 apart, and a constraint that wants the last 0.3 farther. All edges weigh the same, so
// each of the three takes a third of the 0.3.
TEST(OptimizePoseGraph, SharesAGapEvenly) {
  Atlas atlas;
  Map& map = atlas.maps.emplace_back();
  map.id = MapId(0);
  map.initial_keyframe = KeyFrameId(0);
  for (std::uint64_t id = 0; id < 3; ++id) {
    KeyFrame keyframe;
    keyframe.id = KeyFrameId(id);
    if (id > 0) keyframe.parent = KeyFrameId(id - 1);
    keyframe.camera_from_world.translation = {-static_cast<float>(id), 0, 0};
    keyframe.features.right_x = Column<float>(1, 1.0F);  // metric
    keyframe.features.depth = Column<float>(1, 1.0F);
    map.keyframes.push_back(keyframe);
  }
  PoseConstraint constraint{KeyFrameId(0), KeyFrameId(2), {}};
  constraint.first_from_second.translation = {2.3, 0, 0};
  const PoseGraphReport report = OptimizePoseGraph(atlas, map.id, {.constraints = {constraint}});
  EXPECT_NEAR(map.keyframes[0].camera_from_world.Center().x(), 0, 1e-6);
  EXPECT_NEAR(map.keyframes[1].camera_from_world.Center().x(), 1.1, 1e-5);
  EXPECT_NEAR(map.keyframes[2].camera_from_world.Center().x(), 2.2, 1e-5);
  EXPECT_NEAR(report.gap_before.translation, 0.3, 1e-6);
  EXPECT_NEAR(report.gap_after.translation, 0.1, 1e-5);
  EXPECT_NEAR(report.largest_shift, 0.2, 1e-5);
  EXPECT_EQ(report.tree_edges, 2U);
}

// Millimetres that were taken for metres, and turns that nothing in the map allows.
TEST(OptimizePoseGraph, RefusesWhatWouldTearTheMap) {
  for (const Sensor sensor : {Sensor::kMonocular, Sensor::kRgbd}) {
    Atlas atlas = MakeTruth({"", sensor, false});
    const Atlas before = atlas;
    PoseConstraint far = Between(atlas.maps[0], 0, 1);
    for (const double units : {1e3, 1e30}) {
      far.first_from_second.translation = Eigen::Vector3d(units, 0, 0);
      EXPECT_EQ(KindOf([&] { OptimizePoseGraph(atlas, atlas.maps[0].id, {.constraints = {far}}); }),
                ErrorKind::kNotPossible)
          << units;
      EXPECT_THAT(atlas, EqualsAtlas(before));
    }
  }
}

TEST(OptimizePoseGraph, RefusesConstraintsThatMakeNoSense) {
  Atlas atlas = MakeTruth({"", Sensor::kRgbd, false});
  const Atlas before = atlas;
  const PoseConstraint good = Between(atlas.maps[0], 0, 5);
  const auto kind_of = [&](const std::function<void(PoseConstraint&)>& spoil) {
    PoseConstraint constraint = good;
    spoil(constraint);
    return KindOf([&] { OptimizePoseGraph(atlas, atlas.maps[0].id, {.constraints = {constraint}}); });
  };
  EXPECT_EQ(kind_of([](PoseConstraint& c) { c.second = c.first; }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([](PoseConstraint& c) { c.second = KeyFrameId(999); }), ErrorKind::kNotFound);
  EXPECT_EQ(kind_of([](PoseConstraint& c) { c.first_from_second.scale = 0; }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([](PoseConstraint& c) { c.first_from_second.translation.x() = std::nan(""); }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([](PoseConstraint& c) { c.first_from_second.rotation.coeffs().setZero(); }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([](PoseConstraint& c) { c.information.setZero(); }), ErrorKind::kUsage);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

}  // namespace
}  // namespace slamdb::testing
