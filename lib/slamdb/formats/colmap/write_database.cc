// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "slamdb/formats/colmap/detail/database.h"
#include "slamdb/formats/colmap/detail/lenses.h"
#include "slamdb/formats/colmap/detail/models.h"
#include "slamdb/formats/colmap/detail/poses.h"
#include "slamdb/formats/colmap/detail/schemas.h"
#include "slamdb/model/detail/rotations.h"
#include "slamdb/model/index.h"

namespace slamdb::colmap {
namespace {

using sqlite::Statement;
using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

template <class Values>
Bytes BytesOf(const Values& values) {
  return std::as_bytes(std::span(values));
}

constexpr std::int64_t kCameraSensor = 0;

std::array<double, 7> SevenOf(const Pose& pose) {
  std::array<double, 7> seven{};
  std::ranges::copy(pose.wxyz, seven.begin());
  std::ranges::copy(pose.translation, seven.begin() + 4);
  return seven;
}

// x, y, scale and orientation: COLMAP takes one, and keypoints of ORB have no more.
struct KeypointRow {
  float x, y, scale, angle;
};

float ScaleOf(const Keypoint& keypoint, const ScalePyramid& pyramid) {
  const auto octave = static_cast<std::size_t>(std::max(keypoint.octave, 0));
  return octave < pyramid.factors.size() ? pyramid.factors[octave] : 1;
}

std::vector<KeypointRow> RowsOf(const Column<Keypoint>& keypoints, const ScalePyramid& pyramid) {
  std::vector<KeypointRow> rows;
  rows.reserve(keypoints.size());
  constexpr float kHalf = static_cast<float>(kHalfPixel), kDegree = std::numbers::pi_v<float> / 180;
  for (const Keypoint& keypoint : keypoints)
    rows.push_back({keypoint.x + kHalf, keypoint.y + kHalf, ScaleOf(keypoint, pyramid), keypoint.angle * kDegree});
  return rows;
}

// ORB's, or those that travel with the keyframe.
struct Described {
  Bytes bytes;
  std::size_t each = 0;  // bytes
};

Described DescriptorsOf(const KeyFrame& keyframe) {
  const Column<Descriptor>& column = keyframe.features.descriptors;
  if (!column.empty()) return {std::as_bytes(std::span(column)), sizeof(Descriptor)};
  if (!keyframe.carried || keyframe.carried->descriptors.rows <= 0) return {};
  const Column<std::byte>& data = keyframe.carried->descriptors.data;
  return {data, data.size() / static_cast<std::size_t>(keyframe.carried->descriptors.rows)};
}

// ---- pairs of images

using Match = std::array<std::uint32_t, 2>;

// What two images say about each other.
struct Relation {
  Eigen::Quaterniond second_from_first;
  Eigen::Vector3d translation;  // of length 1, since two images tell no scale; or zero
  RowMajor essential = RowMajor::Zero();
  std::optional<RowMajor> fundamental;  // of lenses that do not distort
};

std::optional<Eigen::Matrix3d> InverseCalibration(const Camera& camera) {
  if (camera.model != kPinhole) return std::nullopt;
  const std::vector<double>& p = camera.parameters;
  Eigen::Matrix3d inverse;
  inverse << 1 / p[0], 0, -p[2] / p[0], 0, 1 / p[1], -p[3] / p[1], 0, 0, 1;
  return inverse;
}

Relation RelationOf(const Image& first, const Image& second, const Camera& first_camera, const Camera& second_camera) {
  constexpr double kNothing = 1e-12;
  Relation relation;
  const Pose between = Compose(second.camera_from_world, Inverse(first.camera_from_world));
  relation.second_from_first = RotationOf(between).normalized();
  relation.translation = TranslationOf(between);
  const double length = relation.translation.norm();
  relation.translation = length > kNothing ? Eigen::Vector3d(relation.translation / length) : Eigen::Vector3d::Zero();
  relation.essential = detail::Hat(relation.translation) * relation.second_from_first.toRotationMatrix();
  const auto one = InverseCalibration(first_camera), two = InverseCalibration(second_camera);
  if (one && two) relation.fundamental = two->transpose() * relation.essential * *one;
  return relation;
}

// The images of a model that see the same points.
class Pairs {
 public:
  explicit Pairs(const Model& model) : model_(model), points_(PointRowsOf(model)) {
    std::uint32_t first = ~0U, last = 0;
    for (const Image& image : model.images) {
      first = std::min(first, image.id);
      last = std::max(last, image.id);
    }
    ends_.resize(model.images.size() + 1);
    IdTable images(first, last, model.images.size());
    for (std::uint32_t row = 0; row < model.images.size(); ++row) images.Insert(model.images[row].id, row);
    image_of_element_.reserve(model.tracks.size());
    for (const TrackElement& element : model.tracks) image_of_element_.push_back(images.Find(element.image));
  }

  // What this image, a row of Model::images, and those behind it see.
  void Find(std::uint32_t image) {
    std::ranges::fill(ends_, 0);
    ForEachMatch(image, [this](std::uint32_t other, const Match&) { ++ends_[other + 1]; });
    std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
    matches_.resize(ends_.back());
    ForEachMatch(image, [this](std::uint32_t other, const Match& match) { matches_[ends_[other]++] = match; });
  }

  // Keypoints of the image and one behind it that are the same points, in the order of those of the image.
  std::span<Match> MatchesWith(std::uint32_t other) {
    const std::size_t begin = other == 0 ? 0 : ends_[other - 1];
    return std::span(matches_).subspan(begin, ends_[other] - begin);
  }

 private:
  template <class Work>
  void ForEachMatch(std::uint32_t image, const Work& work) const {
    const Column<Point2>& keypoints = model_.images[image].points;
    for (std::uint32_t row = 0; row < keypoints.size(); ++row) {
      if (keypoints[row].point == kNoPoint) continue;
      const Point& point = model_.points[points_.Find(keypoints[row].point)];
      for (std::uint64_t at = point.track_begin; at < point.track_begin + point.track_length; ++at)
        if (image_of_element_[at] > image) work(image_of_element_[at], Match{row, model_.tracks[at].row});
    }
  }

  const Model& model_;
  IdTable points_;
  std::vector<std::uint32_t> image_of_element_;
  std::vector<Match> matches_;     // in the order of the other images
  std::vector<std::size_t> ends_;  // by the other image: of its matches
};

void BindGeometry(Statement& geometry, const Relation& relation, const std::array<double, 4>& rotation) {
  constexpr std::int64_t kCalibrated = 2, kPanoramic = 5;
  geometry.Bind(5, relation.translation.isZero(0) ? kPanoramic : kCalibrated);
  if (relation.fundamental)
    geometry.BindBlob(6, BytesOf(std::span(relation.fundamental->data(), 9)));
  else
    geometry.BindNull(6);
  geometry.BindBlob(7, BytesOf(std::span(relation.essential.data(), 9)));
  geometry.BindBlob(8, BytesOf(rotation));
  geometry.BindBlob(9, BytesOf(std::span(relation.translation.data(), 3)));
}

std::int64_t PairId(std::uint32_t one, std::uint32_t other) {
  constexpr std::int64_t kMost = 2147483647;
  return kMost * std::min(one, other) + std::max(one, other);
}

}  // namespace

DatabaseWriter::DatabaseWriter(const Outline& outline, ColmapSchema schema, const std::string& path)
    : outline_(outline),
      schema_(schema),
      database_(sqlite::Database::InMemory(path)),
      transaction_(database_, sqlite::Transaction::Kind::kBegin) {
  database_.Execute(std::string(schema == ColmapSchema::kNew ? kNewTables : kOldTables));
  database_.Execute(std::string(kCommonTables));
  AddCameras();
  if (schema == ColmapSchema::kNew) AddRigs();
  AddImages();
}

void DatabaseWriter::AddCameras() {
  Statement insert(database_, "INSERT INTO cameras VALUES (?1, ?2, ?3, ?4, ?5, 1)");
  for (const OutlineCamera& outlined : outline_.cameras) {
    const Camera camera = CameraOf(outlined.settings, outlined.id);
    insert.Bind(1, camera.id).Bind(2, camera.model);
    insert.Bind(3, static_cast<std::int64_t>(camera.width)).Bind(4, static_cast<std::int64_t>(camera.height));
    insert.BindBlob(5, BytesOf(camera.parameters)).Run();
  }
}

void DatabaseWriter::AddRigs() {
  Statement rigs(database_, "INSERT INTO rigs VALUES (?1, ?2, ?3)");
  Statement sensors(database_, "INSERT INTO rig_sensors VALUES (?1, ?2, ?3, ?4)");
  for (const OutlineRig& rig : outline_.rigs) {
    rigs.Bind(1, rig.id).Bind(2, outline_.cameras[rig.left].id).Bind(3, kCameraSensor).Run();
    if (!rig.is_pair()) continue;
    const std::array<double, 7> pose = SevenOf(rig.right_from_left);
    sensors.Bind(1, rig.id).Bind(2, outline_.cameras[rig.right].id).Bind(3, kCameraSensor);
    sensors.BindBlob(4, BytesOf(pose)).Run();
  }
}

void DatabaseWriter::AddImages() {
  const bool is_new = schema_ == ColmapSchema::kNew;
  Statement images(database_, "INSERT INTO images (image_id, name, camera_id) VALUES (?1, ?2, ?3)");
  Statement keypoints(database_, "INSERT INTO keypoints VALUES (?1, ?2, 4, ?3)");
  Statement descriptors(database_, "INSERT INTO descriptors (image_id, rows, cols, data) VALUES (?1, ?2, ?3, ?4)");
  std::optional<Statement> frames, data;
  if (is_new) {
    frames.emplace(database_, "INSERT INTO frames VALUES (?1, ?2)");
    data.emplace(database_, "INSERT INTO frame_data VALUES (?1, ?2, ?3, ?4)");
  }
  std::int64_t frame = 0;
  for (const MapOutline& map : outline_.maps)
    for (const View& view : map.views) {
      ++images_;
      const std::uint32_t camera = outline_.cameras[view.camera].id;
      images.Bind(1, view.image).BindText(2, view.name).Bind(3, camera).Run();
      AddFeatures(view, keypoints, descriptors);
      if (!is_new) continue;
      if (!view.right) frames->Bind(1, frame = view.image).Bind(2, outline_.rigs[view.rig].id).Run();
      data->Bind(1, frame).Bind(2, view.image).Bind(3, camera).Bind(4, kCameraSensor).Run();
    }
}

void DatabaseWriter::AddFeatures(const View& view, Statement& keypoints, Statement& descriptors) {
  const ViewKeypoints of_view = KeypointsOf(view);
  const std::vector<KeypointRow> rows = RowsOf(*of_view.keypoints, view.keyframe->pyramid);
  const auto count = static_cast<std::int64_t>(rows.size());
  keypoints_ += rows.size();
  keypoints.Bind(1, view.image).Bind(2, count).BindBlob(3, BytesOf(rows)).Run();
  const Described described = DescriptorsOf(*view.keyframe);
  const std::size_t begin = of_view.first_row * described.each;
  if (rows.empty() || described.each == 0 || described.bytes.size() < begin + rows.size() * described.each) return;
  descriptors.Bind(1, view.image).Bind(2, count).Bind(3, static_cast<std::int64_t>(described.each));
  descriptors.BindBlob(4, described.bytes.subspan(begin, rows.size() * described.each)).Run();
}

void DatabaseWriter::AddPairs(const MapOutline& map, const Model& model) {
  Statement matches(database_, "INSERT INTO matches VALUES (?1, ?2, 2, ?3)");
  Statement geometry(database_, "INSERT INTO two_view_geometries VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, NULL, ?8, ?9)");
  std::vector<Camera> cameras;
  for (const View& view : map.views)
    cameras.push_back(CameraOf(outline_.cameras[view.camera].settings, outline_.cameras[view.camera].id));
  Pairs pairs(model);
  for (std::uint32_t image = 0; image < model.images.size(); ++image) {
    pairs.Find(image);
    for (std::uint32_t other = image + 1; other < model.images.size(); ++other) {
      const std::span<Match> rows = pairs.MatchesWith(other);
      if (rows.empty()) continue;
      const bool swapped = model.images[image].id > model.images[other].id;
      if (swapped)
        for (Match& match : rows) std::swap(match[0], match[1]);
      const std::uint32_t first = swapped ? other : image, second = swapped ? image : other;
      const Relation relation = RelationOf(model.images[first], model.images[second], cameras[first], cameras[second]);
      const Eigen::Quaterniond& q = relation.second_from_first;
      const std::array<double, 4> wxyz = {q.w(), q.x(), q.y(), q.z()};
      const std::int64_t id = PairId(model.images[first].id, model.images[second].id);
      const auto count = static_cast<std::int64_t>(rows.size());
      matches.Bind(1, id).Bind(2, count).BindBlob(3, BytesOf(rows)).Run();
      geometry.Bind(1, id).Bind(2, count).Bind(3, std::int64_t{2}).BindBlob(4, BytesOf(rows));
      BindGeometry(geometry, relation, wxyz);
      geometry.Run();
      ++pairs_;
    }
  }
}

void DatabaseWriter::Write(AtomicFile& file) {
  transaction_.Commit();
  file.Write(database_.Serialized());
}

}  // namespace slamdb::colmap
