// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rtabmap/detail/rtabmap.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>

#include "slamdb/formats/formats.h"
#include "slamdb/formats/rtabmap/fixes.h"
#include "tests/edit/soundness.h"
#include "tests/formats/rtabmap/forge.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

class Rtabmap : public ::testing::Test {
 protected:
  Rtabmap() : path_(folder_.Path("map.db")) {}

  Atlas Read() { return ReadAtlas(path_, {}, &notices_); }
  std::string Told() const {
    std::string told;
    for (const Notice& notice : notices_.items()) told += notice.text + "\n";
    return told;
  }
  static const MapPoint& PointOf(const Map& map, std::uint64_t id) {
    const auto found = std::ranges::find(map.points, MapPointId(id), &MapPoint::id);
    EXPECT_NE(found, map.points.end());
    return *found;
  }

  const TemporaryFolder folder_;
  const std::string path_;
  Notices notices_;
};

class EveryVersion : public Rtabmap, public ::testing::WithParamInterface<std::string> {};

TEST_P(EveryVersion, IsRead) {
  const std::string version = GetParam();
  {
    Forge forge(path_, version);
    AddDrive(forge, version);
  }
  const std::string before = ReadFile(path_);
  EXPECT_EQ(FormatOfInput({path_, ""}).id, "rtabmap");
  const Atlas atlas = Read();
  EXPECT_THAT(folder_.Names(), ElementsAre("map.db"));
  EXPECT_TRUE(ReadFile(path_) == before);
  ASSERT_THAT(atlas.maps, SizeIs(1));
  const Map& map = atlas.maps[0];
  ASSERT_THAT(map.keyframes, SizeIs(kNodes));
  EXPECT_THAT(atlas.cameras[0].parameters, ElementsAre(100, 100, 64, 48));
  const KeyFrame& third = map.keyframes[2];
  EXPECT_EQ(third.id, KeyFrameId(3));
  EXPECT_EQ(third.timestamp, 3.5);
  EXPECT_EQ(third.origin_map, 0U);
  // The camera looks along x of the world, its x to -y.
  EXPECT_LT((third.camera_from_world * Eigen::Vector3f(4, 1, 0) - Eigen::Vector3f(-1, 0, 3.7F)).norm(), 1e-5F);
  EXPECT_EQ(third.bounds.max_x, 128) << "twice the principal point, where no size is there";
  EXPECT_EQ(third.features.keypoints.size(), kPoints);
  EXPECT_EQ(third.features.keypoints[0].octave, version < "0.12" ? 0 : 1);
  EXPECT_NEAR(third.features.depth[0], 3.7F, 1e-4F);
  EXPECT_NEAR(third.features.right_x[0], third.features.keypoints[0].x - 8 / 3.7F, 1e-4F);
  ASSERT_THAT(map.points, SizeIs(kPoints));
  for (int i = 0; i < kPoints; ++i) {
    const MapPoint& point = PointOf(map, static_cast<std::uint64_t>(i) + 1);
    EXPECT_LT((point.position - WallPoint(i).cast<float>()).norm(), 1e-4F);
    EXPECT_THAT(point.observations, SizeIs(kNodes));
    EXPECT_EQ(point.descriptor[0], i);
  }
  EXPECT_THAT(map.keyframes[0].loop_edges, ElementsAre(KeyFrameId(4)));
  EXPECT_THAT(map.keyframes[3].loop_edges, ElementsAre(KeyFrameId(1)));
  EXPECT_EQ(third.previous, KeyFrameId(2));
  EXPECT_EQ(third.next, KeyFrameId(4));
  EXPECT_THAT(Told(), HasSubstr("poses are those of odometry"));
}

INSTANTIATE_TEST_SUITE_P(Versions, EveryVersion,
                         ::testing::Values("0.11.0", "0.11.4", "0.12.5", "0.13.2", "0.16.0", "0.17.1", "0.18.0",
                                           "0.20.0", "0.21.4", "0.23.8"),
                         [](const auto& instance) {
                           std::string name = instance.param;
                           std::ranges::replace(name, '.', '_');
                           return name;
                         });

TEST_F(Rtabmap, TakesOptimisedPosesAndMovesTheOthersWithThem) {
  Forge forge(path_, "0.21.4");
  AddDrive(forge, "0.21.4", {}, 0.3);
  forge.SetOptimized({{1, BaseAt(1)}, {2, BaseAt(2)}, {3, BaseAt(3)}});
  const Atlas atlas = Read();
  EXPECT_THAT(Told(), HasSubstr("the optimised ones of RTAB-Map: 3 nodes"));
  EXPECT_THAT(Told(), HasSubstr("moved as RTAB-Map moved their neighbours: 1 node"));
  EXPECT_LT((atlas.maps[0].keyframes[2].camera_from_world.Center() - Eigen::Vector3f(0.3F, 0, 0)).norm(), 1e-6F);
  // Between nodes 3 and 4 odometry goes 0.3 m along y.
  EXPECT_LT((atlas.maps[0].keyframes[3].camera_from_world.Center() - Eigen::Vector3f(0.4F, 0.3F, 0)).norm(), 1e-5F);
  // Seen from node 4 all points are elsewhere, and are others.
  EXPECT_THAT(PointOf(atlas.maps[0], 1).observations, SizeIs(3));
  EXPECT_THAT(atlas.maps[0].points, SizeIs(2 * kPoints));
}

TEST_F(Rtabmap, SessionsAreMapsUnlessTheGraphJoinsThem) {
  Forge forge(path_, "0.21.4");
  AddDrive(forge, "0.21.4");
  forge.Execute("UPDATE Node SET map_id = 7 WHERE id > 2");
  const Atlas apart = Read();
  ASSERT_THAT(apart.maps, SizeIs(2));
  EXPECT_EQ(apart.maps[1].id, MapId(7));
  EXPECT_THAT(apart.maps[1].keyframes, SizeIs(2));
  EXPECT_THAT(apart.maps[1].points, SizeIs(kPoints));
  EXPECT_NE(apart.maps[0].points[0].id, apart.maps[1].points[0].id);
  forge.SetOptimized({{1, BaseAt(1)}, {2, BaseAt(2)}, {3, BaseAt(3)}, {4, BaseAt(4)}});
  const Atlas joined = Read();
  ASSERT_THAT(joined.maps, SizeIs(1));
  EXPECT_EQ(joined.maps[0].keyframes[3].origin_map, 7U);
}

TEST_F(Rtabmap, OfStereoCamerasHasTheirBaseline) {
  for (const std::string version : {"0.11.0", "0.12.5", "0.21.4"}) {
    SCOPED_TRACE(version);
    const std::string path = folder_.Path(version);
    {
      Forge forge(path, version);
      AddDrive(forge, version, {.baseline = 0.25F});
    }
    const Atlas atlas = ReadAtlas(path);
    const KeyFrame& first = atlas.maps[0].keyframes[0];
    EXPECT_FLOAT_EQ(first.intrinsics.baseline, 0.25F);
    EXPECT_FLOAT_EQ(first.intrinsics.baseline_fx, 25);
    EXPECT_NEAR(first.features.right_x[3], first.features.keypoints[3].x - 25 / 3.9F, 1e-4F);
  }
}

// The second camera looks to the left, along y of the robot.
TEST_F(Rtabmap, EachCameraOfANodeIsAKeyFrame) {
  ForgedCamera left;
  left.local = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()) * ForgedCamera::Optical();
  Forge forge(path_, "0.21.4");
  const Blob calibration = CalibrationBlob("0.21.4", {{}, left});
  forge.AddNode(5, 0, 1, Eigen::Isometry3d::Identity(), calibration);
  forge.AddNode(6, 0, 2, Eigen::Isometry3d::Identity(), calibration);
  forge.AddLink(5, 6, 0);
  forge.AddFeature({.node = 5, .word = 1, .x = 64, .y = 48, .place = {2, 0, 0}, .descriptor = Blob(32, 1)});
  forge.AddFeature({.node = 5, .word = 2, .x = 128 + 64, .y = 48, .place = {0, 3, 0}, .descriptor = Blob(32, 2)});
  const Atlas atlas = Read();
  const Map& map = atlas.maps[0];
  ASSERT_THAT(map.keyframes, SizeIs(4));
  EXPECT_EQ(map.keyframes[0].id, KeyFrameId(10));
  EXPECT_EQ(map.keyframes[1].id, KeyFrameId(11));
  EXPECT_EQ(map.keyframes[1].next, KeyFrameId(13));
  EXPECT_EQ(map.keyframes[1].features.keypoints[0].x, 64);
  EXPECT_NEAR(map.keyframes[1].features.depth[0], 3, 1e-5F);
  EXPECT_LT((map.keyframes[1].camera_from_world * Eigen::Vector3f(0, 3, 0) - Eigen::Vector3f(0, 0, 3)).norm(), 1e-5F);
  EXPECT_THAT(PointOf(map, 2).observations, ElementsAre(Observation{.keyframe = KeyFrameId(11), .left = 0}));
}

TEST_F(Rtabmap, LookAlikesThatShareAWordAreTwoPoints) {
  Forge forge(path_, "0.21.4");
  AddDrive(forge, "0.21.4");
  forge.Execute("UPDATE Feature SET word_id = 1 WHERE word_id = 12");
  const Atlas atlas = Read();
  const Map& map = atlas.maps[0];
  EXPECT_THAT(map.points, SizeIs(kPoints));
  EXPECT_THAT(PointOf(map, 12).observations, SizeIs(kNodes)) << "the first id that no word has";
  EXPECT_LT((PointOf(map, 1).position - WallPoint(0).cast<float>()).norm(), 1e-4F);
  EXPECT_LT((PointOf(map, 12).position - WallPoint(11).cast<float>()).norm(), 1e-4F);
}

TEST_F(Rtabmap, AFeatureWithoutDepthSeesThePointWhereItProjects) {
  Forge forge(path_, "0.21.4");
  AddDrive(forge, "0.21.4");
  forge.Execute("UPDATE Feature SET depth_x = NULL WHERE word_id = 1 AND node_id = 2");
  forge.Execute("UPDATE Feature SET depth_x = NULL, pos_x = pos_x + 40 WHERE word_id = 1 AND node_id = 3");
  forge.Execute("UPDATE Feature SET depth_x = NULL WHERE word_id = 2");
  const Atlas atlas = Read();
  EXPECT_THAT(PointOf(atlas.maps[0], 1).observations, SizeIs(3));
  EXPECT_THAT(atlas.maps[0].points, SizeIs(kPoints - 1));
  EXPECT_THAT(Told(), HasSubstr("1 word that no feature has depth of"));
  EXPECT_EQ(atlas.maps[0].keyframes[1].features.right_x[0], -1);
}

TEST_F(Rtabmap, OtherDescriptorsAreCarried) {
  Forge forge(path_, "0.21.4");
  forge.AddNode(1, 0, 1, Eigen::Isometry3d::Identity(), CalibrationBlob("0.21.4", {{}}));
  std::vector<float> numbers = {0.5F, -2, 3};
  Blob blob(12);
  std::memcpy(blob.data(), numbers.data(), 12);
  for (const int word : {1, 2})
    forge.AddFeature(
        {.node = 1, .word = word, .x = 64, .y = 48, .place = {2, 0, 0}, .descriptor = blob, .descriptor_size = 3});
  const Atlas atlas = Read();
  const KeyFrame& keyframe = atlas.maps[0].keyframes[0];
  ASSERT_TRUE(keyframe.carried);
  const Matrix& matrix = keyframe.carried->descriptors;
  EXPECT_EQ(matrix.rows, 2);
  EXPECT_EQ(matrix.columns, 3);
  EXPECT_EQ(matrix.type, 5);
  EXPECT_EQ(std::memcmp(matrix.data.data() + 12, numbers.data(), 12), 0);
  EXPECT_THAT(keyframe.features.descriptors, IsEmpty());
  EXPECT_EQ(atlas.maps[0].points[0].carried->descriptors.rows, 1);
}

TEST_F(Rtabmap, NodesWithoutPictureOrPoseAreNamed) {
  Forge forge(path_, "0.21.4");
  AddDrive(forge, "0.21.4");
  forge.Execute("UPDATE Data SET calibration = NULL WHERE id = 2; UPDATE Node SET pose = NULL WHERE id = 3");
  EXPECT_THAT(Read().maps[0].keyframes, SizeIs(2));
  EXPECT_THAT(Told(), HasSubstr("1 node without a picture"));
  EXPECT_THAT(Told(), HasSubstr("1 node without a pose"));
}

TEST_F(Rtabmap, WithoutAnyPictureIsAPath) {
  Forge forge(path_, "0.21.4");
  AddDrive(forge, "0.21.4");
  forge.Execute("UPDATE Data SET calibration = NULL");
  const Atlas atlas = Read();
  ASSERT_THAT(atlas.maps[0].keyframes, SizeIs(kNodes));
  EXPECT_EQ(atlas.maps[0].keyframes[1].camera_from_world.Center(), Eigen::Vector3f(0.2F, 0, 0));
}

TEST_F(Rtabmap, GroundTruthIsATrajectoryOfTheCamera) {
  Forge forge(path_, "0.21.4");
  AddDrive(forge, "0.21.4", {}, 0.5);
  for (const int node : {1, 3})
    forge.Bind("UPDATE Node SET ground_truth_pose = ? WHERE id = " + std::to_string(node), PoseBlob(BaseAt(node)));
  const Atlas truth = ReadAtlas(path_, {.format = "rtabmap-truth"}, &notices_);
  ASSERT_THAT(truth.maps[0].keyframes, SizeIs(2));
  EXPECT_EQ(truth.maps[0].keyframes[1].timestamp, 3.5);
  EXPECT_LT(
      (truth.maps[0].keyframes[1].camera_from_world * Eigen::Vector3f(1, 0, 0) - Eigen::Vector3f(0, 0, 0.7F)).norm(),
      1e-5F);
  EXPECT_THAT(Told(), HasSubstr("no ground truth: 2 nodes"));
}

TEST_F(Rtabmap, GpsFixesAreReadForGeoreferencing) {
  Forge forge(path_, "0.21.4");
  AddDrive(forge, "0.21.4");
  EXPECT_THROW(static_cast<void>(ReadRtabmapFixes(path_)), Error) << "there are none";
  const auto set = [&](int node, std::array<double, 6> fix) {
    Blob blob(sizeof fix);
    std::memcpy(blob.data(), fix.data(), sizeof fix);
    forge.Bind("UPDATE Node SET gps = ? WHERE id = " + std::to_string(node), blob);
  };
  set(1, {9.25, 8.5, 47.25, 400, 2, 90});
  set(2, {0, 8.75, 47.5, 401, 2, 90});
  set(3, {7, 8.75, 147, 401, 2, 90});  // no place on earth
  const std::vector<GpsFix> fixes = ReadRtabmapFixes(path_);
  ASSERT_THAT(fixes, SizeIs(2));
  EXPECT_EQ(fixes[0].timestamp, 2.5) << "of the node, where the fix has none";
  EXPECT_EQ(fixes[1].timestamp, 9.25);
  EXPECT_EQ(fixes[1].place, (Geodetic{.latitude = 47.25, .longitude = 8.5, .altitude = 400}));
  Read();
  EXPECT_THAT(Told(), HasSubstr("the file has GPS fixes"));
  set(4, {});
  forge.Execute("UPDATE Node SET gps = x'00' WHERE id = 4");
  EXPECT_THROW(Read(), Error);
}

TEST_F(Rtabmap, OrbFeaturesHaveThePyramidOfItsParameters) {
  Forge forge(path_, "0.21.4");
  AddDrive(forge, "0.21.4");
  forge.Execute("INSERT INTO Info(parameters) VALUES('Kp/DetectorStrategy:2;ORB/ScaleFactor:2;ORB/NLevels:3')");
  EXPECT_EQ(Read().maps[0].keyframes[0].pyramid.factor, 2);
}

// What another program has not committed yet is not there, and its locks do not matter.
TEST_F(Rtabmap, IsReadWhileAnotherProgramLocksIt) {
  Forge forge(path_, "0.21.4");
  AddDrive(forge, "0.21.4");
  forge.Execute("BEGIN EXCLUSIVE; DELETE FROM Node WHERE id > 1");
  const std::vector<std::string> before = folder_.Names();
  EXPECT_THAT(Read().maps[0].keyframes, SizeIs(kNodes));
  EXPECT_EQ(folder_.Names(), before);
  forge.Execute("ROLLBACK");
}

// A program that was killed leaves a log, which is read, and left as it is.
TEST_F(Rtabmap, IsReadWithTheLogBesideIt) {
  Forge forge(path_, "0.21.4");
  AddDrive(forge, "0.21.4");
  forge.Execute("PRAGMA journal_mode = WAL");
  forge.Execute("UPDATE Node SET stamp = stamp + 100");
  const std::string before = ReadFileOrFolder(folder_.path().string());
  EXPECT_EQ(Read().maps[0].keyframes[0].timestamp, 101.5);
  EXPECT_TRUE(ReadFileOrFolder(folder_.path().string()) == before);
}

TEST_F(Rtabmap, IsReadInAFolderThatCannotBeWritten) {
  {
    Forge forge(path_, "0.21.4");
    AddDrive(forge, "0.21.4");
    forge.Execute("PRAGMA journal_mode = WAL");  // which lays files beside it, wherever it is opened
  }
  const std::string before = ReadFileOrFolder(folder_.path().string());
  std::filesystem::permissions(path_, std::filesystem::perms::owner_read);
  std::filesystem::permissions(folder_.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_THAT(Read().maps[0].keyframes, SizeIs(kNodes));
  std::filesystem::permissions(folder_.path(), std::filesystem::perms::owner_all);
  EXPECT_TRUE(ReadFileOrFolder(folder_.path().string()) == before);
}

TEST_F(Rtabmap, IsNeverWrittenTo) {
  const std::string other = folder_.Path("other.db");
  {
    Forge forge(path_, "0.21.4");
    AddDrive(forge, "0.21.4");
  }
  const std::string before = ReadFile(path_);
  EXPECT_THROW(WriteAtlas(Read(), other, {.format = "rtabmap"}), Error);
  EXPECT_THROW(WriteAtlas(Read(), path_ + "#name"), Error) << "as a store";
  EXPECT_THAT(folder_.Names(), ElementsAre("map.db"));
  EXPECT_TRUE(ReadFile(path_) == before);
}

TEST_F(Rtabmap, IsSoundAndLoadsInBoost) {
  {
    Forge forge(path_, "0.21.4");
    AddDrive(forge, "0.21.4");
  }
  const Atlas atlas = Read();
  EXPECT_THAT(testing::NewTroubles({"vocabulary-checksum"}, atlas), IsEmpty());
  EXPECT_EQ(testing::KeyFramesThatBoostReads(atlas, folder_.Path("a.osa")), static_cast<std::size_t>(kNodes));
}

// fixtures/formats/rtabmap, and rtabmap-truth, the same file: SLAMDB_UPDATE_GOLDEN=1 makes them.
TEST_F(Rtabmap, FixtureIsWhatAForgeMakes) {
  const std::string fixture = SLAMDB_FIXTURES "/formats/rtabmap";
  {
    Forge forge(path_, "0.21.4");
    AddDrive(forge, "0.21.4", {}, 0.05);
    forge.SetOptimized({{1, BaseAt(1)}, {2, BaseAt(2)}, {3, BaseAt(3)}, {4, BaseAt(4)}});
    forge.Bind("UPDATE Node SET ground_truth_pose = ?", PoseBlob(BaseAt(1)));
    forge.Execute("UPDATE Node SET time_enter = NULL; VACUUM");
  }
  if (std::getenv("SLAMDB_UPDATE_GOLDEN") != nullptr)
    for (const std::string& name : {fixture, fixture + "-truth"})
      std::filesystem::copy_file(path_, name, std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(ReadAtlas(fixture), EqualsAtlas(Read()));
}

}  // namespace
}  // namespace slamdb
