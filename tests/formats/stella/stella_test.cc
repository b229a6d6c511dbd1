// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/stella/detail/stella.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "slamdb/formats/export/options.h"
#include "slamdb/formats/formats.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/formats/stella/stored_map.h"

namespace slamdb {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

std::string Repacked(const std::string& bytes) { return Packed(json::from_msgpack(bytes)); }

TEST(Stella, IsReadToTheLastField) {
  const Atlas atlas = ReadStella(SmallStellaMap());
  ASSERT_THAT(atlas.maps, SizeIs(1));
  const Map& map = atlas.maps[0];
  ASSERT_THAT(map.keyframes, SizeIs(2));
  const KeyFrame &first = map.keyframes[0], &second = map.keyframes[1];
  EXPECT_EQ(first.id, KeyFrameId(4));
  EXPECT_EQ(first.timestamp, 0.5);
  EXPECT_EQ(second.timestamp, 1.1);
  EXPECT_EQ(first.camera_from_world.rotation.coeffs(), Eigen::Vector4f(0, 0, 0.6F, 0.8F));
  EXPECT_EQ(second.camera_from_world.translation, Eigen::Vector3f(-1, 0.1F, 2.5F));
  EXPECT_EQ(first.intrinsics.fx, 500.5F);
  EXPECT_EQ(first.bounds.max_x, 640);
  EXPECT_EQ(first.bounds.max_y, 480);
  EXPECT_EQ(first.pyramid.levels, 5);
  EXPECT_EQ(first.pyramid.factor, 1.5F);
  EXPECT_EQ(first.features.undistorted[1], (Keypoint{.angle = 1,
                                                     .response = 0,
                                                     .size = std::floor(31 * 3.375F),
                                                     .x = 100.1F,
                                                     .y = 20,
                                                     .class_id = -1,
                                                     .octave = 3}));
  EXPECT_EQ(first.features.keypoints, first.features.undistorted);
  EXPECT_THAT(first.features.right_x, ElementsAre(-1, -1, -1));
  EXPECT_EQ(first.features.descriptors[2][0], 2);
  EXPECT_EQ(first.features.descriptors[0][12], 300 & 0xff);
  EXPECT_EQ(first.features.descriptors[0][31], 0xff);
  EXPECT_THAT(second.features.map_points, ElementsAre(MapPointId(), MapPointId(7)));
  EXPECT_EQ(second.parent, KeyFrameId(4));
  EXPECT_THAT(first.children, ElementsAre(KeyFrameId(12)));
  EXPECT_THAT(second.loop_edges, ElementsAre(KeyFrameId(4)));
  EXPECT_EQ(map.first_keyframe, KeyFrameId(4));
  ASSERT_THAT(map.points, SizeIs(1));
  const MapPoint& point = map.points[0];
  EXPECT_EQ(point.position, Eigen::Vector3f(0.25F, -1.5F, 4));
  EXPECT_EQ(point.visible_count, 9);
  EXPECT_EQ(point.found_count, 5);
  EXPECT_EQ(point.first_keyframe, 4);
  EXPECT_EQ(point.reference, KeyFrameId(12));
  EXPECT_THAT(point.observations, ElementsAre(Observation{.keyframe = KeyFrameId(4), .left = 0},
                                              Observation{.keyframe = KeyFrameId(12), .left = 1}));
  EXPECT_EQ(atlas.next_ids.keyframe, 20U);
  EXPECT_EQ(atlas.next_ids.map_point, 300U);
}

TEST(Stella, OfOpenVslamIsReadWithWhatEachKeyFrameHas) {
  const Atlas atlas = ReadStella(SmallOpenVslamMap());
  const KeyFrame& keyframe = atlas.maps[0].keyframes[1];
  EXPECT_EQ(keyframe.pyramid.levels, 6);
  EXPECT_EQ(keyframe.pyramid.factor, 1.25F);
  EXPECT_EQ(keyframe.frame_id, 30U);  // `12` stands before `4`
  EXPECT_EQ(keyframe.features.keypoints[0].x, 12);
  EXPECT_EQ(keyframe.features.undistorted[0].x, 13);
  EXPECT_EQ(keyframe.features.undistorted[0].angle, 91);
  EXPECT_EQ(atlas.next_ids.frame, 99U);
}

TEST(Stella, TakesEveryNumericTypeForANumber) {
  json map = SmallStellaMap();
  map["cameras"]["lab"]["fx"] = 500;
  map["keyframes"]["4"]["ts"] = -3;
  map["keyframes"]["4"]["trans_cw"] = {-200, 70000, 5000000000};
  map["keyframes"]["4"]["lm_ids"] = {7.0, -1.0, -1};
  map["keyframe_next_id"] = 20.0;
  const Atlas atlas = ReadStella(map);
  EXPECT_EQ(atlas.maps[0].keyframes[0].intrinsics.fx, 500);
  EXPECT_EQ(atlas.maps[0].keyframes[0].timestamp, -3);
  EXPECT_EQ(atlas.maps[0].keyframes[0].camera_from_world.translation, Eigen::Vector3f(-200, 70000, 5e9F));
  EXPECT_EQ(atlas.maps[0].points[0].observations.size(), 2U);
  EXPECT_EQ(atlas.next_ids.keyframe, 20U);
}

TEST(Stella, IsWrittenAsItsJsonLibraryWrites) {
  Atlas odd = OneMapAtlas();
  odd.maps[0].keyframes[0].timestamp = std::numeric_limits<double>::quiet_NaN();
  odd.maps[0].keyframes[1].timestamp = -std::numeric_limits<double>::infinity();
  odd.maps[0].points[0].position = {std::numeric_limits<float>::denorm_min(), -0.0F, 3.4e38F};
  odd.maps[0].points[0].first_keyframe = -7;
  odd.maps[0].keyframes[0].features.keypoints[0].octave = -1;
  for (const Atlas& atlas : {SmallAtlas(), InertialAtlas(), odd, ReadStella(SmallStellaMap())}) {
    const std::string bytes = Encoded(detail::kStellaFormat, atlas);
    EXPECT_TRUE(bytes == Repacked(bytes));
  }
}

TEST(Stella, NamesAloneChangeInAnUntouchedMap) {
  json expected = SmallStellaMap();
  expected["cameras"] = {{"camera 0", expected["cameras"]["lab"]}};
  expected["cameras"]["camera 0"]["color_order"] = "Gray";
  expected["orb_params"] = {{"ORB of 5 levels, scale 1.5", expected["orb_params"]["fine"]}};
  expected["orb_params"].begin().value()["name"] = "ORB of 5 levels, scale 1.5";
  for (auto& [id, keyframe] : expected["keyframes"].items()) {
    keyframe["cam"] = "camera 0";
    keyframe["orb_params"] = "ORB of 5 levels, scale 1.5";
    keyframe["rot_cw"] = {0.0, 0.0, static_cast<double>(0.6F), static_cast<double>(0.8F)};
    for (json& value : keyframe["trans_cw"]) value = static_cast<double>(value.get<float>());
  }
  const std::string bytes = Encoded(detail::kStellaFormat, ReadStella(SmallStellaMap()));
  EXPECT_EQ(json::from_msgpack(bytes), expected);
  EXPECT_TRUE(bytes == Packed(expected));
}

TEST(Stella, HoldsMapsAsTreesOfTheirOwn) {
  const Atlas back = Decoded(detail::kStellaFormat, Encoded(detail::kStellaFormat, SmallAtlas()));
  ASSERT_THAT(back.maps, SizeIs(2));
  EXPECT_THAT(back.maps[0].keyframes, SizeIs(2));
  EXPECT_EQ(back.maps[1].keyframes[0].id, KeyFrameId(7));
  EXPECT_EQ(back.maps[1].points[0].id, MapPointId(20));
  const WriteOptions second = WriteOptions{}.With(ExportOptions{.map = MapId(1)});
  EXPECT_THAT(Decoded(detail::kStellaFormat, Encoded(detail::kStellaFormat, SmallAtlas(), second)).maps, SizeIs(1));
}

TEST(Stella, JoinsPartsThatALoopOrALandmarkJoins) {
  json map = SmallStellaMap();
  map["keyframes"]["12"]["span_parent"] = -1;
  map["keyframes"]["4"]["span_children"] = json::array();
  EXPECT_THAT(ReadStella(map).maps, SizeIs(1)) << "by loop and landmark";
  map["keyframes"]["12"]["loop_edges"] = map["keyframes"]["4"]["loop_edges"] = json::array();
  EXPECT_THAT(ReadStella(map).maps, SizeIs(1)) << "by landmark";
  map["keyframes"]["12"]["lm_ids"] = {-1, -1};
  EXPECT_THAT(ReadStella(map).maps, SizeIs(2));
}

// At 30 degrees, whose tangent is 0.57735: 0.1 more than its angle, 0.5236, times 1 + 0.1 * 0.5236^2.
TEST(Stella, FisheyeKeypointsAreThoseAsDetected) {
  json map = SmallStellaMap();
  json& camera = map["cameras"]["lab"];
  camera["model_type"] = "Fisheye";
  camera["k1"] = 0.1;
  camera["k4"] = 0.0;
  map["keyframes"]["4"]["undist_keypts"][0]["pt"] = {320 + 500.5 * std::tan(M_PI / 6), 240};
  const Atlas atlas = ReadStella(map);
  EXPECT_EQ(atlas.cameras[0].model, CameraModel::kKannalaBrandt8);
  EXPECT_THAT(atlas.cameras[0].parameters, ElementsAre(500.5F, 501, 320, 240, 0.1F, 0, 0, 0));
  const double angle = M_PI / 6, radius = angle * (1 + 0.1 * angle * angle);
  const Features& features = atlas.maps[0].keyframes[0].features;
  EXPECT_NEAR(features.keypoints[0].x, 320 + 500.5 * radius, 1e-3);
  EXPECT_EQ(features.undistorted, features.keypoints);
  const json back = json::from_msgpack(Encoded(detail::kStellaFormat, atlas));
  EXPECT_EQ(back["cameras"]["camera 0"]["model_type"], "Fisheye");
  EXPECT_NEAR(back["keyframes"]["4"]["undist_keypts"][0]["pt"][0].get<double>(), 320 + 500.5 * std::tan(angle), 1e-3);
}

// (0.2, 0.1) off the centre, r^2 = 0.05: times 1 + 0.5 * 0.05, and 2 * 0.01 * 0.2 * 0.1 and 0.01 * (0.05 + 2 * 0.01).
TEST(Stella, KeypointsAsDetectedFollowFromTheDistortion) {
  json map = SmallStellaMap();
  json& camera = map["cameras"]["lab"];
  camera["fx"] = camera["fy"] = 100;
  camera["k1"] = 0.5;
  camera["p1"] = 0.01;
  map["keyframes"]["4"]["undist_keypts"][0]["pt"] = {340, 250};
  Notices notices;
  const Atlas atlas = ReadStella(Packed(map), notices);
  const Features& features = atlas.maps[0].keyframes[0].features;
  EXPECT_NEAR(features.keypoints[0].x, 320 + 100 * (0.2 * 1.025 + 0.0004), 1e-4);
  EXPECT_NEAR(features.keypoints[0].y, 240 + 100 * (0.1 * 1.025 + 0.0007), 1e-4);
  EXPECT_EQ(features.undistorted[0].x, 340);
  EXPECT_EQ(atlas.maps[0].keyframes[0].distortion.rows, 4);
  EXPECT_THAT(notices.items(), Contains(Field(&Notice::text, HasSubstr("found from the undistorted ones"))));
  const json back = json::from_msgpack(Encoded(detail::kStellaFormat, atlas));
  EXPECT_EQ(back["keyframes"]["4"]["undist_keypts"][0]["pt"][0], 340);
}

// A camera of EuRoC.
TEST(Stella, SizesOfPicturesFollowFromTheirUndistortedCorners) {
  json map = SmallStellaMap();
  map["cameras"]["lab"].update({{"cols", 752},
                                {"rows", 480},
                                {"fx", 458.654},
                                {"fy", 457.296},
                                {"cx", 367.215},
                                {"cy", 248.375},
                                {"k1", -0.28340811},
                                {"k2", 0.07395907},
                                {"p1", 0.00019359},
                                {"p2", 1.76187114e-05}});
  const Atlas atlas = ReadStella(map);
  EXPECT_GT(atlas.maps[0].keyframes[0].bounds.max_x, 800);
  Notices notices;
  const json back = json::from_msgpack(Encoded(detail::kStellaFormat, atlas, {}, notices));
  EXPECT_EQ(back["cameras"]["camera 0"]["cols"], 752);
  EXPECT_EQ(back["cameras"]["camera 0"]["rows"], 480);
  EXPECT_THAT(notices.items(), IsEmpty());
}

TEST(Stella, CamerasThatOrbSlamHasNotAreNamed) {
  json map = SmallStellaMap();
  json& camera = map["cameras"]["lab"];
  camera["model_type"] = "RadialDivision";
  camera["distortion"] = -0.1;
  Notices divided;
  const Atlas division = ReadStella(Packed(map), divided);
  EXPECT_TRUE(divided.lossy());
  EXPECT_THAT(division.cameras[0].parameters, ElementsAre(500.5F, 501, 320, 240));
  // Undistorting is dividing by 1 + l r^2.
  const Features& features = division.maps[0].keyframes[0].features;
  const double x = (features.keypoints[0].x - 320) / 500.5, y = (features.keypoints[0].y - 240) / 501;
  EXPECT_NEAR(320 + 500.5 * x / (1 - 0.1 * (x * x + y * y)), 10.5, 1e-3);

  camera = {{"model_type", "Equirectangular"},
            {"setup_type", "Monocular"},
            {"color_order", "RGB"},
            {"cols", 2000},
            {"rows", 1000},
            {"fps", 30.0},
            {"focal_x_baseline", 0.0}};
  Notices panorama;
  const Atlas round = ReadStella(Packed(map), panorama);
  EXPECT_TRUE(panorama.lossy());
  EXPECT_EQ(round.cameras[0].model, CameraModel::kEquirectangular);
  EXPECT_NEAR(round.maps[0].keyframes[0].intrinsics.fx, 2000 / (2 * M_PI), 1e-3);
  EXPECT_EQ(round.maps[0].keyframes[0].features.keypoints[0].x, 10.5F);
  EXPECT_THAT(round.maps[0].points, SizeIs(1));
  const json back = json::from_msgpack(Encoded(detail::kStellaFormat, round));
  camera["color_order"] = "Gray";
  EXPECT_EQ(back["cameras"]["camera 0"], camera);
}

TEST(Stella, WhatRefersToNothingIsTakenOutAndNamed) {
  json map = SmallStellaMap();
  map["keyframes"]["4"]["lm_ids"] = {7, 7, 8};
  map["keyframes"]["4"]["span_children"] = {12, 99};
  map["landmarks"]["9"] = map["landmarks"]["7"];
  Notices notices;
  const Atlas atlas = ReadStella(Packed(map), notices);
  std::string told;
  for (const Notice& notice : notices.items()) told += notice.text + "\n";
  EXPECT_THAT(told, HasSubstr("1 keypoint that see a landmark which is not there"));
  EXPECT_THAT(told, HasSubstr("1 keypoint that see a landmark which another keypoint"));
  EXPECT_THAT(told, HasSubstr("1 landmark that no keyframe sees: left out"));
  EXPECT_THAT(told, HasSubstr("1 link to keyframes that are not there"));
  EXPECT_THAT(atlas.maps[0].points, SizeIs(1));
}

TEST(Stella, WritesWhatItsLoaderNeeds) {
  Atlas atlas = SmallAtlas();
  Map& map = atlas.maps[0];
  map.points[2].observations.clear();                        // no key frame sees it
  map.points[0].reference = KeyFrameId(77);                  // not there
  map.keyframes[1].parent = KeyFrameId(3);                   // a circle
  map.keyframes[0].features.map_points[0] = MapPointId(11);  // bad
  Notices notices;
  const json written = json::from_msgpack(Encoded(detail::kStellaFormat, atlas, {}, notices));
  EXPECT_TRUE(notices.lossy());
  EXPECT_FALSE(written["landmarks"].contains("12"));
  EXPECT_FALSE(written["landmarks"].contains("11"));
  EXPECT_EQ(written["landmarks"]["10"]["ref_keyfrm"], 1);
  EXPECT_EQ(written["keyframes"]["3"]["lm_ids"], json({10})) << "which the point knows";
  int roots = 0;
  for (const auto& [id, keyframe] : written["keyframes"].items()) roots += keyframe["span_parent"] == -1 ? 1 : 0;
  EXPECT_EQ(roots, 2);  // one of each map
}

TEST(Stella, NamesThatResponseAndSizeOfKeypointsAreLost) {
  Atlas atlas = ReadStella(SmallStellaMap());
  Column<Keypoint>& keypoints = atlas.maps[0].keyframes[0].features.undistorted;
  const auto told = [&](const Format& format) {
    Notices notices;
    Encoded(format, atlas, {}, notices);
    std::string text;
    for (const Notice& notice : notices.items()) text += notice.text;
    return text;
  };
  EXPECT_THAT(told(detail::kStellaFormat), Not(HasSubstr("response and size")));
  keypoints[0].response = 20;
  EXPECT_THAT(told(detail::kStellaFormat), HasSubstr("1 keypoint lose response and size"));
  keypoints[0].response = 0;
  keypoints[0].size += 1;
  EXPECT_THAT(told(detail::kStellaFormat), HasSubstr("1 keypoint lose response and size"));
  EXPECT_THAT(told(detail::kStellaDatabaseFormat), Not(HasSubstr("response and size")));
}

TEST(Stella, RefusesIdsThatItHasNoPlaceFor) {
  Atlas large = OneMapAtlas();
  large.maps[0].keyframes[0].id = KeyFrameId(std::uint64_t{1} << 31);
  EXPECT_THROW(Encoded(detail::kStellaFormat, large), Error);
  Atlas twins = SmallAtlas();
  twins.maps[1].keyframes[0].id = KeyFrameId(1);
  EXPECT_THROW(Encoded(detail::kStellaFormat, twins), Error);
}

}  // namespace
}  // namespace slamdb
