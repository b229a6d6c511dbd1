// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/folders.h"
#include "slamdb/formats/colmap/detail/poses.h"
#include "slamdb/formats/export/detail/json_appender.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/splats/detail/scene.h"
#include "slamdb/formats/splats/detail/splats.h"
#include "slamdb/model/up.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;
using colmap::Image;
using colmap::View;
using splats::Developed;
using splats::Scene;

constexpr std::string_view kPoints = "points.ply", kTransforms = "transforms.json";

// World coordinates are turned so that z is up: where y was down as nerfstudio does with COLMAP's, and not at all where
// it is up already, as in maps with inertial data.
Eigen::Matrix3d UpwardFromWorld(const Scene& scene) {
  const Eigen::Vector3d up = scene.outline.map == nullptr ? Up().direction : UpOf(*scene.outline.map).direction;
  const std::optional<std::string> axis = NearAxis(up);
  if (axis == "z") return Eigen::Matrix3d::Identity();
  const auto without_rounding = [](double value) { return std::abs(value) < 1e-12 ? 0.0 : value; };
  if (axis != "-y") return UprightFromMap(up).toRotationMatrix().unaryExpr(without_rounding);
  Eigen::Matrix3d turn;
  turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return turn;
}

template <class Matrix>
void AddMatrix(detail::JsonAppender& json, std::string_view name, const Matrix& matrix) {
  json.BeginArray(name);
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) json.Value(matrix.row(row));
  json.EndArray();
}

void AddCamera(detail::JsonAppender& json, const colmap::Camera& camera) {
  const std::vector<double>& p = camera.parameters;
  const bool fisheye = camera.model == colmap::kOpencvFisheye;
  json.Field("camera_model", fisheye ? "OPENCV_FISHEYE" : "OPENCV");
  json.Field("w", camera.width);
  json.Field("h", camera.height);
  constexpr std::array<std::string_view, 4> kPinhole = {"fl_x", "fl_y", "cx", "cy"};
  for (std::size_t row = 0; row < kPinhole.size(); ++row) json.Field(kPinhole[row], p[row]);
  constexpr std::array<std::string_view, 4> kFisheye = {"k1", "k2", "k3", "k4"};
  constexpr std::array<std::string_view, 5> kBrown = {"k1", "k2", "p1", "p2", "k3"};
  for (std::size_t row = 0; fisheye && row < kFisheye.size(); ++row) json.Field(kFisheye[row], p[4 + row]);
  for (std::size_t row = 0; !fisheye && row < kBrown.size() && 4 + row < p.size(); ++row)
    json.Field(kBrown[row], p[4 + row]);
}

// World from camera, of the turned world and a camera that looks along -z, y up.
Eigen::Matrix4d TransformOf(const Image& image, const Eigen::Matrix3d& upward) {
  const colmap::Pose world_from_camera = colmap::Inverse(image.camera_from_world);
  Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();
  transform.topLeftCorner<3, 3>() = upward * colmap::RotationOf(world_from_camera).normalized().toRotationMatrix() *
                                    Eigen::Vector3d(1, -1, -1).asDiagonal();
  transform.topRightCorner<3, 1>() = upward * colmap::TranslationOf(world_from_camera);
  return transform.array() + 0.0;  // no -0
}

// From where transforms.json is.
std::string PathOf(const View& view, const fs::path& folder) {
  if (view.picture.empty()) return view.name;
  std::error_code failed;
  const fs::path from = fs::absolute(folder, failed), to = fs::absolute(view.picture, failed);
  std::string path = to.lexically_normal().lexically_relative(from.lexically_normal()).string();
  if (!detail::IsUtf8(path))
    throw Error(ErrorKind::kNotPossible, view.picture, "",
                "has a path that is no UTF-8, which JSON cannot hold; rename it");
  return path;
}

std::string TransformsOf(const Scene& scene, const Eigen::Matrix3d& upward, const fs::path& folder) {
  const colmap::Model& model = scene.model;
  std::string text;
  detail::JsonAppender json(text);
  json.BeginObject();
  if (model.cameras.size() == 1) AddCamera(json, model.cameras[0]);
  Eigen::Matrix<double, 3, 4> applied = Eigen::Matrix<double, 3, 4>::Zero();
  applied.leftCols<3>() = upward;
  AddMatrix(json, "applied_transform", applied);
  json.Field("ply_file_path", kPoints);
  json.BeginArray("frames");
  for (std::size_t row = 0; row < model.images.size(); ++row) {
    json.BeginObject();
    json.Field("file_path", std::string_view(PathOf(scene.outline.views[row], folder)));
    for (const colmap::Camera& camera : model.cameras)
      if (model.cameras.size() > 1 && camera.id == model.images[row].camera) AddCamera(json, camera);
    AddMatrix(json, "transform_matrix", TransformOf(model.images[row], upward));
    json.EndObject();
    text += '\n';
  }
  json.EndArray();
  json.EndObject();
  return text + "\n";
}

// Scenes of an earlier run, of more maps or fewer.
void RefuseOtherScenes(const std::string& folder, const std::vector<Scene>& scenes) {
  std::vector<std::string> places;
  for (const Scene& scene : scenes) places.push_back(scene.folder);
  colmap::RefuseLeft(folder, places, [](const std::string& place) {
    std::error_code missing;
    return fs::exists(fs::path(place) / kTransforms, missing);
  });
}

void WriteNerf(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFolder folder(target, detail::FileOptions(options));
  const colmap::Outline outline = colmap::OutlineOf(atlas, target, options, options.of<ColmapWriteOptions>().pictures);
  colmap::Unheld unheld;
  std::vector<Scene> scenes = splats::ScenesOf(outline, options, unheld);
  RefuseOtherScenes(target.path, scenes);
  for (Scene& scene : scenes) {
    const auto leave = [](const View&, const std::string&, const ColorPicture&) { return Developed{}; };
    splats::ShowPictures(outline, scene, options, leave, [](const Developed&) {});
    const auto write = [&](std::string_view name, const std::string& bytes) {
      const std::unique_ptr<AtomicFile> file = folder.Make(scene.folder + std::string(name));
      file->Write(bytes);
      file->Commit();
    };
    const Eigen::Matrix3d upward = UpwardFromWorld(scene);
    write(kTransforms, TransformsOf(scene, upward, fs::path(target.path) / scene.folder));
    write(kPoints, splats::PlyOf(scene.model, upward));
  }
  RefuseOtherScenes(target.path, scenes);  // that came in the meantime
  folder.Commit();
  splats::Tell(scenes, outline, unheld, notices);
}

constexpr std::array<std::string_view, 1> kSuffixes = {".nerf"};

}  // namespace

const Format detail::kNerfFormat = {.id = "nerf",
                                    .title = "scene for NeRFs",
                                    .suffixes = kSuffixes,
                                    .kind = FileKind::kBinary,
                                    .is_folder = true,
                                    .chooses_maps = true,
                                    .is_export = true,
                                    .writes = Content::kPoses | Content::kPoints | Content::kCameras | Content::kMaps,
                                    .write = WriteNerf};

}  // namespace slamdb
