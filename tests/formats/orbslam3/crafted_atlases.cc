// SPDX-License-Identifier: BSD-3-Clause
#include "tests/formats/orbslam3/crafted_atlases.h"

#include <array>
#include <cstdint>
#include <map>

namespace slamdb {
namespace {

constexpr std::uint64_t kNoId = ~std::uint64_t{0};
constexpr std::uint32_t kNoCamera = ~std::uint32_t{0};

// What differs between crafted keyframes; the rest follows from it.
struct KeyFrameContent {
  std::uint64_t id = 0, frame = 0;
  double time = 0;
  float x = 0;                            // of mTcw
  int left = 2, right = 0;                // features; right > 0: fisheye stereo
  bool words = true;                      // bag of words
  std::vector<std::int64_t> points = {};  // mvBackupMapPointsId
  std::map<std::uint64_t, std::int32_t> connections = {};
  bool first = false;
  std::int64_t parent = -1;
  std::vector<std::uint64_t> children = {}, loops = {};
  std::uint32_t map = 0, camera = 0, right_camera = kNoCamera;
  int measurements = 0;
  std::int64_t previous = -1, next = -1;
};

struct PointContent {
  std::uint64_t id = 0;
  float x = 0;
  std::map<std::uint64_t, std::array<std::int32_t, 2>> observations = {};  // left, right
  bool descriptor = true;
  std::uint64_t reference = 0;
  std::int64_t replaced = -1;
};

void Pose(CraftedArchive& archive, float x = 0) {
  archive.Float(1);
  archive.Floats(0, 3);
  archive.Float(x);
  archive.Floats(0, 2);
}

void Matrix(CraftedArchive& archive, int columns, int rows, int type, bool continuous) {
  for (const int value : {columns, rows, type}) archive.Int(value);
  archive.Bool(continuous);
}

void Keypoints(CraftedArchive& archive, int count, float y) {
  archive.IntCount(count);
  for (int i = 0; i < count; ++i) {
    const float step = static_cast<float>(i);
    for (const float value : {0.0F, 30.0F + step, 31.0F, 100.0F + 10.0F * step, y}) archive.Float(value);
    archive.Int(-1);
    archive.Int(i % 2);
  }
}

void Descriptors(CraftedArchive& archive, int rows, int first) {
  Matrix(archive, 32, rows, 0, true);
  for (int row = 0; row < rows; ++row)
    for (int i = 0; i < 32; ++i) archive.Byte(first + 16 * row + i % 16);
}

void FloatVector(CraftedArchive& archive, const std::vector<float>& values) {
  archive.NumberVector("vector<float>", values.size());
  for (const float value : values) archive.Float(value);
}

void UnsignedLongVector(CraftedArchive& archive, const std::vector<std::uint64_t>& values) {
  archive.NumberVector("vector<unsigned long>", values.size());
  for (const std::uint64_t value : values) archive.UnsignedLong(value);
}

void IntVector(CraftedArchive& archive, int count) {
  archive.NumberVector("vector<int>", static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) archive.Int(i - 1);
}

void Words(CraftedArchive& archive, bool any, int features) {
  archive.Value("BowVector");
  archive.Container("map<unsigned, double>", any ? 2 : 0);
  for (const std::uint32_t word : {7U, 9U}) {
    if (!any) break;
    archive.Value("pair<const unsigned, double>");
    archive.Unsigned(word);
    archive.Double(0.5);
  }
  archive.Value("FeatureVector");
  archive.Container("map<unsigned, vector<unsigned>>", any ? 1 : 0);
  if (!any) return;
  archive.Value("pair<const unsigned, vector<unsigned>>");
  archive.Unsigned(3);
  archive.NumberVector("vector<unsigned>", static_cast<std::size_t>(features));
  for (int i = 0; i < features; ++i) archive.Unsigned(static_cast<std::uint32_t>(i));
}

// A column for each feature, one cell in each.
void Grid(CraftedArchive& archive, int features) {
  archive.Container("vector<vector<vector<size_t>>>", static_cast<std::size_t>(features));
  for (int i = 0; i < features; ++i) {
    archive.Container("vector<vector<size_t>>", 1);
    archive.NumberVector("vector<size_t>", 1);
    archive.SizeValue(static_cast<std::uint64_t>(i));
  }
}

void WeightMap(CraftedArchive& archive, const std::map<std::uint64_t, std::int32_t>& weights) {
  archive.Container("map<unsigned long, int>", weights.size());
  for (const auto& [id, weight] : weights) {
    archive.Value("pair<const unsigned long, int>");
    archive.UnsignedLong(id);
    archive.Int(weight);
  }
}

void Bias(CraftedArchive& archive) {
  archive.Value("Bias");
  archive.Floats(0, 6);
}

void Inertial(CraftedArchive& archive, int measurements) {
  Bias(archive);
  archive.Value("Preintegrated");
  archive.Float(0.005F * static_cast<float>(measurements));
  archive.Floats(0, 225 + 225 + 6 + 6);
  Bias(archive);
  archive.Floats(0, 9 + 3 + 3 + 5 * 9 + 3 + 3);
  Bias(archive);
  archive.Floats(0, 6);
  archive.Container("vector<integrable>", static_cast<std::size_t>(measurements));
  for (int i = 0; i < measurements; ++i) {
    archive.Value("integrable");
    for (const float value : {0.1F, 9.81F, 0.0F, 0.01F, 0.0F, -0.02F, 0.005F}) archive.Float(value);
  }
  archive.Value("Calib");
  Pose(archive);
  Pose(archive);
  archive.Floats(0, 12);
  archive.Bool(measurements > 0);
}

void Image(CraftedArchive& archive, const KeyFrameContent& keyframe) {
  archive.UnsignedLong(keyframe.id);
  archive.UnsignedLong(keyframe.frame);
  archive.Double(keyframe.time);
  archive.Int(keyframe.left);
  archive.Int(1);
  for (const float value : {0.1F, 0.1F, 0.0F, 500.0F, 500.0F, 0.002F, 0.002F, 320.0F, 240.0F, 0.0F, 0.0F, 0.0F})
    archive.Float(value);
  Matrix(archive, 1, 4, 5, true);
  for (int i = 0; i < 16; ++i) archive.Byte(0);
  archive.Int(keyframe.left + keyframe.right);
  Keypoints(archive, keyframe.left, 50);
  Keypoints(archive, keyframe.left, 50);
  for (int column = 0; column < 2; ++column)
    FloatVector(archive, std::vector<float>(static_cast<std::size_t>(keyframe.left), -1.0F));
  Descriptors(archive, keyframe.left + keyframe.right, 0x40 + static_cast<int>(keyframe.id % 2));
  Words(archive, keyframe.words, keyframe.left);
  Pose(archive);
  archive.Int(2);
  for (const float value : {1.2F, 0.1823F}) archive.Float(value);
  FloatVector(archive, {1.0F, 1.2F});
  FloatVector(archive, {1.0F, 1.44F});
  FloatVector(archive, {1.0F, 0.6944F});
  for (const int value : {0, 0, 640, 480}) archive.Int(value);
  for (const float value : {500.0F, 0.0F, 0.0F, 0.0F, 500.0F, 0.0F, 320.0F, 240.0F, 1.0F}) archive.Float(value);
  Pose(archive, keyframe.x);
}

void KeyFrame(CraftedArchive& archive, const KeyFrameContent& keyframe) {
  Image(archive, keyframe);
  archive.NumberVector("vector<long long>", keyframe.points.size());
  for (const std::int64_t point : keyframe.points) archive.LongLong(point);
  Grid(archive, keyframe.left);
  WeightMap(archive, keyframe.connections);
  archive.Bool(keyframe.first);
  archive.LongLong(keyframe.parent);
  UnsignedLongVector(archive, keyframe.children);
  UnsignedLongVector(archive, keyframe.loops);
  UnsignedLongVector(archive, {});
  for (int flag = 0; flag < 3; ++flag) archive.Bool(false);
  archive.Float(0);
  for (const std::uint32_t value : {keyframe.map, keyframe.camera, keyframe.right_camera}) archive.Unsigned(value);
  const bool fisheye = keyframe.right > 0;
  IntVector(archive, fisheye ? keyframe.left : 0);
  IntVector(archive, keyframe.right);
  archive.Int(fisheye ? keyframe.left : -1);
  archive.Int(fisheye ? keyframe.right : -1);
  Pose(archive, fisheye ? 0.1F : 0.0F);
  Keypoints(archive, keyframe.right, 70);
  Grid(archive, keyframe.right);
  Inertial(archive, keyframe.measurements);
  archive.LongLong(keyframe.previous);
  archive.LongLong(keyframe.next);
  archive.Bool(keyframe.measurements > 0);
  archive.Floats(0, 6);
  archive.Bool(keyframe.measurements > 0);
}

void Point(CraftedArchive& archive, const PointContent& point) {
  archive.UnsignedLong(point.id);
  archive.Long(0);
  archive.Long(0);
  archive.Int(static_cast<std::int32_t>(point.observations.size()));
  for (const float value : {point.x, 0.0F, 5.0F, 0.0F, 0.0F, 1.0F}) archive.Float(value);
  for (const std::size_t side : {0U, 1U}) {
    std::map<std::uint64_t, std::int32_t> rows;
    for (const auto& [keyframe, row] : point.observations) rows[keyframe] = row[side];
    WeightMap(archive, rows);
  }
  if (point.descriptor) {
    Descriptors(archive, 1, 0x40);
  } else {
    Matrix(archive, 0, 0, 0, false);
  }
  archive.UnsignedLong(point.reference);
  archive.Bool(false);
  archive.LongLong(point.replaced);
  archive.Float(4);
  archive.Float(6);
}

void KeyFrameObject(CraftedArchive& archive, const KeyFrameContent& keyframe) {
  if (archive.Object("KeyFrame", static_cast<int>(keyframe.id))) KeyFrame(archive, keyframe);
}

void PointObject(CraftedArchive& archive, const PointContent& point) {
  if (archive.Object("MapPoint", static_cast<int>(point.id))) Point(archive, point);
}

void MapHead(CraftedArchive& archive, std::uint64_t id, std::uint64_t initial, std::uint64_t largest) {
  for (const std::uint64_t value : {id, initial, largest}) archive.UnsignedLong(value);
  archive.Int(0);
}

void MapTail(CraftedArchive& archive, const std::vector<std::uint64_t>& origins, std::uint64_t first,
             std::uint64_t lowest, bool inertial) {
  UnsignedLongVector(archive, origins);
  archive.UnsignedLong(first);
  archive.UnsignedLong(lowest);
  for (int flag = 0; flag < 4; ++flag) archive.Bool(inertial);
}

// A camera; `fisheye` is a KannalaBrandt8.
void Camera(CraftedArchive& archive, std::uint32_t id, bool fisheye) {
  if (!archive.Object(fisheye ? "KannalaBrandt8" : "Pinhole", static_cast<int>(id))) return;
  archive.Value("GeometricCamera");
  archive.Unsigned(id);
  archive.Unsigned(fisheye ? 1 : 0);
  std::vector<float> parameters = {500.0F, 500.0F, 320.0F, 240.0F};
  if (fisheye) parameters.insert(parameters.end(), {0.003F, 0.0007F, -0.002F, 0.0002F});
  FloatVector(archive, parameters);
  if (fisheye) archive.Float(1e-6F);
}

void Begin(CraftedArchive& archive) {
  archive.String("ORBvoc.txt");
  archive.String("0123456789abcdef0123456789abcdef");
  archive.Object("Atlas", 0);
  archive.Register("Pinhole");
  archive.Register("KannalaBrandt8");
}

void OddSecondMap(CraftedArchive& archive) {
  if (!archive.Object("Map", 1)) return;
  MapHead(archive, 1, 3, 4);
  KeyFrameContent inertial{.id = 3, .frame = 30, .time = 1.5e9, .words = false, .points = {8, -1}};
  inertial.connections = {{4, 15}, {77, 1}};
  inertial.first = true;
  inertial.children = {4};
  inertial.loops = {4};
  inertial.measurements = 2;
  inertial.next = 4;
  KeyFrameContent fisheye{.id = 4, .frame = 41, .time = 1.5e9 + 0.1, .x = -0.1F, .left = 2, .right = 1};
  fisheye.points = {8, 9, 8};
  fisheye.parent = 3;
  fisheye.map = 1;
  fisheye.camera = 1;
  fisheye.right_camera = 0;
  fisheye.previous = 3;
  archive.Container("vector<KeyFrame*>", 3);
  KeyFrameObject(archive, inertial);
  archive.Null("KeyFrame");
  KeyFrameObject(archive, fisheye);
  const PointContent seen{.id = 8, .x = 0.3F, .observations = {{3, {0, -1}}, {4, {0, 2}}}, .reference = 3};
  const PointContent bare{.id = 9, .x = 1e-30F, .descriptor = false, .reference = kNoId, .replaced = 8};
  archive.Container("vector<MapPoint*>", 3);
  PointObject(archive, seen);
  PointObject(archive, bare);
  PointObject(archive, seen);
  MapTail(archive, {3}, 3, 3, true);
}

Crafted Finish(const CraftedArchive& archive) { return {archive.Finish(), archive.fields()}; }

}  // namespace

Crafted CraftTinyAtlas(const Craft& craft) {
  CraftedArchive archive(craft);
  Begin(archive);
  archive.Container("vector<Map*>", 1);
  archive.Object("Map", 0);
  MapHead(archive, 0, 0, 1);
  KeyFrameContent root{.id = 0, .frame = 0, .time = 100.5, .x = -0.0F, .points = {0, 1}};
  root.connections = {{1, 2}};
  root.first = true;
  root.children = {1};
  KeyFrameContent leaf{.id = 1, .frame = 10, .time = 101.5, .x = -0.1F, .points = {0, 1}};
  leaf.connections = {{0, 2}};
  leaf.parent = 0;
  archive.Container("vector<KeyFrame*>", 2);
  KeyFrameObject(archive, root);
  KeyFrameObject(archive, leaf);
  archive.Container("vector<MapPoint*>", 2);
  PointObject(archive, {.id = 0, .x = 0, .observations = {{0, {0, -1}}, {1, {0, -1}}}});
  PointObject(archive, {.id = 1, .x = 1, .observations = {{0, {1, -1}}, {1, {1, -1}}}});
  MapTail(archive, {}, 0, 0, false);
  archive.Container("vector<GeometricCamera*>", 1);
  Camera(archive, 0, false);
  for (const std::uint64_t counter : {1U, 11U, 2U, 2U, 1U, 0U}) archive.UnsignedLong(counter);
  return Finish(archive);
}

Crafted CraftOddAtlas(const Craft& craft) {
  CraftedArchive archive(craft);
  Begin(archive);
  archive.Container("vector<Map*>", 3);
  archive.Object("Map", 0);
  MapHead(archive, 0, 0, 0);
  archive.Container("vector<KeyFrame*>", 0);
  archive.Container("vector<MapPoint*>", 0);
  MapTail(archive, {}, kNoId, kNoId, false);
  OddSecondMap(archive);
  OddSecondMap(archive);
  archive.Container("vector<GeometricCamera*>", 2);
  Camera(archive, 1, true);
  Camera(archive, 0, false);
  for (const std::uint64_t counter : {2U, 42U, 5U, 10U, 2U, 5U}) archive.UnsignedLong(counter);
  return Finish(archive);
}

}  // namespace slamdb
