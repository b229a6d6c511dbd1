// SPDX-License-Identifier: BSD-3-Clause
// Single objects by value. No pointer to a point or keyframe is archived in this program, so none is tracked.
#include <boost/serialization/string.hpp>

#include "slamdb/boost.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/boost/archives.h"
#include "tests/boost/points.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using testing::Load;
using testing::Loaded;
using testing::Saved;

Atlas MakeAtlas() {
  return SynthesizeAtlas({.sensor = Sensor::kFisheyeStereo,
                          .inertial = true,
                          .keyframes = 4,
                          .points = 60,
                          .features = 200,
                          .threads = 1});
}

template <class Kind>
class BoostValue : public ::testing::Test {};
TYPED_TEST_SUITE(BoostValue, testing::Kinds);

TYPED_TEST(BoostValue, APointIsWhatAnotherProgramArchives) {
  const orb::MapPoint theirs = orb::MakePoint(5);
  const std::string bytes = Saved<TypeParam>(theirs);
  const auto point = Loaded<MapPoint, TypeParam>(bytes);
  testing::ExpectSame(point, theirs);
  EXPECT_TRUE(Saved<TypeParam>(point) == bytes);
  EXPECT_TRUE(Saved<TypeParam>(Loaded<orb::MapPoint, TypeParam>(Saved<TypeParam>(point))) == bytes);
}

// Every value is archived in full, also when it lies where another one lay.
TYPED_TEST(BoostValue, PointsInOnePlaceAreAllArchived) {
  std::ostringstream ours, theirs;
  {
    typename TypeParam::Output our_archive(ours), their_archive(theirs);
    for (unsigned long id = 0; id < 3; ++id) {
      const orb::MapPoint point = orb::MakePoint(id);
      their_archive << point;
      MapPoint same = Loaded<MapPoint, TypeParam>(Saved<TypeParam>(point));
      our_archive << same;
    }
  }
  EXPECT_TRUE(ours.str() == theirs.str());
}

TYPED_TEST(BoostValue, ContainersOfPointsAreWhatAnotherProgramArchives) {
  const std::vector<orb::MapPoint> theirs{orb::MakePoint(1), orb::MakePoint(2)};
  const std::string bytes = Saved<TypeParam>(theirs);
  const auto points = Loaded<std::vector<MapPoint>, TypeParam>(bytes);
  ASSERT_EQ(points.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) testing::ExpectSame(points[i], theirs[i]);
  EXPECT_TRUE(Saved<TypeParam>(points) == bytes);
}

// What stands behind a point in the archive has the class numbers that it has in the other program.
TYPED_TEST(BoostValue, OtherMembersFindTheirClassesAfterAPoint) {
  const std::map<unsigned long, int> weights{{1, 2}};
  const std::vector<float> floats{1, 2};
  orb::CameraHolder theirs;
  orb::Pinhole pinhole;
  pinhole.mvParameters = {450, 451, 320, 240};
  theirs.camera = &pinhole;
  const std::string bytes = Saved<TypeParam>(orb::MakePoint(1), weights, floats, theirs);

  MapPoint point;
  std::map<unsigned long, int> same_weights;
  std::vector<float> same_floats;
  orb::CameraHolder same;
  Load<TypeParam>(bytes, point, same_weights, same_floats, same);
  const std::unique_ptr<orb::GeometricCamera> camera(same.camera);
  EXPECT_EQ(same_weights, weights);
  EXPECT_EQ(same_floats, floats);
  ASSERT_NE(camera, nullptr);
  EXPECT_EQ(camera->mvParameters, pinhole.mvParameters);
  EXPECT_TRUE(Saved<TypeParam>(point, weights, floats, theirs) == bytes);
}

// The records of an atlas with one keyframe and of one with one point stand in the file as they stand alone: nothing in
// front of them has used their classes.
TYPED_TEST(BoostValue, AKeyFrameAndAPointStandInAFileAsTheyStandAlone) {
  Atlas atlas = MakeAtlas();
  const KeyFrame keyframe = atlas.maps[0].keyframes[1];
  const MapPoint point = atlas.maps[0].points[7];
  const auto contents = [](const std::string& archive) {
    const std::size_t head = Saved<TypeParam>(0).size() - (TypeParam::kText ? 3 : 4);  // " 0\n", or the bytes of 0
    return archive.substr(head + (TypeParam::kText ? 4 : 5));                          // behind the class information
  };
  const auto file = [&](bool with_keyframe) {
    Atlas one = atlas;
    one.encoding.text = TypeParam::kText;
    one.maps[0].keyframes.clear();
    one.maps[0].points.clear();
    if (with_keyframe) one.maps[0].keyframes.push_back(keyframe);
    if (!with_keyframe) one.maps[0].points.push_back(point);
    return EncodeOrbslam3(one);
  };
  for (const bool is_keyframe : {true, false}) {
    std::string alone = contents(is_keyframe ? Saved<TypeParam>(keyframe) : Saved<TypeParam>(point));
    if (TypeParam::kText) alone.pop_back();  // the line's end
    ASSERT_GT(alone.size(), 100U);
    EXPECT_NE(file(is_keyframe).find(alone), std::string::npos) << is_keyframe;
  }
}

TYPED_TEST(BoostValue, ImuTypesComeBack) {
  const KeyFrame keyframe = MakeAtlas().maps[0].keyframes[2];
  ASSERT_FALSE(keyframe.preintegration.measurements.empty());
  const std::string bytes = Saved<TypeParam>(keyframe.preintegration, keyframe.imu_bias, keyframe.imu_calibration,
                                             keyframe.preintegration.measurements[0]);
  KeyFrame again;
  again.preintegration.measurements.resize(1);
  ImuMeasurement measurement;
  Load<TypeParam>(bytes, again.preintegration, again.imu_bias, again.imu_calibration, measurement);
  EXPECT_TRUE(Saved<TypeParam>(again.preintegration, again.imu_bias, again.imu_calibration, measurement) == bytes);
  Atlas expected, loaded;
  expected.maps.resize(1);
  loaded.maps.resize(1);
  KeyFrame only_inertial;
  only_inertial.preintegration = keyframe.preintegration;
  only_inertial.imu_bias = keyframe.imu_bias;
  only_inertial.imu_calibration = keyframe.imu_calibration;
  expected.maps[0].keyframes.push_back(only_inertial);
  loaded.maps[0].keyframes.push_back(again);
  EXPECT_EQ(FirstDifference(loaded, expected), "");
}

TYPED_TEST(BoostValue, ACameraIsThePointerThatAnotherProgramArchives) {
  for (const bool fisheye : {false, true}) {
    orb::Pinhole pinhole;
    orb::KannalaBrandt8 kannala_brandt8;
    kannala_brandt8.precision = 2e-5F;
    orb::CameraHolder theirs;
    theirs.camera = &pinhole;
    if (fisheye) theirs.camera = &kannala_brandt8;
    theirs.camera->mnId = 3;
    theirs.camera->mnType = fisheye ? 1 : 0;
    theirs.camera->mvParameters = {450, 451, 320, 240};

    // The holder is a class of theirs; what it holds is what we compare.
    std::ostringstream stream;
    {
      typename TypeParam::Output archive(stream);
      archive.template register_type<orb::Pinhole>();
      archive.template register_type<orb::KannalaBrandt8>();
      archive << theirs.camera;
    }
    const auto camera = Loaded<Camera, TypeParam>(stream.str());
    EXPECT_EQ(camera.model, fisheye ? CameraModel::kKannalaBrandt8 : CameraModel::kPinhole);
    EXPECT_EQ(camera.id, CameraId(3));
    EXPECT_EQ(camera.recorded_type, theirs.camera->mnType);
    EXPECT_EQ(camera.parameters, theirs.camera->mvParameters);
    if (fisheye) {
      EXPECT_EQ(camera.precision, 2e-5F);
    }
    EXPECT_TRUE(Saved<TypeParam>(camera) == stream.str());
  }
}

TYPED_TEST(BoostValue, CamerasInOnePlaceAreAllArchived) {
  std::ostringstream stream;
  {
    typename TypeParam::Output archive(stream);
    for (const std::uint64_t id : {4, 5, 6}) {
      Camera camera;
      camera.id = CameraId(id);
      camera.model = id == 5 ? CameraModel::kKannalaBrandt8 : CameraModel::kPinhole;
      archive << camera;
    }
  }
  Camera a, b, c;
  Load<TypeParam>(stream.str(), a, b, c);
  EXPECT_EQ(a.id, CameraId(4));
  EXPECT_EQ(b.id, CameraId(5));
  EXPECT_EQ(b.model, CameraModel::kKannalaBrandt8);
  EXPECT_EQ(c.id, CameraId(6));
}

// A map alone: also with a point and a keyframe that are listed twice, and a null pointer.
TYPED_TEST(BoostValue, AMapComesBackWithItsIrregularEntries) {
  Atlas atlas = MakeAtlas();
  Map& map = atlas.maps[0];
  map.repeated_keyframes = {{.position = 1}, {.position = 3, .owner_map = 0, .row = 1}};
  map.repeated_points = {{.position = 2, .owner_map = 0, .row = 0}};
  const std::string bytes = Saved<TypeParam>(map);
  Atlas loaded = atlas;
  loaded.maps[0] = Loaded<Map, TypeParam>(bytes);
  EXPECT_EQ(FirstDifference(loaded, atlas), "");
  EXPECT_TRUE(Saved<TypeParam>(loaded.maps[0]) == bytes);
}

TYPED_TEST(BoostValue, WhatOrbSlam3CannotHoldIsRefused) {
  const auto kind_of = [](const auto& value) {
    try {
      Saved<TypeParam>(value);
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::kInternal;
  };
  Map map;
  map.points.resize(2);
  map.repeated_points = {{.position = 0, .owner_map = 0, .row = 1}};  // listed first behind it
  EXPECT_EQ(kind_of(map), ErrorKind::kUsage);
  map.repeated_points = {{.position = 2, .owner_map = 1, .row = 0}};  // of a map that is not there
  EXPECT_EQ(kind_of(map), ErrorKind::kUsage);
  Camera camera;
  camera.id = CameraId(std::uint64_t{1} << 32);
  EXPECT_EQ(kind_of(camera), ErrorKind::kNotPossible);
}

TYPED_TEST(BoostValue, SmallTypesComeBack) {
  Rigid3f pose;
  pose.rotation = Quaternionf(0.5F, -0.5F, 0.5F, 0.5F);
  pose.translation = {1, 2, 3};
  Flag flag;
  flag.recorded = 205;  // memory that was never set
  const KeyFrameId id(77), none;
  const std::string bytes = Saved<TypeParam>(pose, flag, id, none);
  Rigid3f pose_again;
  Flag flag_again;
  KeyFrameId id_again, none_again(1);
  Load<TypeParam>(bytes, pose_again, flag_again, id_again, none_again);
  EXPECT_EQ(pose_again.rotation.coeffs(), pose.rotation.coeffs());
  EXPECT_EQ(pose_again.translation, pose.translation);
  EXPECT_EQ(flag_again.recorded, 205);
  EXPECT_EQ(id_again, id);
  EXPECT_EQ(none_again, none);
}

}  // namespace
}  // namespace slamdb
