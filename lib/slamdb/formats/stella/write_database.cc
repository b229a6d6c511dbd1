// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <span>
#include <string>

#include "slamdb/base/detail/run_files.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/stella/detail/database_format.h"
#include "slamdb/formats/stella/detail/pose_matrix.h"

namespace slamdb::stella {
namespace {

// The columns in the order in which stella_vslam expects them: it selects them all, and counts.
constexpr const char* kTables = R"(
CREATE TABLE cameras(id INTEGER PRIMARY KEY, name BLOB, setup_type BLOB, model_type BLOB, color_type BLOB, cols INTEGER, rows INTEGER, fps REAL, fx REAL, fy REAL, cx REAL, cy REAL, k1 REAL, k2 REAL, p1 REAL, p2 REAL, k3 REAL, k4 REAL, focal_x_baseline REAL, distortion REAL);
CREATE TABLE keyframes(id INTEGER PRIMARY KEY, src_frm_id INTEGER, ts REAL, cam BLOB, orb_params BLOB, pose_cw BLOB, n_keypts INTEGER, undist_keypts BLOB, x_rights BLOB, depths BLOB, descs BLOB, n_markers INTEGER, markers BLOB);
CREATE TABLE landmarks(id INTEGER PRIMARY KEY, first_keyfrm INTEGER, pos_w BLOB, ref_keyfrm INTEGER, n_vis INTEGER, n_fnd INTEGER);
CREATE TABLE associations(id INTEGER PRIMARY KEY, lm_ids BLOB, span_parent INTEGER, n_spanning_children INTEGER, spanning_children BLOB, n_loop_edges INTEGER, loop_edges BLOB);
CREATE TABLE markers(id INTEGER PRIMARY KEY, corners_pos_w BLOB, keep_fixed INTEGER, n_observations INTEGER, observations BLOB, initialized_before INTEGER);
CREATE TABLE stats(id INTEGER PRIMARY KEY, frame_next_id INTEGER, keyframe_next_id INTEGER, landmark_next_id INTEGER);
)";

Bytes BytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }
template <class Column>
Bytes BytesOfColumn(const Column& column) {
  return std::as_bytes(std::span(column));
}

std::vector<std::int32_t> Numbers(const std::vector<KeyFrameId>& ids) {
  std::vector<std::int32_t> numbers;
  for (const KeyFrameId id : ids) numbers.push_back(static_cast<std::int32_t>(id.value()));
  return numbers;
}

// x, y, size, angle, response, octave, class_id: as cv::KeyPoint is in memory.
void SetKeypointBytes(std::span<const Keypoint> keypoints, std::vector<char>& bytes) {
  constexpr std::size_t kBytes = 28;
  bytes.resize(kBytes * keypoints.size());
  char* at = bytes.data();
  const auto put = [&at](auto value) {
    std::memcpy(at, &value, sizeof value);
    at += sizeof value;
  };
  for (const Keypoint& keypoint : keypoints) {
    for (const float value : {keypoint.x, keypoint.y, keypoint.size, keypoint.angle, keypoint.response}) put(value);
    put(keypoint.octave);
    put(keypoint.class_id);
  }
}

// As many as there are keypoints; zeros stand for those that are missing, which `padded` then has too.
Bytes DescriptorBytes(const Column<Descriptor>& descriptors, std::size_t rows, Column<Descriptor>& padded) {
  if (descriptors.size() >= rows) return BytesOfColumn(std::span(descriptors).first(rows));
  padded = descriptors;
  padded.resize(rows, Descriptor{});
  return BytesOfColumn(padded);
}

void InsertCameras(sqlite::Database& database, const Outgoing& map) {
  sqlite::Statement insert(database,
                           "INSERT INTO cameras VALUES(?1,?2,?3,?4,?5,?6,?7,?8,?9,?10,?11,?12,?13,?14,?15,?16,"
                           "?17,?18,?19,NULL)");
  std::int64_t id = 0;
  for (const LensCamera& camera : map.cameras()) {
    const std::array<double, 5>& k = camera.distortion;
    insert.Bind(1, id++).BindBlob(2, BytesOf(camera.name)).BindBlob(3, BytesOf(NameOf(camera.setup)));
    insert.BindBlob(4, BytesOf(NameOf(camera.model))).BindBlob(5, BytesOf(camera.color_order));
    insert.Bind(6, std::int64_t{camera.columns}).Bind(7, std::int64_t{camera.rows}).BindReal(8, camera.fps);
    for (int column = 9; column <= 18; ++column) insert.BindNull(column);
    int column = 9;
    if (camera.model != Model::kEquirectangular)
      for (const double value : {camera.fx, camera.fy, camera.cx, camera.cy, k[0], k[1]})
        insert.BindReal(column++, value);
    if (camera.model == Model::kPerspective) insert.BindReal(15, k[2]).BindReal(16, k[3]).BindReal(17, k[4]);
    if (camera.model == Model::kFisheye) insert.BindReal(17, k[2]).BindReal(18, k[3]);
    insert.BindReal(19, camera.focal_x_baseline).Run();
  }
}

void InsertKeyFrames(sqlite::Database& database, const Outgoing& map, const WriteOptions& options) {
  sqlite::Statement keyframe(database, "INSERT INTO keyframes VALUES(?1,NULL,?2,?3,?4,?5,?6,?7,?8,?9,?10,0,x'')");
  sqlite::Statement association(database, "INSERT INTO associations VALUES(?1,?2,?3,?4,?5,?6,?7)");
  std::vector<char> keypoints;
  Column<Descriptor> padded;
  std::size_t done = 0;
  for (const OutgoingKeyFrame& written : map.keyframes()) {
    const KeyFrame& from = *written.keyframe;
    const auto id = static_cast<std::int64_t>(from.id.value());
    const OutgoingFeatures features = map.FeaturesOf(written);
    SetKeypointBytes(features.undistorted, keypoints);
    const Bytes descriptors = DescriptorBytes(from.features.descriptors, written.rows, padded);
    const Eigen::Matrix4d pose = PoseMatrix(from.camera_from_world);
    keyframe.Bind(1, id).BindReal(2, from.timestamp).BindBlob(3, BytesOf(map.cameras()[written.camera].name));
    keyframe.BindBlob(4, BytesOf(map.orb_params()[written.orb_params].name));
    keyframe.BindBlob(5, std::as_bytes(std::span(pose.data(), 16))).Bind(6, static_cast<std::int64_t>(written.rows));
    keyframe.BindBlob(7, BytesOfColumn(keypoints)).BindBlob(8, BytesOfColumn(features.right_x));
    keyframe.BindBlob(9, BytesOfColumn(features.depth)).BindBlob(10, descriptors).Run();
    const std::vector<std::int32_t> children = Numbers(written.children), loops = Numbers(written.loop_edges);
    association.Bind(1, id).BindBlob(2, BytesOfColumn(written.points));
    association.Bind(3, written.parent ? static_cast<std::int64_t>(written.parent.value()) : -1);
    association.Bind(4, static_cast<std::int64_t>(children.size())).BindBlob(5, BytesOfColumn(children));
    association.Bind(6, static_cast<std::int64_t>(loops.size())).BindBlob(7, BytesOfColumn(loops)).Run();
    if (options.progress)
      options.progress("writing", static_cast<double>(++done) / static_cast<double>(map.keyframes().size()));
  }
}

// `rows` times (?,?,?,?,?,?).
std::string InsertLandmarks(std::size_t rows) {
  std::string sql = "INSERT INTO landmarks VALUES";
  for (std::size_t row = 0; row < rows; ++row) sql += row == 0 ? "(?,?,?,?,?,?)" : ",(?,?,?,?,?,?)";
  return sql;
}

// Many with each statement, since its start costs SQLite as much as a row.
void InsertPoints(sqlite::Database& database, const Outgoing& map) {
  constexpr std::size_t kTogether = 100;  // 600 numbers; some builds of SQLite take 999
  const std::span<const OutgoingPoint> points = map.points();
  std::array<Eigen::Vector3d, kTogether> positions;
  std::optional<sqlite::Statement> insert;
  for (std::size_t begin = 0; begin < points.size(); begin += kTogether) {
    const std::size_t rows = std::min(kTogether, points.size() - begin);
    if (begin == 0 || rows < kTogether) insert.emplace(database, InsertLandmarks(rows));
    int column = 0;
    for (std::size_t row = 0; row < rows; ++row) {
      const OutgoingPoint& written = points[begin + row];
      const MapPoint& point = *written.point;
      positions[row] = point.position.cast<double>();
      insert->Bind(++column, static_cast<std::int64_t>(point.id.value()));
      insert->Bind(++column, FirstKeyFrameOf(point));
      insert->BindBlob(++column, std::as_bytes(std::span(positions[row].data(), 3)));
      insert->Bind(++column, static_cast<std::int64_t>(written.reference.value()));
      insert->Bind(++column, static_cast<std::int64_t>(CountOf(point.visible_count)));
      insert->Bind(++column, static_cast<std::int64_t>(CountOf(point.found_count)));
    }
    insert->Run();
  }
}

}  // namespace

void WriteDatabase(const Outgoing& map, const Target& target, const WriteOptions& options) {
  AtomicFile file(target, detail::FileOptions(options));
  if (target.is_file()) detail::RefuseLogOfAnother(target.path);
  sqlite::Database database = sqlite::Database::InMemory(target.path);
  sqlite::Transaction transaction(database, sqlite::Transaction::Kind::kBegin);
  database.Execute(kTables);
  InsertCameras(database, map);
  InsertKeyFrames(database, map, options);
  InsertPoints(database, map);
  sqlite::Statement stats(database, "INSERT INTO stats VALUES(0,NULL,?1,?2)");
  stats.Bind(1, static_cast<std::int64_t>(map.next_keyframe()))
      .Bind(2, static_cast<std::int64_t>(map.next_point()))
      .Run();
  transaction.Commit();
  file.Write(database.Serialized());
  file.Commit();
}

}  // namespace slamdb::stella
