// SPDX-License-Identifier: BSD-3-Clause
#include "tests/formats/store/atlases.h"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <sstream>

#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/model/derive.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb::store_test {
namespace {

const float kNan = std::bit_cast<float>(0x7fc12345U);
const float kSignalingNan = std::bit_cast<float>(0xff812345U);
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Keypoint KeypointAt(int i) {
  return {.angle = static_cast<float>(i),
          .response = 20.0F,
          .size = 31.0F,
          .x = static_cast<float>(7 * i % 640),
          .y = static_cast<float>(11 * i % 480),
          .class_id = -1,
          .octave = i % 8};
}

Flag FlagOf(int recorded) {
  Flag flag;
  flag.recorded = static_cast<std::uint8_t>(recorded);
  return flag;
}

// A keyframe whose columns compress well: everything follows from something else.
KeyFrame RegularKeyframe(std::uint64_t id) {
  KeyFrame keyframe;
  keyframe.id = KeyFrameId(id);
  keyframe.frame_id = 10 * id;
  keyframe.timestamp = 1.5e9 + 0.05 * static_cast<double>(id);
  keyframe.camera = CameraId(0);
  keyframe.bounds = {.grid_columns = 64,
                     .grid_rows = 48,
                     .inverse_cell_width = 0.1F,
                     .inverse_cell_height = 0.1F,
                     .min_x = 0,
                     .min_y = 0,
                     .max_x = 640,
                     .max_y = 480};
  keyframe.pyramid = DerivePyramid(8, 1.2F);
  Features& features = keyframe.features;
  features.count = 50;
  for (int i = 0; i < 50; ++i) {
    Keypoint keypoint = KeypointAt(i);
    keypoint.size = 31.0F * keyframe.pyramid.factors[static_cast<std::size_t>(keypoint.octave)];
    features.keypoints.push_back(keypoint);
    features.descriptors.push_back({static_cast<std::uint8_t>(i), 1, 2});
    features.map_points.push_back(i % 3 == 0 ? MapPointId(static_cast<std::uint64_t>(i)) : MapPointId());
  }
  features.undistorted = features.keypoints;
  features.right_x.assign(50, -1.0F);
  features.depth.assign(50, -1.0F);
  features.grid = DeriveGrid(features.undistorted, keyframe.bounds);
  features.bag_of_words.words = {3, 70000, 900000};
  features.bag_of_words.weights = {0.25, 0.5, 0.25};
  features.feature_vector.nodes = {1, 300};
  features.feature_vector.sizes = {2, 1};
  features.feature_vector.features = {0, 49, 7};
  return keyframe;
}

// A keyframe whose every column is at odds with the others.
KeyFrame OddKeyframe() {
  KeyFrame keyframe = RegularKeyframe(0);
  keyframe.id = KeyFrameId(0xfedcba9876543210U);
  keyframe.timestamp = -0.0;
  keyframe.camera_from_world.rotation.coeffs() << kNan, -0.0F, kSignalingNan, kInfinity;
  keyframe.camera_from_world.translation = {-0.0F, kNan, -kInfinity};
  keyframe.velocity = {kSignalingNan, 0.0F, -0.0F};
  keyframe.merge_scale = kSignalingNan;
  keyframe.camera = CameraId(77);
  keyframe.right_camera = CameraId(0);
  keyframe.distortion = {.rows = 1, .columns = 1, .type = 5, .continuous = FlagOf(1), .data = {}};
  keyframe.distortion.data.assign(4, std::byte{9});
  keyframe.preintegration.covariance(3, 4) = kNan;
  keyframe.preintegration.bias.gyroscope.z() = -0.0F;
  keyframe.preintegration.measurements.push_back({{1, 2, 3}, {4, -0.0F, 6}, kNan});
  keyframe.imu_calibration.is_set = FlagOf(0xcd);
  Features& features = keyframe.features;
  features.count = 49;
  features.left_count = 30;
  features.right_count = 19;
  features.keypoints[3].class_id = 5;
  features.keypoints[4].octave = -7;
  features.keypoints[5].x = kSignalingNan;
  features.undistorted.pop_back();
  features.right_keypoints.assign(3, KeypointAt(400));
  features.right_x.push_back(4.0F);
  features.depth.assign(500, kNan);
  features.descriptors_form = MatrixForm::kUsualNotContinuous;
  features.map_points[1] = MapPointId(0xffffffffU);
  features.right_of_left = {1, -1, 4};
  features.left_of_right.assign(70, -1);
  features.grid.keypoints[0] = 4000000000000;
  features.right_grid.column_sizes = {0, 0, 0};
  features.bag_of_words.weights.push_back(-0.0);
  keyframe.connections = {{KeyFrameId(5), 3}, {KeyFrameId(4), -2}, {KeyFrameId(5), 3}, {KeyFrameId(), 0}};
  keyframe.children = {KeyFrameId(9), KeyFrameId(), KeyFrameId(9)};
  keyframe.loop_edges = {KeyFrameId(12345678901234567890U)};
  keyframe.merge_edges = {KeyFrameId(1), KeyFrameId(0)};
  keyframe.parent = KeyFrameId(404);
  keyframe.first_connection = FlagOf(2);
  keyframe.bad = FlagOf(255);
  keyframe.origin_map = 0xffffffff;
  return keyframe;
}

MapPoint PointAt(std::uint64_t id, float x, float y, float z) {
  MapPoint point;
  point.id = MapPointId(id);
  point.position = {x, y, z};
  point.normal = {0, 0, 1};
  point.first_keyframe = 1;
  point.first_frame = 10;
  point.observation_count = 2;
  point.observations = {{KeyFrameId(1), 3, -1}, {KeyFrameId(2), 4, -1}};
  point.reference = KeyFrameId(1);
  point.descriptor = {static_cast<std::uint8_t>(id), 7};
  point.min_distance = 1;
  point.max_distance = 9;
  return point;
}

MapPoint OddPoint() {
  MapPoint point = PointAt(3, kNan, -0.0F, kInfinity);
  point.normal = {kSignalingNan, -0.0F, 0};
  point.first_keyframe = -1;
  point.observations = {{KeyFrameId(900), 1, -1},
                        {KeyFrameId(2), Observation::kAbsent, 5},
                        {KeyFrameId(2), 0, Observation::kAbsent},
                        {KeyFrameId(), -1, -1}};
  point.reference = KeyFrameId(0xcdcdcdcdcdcdcdcdU);
  point.replaced_by = MapPointId(808);
  point.bad = FlagOf(77);
  point.descriptor_form = MatrixForm::kEmptyContinuous;
  point.descriptor = {};
  point.min_distance = -kInfinity;
  return point;
}

Map OddMap() {
  Map map;
  map.id = MapId(4);
  map.initial_keyframe = KeyFrameId(1000);
  map.max_keyframe_id = 0xffffffffffffffffU;
  map.big_change_index = -3;
  // Not in the order of their ids; 2 stands three times, one keyframe has no id.
  for (const std::uint64_t id : {2U, 1U, 2U, 2U}) map.keyframes.push_back(RegularKeyframe(id));
  map.keyframes[2].timestamp = 77;
  map.keyframes.push_back(OddKeyframe());
  map.keyframes.push_back(KeyFrame());
  map.points.push_back(PointAt(8, 1, 2, 3));
  map.points.push_back(OddPoint());
  map.points.push_back(PointAt(8, -1, -2, -3));
  map.points.push_back(MapPoint());
  map.points.push_back(PointAt(0x8000000000000001U, 1e30F, 1e-40F, kInfinity));
  map.repeated_keyframes = {{1, RepeatedEntry::kNull, 0}, {3, 0, 2}};
  map.repeated_points = {{0, 1, 17}};
  map.origins = {KeyFrameId(1), KeyFrameId(), KeyFrameId(555), KeyFrameId(1)};
  map.first_keyframe = KeyFrameId(1);
  map.lowest_keyframe = KeyFrameId(666);
  map.inertial = FlagOf(3);
  return map;
}

std::vector<Landmark> OddLandmarks() {
  Landmark odd;
  odd.id = LandmarkId(0xfedcba9876543210U);
  odd.mean = {std::numeric_limits<double>::quiet_NaN(), -0.0, 1e300};
  odd.cov_12 = -0.0;
  odd.last_seen = 0xffffffffffffffffU;
  odd.seen_count = 0xffffffff;
  odd.features.resize(2);
  odd.features[0].x = kSignalingNan;
  odd.features[0].type = static_cast<FeatureType>(99);
  odd.features[0].has_patch = true;
  odd.features[0].patch = {1, 0, 2};
  odd.features[1].has_patch = true;
  odd.features[1].descriptors = {{DescriptorKind::kSift, {}}, {DescriptorKind::kLatch, {9, 8, 7}}};
  Landmark plain;
  plain.id = LandmarkId(3);
  return {plain, odd, Landmark(), plain, Landmark()};
}

}  // namespace

Atlas OddAtlas() {
  Atlas atlas;
  atlas.vocabulary = {std::string("voc\0\xff'ab", 8), ""};
  atlas.maps.push_back(OddMap());
  atlas.maps.emplace_back();  // empty, without id
  atlas.maps.push_back(OddMap());
  atlas.maps[2].keyframes.resize(1);
  atlas.maps[0].landmarks = OddLandmarks();
  atlas.repeated_maps = {{0, 2, 0}, {5, RepeatedEntry::kNull, 0}};
  Camera camera{.id = CameraId(0),
                .model = CameraModel::kPinhole,
                .recorded_type = 9,
                .parameters = {458.654F, 1.0F / 3, 367, 248}};
  atlas.cameras = {camera, camera, Camera()};
  atlas.cameras[1].model = CameraModel::kKannalaBrandt8;
  atlas.cameras[1].parameters = {kNan, -0.0F, kSignalingNan};
  atlas.cameras[1].precision = kNan;
  atlas.repeated_cameras = {{1, 0, 0}};
  atlas.next_ids = {1, 2, 0xffffffffffffffffU, 4, 5, 6};
  atlas.encoding.boost_version = 18;
  return atlas;
}

Atlas SoundAtlas() {
  SyntheticOptions options;
  options.maps = 2;
  options.keyframes = 12;
  options.points = 400;
  options.features = 200;
  options.threads = 1;
  return SynthesizeAtlas(options);
}

std::string FileBytes(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

SaveReport SaveIn(const std::string& path, const Atlas& atlas, const std::string& name) {
  Store store = Store::OpenForWriting(path, {.sync = false, .lock_timeout = 1});
  return store.Save(name, atlas, {.provenance = "test"});
}

Atlas LoadFrom(const std::string& path, const std::string& name, const ReadOptions& options) {
  return Store::Open(path).Load(name, options);
}

void MigrateBackTo(const std::string& path, int version) {
  for (int from = sqlite::NewestVersion(); from > version; --from)
    sqlite::Migrate(path, {.back = true, .backup = false}, sqlite::Migrations().first(static_cast<std::size_t>(from)));
}

std::string Sql(const std::string& path, const std::string& sql) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr), SQLITE_OK);
  std::string rows;
  char* message = nullptr;
  const auto append = [](void* out, int count, char** values, char**) {
    auto& text = *static_cast<std::string*>(out);
    if (!text.empty()) text += ';';
    for (int i = 0; i < count; ++i) text += std::string(i > 0 ? "|" : "") + (values[i] != nullptr ? values[i] : "NULL");
    return 0;
  };
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), append, &rows, &message), SQLITE_OK) << message;
  sqlite3_free(message);
  sqlite3_close(database);
  return rows;
}

int InChild(void (*work)(const std::string&), const std::string& argument) {
  const pid_t child = ::fork();
  if (child == 0) {
    work(argument);
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

}  // namespace slamdb::store_test
