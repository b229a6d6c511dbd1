// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/import/detail/possible.h"
#include "slamdb/formats/sqlite/detail/foreign.h"
#include "slamdb/formats/stella/detail/cameras.h"
#include "slamdb/formats/stella/detail/database_format.h"
#include "slamdb/formats/stella/detail/pose_matrix.h"
#include "slamdb/model/index.h"

namespace slamdb::stella {
namespace {

using detail::Concat;
using sqlite::Database;
using sqlite::Statement;

// A row of a table, and how errors call it.
class Row {
 public:
  Row(Database& database, Statement& statement, const char* table)
      : database_(database), statement_(statement), table_(table) {}

  std::uint64_t Id(int column) const {
    const std::int64_t id = statement_.Integer(column);
    if (id < 0 || id > std::int64_t{0xffffffff}) Fail(Concat("the id is ", id));
    return static_cast<std::uint64_t>(id);
  }
  std::int64_t Integer(int column) const { return statement_.Integer(column); }
  std::uint32_t Size(int column) const {
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(Integer(column), 0, 0xffffffff));
  }
  double Real(int column) const { return statement_.Real(column); }
  double RealOrZero(int column) const { return statement_.IsNull(column) ? 0 : statement_.Real(column); }
  std::string Text(int column) const { return statement_.Text(column); }  // of blobs too

  // Copies a blob into `count` values of a column.
  template <class Column>
  void Fill(int column, Column& values, std::size_t count, const char* what) const {
    const Bytes blob = statement_.Blob(column);
    constexpr std::size_t kBytes = sizeof(typename Column::value_type);
    if (blob.size() != count * kBytes)
      Fail(Concat(what, " has ", blob.size(), " bytes, expected ", count * kBytes, " for ", count));
    values.resize(count);
    if (count > 0) std::memcpy(values.data(), blob.data(), blob.size());
  }
  // As many as its bytes hold.
  template <class Column>
  void FillAll(int column, Column& values, const char* what) const {
    Fill(column, values, BlobBytes(column) / sizeof(typename Column::value_type), what);
  }
  std::size_t BlobBytes(int column) const { return statement_.Blob(column).size(); }

  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(ErrorKind::kDamaged, database_.path(), Concat("table ", table_, ", row ", statement_.Integer(0)),
                problem);
  }
  void Require(const std::string& why_not) const {
    if (!why_not.empty()) Fail(why_not);
  }

 private:
  Database& database_;
  Statement& statement_;
  const char* table_;
};

template <class Take>
void ForEachRow(Database& database, const char* table, const std::vector<std::string_view>& columns, const Take& take) {
  Statement statement(database, sqlite::SelectColumns(database, table, columns), Concat("table ", table));
  const Row row(database, statement, table);
  while (statement.Step()) take(row);
}

// What a name of a camera's table means.
template <class Value>
Value Require(const std::optional<Value>& value, const std::string& name, Database& database) {
  if (value) return *value;
  throw Error(ErrorKind::kUnsupported, database.path(), "table cameras", Concat("`", name, "` is not known to slamdb"));
}

void ReadCameras(Database& database, StoredMap& map) {
  ForEachRow(database, "cameras",
             {"id",
              "name",
              "setup_type",
              "model_type",
              "color_type",
              "cols",
              "rows",
              "fps",
              "fx",
              "fy",
              "cx",
              "cy",
              "k1",
              "k2",
              "p1",
              "p2",
              "k3",
              "k4",
              "focal_x_baseline",
              "distortion"},
             [&](const Row& row) {
               LensCamera& camera = map.cameras.emplace_back();
               camera.name = row.Text(1);
               camera.setup = Require(SetupOf(row.Text(2)), row.Text(2), database);
               camera.model = Require(ModelOf(row.Text(3)), row.Text(3), database);
               camera.color_order = row.Text(4);
               camera.columns = row.Size(5);
               camera.rows = row.Size(6);
               camera.fps = row.Real(7);
               camera.fx = row.RealOrZero(8), camera.fy = row.RealOrZero(9);
               camera.cx = row.RealOrZero(10), camera.cy = row.RealOrZero(11);
               const auto k = [&](int column) { return row.RealOrZero(column); };
               if (camera.model == Model::kPerspective) camera.distortion = {k(12), k(13), k(14), k(15), k(16)};
               if (camera.model == Model::kFisheye) camera.distortion = {k(12), k(13), k(16), k(17), 0};
               if (camera.model == Model::kRadialDivision) camera.distortion = {k(19), 0, 0, 0, 0};
               camera.focal_x_baseline = row.RealOrZero(18);
               row.Require(WhyNoCamera(camera));
             });
}

// As cv::KeyPoint is in memory.
struct KeypointBytes {
  float x, y, size, angle, response;
  std::int32_t octave, class_id;
};
static_assert(sizeof(KeypointBytes) == 28);

void ReadFeatures(const Row& row, Features& features) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  const std::int64_t claimed = row.Integer(6);
  if (claimed < 0 || claimed > kMost) row.Fail(Concat("claims ", claimed, " keypoints"));
  const auto count = static_cast<std::size_t>(claimed);
  std::vector<KeypointBytes> keypoints;
  row.Fill(7, keypoints, count, "undist_keypts");
  features.undistorted.reserve(count);
  for (const KeypointBytes& from : keypoints)
    features.undistorted.push_back({.angle = from.angle,
                                    .response = from.response,
                                    .size = from.size,
                                    .x = from.x,
                                    .y = from.y,
                                    .class_id = from.class_id,
                                    .octave = from.octave});
  if (row.BlobBytes(8) > 0) row.Fill(8, features.right_x, count, "x_rights");
  if (row.BlobBytes(9) > 0) row.Fill(9, features.depth, count, "depths");
  row.Fill(10, features.descriptors, count, "descs");
}

Rigid3f TakePose(const Row& row, int column) {
  std::vector<double> numbers;
  row.Fill(column, numbers, 16, "pose_cw");
  const Eigen::Map<const Eigen::Matrix4d> pose(numbers.data());
  row.Require(detail::WhyNoPose(Eigen::Matrix3d(pose.topLeftCorner<3, 3>()), pose.topRightCorner<3, 1>()));
  return PoseOf(pose);
}

void ReadKeyFrames(Database& database, StoredMap& map, const ReadOptions& options) {
  const std::int64_t total = database.Integer("SELECT count(*) FROM keyframes");
  ForEachRow(database, "keyframes",
             {"id", "src_frm_id", "ts", "cam", "orb_params", "pose_cw", "n_keypts", "undist_keypts", "x_rights",
              "depths", "descs", "n_markers"},
             [&](const Row& row) {
               StoredKeyFrame& stored = map.keyframes.emplace_back();
               stored.keyframe.id = KeyFrameId(row.Id(0));
               const std::int64_t frame = row.Integer(1);
               stored.keyframe.frame_id = frame > 0 ? static_cast<std::uint64_t>(frame) : row.Id(0);
               stored.keyframe.timestamp = row.Real(2);
               stored.camera = row.Text(3);
               stored.orb_params = row.Text(4);
               stored.keyframe.camera_from_world = TakePose(row, 5);
               ReadFeatures(row, stored.keyframe.features);
               if (row.Integer(11) > 0) map.marker_sightings += static_cast<std::uint64_t>(row.Integer(11));
               if (options.progress && total > 0)
                 options.progress("reading", static_cast<double>(map.keyframes.size()) / static_cast<double>(total));
             });
}

KeyFrameId KeyFrameOf(std::int64_t id) { return id < 0 ? KeyFrameId() : KeyFrameId(static_cast<std::uint64_t>(id)); }

void ReadAssociations(Database& database, StoredMap& map) {
  std::uint64_t highest = 0;
  for (const StoredKeyFrame& stored : map.keyframes) highest = std::max(highest, stored.keyframe.id.value());
  IdTable rows(0, highest, map.keyframes.size());
  for (std::size_t i = 0; i < map.keyframes.size(); ++i)
    rows.Insert(map.keyframes[i].keyframe.id.value(), static_cast<std::uint32_t>(i));
  ForEachRow(database, "associations", {"id", "lm_ids", "span_parent", "spanning_children", "loop_edges"},
             [&](const Row& row) {
               const std::uint32_t found = rows.Find(row.Id(0));
               if (found == kNoRow) return;  // of a keyframe that is not there
               KeyFrame& keyframe = map.keyframes[found].keyframe;
               std::vector<std::int32_t> ids;
               row.Fill(1, ids, keyframe.features.undistorted.size(), "lm_ids");
               keyframe.features.map_points.resize(ids.size());
               for (std::size_t i = 0; i < ids.size(); ++i)
                 keyframe.features.map_points[i] =
                     ids[i] < 0 ? MapPointId() : MapPointId(static_cast<std::uint64_t>(ids[i]));
               keyframe.parent = KeyFrameOf(row.Integer(2));
               const auto links = [&](int column, Column<KeyFrameId>& to, const char* what) {
                 row.FillAll(column, ids, what);
                 for (const std::int32_t id : ids) to.push_back(KeyFrameOf(id));
               };
               links(3, keyframe.children, "spanning_children");
               links(4, keyframe.loop_edges, "loop_edges");
             });
  for (StoredKeyFrame& stored : map.keyframes)
    stored.keyframe.features.map_points.resize(stored.keyframe.features.undistorted.size());
}

void ReadPoints(Database& database, StoredMap& map) {
  ForEachRow(database, "landmarks", {"id", "first_keyfrm", "pos_w", "ref_keyfrm", "n_vis", "n_fnd"},
             [&](const Row& row) {
               MapPoint& point = map.points.emplace_back();
               point.descriptor_form = MatrixForm::kEmpty;
               point.id = MapPointId(row.Id(0));
               point.first_keyframe = row.Integer(1);
               std::vector<double> position;
               row.Fill(2, position, 3, "pos_w");
               const Eigen::Map<const Eigen::Vector3d> place(position.data());
               row.Require(detail::WhyNoPosition(place));
               point.position = place.cast<float>();
               point.reference = KeyFrameOf(row.Integer(3));
               const auto count = [&](int column) {
                 return static_cast<std::int32_t>(std::min<std::uint32_t>(row.Size(column), 0x7fffffff));
               };
               point.visible_count = count(4);
               point.found_count = count(5);
             });
}

}  // namespace

StoredMap ReadDatabase(Database& database, const ReadOptions& options) {
  StoredMap map;
  ReadCameras(database, map);
  ReadKeyFrames(database, map, options);
  ReadAssociations(database, map);
  ReadPoints(database, map);
  if (!sqlite::ColumnsOf(database, "markers").empty())
    map.markers = static_cast<std::uint64_t>(database.Integer("SELECT count(*) FROM markers"));
  if (!sqlite::ColumnsOf(database, "stats").empty())
    ForEachRow(database, "stats", {"id", "frame_next_id", "keyframe_next_id", "landmark_next_id"}, [&](const Row& row) {
      map.next_frame = row.Size(1), map.next_keyframe = row.Size(2), map.next_point = row.Size(3);
    });
  return map;
}

}  // namespace slamdb::stella
