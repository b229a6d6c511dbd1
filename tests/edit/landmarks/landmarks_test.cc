// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/landmarks/landmarks.h"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <numbers>
#include <set>

#include "slamdb/edit/ids/renumber.h"
#include "slamdb/edit/merge/join.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/index.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/edit/landmarks/some_landmarks.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using ::testing::SizeIs;

Similarity3d SomeTransform() {
  return {2, Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 3).normalized())), {4, 5, -6}};
}

class EverySensor : public ::testing::TestWithParam<Sensor> {
 protected:
  static Atlas Make() {
    return SynthesizeAtlas({.sensor = GetParam(), .maps = 2, .keyframes = 10, .points = 300, .features = 300});
  }
};

TEST_P(EverySensor, PointsBecomeLandmarks) {
  Atlas atlas = Make();
  atlas.maps[1].points[3].bad = true;
  const Atlas before = atlas;
  const MakeLandmarksReport report = MakeLandmarks(atlas, {});
  EXPECT_EQ(report.bad, 1U);
  EXPECT_EQ(report.landmarks, before.maps[0].points.size() + before.maps[1].points.size() - 1);
  EXPECT_LT(report.undetermined, report.landmarks / 10);
  const AtlasIndex index(atlas);
  for (const Landmark& landmark : atlas.maps[0].landmarks) {
    const MapPoint& point = *index.FindPoint(0, MapPointId(landmark.id.value()));
    EXPECT_EQ(landmark.mean, point.position.cast<double>());
    EXPECT_NEAR(landmark.normal.norm(), 1, 1e-12);
    // MRPT's direction: to the cameras.
    EXPECT_LT(landmark.normal.dot(landmark.mean - CameraCenter(*index.FindKeyFrame(0, point.reference)).cast<double>()),
              0);
    EXPECT_EQ(landmark.seen_count, point.observations.size());
    std::uint64_t newest = 0;
    for (const Observation& observation : point.observations)
      newest = std::max(newest, TicksOfSeconds(index.FindKeyFrame(0, observation.keyframe)->timestamp));
    EXPECT_EQ(landmark.last_seen, newest);
    ASSERT_THAT(landmark.features, SizeIs(1));
    const LandmarkFeature& feature = landmark.features[0];
    const KeyFrame& reference = *index.FindKeyFrame(0, point.reference);
    const auto& keypoint = *ObservedKeypoint(reference, static_cast<std::int32_t>(feature.keypoint_id));
    EXPECT_EQ(reference.features.map_points[feature.keypoint_id], point.id);
    EXPECT_EQ(feature.x, keypoint.x);
    EXPECT_EQ(feature.octave, keypoint.octave);
    EXPECT_FLOAT_EQ(feature.orientation, keypoint.angle * std::numbers::pi_v<float> / 180);
    EXPECT_EQ(feature.depth, feature.position_in_camera.z());
    EXPECT_GT(feature.depth, 0);
    ASSERT_THAT(feature.descriptors, SizeIs(1));
    EXPECT_TRUE(std::equal(point.descriptor.begin(), point.descriptor.end(), feature.descriptors[0].bytes.begin()));
    const Eigen::Matrix3d covariance = landmark.pose().covariance;
    EXPECT_TRUE(covariance.isZero(0) || covariance.determinant() > 0);
  }
  for (Map& map : atlas.maps) map.landmarks.clear();
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

TEST_P(EverySensor, ThreadsMakeNoDifference) {
  Atlas one = Make(), many = one;
  MakeLandmarks(one, {.threads = 1});
  MakeLandmarks(many, {.threads = 4});
  EXPECT_THAT(many, EqualsAtlas(one));
}

TEST_P(EverySensor, ThereAndBackPutsPointsWhereTheyWere) {
  Atlas atlas = Make();
  const Atlas before = atlas;
  MakeLandmarks(atlas, {});
  for (Map& map : atlas.maps)
    for (MapPoint& point : map.points) point.position.x() += 1;
  const MakePointsReport report = MakePoints(atlas);
  EXPECT_EQ(report.added, 0U);
  for (Map& map : atlas.maps) map.landmarks.clear();
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

INSTANTIATE_TEST_SUITE_P(Sensors, EverySensor,
                         ::testing::Values(Sensor::kMonocular, Sensor::kStereo, Sensor::kRgbd, Sensor::kFisheyeStereo));

TEST(MakeLandmarks, CovarianceGrowsWithTheNoise) {
  Atlas one = SynthesizeAtlas({.keyframes = 6, .points = 100}), three = one;
  MakeLandmarks(one, {.pixel_sigma = 1});
  MakeLandmarks(three, {.pixel_sigma = 3});
  for (std::size_t i = 0; i < one.maps[0].landmarks.size(); ++i)
    EXPECT_NEAR(three.maps[0].landmarks[i].cov_22, 9 * one.maps[0].landmarks[i].cov_22,
                1e-5 * three.maps[0].landmarks[i].cov_22);
}

TEST(MakeLandmarks, TakesDanglingReferencesAsTheyAre) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 100});
  atlas.maps[0].points[0].observations = {{.keyframe = KeyFrameId(4711), .left = 3}};
  atlas.maps[0].points[1].observations.clear();
  atlas.maps[0].points[2].observations[0].left = 100'000;
  atlas.maps[0].points[2].reference = atlas.maps[0].points[2].observations[0].keyframe;
  EXPECT_GE(MakeLandmarks(atlas, {}).undetermined, 2U);
  EXPECT_TRUE(atlas.maps[0].landmarks[0].features.empty());
  EXPECT_EQ(atlas.maps[0].landmarks[1].seen_count, 0U);
}

TEST(MakePoints, AddsWhatIsNotThere) {
  Atlas atlas;
  Map& map = atlas.maps.emplace_back();
  map.landmarks = {LandmarkAt({1, 2, 3}, {0, 0, 0}), LandmarkAt({4, 5, 6}, {0, 0, 0}), LandmarkAt({0, 0, 0}, {0, 0, 0}),
                   LandmarkAt({2, 2, 2}, {0, 0, 0})};
  map.landmarks[1].id = map.landmarks[3].id = LandmarkId(41);
  map.landmarks[1].CreateOneFeature().descriptors = {{DescriptorKind::kOrb, std::vector<std::uint8_t>(32, 7)}};
  map.landmarks[2].CreateOneFeature().descriptors = {{DescriptorKind::kSift, std::vector<std::uint8_t>(128, 7)}};
  const MakePointsReport report = MakePoints(atlas);
  EXPECT_EQ(report.added, 3U);
  EXPECT_EQ(report.plain, 2U);
  EXPECT_EQ(report.fused, 1U);
  ASSERT_THAT(map.points, SizeIs(3));
  EXPECT_EQ(map.points[0].id, MapPointId(42));
  EXPECT_EQ(map.points[1].id, MapPointId(41));
  EXPECT_EQ(map.points[1].position, Eigen::Vector3f(3, 3.5F, 4));  // the two of this id, fused
  EXPECT_EQ(map.points[1].descriptor[31], 7);
  EXPECT_FALSE(map.points[2].has_descriptor());
  EXPECT_EQ(atlas.next_ids.map_point, 44U);
}

TEST(MakePoints, FindsTheOrbDescriptorThatMrptMisplaced) {
  Atlas atlas;
  atlas.maps.emplace_back().landmarks = {LandmarkAt({1, 2, 3}, {0, 0, 0}), LandmarkAt({1, 2, 3}, {0, 0, 0})};
  for (Landmark& landmark : atlas.maps[0].landmarks)
    landmark.CreateOneFeature().descriptors = {{DescriptorKind::kBld, std::vector<std::uint8_t>(32, 9)}};
  atlas.maps[0].landmarks[0].features[0].type = FeatureType::kOrb;
  EXPECT_EQ(MakePoints(atlas).plain, 1U);
  EXPECT_EQ(atlas.maps[0].points[0].descriptor[5], 9);
}

// Maps of one MRPT stream count their landmarks each from 0, and atlases know a point by its id alone.
TEST(MakePoints, GivesNoIdTwice) {
  Atlas atlas;
  for (const std::uint64_t id : {0, 1}) {
    Map& map = atlas.maps.emplace_back();
    map.id = MapId(id);
    map.landmarks = {LandmarkAt({1, 2, 3}, {1, 1, 1}), LandmarkAt({4, 5, 6}, {1, 1, 1}),
                     LandmarkAt({7, 8, 9}, {1, 1, 1})};
    map.landmarks[0].id = LandmarkId(0);
    map.landmarks[1].id = LandmarkId(static_cast<std::uint64_t>(-2));
  }
  const MakePointsReport report = MakePoints(atlas);
  EXPECT_EQ(report.added, 6U);
  EXPECT_EQ(report.renamed, 1U);
  std::set<std::uint64_t> ids;
  for (const Map& map : atlas.maps)
    for (std::size_t row = 0; row < 3; ++row) {
      EXPECT_TRUE(ids.insert(map.points[row].id.value()).second);
      EXPECT_LT(map.points[row].id.value(), atlas.next_ids.map_point);
      EXPECT_EQ(map.landmarks[row].id.value(), map.points[row].id.value());
    }
  EXPECT_EQ(atlas.maps[0].points[0].id, MapPointId(0));
  const Atlas once = atlas;
  EXPECT_EQ(MakePoints(atlas).added, 0U);
  EXPECT_THAT(atlas, EqualsAtlas(once));
}

// How many points a frame takes for in view: those whose normal is within 60 degrees of the ray, as isInFrustum asks.
std::size_t InView(const Atlas& atlas, std::size_t keyframe) {
  const Eigen::Vector3f center = CameraCenter(atlas.maps[0].keyframes[keyframe]);
  return static_cast<std::size_t>(std::ranges::count_if(atlas.maps[0].points, [&](const MapPoint& point) {
    return (point.position - center).normalized().dot(point.normal) >= 0.5F;
  }));
}

TEST(MakePoints, AsManyAreInViewAsBefore) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 10, .points = 300, .features = 300});
  const std::size_t before = InView(atlas, 3);
  EXPECT_GT(before, 50U);
  MakeLandmarks(atlas);
  MakePoints(atlas);
  EXPECT_EQ(InView(atlas, 3), before);
  Atlas made;  // of the landmarks alone
  made.maps.emplace_back().landmarks = atlas.maps[0].landmarks;
  made.maps[0].keyframes = atlas.maps[0].keyframes;
  MakePoints(made);
  EXPECT_GE(InView(made, 3), before) << "unit vectors";
}

TEST(MakePoints, KeepsTheNormalWhereALandmarkHasNone) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 100});
  const Eigen::Vector3f normal = atlas.maps[0].points[7].normal;
  MakeLandmarks(atlas);
  for (Landmark& landmark : atlas.maps[0].landmarks) landmark.normal.setZero();  // as in MRPT 3
  MakePoints(atlas);
  EXPECT_EQ(atlas.maps[0].points[7].normal, normal);
}

TEST(MakePoints, TurnsWhatEarlierVersionsMade) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 100});
  const Atlas before = atlas;
  MakeLandmarks(atlas);
  for (Landmark& landmark : atlas.maps[0].landmarks) landmark.normal = -landmark.normal;
  EXPECT_EQ(MakePoints(atlas).turned, atlas.maps[0].landmarks.size());
  for (Map& map : atlas.maps) map.landmarks.clear();
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

// Two thirds of the normals are wrong: the others are right, and stay.
TEST(MakePoints, TurnsOnlyWhatItsPointTells) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 100});
  const Atlas before = atlas;
  MakeLandmarks(atlas);
  std::vector<Landmark>& landmarks = atlas.maps[0].landmarks;
  std::size_t turned = 0;
  for (std::size_t row = 0; row < landmarks.size(); ++row)
    if (row % 3 != 0) {
      landmarks[row].normal = -landmarks[row].normal;
      ++turned;
    }
  Landmark& alone = landmarks.emplace_back(landmarks[0]);  // no point tells
  alone.id = LandmarkId(1'000'000);
  const Eigen::Vector3d normal = alone.normal;
  const MakePointsReport report = MakePoints(atlas);
  EXPECT_EQ(report.turned, turned);
  EXPECT_EQ(report.unturned, 1U);
  EXPECT_EQ(atlas.maps[0].landmarks.back().normal, normal);
  for (std::size_t row = 0; row < before.maps[0].points.size(); ++row)
    EXPECT_EQ(atlas.maps[0].points[row].normal, before.maps[0].points[row].normal);
}

TEST(MakePoints, TurnsTheRestWithNineTenthsOfTheOthers) {
  for (const std::size_t right : {5U, 20U}) {
    Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 100});
    MakeLandmarks(atlas);
    std::vector<Landmark>& landmarks = atlas.maps[0].landmarks;
    ASSERT_GE(landmarks.size(), 60U);
    for (std::size_t row = right; row < landmarks.size(); ++row) landmarks[row].normal = -landmarks[row].normal;
    Landmark& alone = landmarks.emplace_back(landmarks.back());
    alone.id = LandmarkId(1'000'000);
    const std::size_t others = landmarks.size() - 1 - right;
    const bool overwhelming = others >= 9 * right;
    const MakePointsReport report = MakePoints(atlas);
    EXPECT_EQ(report.turned, others + (overwhelming ? 1 : 0));
    EXPECT_EQ(report.unturned, overwhelming ? 0U : 1U);
  }
}

TEST(LayLandmarks, ChangesNothingWhereNothingChanged) {
  Atlas atlas = SynthesizeAtlas({.maps = 2, .keyframes = 6, .points = 100});
  const Atlas before = atlas;
  const LayLandmarksReport report = LayLandmarks(atlas, LandmarksOf(atlas));
  EXPECT_EQ(report.moved, before.maps[0].points.size() + before.maps[1].points.size());
  EXPECT_EQ(report.same, report.moved);
  EXPECT_EQ(report.taken, report.moved);
  EXPECT_EQ(report.counts, 0U);
  EXPECT_EQ(report.without, 0U);
  EXPECT_EQ(atlas.maps[1].landmarks.size(), atlas.maps[1].points.size());
  for (Map& map : atlas.maps) map.landmarks.clear();
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

TEST(LayLandmarks, MovesPointsAndKeepsTimesAndCounts) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 100});
  const Atlas before = atlas;
  Atlas file = LandmarksOf(atlas);
  std::vector<Landmark>& landmarks = file.maps[0].landmarks;
  landmarks[5].mean += Eigen::Vector3d(1, 2, 3);
  landmarks[5].normal = {0, 0, -1};
  landmarks[5].seen_count = 77;
  landmarks[6].last_seen += 5;
  landmarks.erase(landmarks.begin() + 9);
  const LayLandmarksReport report = LayLandmarks(atlas, file);
  EXPECT_EQ(report.moved - report.same, 1U);
  EXPECT_EQ(report.counts, 2U);
  EXPECT_EQ(report.without, 1U);
  const MapPoint &moved = atlas.maps[0].points[5], &was = before.maps[0].points[5];
  EXPECT_TRUE(moved.position.isApprox(was.position + Eigen::Vector3f(1, 2, 3)));
  EXPECT_TRUE(moved.normal.isApprox(Eigen::Vector3f(0, 0, was.normal.norm())));
  EXPECT_EQ(moved.observations.size(), was.observations.size());
  EXPECT_EQ(atlas.maps[0].landmarks[5].seen_count, 77U);
  EXPECT_EQ(atlas.maps[0].landmarks[6].last_seen, landmarks[6].last_seen);
}

TEST(LayLandmarks, NamesWhatDoesNotFit) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 100});
  Atlas file = LandmarksOf(atlas);
  file.maps[0].landmarks.resize(3);
  file.maps.emplace_back().id = MapId(9);  // before anybody refers to the first
  std::vector<Landmark>& landmarks = file.maps[0].landmarks;
  landmarks.push_back(LandmarkAt({1, 1, 1}, {1, 1, 1}));
  landmarks.push_back(LandmarkAt({1, 1, 1}, {1, 1, 1}));
  landmarks.back().id = LandmarkId(1'000'000);
  landmarks[1].mean.x() = std::numeric_limits<double>::infinity();
  file.maps[1].landmarks = {landmarks[2]};
  Atlas added = atlas;
  const LayLandmarksReport report = LayLandmarks(atlas, file);
  EXPECT_EQ(report.moved, 1U);
  EXPECT_EQ(report.infinite, (std::vector{landmarks[1].id}));
  EXPECT_EQ(report.ambiguous, (std::vector{landmarks[2].id, landmarks[2].id}));
  EXPECT_EQ(report.not_there, (std::vector{LandmarkId(), LandmarkId(1'000'000)}));
  EXPECT_EQ(LayLandmarks(added, file, {.add = true}).added, 1U);
  Atlas twice = added;
  twice.maps[0].landmarks.clear();
  file.maps[0].landmarks[4].id = file.maps[1].landmarks[0].id = LandmarkId(2'000'000);
  EXPECT_EQ(LayLandmarks(twice, file, {.add = true}).added, 0U) << "no id is given twice";
  EXPECT_EQ(added.maps[0].points.back().id, MapPointId(1'000'000));
  EXPECT_GT(added.next_ids.map_point, 1'000'000U);
}

// Landmarks keep the ids of their points, and stay where those are, whatever happens to the maps.
TEST(MakeLandmarks, TravelThroughRenumberingAndJoining) {
  Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kRgbd, .maps = 2, .keyframes = 6, .points = 100});
  MakeLandmarks(atlas, {});
  const std::size_t landmarks = atlas.maps[0].landmarks.size() + atlas.maps[1].landmarks.size();
  Renumber(atlas, {.kinds = {IdKind::kPoint}, .start = 5000});
  JoinMaps(
      atlas,
      {.first = atlas.maps[0].id, .second = atlas.maps[1].id, .first_from_second = SomeTransform(), .force = true});
  ASSERT_THAT(atlas.maps, SizeIs(1));
  ASSERT_THAT(atlas.maps[0].landmarks, SizeIs(landmarks));
  const AtlasIndex index(atlas);
  for (const Landmark& landmark : atlas.maps[0].landmarks) {
    const MapPoint* point = index.FindPoint(0, MapPointId(landmark.id.value()));
    ASSERT_NE(point, nullptr);
    EXPECT_LT((landmark.mean - point->position.cast<double>()).norm(), 1e-5);
  }
}

TEST(TransformLandmarks, MovesMeanCovarianceAndNormal) {
  Landmark landmark = LandmarkAt({1, 2, 3}, {1, 2, 3});
  landmark.cov_12 = 0.5;
  landmark.normal = {0, 0, 1};
  landmark.CreateOneFeature().depth = 4;
  const GaussianPoint before = landmark.pose();
  const Similarity3d transform = SomeTransform();
  TransformLandmarks({&landmark, 1}, transform);
  const Eigen::Matrix3d turn = transform.rotation.toRotationMatrix();
  EXPECT_TRUE(landmark.mean.isApprox(transform * before.mean));
  EXPECT_TRUE(landmark.pose().covariance.isApprox(4 * turn * before.covariance * turn.transpose()));
  EXPECT_TRUE(landmark.normal.isApprox(turn.col(2)));
  EXPECT_EQ(landmark.features[0].depth, 8);
  TransformLandmarks({&landmark, 1}, transform.Inverse());
  EXPECT_TRUE(landmark.mean.isApprox(before.mean));
  EXPECT_TRUE(landmark.pose().covariance.isApprox(before.covariance));
}

}  // namespace
}  // namespace slamdb
