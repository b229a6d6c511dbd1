// SPDX-License-Identifier: BSD-3-Clause
#include "tests/formats/formats/small_atlas.h"

namespace slamdb {
namespace {

Camera PinholeCamera() {
  Camera camera;
  camera.id = CameraId(0);
  camera.parameters = {100, 100, 64, 48};
  return camera;
}

// A keyframe without keypoints at `center`, its camera axes along the world's.
KeyFrame KeyFrameAt(std::uint64_t id, double timestamp, const Eigen::Vector3f& center) {
  KeyFrame keyframe;
  keyframe.id = KeyFrameId(id);
  keyframe.frame_id = 10 * id;
  keyframe.timestamp = timestamp;
  keyframe.camera = CameraId(0);
  keyframe.camera_from_world.translation = -center;
  return keyframe;
}

void AddKeypoint(KeyFrame& keyframe, float x, float y, MapPointId point) {
  Features& features = keyframe.features;
  features.keypoints.push_back({.angle = 0, .response = 20, .size = 31, .x = x, .y = y, .class_id = -1, .octave = 1});
  features.undistorted.push_back(features.keypoints.back());
  features.right_x.push_back(-1);
  features.depth.push_back(-1);
  features.descriptors.push_back(Descriptor{static_cast<std::uint8_t>(keyframe.id.value()), 0xab});
  features.map_points.push_back(point);
  ++features.count;
}

MapPoint PointAt(std::uint64_t id, const Eigen::Vector3f& position) {
  MapPoint point;
  point.id = MapPointId(id);
  point.position = position;
  point.normal = Eigen::Vector3f(0, 0, 1);
  point.min_distance = 0.5F;
  point.max_distance = 4;
  point.reference = KeyFrameId(1);
  return point;
}

Map FirstMap() {
  Map map;
  map.id = MapId(0);
  map.initial_keyframe = map.first_keyframe = map.lowest_keyframe = KeyFrameId(1);
  map.max_keyframe_id = 3;
  map.keyframes = {KeyFrameAt(3, 1.5, {1, 0, 0}), KeyFrameAt(1, 0.5, {0, 0, 0})};
  map.points = {PointAt(10, {0, 0, 2}), PointAt(11, {0, 1, 2}), PointAt(12, {0.25F, -1.5F, 1e-5F})};

  AddKeypoint(map.keyframes[0], 17, 52, MapPointId(10));  // 5 pixels from (14, 48)
  AddKeypoint(map.keyframes[1], 64, 48, MapPointId(10));  // where the point projects to
  map.points[0].observations = {{.keyframe = KeyFrameId(1), .left = 0}, {.keyframe = KeyFrameId(3), .left = 0}};
  map.points[0].observation_count = 2;
  map.points[1].bad = true;

  map.keyframes[0].parent = KeyFrameId(1);
  map.keyframes[1].children = {KeyFrameId(3)};
  map.keyframes[0].connections = {{.keyframe = KeyFrameId(1), .weight = 1}};
  map.keyframes[1].connections = {{.keyframe = KeyFrameId(3), .weight = 1}};
  return map;
}

Map SecondMap() {
  Map map;
  map.id = MapId(1);
  map.initial_keyframe = map.first_keyframe = map.lowest_keyframe = KeyFrameId(7);
  map.max_keyframe_id = 7;
  map.keyframes = {KeyFrameAt(7, 2, {0, 0, 0})};
  map.keyframes[0].camera_from_world = {Quaternionf(0.5F, 0.5F, 0.5F, 0.5F), Eigen::Vector3f(0, 0, 3)};
  map.points = {PointAt(20, {0, 1, 0})};
  map.points[0].reference = KeyFrameId(7);
  AddKeypoint(map.keyframes[0], 64, 48, MapPointId(20));
  map.points[0].observations = {{.keyframe = KeyFrameId(7), .left = 0}};
  map.points[0].observation_count = 1;
  return map;
}

}  // namespace

Atlas OneMapAtlas() {
  Atlas atlas;
  atlas.vocabulary = {.name = "ORBvoc.txt", .checksum = "0123456789abcdef0123456789abcdef"};
  atlas.cameras = {PinholeCamera()};
  atlas.maps = {FirstMap()};
  atlas.next_ids = {.map = 1, .frame = 80, .keyframe = 8, .map_point = 21, .camera = 1, .initial_keyframe = 4};
  return atlas;
}

Atlas SmallAtlas() {
  Atlas atlas = OneMapAtlas();
  atlas.maps.push_back(SecondMap());
  atlas.next_ids.map = 2;
  atlas.next_ids.initial_keyframe = 8;
  return atlas;
}

Atlas LandmarkAtlas() {
  Atlas atlas = SmallAtlas();
  Landmark landmark;
  landmark.id = LandmarkId(10);
  landmark.mean = {0, 0, 2};
  landmark.normal = {0, 0, 1};
  landmark.cov_11 = landmark.cov_22 = 0.25;
  landmark.cov_33 = 0.5;
  landmark.last_seen = TicksOfSeconds(1.5);
  landmark.seen_count = 2;
  LandmarkFeature& feature = landmark.CreateOneFeature();
  feature.type = FeatureType::kOrb;
  feature.x = 17;
  feature.y = 52;
  feature.descriptors = {{DescriptorKind::kOrb, {1, 2, 3}}};
  atlas.maps[0].landmarks = {landmark, Landmark()};
  atlas.maps[1].landmarks = {landmark};
  return atlas;
}

Atlas InertialAtlas() {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].inertial = atlas.maps[0].imu_initialized = true;
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) {
    keyframe.imu_calibration.is_set = true;
    keyframe.imu_calibration.camera_from_body.translation = Eigen::Vector3f(0, 0, 1);
    keyframe.imu_calibration.body_from_camera.translation = Eigen::Vector3f(0, 0, -1);
    keyframe.imu_initialized = keyframe.has_velocity = true;
    keyframe.velocity = Eigen::Vector3f(0.5F, 0, static_cast<float>(keyframe.id.value()));
    keyframe.imu_bias = {.accelerometer = {0.125F, 0, 0}, .gyroscope = {0, 0.0625F, 0}};
  }
  return atlas;
}

}  // namespace slamdb
