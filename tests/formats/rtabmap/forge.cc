// SPDX-License-Identifier: BSD-3-Clause
#include "tests/formats/rtabmap/forge.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>

namespace slamdb {
namespace {

template <class Value>
void Append(Blob& blob, Value value) {
  const std::size_t at = blob.size();
  blob.resize(at + sizeof value);
  std::memcpy(blob.data() + at, &value, sizeof value);
}

void AppendPose(Blob& blob, const Eigen::Isometry3d& pose) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) Append(blob, static_cast<float>(pose.matrix()(row, column)));
}

int MinorOf(const std::string& version) { return std::atoi(version.c_str() + 2); }
int PatchOf(const std::string& version) { return std::atoi(version.c_str() + version.rfind('.') + 1); }

// Since 0.18: K, D, P and the local transform.
Blob MonoBlob(const ForgedCamera& camera, double shift) {
  Blob blob;
  for (const int number : {0, 18, 0, 0, camera.width, camera.height, 9, 5, 0, 12, 12}) Append(blob, number);
  const double f = camera.f, cx = camera.cx, cy = camera.cy;
  for (const double number : {f + 1, 0.0, cx, 0.0, f + 1, cy, 0.0, 0.0, 1.0}) Append(blob, number);
  for (int i = 0; i < 5; ++i) Append(blob, 0.0);
  for (const double number : {f, 0.0, cx, shift, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0}) Append(blob, number);
  AppendPose(blob, camera.local);
  return blob;
}

Blob NewCalibration(const ForgedCamera& camera) {
  if (camera.baseline == 0) return MonoBlob(camera, 0);
  const Blob left = MonoBlob(camera, 0), right = MonoBlob(camera, -camera.baseline * static_cast<double>(camera.f));
  Blob blob;
  for (const int number : {0, 18, 0, 1, 9, 3, 0, 0, static_cast<int>(left.size()), static_cast<int>(right.size())})
    Append(blob, number);
  for (int i = 0; i < 12; ++i) Append(blob, 0.0);
  blob.insert(blob.end(), left.begin(), left.end());
  blob.insert(blob.end(), right.begin(), right.end());
  return blob;
}

Blob OldCalibration(const ForgedCamera& camera, bool has_size) {
  Blob blob;
  for (const float number : {camera.f, camera.f, camera.cx, camera.cy}) Append(blob, number);
  if (camera.baseline != 0) Append(blob, camera.baseline);
  if (has_size) Append(blob, static_cast<float>(camera.width)), Append(blob, static_cast<float>(camera.height));
  AppendPose(blob, camera.local);
  return blob;
}

}  // namespace

Blob PoseBlob(const Eigen::Isometry3d& pose) {
  Blob blob;
  AppendPose(blob, pose);
  return blob;
}

Blob MatrixBlob(const void* data, std::size_t bytes, int rows, int columns, int type) {
  Blob blob(compressBound(bytes));
  uLongf size = blob.size();
  EXPECT_EQ(compress(blob.data(), &size, static_cast<const Bytef*>(data), bytes), Z_OK);
  blob.resize(size);
  for (const int number : {rows, columns, type}) Append(blob, number);
  return blob;
}

Eigen::Isometry3d ForgedCamera::Optical() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return pose;
}

Blob CalibrationBlob(const std::string& version, const std::vector<ForgedCamera>& cameras) {
  Blob blob;
  for (const ForgedCamera& camera : cameras) {
    const Blob one = MinorOf(version) >= 18 ? NewCalibration(camera)
                                            : OldCalibration(camera, MinorOf(version) > 11 || PatchOf(version) >= 2);
    blob.insert(blob.end(), one.begin(), one.end());
  }
  return blob;
}

Forge::Forge(const std::string& path, const std::string& version) : minor_(MinorOf(version)), patch_(PatchOf(version)) {
  sqlite3* handle = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &handle), SQLITE_OK);
  handle_.reset(handle);
  Execute("PRAGMA page_size = 512; PRAGMA synchronous = OFF");
  const bool words = minor_ > 11 || patch_ >= 2;
  Execute(std::string("CREATE TABLE Node(id INTEGER NOT NULL, map_id INTEGER NOT NULL, weight INTEGER, stamp FLOAT, "
                      "pose BLOB, ground_truth_pose BLOB, ") +
          (minor_ >= 14 ? "velocity BLOB, " : "") + "label TEXT, " + (minor_ >= 14 ? "gps BLOB, " : "") +
          "time_enter DATE, PRIMARY KEY (id))");
  Execute(std::string("CREATE TABLE Data(id INTEGER NOT NULL, image BLOB, depth BLOB, ") +
          (minor_ >= 23 ? "depth_confidence BLOB, " : "") +
          "calibration BLOB, scan BLOB, user_data BLOB, time_enter DATE, PRIMARY KEY (id))");
  Execute(std::string("CREATE TABLE Link(from_id INTEGER NOT NULL, to_id INTEGER NOT NULL, type INTEGER NOT NULL, ") +
          (minor_ >= 13 ? "information_matrix BLOB" : "rot_variance FLOAT, trans_variance FLOAT") +
          ", transform BLOB, user_data BLOB)");
  Execute(
      "CREATE TABLE Word(id INTEGER NOT NULL, descriptor_size INTEGER NOT NULL, descriptor BLOB NOT NULL, "
      "time_enter DATE, PRIMARY KEY (id))");
  Execute(
      std::string("CREATE TABLE ") + (minor_ >= 13 ? "Feature" : "Map_Node_Word") +
      "(node_id INTEGER NOT NULL, word_id INTEGER NOT NULL, pos_x FLOAT NOT NULL, pos_y FLOAT NOT NULL, size INTEGER "
      "NOT NULL, dir FLOAT NOT NULL, response FLOAT NOT NULL, " +
      (minor_ >= 12 ? "octave INTEGER NOT NULL, " : "") + "depth_x FLOAT, depth_y FLOAT, depth_z FLOAT" +
      (words ? ", descriptor_size INTEGER, descriptor BLOB)" : ")"));
  Execute("CREATE TABLE Info(STM_size INTEGER, parameters TEXT)");
  Execute(std::string("CREATE TABLE Admin(version TEXT, ") + (minor_ >= 16 ? "opt_ids BLOB, opt_poses BLOB, " : "") +
          "time_enter DATE)");
  Execute("INSERT INTO Admin(version) VALUES('" + version + "')");
  Execute(
      "CREATE TRIGGER insert_Node_timeEnter AFTER INSERT ON Node BEGIN UPDATE Node SET time_enter = DATETIME('NOW') "
      "WHERE rowid = new.rowid; END");
  Execute("CREATE INDEX IDX_Link_from_id on Link (from_id)");
}

void Forge::Execute(const std::string& sql) {
  ASSERT_EQ(sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sql << ": " << sqlite3_errmsg(handle_.get());
}

void Forge::Bind(const std::string& sql, const Blob& blob) {
  sqlite3_stmt* statement = nullptr;
  ASSERT_EQ(sqlite3_prepare_v2(handle_.get(), sql.c_str(), -1, &statement, nullptr), SQLITE_OK)
      << sql << ": " << sqlite3_errmsg(handle_.get());
  sqlite3_bind_blob(statement, 1, blob.data(), static_cast<int>(blob.size()), SQLITE_TRANSIENT);
  EXPECT_EQ(sqlite3_step(statement), SQLITE_DONE) << sqlite3_errmsg(handle_.get());
  sqlite3_finalize(statement);
}

void Forge::AddNode(int id, int session, double stamp, const Eigen::Isometry3d& odometry, const Blob& calibration) {
  const std::string number = std::to_string(id);
  Bind("INSERT INTO Node(id, map_id, weight, stamp, pose) VALUES(" + number + ", " + std::to_string(session) + ", 0, " +
           std::to_string(stamp) + ", ?)",
       PoseBlob(odometry));
  Bind("INSERT INTO Data(id, calibration) VALUES(" + number + ", ?)", calibration);
}

void Forge::AddLink(int from, int to, int type) {
  const std::string columns = minor_ >= 13 ? "information_matrix" : "rot_variance, trans_variance";
  Execute("INSERT INTO Link(from_id, to_id, type, " + columns + ") VALUES(" + std::to_string(from) + ", " +
          std::to_string(to) + ", " + std::to_string(type) + (minor_ >= 13 ? ", x'00')" : ", 1, 1)"));
}

void Forge::AddFeature(const ForgedFeature& feature) {
  const auto place = [&](int axis) {
    return std::isfinite(feature.place[axis]) ? std::to_string(feature.place[axis]) : std::string("NULL");
  };
  std::string columns = "node_id, word_id, pos_x, pos_y, size, dir, response, depth_x, depth_y, depth_z";
  std::string values = std::to_string(feature.node) + ", " + std::to_string(feature.word) + ", " +
                       std::to_string(feature.x) + ", " + std::to_string(feature.y) + ", 31, 90, 0.5, " + place(0) +
                       ", " + place(1) + ", " + place(2);
  if (minor_ >= 12) columns += ", octave", values += ", 1";
  const std::string table = minor_ >= 13 ? "Feature" : "Map_Node_Word";
  if (minor_ == 11 && patch_ < 2) return Execute("INSERT INTO " + table + "(" + columns + ") VALUES(" + values + ")");
  Bind("INSERT INTO " + table + "(" + columns + ", descriptor_size, descriptor) VALUES(" + values + ", " +
           std::to_string(feature.descriptor_size) + ", ?)",
       feature.descriptor);
}

void Forge::AddWord(int id, const Blob& descriptor) {
  Bind("INSERT INTO Word(id, descriptor_size, descriptor) VALUES(" + std::to_string(id) + ", " +
           std::to_string(descriptor.size()) + ", ?)",
       descriptor);
}

void Forge::SetOptimized(const std::vector<std::pair<int, Eigen::Isometry3d>>& poses) {
  std::vector<int> ids;
  Blob floats;
  for (const auto& [id, pose] : poses) {
    ids.push_back(id);
    AppendPose(floats, pose);
  }
  const int count = static_cast<int>(ids.size());
  Bind("UPDATE Admin SET opt_ids = ?", MatrixBlob(ids.data(), 4 * ids.size(), 1, count, 4));
  Bind("UPDATE Admin SET opt_poses = ?", MatrixBlob(floats.data(), floats.size(), 1, 12 * count, 5));
}

Eigen::Vector3d WallPoint(int index) { return {4, -1.5 + 0.25 * index, index % 3 == 0 ? 0.5 : -0.25}; }

Eigen::Isometry3d BaseAt(int node, double drift) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(0.1 * node, drift * node, 0);
  return pose;
}

ForgedFeature FeatureOf(int node, int point, const ForgedCamera& camera) {
  const Eigen::Vector3d in_base = BaseAt(node).inverse() * WallPoint(point);
  const Eigen::Vector3d in_camera = camera.local.inverse() * in_base;
  ForgedFeature feature{
      .node = node, .word = point + 1, .x = 0, .y = 0, .place = in_base.cast<float>(), .descriptor = {}};
  feature.x = static_cast<float>(camera.f * in_camera.x() / in_camera.z() + camera.cx);
  feature.y = static_cast<float>(camera.f * in_camera.y() / in_camera.z() + camera.cy);
  feature.descriptor = Blob(32, static_cast<std::uint8_t>(point));
  return feature;
}

void AddDrive(Forge& forge, const std::string& version, const ForgedCamera& camera, double drift) {
  const Blob calibration = CalibrationBlob(version, {camera});
  for (int node = 1; node <= kNodes; ++node) {
    forge.AddNode(node, 0, node + 0.5, BaseAt(node, drift), calibration);
    for (int point = 0; point < kPoints; ++point) forge.AddFeature(FeatureOf(node, point, camera));
    if (node > 1) forge.AddLink(node - 1, node, 0), forge.AddLink(node, node - 1, 0);
  }
  forge.AddLink(kNodes, 1, 1);
  forge.AddLink(1, kNodes, 1);
  for (int point = 0; point < kPoints; ++point) forge.AddWord(point + 1, Blob(32, static_cast<std::uint8_t>(point)));
}

}  // namespace slamdb
