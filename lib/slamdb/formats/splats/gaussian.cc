// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <unordered_set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/colmap/detail/codec.h"
#include "slamdb/formats/colmap/detail/folders.h"
#include "slamdb/formats/colmap/detail/lenses.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/splats/detail/scene.h"
#include "slamdb/formats/splats/detail/splats.h"
#include "slamdb/model/derive.h"

namespace slamdb {
namespace {

using colmap::Part;
using colmap::View;
using detail::Concat;
using splats::Developed;
using splats::Scene;

// Whether the lens bends what it sees.
bool Distorts(const CameraSettings& settings) {
  return settings.camera.model != CameraModel::kPinhole || !settings.distortion.empty();
}

bool IsJpeg(const std::string& name) {
  const std::string suffix = std::filesystem::path(name).extension().string();
  return suffix == ".jpg" || suffix == ".jpeg" || suffix == ".JPG" || suffix == ".JPEG";
}

// Names of files in one folder: trainers look for them by the last part of their name alone. What is neither PNG nor
// JPEG becomes PNG where it is made anew.
class FlatNames {
 public:
  std::string Of(const View& view, bool is_made) {
    std::string name = view.name;
    if (is_made && !IsJpeg(name)) name = std::filesystem::path(name).replace_extension(".png").string();
    std::ranges::replace(name, '/', '_');
    while (!taken_.insert(name).second) name = Concat(view.image, "_", name);
    return name;
  }

 private:
  std::unordered_set<std::string> taken_;
};

// Where the pinhole sees what the lens sees at that place; both count from the centre of the first pixel.
Eigen::Vector2d StraightPlace(const CameraSettings& settings, const Eigen::Vector2d& at) {
  if (settings.camera.model == CameraModel::kPinhole) return Undistorted(settings, at);
  const std::vector<float>& p = settings.camera.parameters;
  const Eigen::Vector3f ray = Unproject(settings.camera, at.cast<float>());
  return {static_cast<double>(p[0] * ray.x() + p[2]), static_cast<double>(p[1] * ray.y() + p[3])};
}

// Cameras become pinholes of the same focal lengths and centres, and images get flat names.
void Straighten(const colmap::Outline& outline, Scene& scene) {
  for (colmap::Camera& camera : scene.model.cameras) {
    camera.model = colmap::kPinhole;
    camera.parameters.resize(4);
  }
  FlatNames names;
  for (std::size_t row = 0; row < scene.model.images.size(); ++row) {
    View& view = scene.outline.views[row];
    colmap::Image& image = scene.model.images[row];
    const CameraSettings& settings = outline.cameras[view.camera].settings;
    view.name = image.name = names.Of(view, Distorts(settings) && !view.picture.empty());
    if (!Distorts(settings)) continue;
    for (colmap::Point2& point : image.points) {
      const Eigen::Vector2d at = StraightPlace(settings, {point.x - colmap::kHalfPixel, point.y - colmap::kHalfPixel});
      point.x = at.x() + colmap::kHalfPixel;
      point.y = at.y() + colmap::kHalfPixel;
    }
  }
}

void WriteBytes(AtomicFolder& folder, const std::string& name, std::string_view bytes,
                Replaces replaces = Replaces::kOthers) {
  const std::unique_ptr<AtomicFile> file = folder.Make(name, replaces);
  file->Write(bytes);
  file->Commit();
}

constexpr std::string_view kModel = "sparse/0/";
constexpr std::array kParts = {Part::kCameras, Part::kImages, Part::kPoints};

void WriteScene(const colmap::Outline& outline, Scene& scene, AtomicFolder& folder, const WriteOptions& options) {
  Straighten(outline, scene);
  const auto develop = [&](const View& view, const std::string& bytes, const ColorPicture& picture) {
    const CameraSettings& settings = outline.cameras[view.camera].settings;
    if (!Distorts(settings)) return Developed{view.name, bytes};
    const PictureFormat format = IsJpeg(view.name) ? PictureFormat::kJpeg : PictureFormat::kPng;
    return Developed{view.name, EncodePicture(Undistorted(picture, settings), format)};
  };
  splats::ShowPictures(outline, scene, options, develop, [&](const Developed& developed) {
    // Which of the pictures there slamdb has written, and which are the only ones, nothing tells.
    WriteBytes(folder, Concat(scene.folder, "images/", developed.name), developed.bytes, Replaces::kEqual);
  });
  for (const Part part : kParts) {
    const std::string_view name = colmap::kPartNames[static_cast<std::size_t>(part)];
    const std::unique_ptr<AtomicFile> file = folder.Make(Concat(scene.folder, kModel, name, ".bin"));
    colmap::EncodeBinary(part, scene.model, *file, options);
    file->Commit();
  }
  WriteBytes(folder, Concat(scene.folder, kModel, "points3D.ply"),
             splats::PlyOf(scene.model, Eigen::Matrix3d::Identity()));
}

void WriteGaussian(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFolder folder(target, detail::FileOptions(options));
  const colmap::Outline outline = colmap::OutlineOf(atlas, target, options, options.of<ColmapWriteOptions>().pictures);
  colmap::Unheld unheld;
  std::vector<Scene> scenes = splats::ScenesOf(outline, options, unheld);
  std::vector<std::string> models;
  for (const Scene& scene : scenes) models.push_back(Concat(scene.folder, kModel));
  colmap::RefuseOtherModels(target.path, models, colmap::kBinary, kParts.size());
  for (Scene& scene : scenes) WriteScene(outline, scene, folder, options);
  colmap::RefuseOtherModels(target.path, models, colmap::kBinary, kParts.size());  // that came in the meantime
  folder.Commit();
  splats::Tell(scenes, outline, unheld, notices);
}

constexpr std::array<std::string_view, 1> kSuffixes = {".3dgs"};

}  // namespace

const Format detail::kGaussianFormat = {
    .id = "3dgs",
    .title = "scene for 3D Gaussian splatting",
    .suffixes = kSuffixes,
    .kind = FileKind::kBinary,
    .is_folder = true,
    .chooses_maps = true,
    .is_export = true,
    .writes = Content::kPoses | Content::kPoints | Content::kObservations | Content::kCameras | Content::kMaps,
    .write = WriteGaussian};

}  // namespace slamdb
