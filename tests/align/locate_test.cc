// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/locate.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "slamdb/align/locate_report.h"
#include "slamdb/evaluate/evaluate.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/model/statistics.h"
#include "slamdb/pictures/picture_list.h"
#include "slamdb/pictures/pictures.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/kind_of.h"

namespace slamdb {
namespace {

Atlas World(std::uint64_t seed) {
  return SynthesizeAtlas({.sensor = Sensor::kStereo, .keyframes = 24, .points = 1500, .seed = seed, .threads = 1});
}

TEST(Locator, FindsAKeyFrameThatTheMapNeverHad) {
  const Atlas atlas = World(1);
  const Locator locator(atlas, {.threads = 1});
  const Localization found = locator.LocateLeftOut({0, 7});
  ASSERT_EQ(found.verdict, LocateVerdict::kFound) << found.reason;
  const KeyFrame& keyframe = atlas.maps[0].keyframes[7];
  EXPECT_NE(found.resembles, keyframe.id);
  EXPECT_EQ(found.map, atlas.maps[0].id);
  EXPECT_LT((found.position - keyframe.camera_from_world.Center().cast<double>()).norm(), 0.05);
  EXPECT_LT(PrecisionOf(found).position, 0.05);
  EXPECT_GE(found.evidence.inliers, 30U);
}

TEST(Locator, FindsNothingOfAnotherWorld) {
  const Atlas atlas = World(1), other = World(2);
  const Locator locator(atlas, {.threads = 1});
  for (const KeyFrame& keyframe : other.maps[0].keyframes)
    EXPECT_NE(locator.Locate(FeaturesOf(other, keyframe)).verdict, LocateVerdict::kFound);
}

// As the fragments that tracking losses leave, or atlases put side by side.
TEST(Locator, MapsOfOnePlaceDoNotContradictEachOther) {
  Atlas atlas = World(1);
  atlas.maps.push_back(atlas.maps.front());
  atlas.maps.back().id = MapId(7);
  const Locator locator(atlas, {.threads = 1});
  for (const std::size_t row : {3U, 9U, 15U}) {
    const Localization found = locator.Locate(FeaturesOf(atlas, atlas.maps[0].keyframes[row]));
    EXPECT_EQ(found.verdict, LocateVerdict::kFound) << found.reason;
  }
}

TEST(Locator, SurvivesPicturesThatAreNone) {
  const Atlas atlas = World(1);
  const Locator locator(atlas, {.threads = 1});
  EXPECT_EQ(locator.Locate({}).verdict, LocateVerdict::kNotFound);
  PictureFeatures picture = FeaturesOf(atlas, atlas.maps[0].keyframes[3]);
  for (Keypoint& keypoint : picture.keypoints) {
    keypoint.x = std::numeric_limits<float>::quiet_NaN();
    keypoint.octave = std::numeric_limits<std::int32_t>::max();
  }
  EXPECT_NE(locator.Locate(picture).verdict, LocateVerdict::kFound);
  picture = FeaturesOf(atlas, atlas.maps[0].keyframes[3]);
  picture.camera.parameters.clear();
  EXPECT_EQ(locator.Locate(picture).verdict, LocateVerdict::kNotFound);
  EXPECT_EQ(KindOf([] { const Locator none{Atlas()}; }), ErrorKind::kNotPossible);
}

TEST(BenchmarkLocating, IsTheSameForAnyNumberOfThreads) {
  const Atlas atlas = World(1);
  const Locator locator(atlas, {.threads = 1});
  const LocateReport one = BenchmarkLocating(locator, atlas, {.most_keyframes = 12, .threads = 1});
  EXPECT_EQ(one.pictures.size(), 12U);
  EXPECT_GE(one.found(), 10U);
  ASSERT_TRUE(one.MedianError());
  EXPECT_LT(one.MedianError()->position, 0.03);
  EXPECT_EQ(ToJson(one, "a"), ToJson(BenchmarkLocating(locator, atlas, {.most_keyframes = 12, .threads = 4}), "a"));
}

TEST(Locator, AsksAtPlacesThatAreKnown) {
  const Atlas atlas = World(1);
  const Locator locator(atlas, {.places_are_known = true, .threads = 1});
  const KeyFrame& keyframe = atlas.maps[0].keyframes[7];
  const PictureFeatures picture = FeaturesOf(atlas, keyframe);
  const std::vector<KeyFrameRef> near = {{0, 8}, {0, 9}}, far = {{0, 19}}, none = {{0, 99}, {5, 0}};
  const Localization found = locator.LocateAt(picture, near);
  ASSERT_EQ(found.verdict, LocateVerdict::kFound) << found.reason;
  EXPECT_LT((found.position - keyframe.camera_from_world.Center().cast<double>()).norm(), 0.05);
  EXPECT_EQ(found.evidence.candidates, 2U);
  EXPECT_NE(locator.LocateAt(picture, far).verdict, LocateVerdict::kFound);
  EXPECT_EQ(locator.LocateAt(picture, none).verdict, LocateVerdict::kNotFound);
  EXPECT_EQ(locator.LocateAt({}, near).verdict, LocateVerdict::kNotFound);
  EXPECT_EQ(locator.Locate(picture).verdict, LocateVerdict::kNotFound) << "it has no words to recognise places by";
}

// Rendered rooms with true poses (SLAMDB_LAB2, with its folder `frames`): which of their pictures are found in a map,
// never in a wrong place: what was found, laid onto the truth as a whole, misses it nowhere by 10 cm or 3 degrees.
struct Room {
  const char* map;
  std::size_t at_least;  // one more than ORB-SLAM3 finds with its own relocalisation
};
class LocateReal : public ::testing::TestWithParam<Room> {};

TEST_P(LocateReal, FindsMoreThanOrbSlamAndNothingWrong) {
  const char* lab = std::getenv("SLAMDB_LAB2");
  if (lab == nullptr) GTEST_SKIP() << "SLAMDB_LAB2 names no folder of atlases";
  const Atlas atlas = ReadAtlas(Location(std::string(lab) + "/" + GetParam().map + ".osa"));
  const Locator locator(atlas);
  const std::vector<std::string> folder = {std::string(lab) + "/frames"};
  const CameraSettings camera = ReadCameraSettings(folder.front() + "/camera.yaml");
  Estimate found{.map = atlas.maps[0].id, .poses = {}, .open_scale = !IsMetric(atlas.maps[0])};
  for (const PictureFile& file : FindPictures(folder)) {
    const char room = file.path[file.path.rfind('/') + 1];
    const Localization localization = locator.Locate(ExtractFeatures(ReadPicture(file.path), camera, 2000));
    if (localization.verdict != LocateVerdict::kFound) continue;
    EXPECT_TRUE(room == 'a' || room == 'd') << file.path;  // of the map's room
    found.poses.push_back({file.timestamp, localization.position, localization.rotation});
  }
  EXPECT_GE(found.poses.size(), GetParam().at_least);
  const std::vector<TrajectoryPose> truth = ReadTrajectory(Location(folder.front() + "/poses_tum.txt"));
  const TrajectoryEvaluation evaluation = EvaluateTrajectory(found, truth, {.deltas = {}});
  ASSERT_EQ(evaluation.poses.size(), found.poses.size());
  for (const PairedPose& pose : evaluation.poses) {
    EXPECT_LT(pose.translation_error, 0.1) << "picture " << pose.timestamp;
    EXPECT_LT(pose.rotation_error_degrees, 3) << "picture " << pose.timestamp;
  }
}

INSTANTIATE_TEST_SUITE_P(Maps, LocateReal,
                         ::testing::Values(Room{"p1", 20}, Room{"p2", 11}, Room{"m1", 4}, Room{"m2", 3}),
                         [](const ::testing::TestParamInfo<Room>& room) { return room.param.map; });

}  // namespace
}  // namespace slamdb
