// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/splats/detail/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <unordered_set>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/export/detail/rows.h"

namespace slamdb::splats {
namespace {

using detail::Concat;
using detail::Counted;

// The colour of one keypoint that is a point.
struct Sample {
  std::uint32_t point;  // row of Model::points
  std::array<std::uint8_t, 3> color;
};

struct Size {
  std::int32_t width = 0, height = 0;
  friend bool operator==(const Size&, const Size&) = default;
};

struct Shown {
  Size size;
  std::vector<Sample> samples;
  Developed developed;
};

// Where keypoints are that slots name; observations that a model leaves out count too.
std::vector<Sample> SamplesOf(const colmap::View& view, const ColorPicture& picture, const IdTable& rows) {
  const colmap::ViewKeypoints of_view = colmap::KeypointsOf(view);
  const Column<MapPointId>& slots = view.keyframe->features.map_points;
  std::vector<Sample> samples;
  for (std::size_t row = 0; row < of_view.keypoints->size() && of_view.first_row + row < slots.size(); ++row) {
    const MapPointId id = slots[of_view.first_row + row];
    const std::uint32_t point = id ? rows.Find(id.value()) : kNoRow;
    const Keypoint& at = (*of_view.keypoints)[row];
    const float x = std::round(at.x), y = std::round(at.y);
    if (point == kNoRow ||
        !(x >= 0 && y >= 0 && x < static_cast<float>(picture.width) && y < static_cast<float>(picture.height)))
      continue;
    const std::size_t pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x);
    const std::uint8_t* color = &picture.pixels[3 * pixel];
    samples.push_back({point, {color[0], color[1], color[2]}});
  }
  return samples;
}

// Sizes of cameras are known to a few pixels where a lens distorts.
void RequireSize(const colmap::View& view, const CameraSettings& settings, const ColorPicture& picture) {
  constexpr std::int32_t kOff = 16;
  if (std::abs(picture.width - settings.width) <= kOff && std::abs(picture.height - settings.height) <= kOff) return;
  throw Error(ErrorKind::kNotPossible, view.picture, "",
              Concat("has ", picture.width, " x ", picture.height, " pixels, and the images of ", view.keyframe->id,
                     " had ", settings.width, " x ", settings.height));
}

// Sums of colours by point.
class Colors {
 public:
  explicit Colors(std::size_t points) : sums_(points), counts_(points) {}
  void Add(const Sample& sample) {
    for (std::size_t channel = 0; channel < 3; ++channel) sums_[sample.point][channel] += sample.color[channel];
    ++counts_[sample.point];
  }
  void Give(Column<colmap::Point>& points) const {
    for (std::size_t row = 0; row < points.size(); ++row)
      for (std::size_t channel = 0; channel < 3 && counts_[row] > 0; ++channel)
        points[row].color[channel] = static_cast<std::uint8_t>((sums_[row][channel] + counts_[row] / 2) / counts_[row]);
  }

 private:
  std::vector<std::array<std::uint64_t, 3>> sums_;
  std::vector<std::uint64_t> counts_;
};

// All pictures of a camera have one size, which the camera gets.
class Sizes {
 public:
  void Set(const colmap::View& view, const Size& size, colmap::Camera& camera) {
    const auto [known, is_new] = by_camera_.emplace(camera.id, size);
    if (known->second != size)
      throw Error(ErrorKind::kNotPossible, view.picture, "",
                  Concat("has ", size.width, " x ", size.height, " pixels, and another picture of the camera ",
                         known->second.width, " x ", known->second.height));
    camera.width = static_cast<std::uint64_t>(size.width);
    camera.height = static_cast<std::uint64_t>(size.height);
  }

 private:
  std::map<std::uint32_t, Size> by_camera_;
};

// What trainers do not find they stop at: where pictures were named, images without one are left out.
void LeaveOutUnpictured(Scene& scene) {
  std::vector<colmap::View> views;
  std::vector<colmap::Image> images;
  std::unordered_set<std::uint32_t> left_out;
  for (std::size_t row = 0; row < scene.outline.views.size(); ++row) {
    if (scene.outline.views[row].picture.empty()) {
      left_out.insert(scene.outline.views[row].image);
      continue;
    }
    views.push_back(std::move(scene.outline.views[row]));
    images.push_back(std::move(scene.model.images[row]));
  }
  scene.outline.view_of_row.clear();
  scene.outline.views = std::move(views);
  scene.model.images = std::move(images);
  scene.left_out = left_out.size();
  Column<colmap::TrackElement> tracks;
  for (colmap::Point& point : scene.model.points) {
    const colmap::TrackElement* element = scene.model.tracks.data() + point.track_begin;
    point.track_begin = tracks.size();
    for (const colmap::TrackElement* end = element + point.track_length; element != end; ++element)
      if (!left_out.contains(element->image)) tracks.push_back(*element);
    point.track_length = tracks.size() - point.track_begin;
  }
  scene.model.tracks = std::move(tracks);
}

}  // namespace

void ShowPictures(const colmap::Outline& outline, Scene& scene, const WriteOptions& options,
                  const std::function<Developed(const colmap::View&, const std::string&, const ColorPicture&)>& develop,
                  const std::function<void(Developed)>& take) {
  std::vector<std::size_t> with_picture;
  for (std::size_t row = 0; row < scene.outline.views.size(); ++row)
    if (!scene.outline.views[row].picture.empty()) with_picture.push_back(row);
  const IdTable rows = colmap::PointRowsOf(scene.model);
  Colors colors(scene.model.points.size());
  Sizes sizes;
  const std::size_t at_once = 2 * static_cast<std::size_t>(detail::ThreadCount(options.threads));
  for (std::size_t begin = 0; begin < with_picture.size(); begin += at_once) {
    std::vector<Shown> shown(std::min(at_once, with_picture.size() - begin));
    detail::ParallelFor(shown.size(), 1, options.threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t row = first; row < last; ++row) {
        const colmap::View& view = scene.outline.views[with_picture[begin + row]];
        const CameraSettings& settings = outline.cameras[view.camera].settings;
        const WholeFile file{Source(view.picture)};
        const ColorPicture picture = ReadColorPicture({file.bytes(), view.picture});
        RequireSize(view, settings, picture);
        shown[row] = {{picture.width, picture.height},
                      SamplesOf(view, picture, rows),
                      develop(view, std::string(file.text()), picture)};
      }
    });
    for (std::size_t row = 0; row < shown.size(); ++row) {
      const colmap::View& view = scene.outline.views[with_picture[begin + row]];
      sizes.Set(view, shown[row].size,
                *std::ranges::find(scene.model.cameras, outline.cameras[view.camera].id, &colmap::Camera::id));
      for (const Sample& sample : shown[row].samples) colors.Add(sample);
      take(std::move(shown[row].developed));
    }
    if (options.progress)
      options.progress("pictures", static_cast<double>(begin) / static_cast<double>(with_picture.size()));
  }
  colors.Give(scene.model.points);
}

std::string PlyOf(const colmap::Model& model, const Eigen::Matrix3d& turn) {
  std::string ply = Concat("ply\nformat binary_little_endian 1.0\nelement vertex ", model.points.size(),
                           "\nproperty float x\nproperty float y\nproperty float z\n"
                           "property float nx\nproperty float ny\nproperty float nz\n"
                           "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n");
  constexpr std::size_t kVertex = 27;
  ply.reserve(ply.size() + kVertex * model.points.size());
  for (const colmap::Point& point : model.points) {
    const Eigen::Vector3d at = turn * Eigen::Map<const Eigen::Vector3d>(point.position.data());
    for (const double value : at) detail::AppendRaw(ply, static_cast<float>(value));
    ply.append(3 * sizeof(float), '\0');
    for (const std::uint8_t value : point.color) detail::AppendRaw(ply, value);
  }
  return ply;
}

std::vector<Scene> ScenesOf(const colmap::Outline& outline, const WriteOptions& options, colmap::Unheld& unheld) {
  std::vector<Scene> scenes;
  for (std::size_t row = 0; row < outline.maps.size(); ++row)
    scenes.push_back({.outline = outline.maps[row],
                      .model = colmap::ModelOf(outline, outline.maps[row], options, unheld),
                      .folder = outline.maps.size() == 1 ? "" : Concat(row, "/")});
  if (!options.of<ColmapWriteOptions>().pictures.files.empty())
    for (Scene& scene : scenes) LeaveOutUnpictured(scene);
  if (scenes.empty()) scenes.emplace_back();
  return scenes;
}

void Tell(const std::vector<Scene>& scenes, const colmap::Outline& outline, const colmap::Unheld& unheld,
          Notices& notices) {
  std::size_t images = 0, keyframes = 0, pictures = 0, points = 0, left_out = 0;
  for (const Scene& scene : scenes) {
    images += scene.model.images.size();
    keyframes += colmap::CountKeyFrames({&scene.outline, 1});
    points += scene.model.points.size();
    left_out += scene.left_out;
    pictures += static_cast<std::size_t>(
        std::ranges::count_if(scene.outline.views, [](const colmap::View& view) { return !view.picture.empty(); }));
  }
  if (left_out > 0)
    notices.Warn(Concat(Counted(left_out, "image"), " left out, of which there is no picture: ",
                        Counted(outline.without_picture, "keyframe"), " without one near in time, ",
                        Counted(left_out - outline.without_picture, "right image"), " of fisheye pairs"));
  else if (images > 0 && pictures == 0)
    notices.Warn(
        "without pictures: images are named by their timestamps, and points are grey; "
        "KeyFramePictures::files names them");
  colmap::WarnOfLeftOut(outline, unheld, notices);
  if (scenes.size() > 1)
    notices.Note(Concat(scenes.size(), " maps are in folders 0 to ", scenes.size() - 1, ", a scene each"));
  notices.Tell(Concat(detail::CountWritten(images, pictures == 0 ? "pose" : "image", outline.bad_keyframes), ", ",
                      detail::CountWritten(points, "point", unheld.bad_points)),
               WrittenCounts{.keyframes = keyframes, .points = points});
}

}  // namespace slamdb::splats
