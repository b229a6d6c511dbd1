// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/put_poses.h"

#include <gmock/gmock.h>

#include <cmath>

#include "slamdb/base/error.h"
#include "slamdb/model/derive.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/message_of.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Similarity3d PoseOf(const KeyFrame& keyframe) {
  const Rigid3f& pose = keyframe.camera_from_world;
  return Similarity3d{1, Eigen::Quaternionf(pose.rotation).cast<double>().normalized(), pose.translation.cast<double>()}
      .Inverse();
}

std::vector<KeyFramePose> PosesOf(const Map& map) {
  std::vector<KeyFramePose> poses;
  for (const KeyFrame& keyframe : map.keyframes) poses.push_back({keyframe.id, keyframe.timestamp, PoseOf(keyframe)});
  return poses;
}

Atlas InertialWorld() {
  return SynthesizeAtlas(
      {.sensor = Sensor::kStereo, .inertial = true, .keyframes = 12, .points = 300, .features = 150});
}

TEST(PutPoses, ThatAreThereChangeNothing) {
  const Atlas atlas = InertialWorld();
  Atlas put = atlas;
  const PutPosesReport report = PutPoses(put, PosesOf(atlas.maps[0]));
  EXPECT_EQ(report.keyframes, 12U);
  EXPECT_EQ(report.unknown_poses, 0U);
  EXPECT_THAT(put, EqualsAtlas(atlas));
}

TEST(PutPoses, OfTheBodyLeadToTheCamera) {
  const Atlas atlas = InertialWorld();
  std::vector<KeyFramePose> poses = PosesOf(atlas.maps[0]);
  for (std::size_t row = 0; row < poses.size(); ++row) {
    const Rigid3f body = WorldFromBody(atlas.maps[0].keyframes[row]);
    poses[row].world_from_camera = {1, Eigen::Quaternionf(body.rotation).cast<double>().normalized(),
                                    body.translation.cast<double>()};
  }
  Atlas put = atlas;
  EXPECT_LT(PutPoses(put, poses, {.of_body = true}).largest_shift, 1e-5);
  for (std::size_t row = 0; row < poses.size(); ++row)
    EXPECT_LT(
        PoseOf(put.maps[0].keyframes[row]).rotation.angularDistance(PoseOf(atlas.maps[0].keyframes[row]).rotation),
        1e-5);
  put = atlas;
  EXPECT_GT(PutPoses(put, poses).largest_shift, 0.01);  // taken for the camera's

  Atlas bare = atlas;
  bare.maps[0].keyframes[3].imu_calibration.is_set = false;
  const Atlas before = bare;
  EXPECT_THAT(MessageOf([&] { PutPoses(bare, poses, {.of_body = true}); }), HasSubstr("kf 3 has no IMU calibration"));
  bare = atlas;
  bare.maps[0].keyframes[3].imu_calibration.body_from_camera.rotation.coeffs() *= 0.1F;  // no rotation
  EXPECT_THAT(MessageOf([&] { PutPoses(bare, poses, {.of_body = true}); }), HasSubstr("kf 3 has no IMU calibration"));
  bare = before;
  EXPECT_THROW(PutPoses(bare, poses, {.of_body = true}), Error);
  EXPECT_THAT(bare, EqualsAtlas(before));
}

// Positions were taken to an origin among them: those of the atlas are not there, or are.
TEST(PutPoses, LieWhereTheAtlasDoes) {
  const Atlas atlas = InertialWorld();
  const Eigen::Vector3d origin(4'000'000, -3'000'000, 500'000);
  std::vector<KeyFramePose> poses = PosesOf(atlas.maps[0]);
  PutPosesOptions options{.origin = origin};
  options.points.push_back({.point = atlas.maps[0].points[0].id,
                            .position = atlas.maps[0].points[0].position.cast<double>() + Eigen::Vector3d(1, 2, 3)});
  Atlas put = atlas;
  const PutPosesReport stays = PutPoses(put, poses, options);
  EXPECT_LT(stays.largest_shift, 1e-5);
  EXPECT_THAT(
      stays.warnings,
      ::testing::Contains(HasSubstr("positions stay as the atlas has them: without (4000000, -3000000, 500000")));

  for (KeyFramePose& pose : poses) pose.world_from_camera.translation -= origin;
  options.points[0].position -= origin;
  Atlas far = atlas;
  const PutPosesReport moves = PutPoses(far, poses, options);
  EXPECT_LT(moves.largest_shift, 1e-5);
  EXPECT_EQ(far.maps[0].points[0].position, put.maps[0].points[0].position);
}

// A part of a model has another middle than the whole that the atlas was made of, by whole numbers.
TEST(PutPoses, OfAPartLieWhereTheAtlasOfTheWholeDoes) {
  const Atlas atlas = InertialWorld();
  const Eigen::Vector3d origin(500'000, 5'400'000, 500), other(1, 0, 2), adjusted(0.3, -0.1, 0);
  std::vector<KeyFramePose> poses = PosesOf(atlas.maps[0]);
  poses.resize(9);
  for (KeyFramePose& pose : poses) pose.world_from_camera.translation += adjusted - other;
  poses[4].world_from_camera.translation.x() += 7;
  PutPosesOptions options{.origin = origin + other};
  options.points.push_back(
      {.point = atlas.maps[0].points[0].id, .position = atlas.maps[0].points[0].position.cast<double>() - other});
  Atlas put = atlas;
  const PutPosesReport report = PutPoses(put, poses, options);
  EXPECT_THAT(report.warnings, ::testing::Contains(HasSubstr("without (500000, 5400000, 500), which the poses have")));
  for (std::size_t row = 0; row < poses.size(); ++row) {
    const Eigen::Vector3d shift =
        PoseOf(put.maps[0].keyframes[row]).translation - PoseOf(atlas.maps[0].keyframes[row]).translation;
    EXPECT_LT((shift - adjusted - Eigen::Vector3d(row == 4 ? 7 : 0, 0, 0)).norm(), 1e-5) << row;
  }
  EXPECT_LT((put.maps[0].points[0].position - atlas.maps[0].points[0].position).norm(), 1e-5F);

  Atlas moved = atlas;  // nothing was taken off: a shift is one
  EXPECT_NEAR(PutPoses(moved, poses).largest_shift, (adjusted - other + Eigen::Vector3d(7, 0, 0)).norm(), 1e-5);
}

TEST(PutPoses, NameWhatFloatsRound) {
  const Atlas atlas = InertialWorld();
  std::vector<KeyFramePose> poses = PosesOf(atlas.maps[0]);
  Atlas put = atlas;
  EXPECT_THAT(PutPoses(put, poses).losses, ElementsAre());
  for (KeyFramePose& pose : poses) pose.world_from_camera.translation += Eigen::Vector3d(500'000.3, 5'400'000.6, 500.2);
  EXPECT_THAT(PutPoses(put, poses).losses,
              ElementsAre(HasSubstr("coordinates are rounded to the 32-bit floats of an atlas: 12, by up to 0.")));
}

// One keyframe moves; the points that refer to it stay where they are in its picture.
TEST(PutPoses, ChangeNothingElse) {
  const Atlas atlas = InertialWorld();
  const std::size_t moved = 5;
  const Similarity3d motion{
      1, Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ())), {0.25, -0.5, 0.125}};
  std::vector<KeyFramePose> poses = PosesOf(atlas.maps[0]);
  poses[moved].world_from_camera = motion * poses[moved].world_from_camera;
  Atlas put = atlas;
  PutPoses(put, poses);
  Map& map = put.maps[0];
  const Map& before = atlas.maps[0];
  const KeyFrame& keyframe = map.keyframes[moved];
  EXPECT_LT((CameraCenter(keyframe).cast<double>() - poses[moved].world_from_camera.translation).norm(), 1e-5);
  EXPECT_LT(
      (keyframe.velocity.cast<double>() - motion.rotation * before.keyframes[moved].velocity.cast<double>()).norm(),
      1e-5);
  std::size_t followed = 0;
  for (std::size_t row = 0; row < map.points.size(); ++row) {
    MapPoint& point = map.points[row];
    const MapPoint& was = before.points[row];
    const bool follows = point.reference == keyframe.id;
    const Eigen::Vector3d expected = motion * was.position.cast<double>();
    if (follows) {
      EXPECT_LT((point.position.cast<double>() - expected).norm(), 1e-4);
      ++followed;
    }
    bool seen = follows;
    for (const Observation& observation : point.observations) seen |= observation.keyframe == keyframe.id;
    if (follows) point.position = was.position;
    if (!seen) continue;
    point.normal = was.normal;
    point.min_distance = was.min_distance;
    point.max_distance = was.max_distance;
  }
  EXPECT_GT(followed, 0U);
  map.keyframes[moved].camera_from_world = before.keyframes[moved].camera_from_world;
  map.keyframes[moved].body_position = before.keyframes[moved].body_position;
  map.keyframes[moved].velocity = before.keyframes[moved].velocity;
  EXPECT_THAT(put, EqualsAtlas(atlas));
}

TEST(PutPoses, GiveTheSameForAnyNumberOfThreads) {
  const Atlas atlas = InertialWorld();
  std::vector<KeyFramePose> poses = PosesOf(atlas.maps[0]);
  for (KeyFramePose& pose : poses)
    pose.world_from_camera.translation.x() += 0.1 * static_cast<double>(pose.keyframe.value() % 3);
  Atlas alone = atlas, many = atlas;
  PutPoses(alone, poses, {.threads = 1});
  PutPoses(many, poses, {.threads = 5});
  EXPECT_THAT(many, EqualsAtlas(alone));
}

TEST(PutPoses, LeaveMapsAloneForWhichThereIsNothing) {
  const Atlas atlas = SynthesizeAtlas({.maps = 2, .keyframes = 6, .points = 100, .features = 100});
  std::vector<KeyFramePose> poses = PosesOf(atlas.maps[1]);
  for (KeyFramePose& pose : poses) pose.world_from_camera.translation.y() += 1;
  Atlas put = atlas;
  EXPECT_EQ(PutPoses(put, poses).maps, 1U);
  EXPECT_NE(put.maps[1].points[0].position, atlas.maps[1].points[0].position);
  put.maps[1] = atlas.maps[1];
  EXPECT_THAT(put, EqualsAtlas(atlas));
}

TEST(PutPoses, KeepTheFirstOfSeveralOfOneKeyFrame) {
  Atlas atlas = OneMapAtlas();
  const auto at = [](double x) { return Similarity3d{1, Eigen::Quaterniond::Identity(), {x, 0, 0}}; };
  const PutPosesReport report = PutPoses(atlas, {{KeyFrameId(3), 0, at(5)}, {KeyFrameId(3), 0, at(6)}});
  EXPECT_EQ(CameraCenter(atlas.maps[0].keyframes[0]), Eigen::Vector3f(5, 0, 0));
  EXPECT_EQ(report.unknown_poses, 1U);
  EXPECT_THAT(report.warnings, ElementsAre(HasSubstr("1 pose left out")));
}

// A cycle of parents ends; a keyframe without a parent stays.
TEST(PutPoses, FollowSpanningTreesThatAreNone) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 50, .features = 80});
  Map& map = atlas.maps[0];
  map.keyframes[1].parent = map.keyframes[2].id;
  map.keyframes[2].parent = map.keyframes[1].id;
  map.keyframes[3].parent = KeyFrameId(1'000'000);
  const Eigen::Vector3f center = CameraCenter(map.keyframes[1]);
  Similarity3d pose = PoseOf(map.keyframes[5]);
  pose.translation.x() += 1;
  PutPoses(atlas, {{map.keyframes[5].id, 0, pose}});
  EXPECT_EQ(CameraCenter(map.keyframes[1]), center);
}

TEST(PutPoses, PointsGoWithTheirReferenceKeyFrameAndScaleAboutIt) {
  for (const double scale : {1.0, 2.0}) {
    Atlas atlas = OneMapAtlas();  // kf 1 at the origin, kf 3 at (1, 0, 0), no turns; mp 10 at (0, 0, 2) of kf 1
    const std::vector<KeyFramePose> poses = {
        {KeyFrameId(1),
         0,
         {scale, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY())), {5, 0, 0}}}};
    const PutPosesReport report = PutPoses(atlas, poses);
    const Map& map = atlas.maps[0];
    EXPECT_TRUE(map.points[0].position.isApprox(Eigen::Vector3f(5 + 2 * static_cast<float>(scale), 0, 0), 1e-5F));
    EXPECT_EQ(report.followers, 1U);  // kf 3 goes with its parent
    EXPECT_TRUE(CameraCenter(map.keyframes[0]).isApprox(Eigen::Vector3f(5, 0, -static_cast<float>(scale)), 1e-5F));
    EXPECT_NEAR(report.largest_shift, 5, 1e-9);
  }
}

TEST(PutPoses, TakeTimesWhereThereAreNoIds) {
  Atlas atlas = OneMapAtlas();
  const PutPosesReport report = PutPoses(atlas, {{KeyFrameId(), 1.501, {1, Eigen::Quaterniond::Identity(), {9, 0, 0}}},
                                                 {KeyFrameId(), 17, {1, Eigen::Quaterniond::Identity(), {9, 0, 0}}}});
  EXPECT_EQ(report.keyframes, 1U);
  EXPECT_EQ(report.unknown_poses, 1U);
  EXPECT_EQ(CameraCenter(atlas.maps[0].keyframes[0]), Eigen::Vector3f(9, 0, 0));
  EXPECT_EQ(CameraCenter(atlas.maps[0].keyframes[1]), Eigen::Vector3f(0, 0, 0));
}

TEST(PutPoses, TakePositionsOfPoints) {
  Atlas atlas = OneMapAtlas();
  const Eigen::Vector3f other = atlas.maps[0].points[2].position;
  const PutPosesReport report = PutPoses(
      atlas, {}, {.points = {{MapPointId(10), {0, 0, 4}}, {MapPointId(11), {1, 1, 1}}, {MapPointId(99), {1, 1, 1}}}});
  EXPECT_EQ(report.points, 1U);
  EXPECT_EQ(report.unknown_points, 2U);  // one is bad, one is not there
  EXPECT_EQ(atlas.maps[0].points[0].position, Eigen::Vector3f(0, 0, 4));
  EXPECT_EQ(atlas.maps[0].points[2].position, other);
}

// Programs that make points anew number them from 1 on: an id alone does not tell that it is the same point.
TEST(PutPoses, LeavePointsThatAreSeenElsewhere) {
  Atlas atlas = OneMapAtlas();
  const PointPosition same{MapPointId(10), {0, 0, 4}, KeyFrameId(3), 0};
  const PointPosition other{MapPointId(10), {9, 9, 9}, KeyFrameId(3), 1};
  EXPECT_EQ(PutPoses(atlas, {}, {.points = {same}}).points, 1U);
  const std::vector<KeyFramePose> poses = {{KeyFrameId(1), 0.5, {}}};
  EXPECT_EQ(PutPoses(atlas, poses, {.points = {other}}).unknown_points, 1U);
  EXPECT_EQ(atlas.maps[0].points[0].position, Eigen::Vector3f(0, 0, 4));
}

// Ids begin anew in every atlas: the time tells whether a keyframe is the same one.
TEST(PutPoses, RefuseThoseOfAnotherAtlas) {
  const Atlas before = OneMapAtlas();
  const KeyFrame& keyframe = before.maps[0].keyframes[0];
  const auto put_at = [&](double time, bool has_time) {
    Atlas atlas = before;
    return PutPoses(atlas, {{.keyframe = keyframe.id, .timestamp = time, .has_time = has_time}}).keyframes;
  };
  EXPECT_EQ(put_at(keyframe.timestamp + 0.004, true), 1U);
  EXPECT_EQ(put_at(keyframe.timestamp + 7, false), 1U);
  EXPECT_EQ(put_at(std::nan(""), true), 1U);
  try {
    put_at(keyframe.timestamp + 7, true);
    FAIL() << "put";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kNotPossible);
    EXPECT_THAT(error.what(), HasSubstr("the poses are of another atlas: kf "));
  }
}

TEST(PutPoses, WarnOfOtherLenses) {
  Atlas before = OneMapAtlas();
  KeyFrame& keyframe = before.maps[0].keyframes[0];
  Intrinsics& it = keyframe.intrinsics;
  it.fx = it.fy = 500;
  it.cx = 320;
  it.cy = 240;
  const std::vector<double> same = {500, 500, 320, 240};
  const auto warnings_of = [&](const std::vector<double>& lens) {
    Atlas atlas = before;
    return PutPoses(atlas, {{.keyframe = keyframe.id, .lens = lens}}).warnings;
  };
  const std::vector<std::string> of_none = warnings_of({});
  EXPECT_EQ(warnings_of(same), of_none);
  std::vector<double> longer = same, bent = same;
  longer[0] += 1;
  bent.insert(bent.end(), {0.25, 0});
  for (const std::vector<double>& lens : {longer, bent}) {
    const std::vector<std::string> warnings = warnings_of(lens);
    ASSERT_EQ(warnings.size(), of_none.size() + 1);
    EXPECT_THAT(warnings.back(), HasSubstr("1 pose of another lens than the atlas has, as that of kf "));
  }
}

TEST(PutPoses, RefuseWhatIsNoneOrOfNoKeyFrame) {
  Atlas atlas = OneMapAtlas();
  const Similarity3d somewhere{1, Eigen::Quaterniond::Identity(), {1, 1, 1}};
  EXPECT_THROW(PutPoses(atlas, {{KeyFrameId(77), 0, somewhere}}), Error);
  Similarity3d nowhere = somewhere;
  nowhere.translation.x() = std::nan("");
  EXPECT_THROW(PutPoses(atlas, {{KeyFrameId(1), 0, nowhere}}), Error);
  nowhere = somewhere;
  nowhere.scale = 0;
  EXPECT_THROW(PutPoses(atlas, {{KeyFrameId(1), 0, nowhere}}), Error);
}

}  // namespace
}  // namespace slamdb
