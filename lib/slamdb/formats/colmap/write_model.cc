// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/colmap/detail/lenses.h"
#include "slamdb/formats/colmap/detail/models.h"
#include "slamdb/formats/colmap/detail/poses.h"
#include "slamdb/model/colors.h"
#include "slamdb/model/index.h"

namespace slamdb::colmap {
namespace {

using detail::Concat;
using detail::Counted;

bool IsSoundId(std::uint64_t id, std::uint32_t row, const IdTable& rows) {
  return id != kNoPoint && rows.Find(id) == row;
}

std::uint64_t CarriedRows(const KeyFrame& keyframe) {
  return static_cast<std::uint64_t>(std::max(keyframe.carried->descriptors.rows, 0));
}

// Keypoints with a column in the right image of a rectified pair, or a depth.
std::uint64_t CountStereo(const Features& features) {
  const Column<float>&right = features.right_x, &depth = features.depth;
  const std::size_t both = std::min(right.size(), depth.size());
  std::uint64_t count = 0;
  for (std::size_t row = 0; row < both; ++row) count += int{right[row] >= 0} | int{depth[row] > 0};
  for (std::size_t row = both; row < right.size(); ++row) count += right[row] >= 0 ? 1 : 0;
  for (std::size_t row = both; row < depth.size(); ++row) count += depth[row] > 0 ? 1 : 0;
  return count;
}

// An image as what sees points.
class Eye {
 public:
  Eye(Image& image, const Camera& camera, const Features& features)
      : points_(image.points.data()),
        count_(image.points.size()),
        left_(features.is_fisheye_stereo() ? static_cast<std::size_t>(features.left_count) : ~std::size_t{0}),
        image_(image.id),
        camera_(&camera),
        rotation_(RotationOf(image.camera_from_world).normalized().toRotationMatrix()),
        translation_(TranslationOf(image.camera_from_world)) {}

  std::uint32_t image() const { return image_; }
  // Rows of observations from here on are keypoints of the right image, whose eye follows.
  std::size_t left() const { return left_; }
  // Null: there is none.
  Point2* KeypointAt(std::size_t row) const { return row < count_ ? points_ + row : nullptr; }

  // Of a point that a keypoint is, in pixels; infinite behind the camera.
  double Error(const Eigen::Vector3d& point, const Point2& keypoint) const {
    const std::optional<Eigen::Vector2d> seen = SeenBy(*camera_, rotation_ * point + translation_);
    return seen ? (*seen - Eigen::Vector2d(keypoint.x, keypoint.y)).norm() : std::numeric_limits<double>::infinity();
  }

 private:
  Point2* points_;
  std::size_t count_, left_;
  std::uint32_t image_;
  const Camera* camera_;
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d translation_;
};

// In the image as it is, over the track, as COLMAP has it.
class MeanError {
 public:
  void Add(double error) {
    if (!std::isfinite(error)) return;
    sum_ += error;
    ++count_;
  }
  double value() const { return count_ == 0 ? -1 : sum_ / count_; }  // -1: there is none

 private:
  double sum_ = 0, count_ = 0;
};

// Makes one model.
class Maker {
 public:
  Maker(const Outline& outline, const MapOutline& map, const WriteOptions& options, Unheld& unheld)
      : outline_(outline),
        map_(map),
        options_(options),
        unheld_(unheld),
        alone_before_(unheld.alone),
        keyframes_(KeyFrameTable(*map.map)) {}

  Model Make() {
    AddCameras();
    AddImages();
    AddFrames();
    AddEyes();
    AddPoints();
    CountSlots();
    CountMatches();
    return std::move(model_);
  }

 private:
  void AddCameras() {
    std::vector<bool> used(outline_.rigs.size(), false);
    for (const View& view : map_.views) used[view.rig] = true;
    for (std::size_t row = 0; row < used.size(); ++row) {
      if (!used[row]) continue;
      const OutlineRig& rig = outline_.rigs[row];
      Rig& written = model_.rigs.emplace_back();
      written.id = rig.id;
      Add(rig.left, std::nullopt, written);
      if (rig.is_pair()) Add(rig.right, rig.right_from_left, written);
    }
  }

  void Add(std::uint32_t row, const std::optional<Pose>& pose, Rig& rig) {
    const OutlineCamera& camera = outline_.cameras[row];
    model_.cameras.push_back(CameraOf(camera.settings, camera.id));
    rig.sensors.push_back({{SensorType::kCamera, camera.id}, pose});
  }

  void AddImages() {
    constexpr std::size_t kGrain = 16;
    model_.images.resize(map_.views.size());
    detail::ParallelFor(map_.views.size(), kGrain, options_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) FillImage(map_.views[row], model_.images[row]);
    });
    for (const Image& image : model_.images) unheld_.keypoints += image.points.size();
    for (const View& view : map_.views) {
      const Features& features = view.keyframe->features;
      if (view.right) continue;
      unheld_.descriptors += features.descriptors.size();
      if (view.keyframe->carried) unheld_.descriptors += CarriedRows(*view.keyframe);
      unheld_.stereo += CountStereo(features);
    }
  }

  void FillImage(const View& view, Image& image) const {
    const OutlineCamera& camera = outline_.cameras[view.camera];
    image.id = view.image;
    image.camera = camera.id;
    image.camera_from_world = PoseOf(view);
    image.name = view.name;
    const Column<Keypoint>& keypoints = *KeypointsOf(view).keypoints;
    image.points.reserve(keypoints.size());
    for (const Keypoint& keypoint : keypoints)
      image.points.push_back(
          {static_cast<double>(keypoint.x) + kHalfPixel, static_cast<double>(keypoint.y) + kHalfPixel, kNoPoint});
  }

  // One for each keyframe.
  void AddFrames() {
    for (std::size_t row = 0; row < map_.views.size(); ++row) {
      const View& view = map_.views[row];
      const FrameData data{{SensorType::kCamera, outline_.cameras[view.camera].id}, view.image};
      if (view.right)
        model_.frames.back().data.push_back(data);
      else
        model_.frames.push_back({view.image, outline_.rigs[view.rig].id, model_.images[row].camera_from_world, {data}});
    }
  }

  void AddEyes() {
    eyes_.reserve(model_.images.size());
    for (std::size_t row = 0; row < model_.images.size(); ++row) {
      Image& image = model_.images[row];
      const Camera& camera = *std::ranges::find(model_.cameras, image.camera, &Camera::id);
      eyes_.emplace_back(image, camera, map_.views[row].keyframe->features);
    }
  }

  void AddPoints() {
    const IdTable rows = PointTable(*map_.map);
    const Column<MapPoint>& points = map_.map->points;
    std::size_t observations = 0;
    for (const MapPoint& point : points) observations += point.observations.size();
    model_.points.reserve(points.size());
    model_.tracks.reserve(observations);
    for (std::uint32_t row = 0; row < points.size(); ++row) {
      const MapPoint& point = points[row];
      if (point.bad) {
        ++unheld_.bad_points;
      } else if (!IsSoundId(point.id.value(), row, rows) || !point.position.allFinite()) {
        ++unheld_.strange_points;
      } else {
        AddPoint(point);
      }
    }
  }

  void AddPoint(const MapPoint& point) {
    const Eigen::Vector3d position = point.position.cast<double>();
    Point written{.id = point.id.value(),
                  .position = {position.x(), position.y(), position.z()},
                  .color = kNoColor,
                  .track_begin = model_.tracks.size()};
    MeanError error;
    Point2* last = nullptr;
    for (const Observation& observation : point.observations)
      for (const std::int32_t row : {observation.left, observation.right}) {
        if (row < 0) continue;
        const Sight sight = SightOf(observation.keyframe, row);
        if (sight.keypoint == nullptr || sight.keypoint->point != kNoPoint) {
          ++unheld_.observations;
          continue;
        }
        last = sight.keypoint;
        last->point = written.id;
        model_.tracks.push_back({sight.eye->image(), static_cast<std::uint32_t>(sight.row)});
        error.Add(sight.eye->Error(position, *last));
      }
    written.track_length = model_.tracks.size() - written.track_begin;
    written.error = error.value();
    if (written.track_length == 1) Forget(*last, written);
    model_.points.push_back(written);
  }

  // COLMAP's bundle adjustment ends the program at points that one image alone sees.
  void Forget(Point2& keypoint, Point& point) {
    keypoint.point = kNoPoint;
    model_.tracks.pop_back();
    point.track_length = 0;
    point.error = -1;
    ++unheld_.alone;
  }

  // A keypoint of an image; null: there is none.
  struct Sight {
    const Eye* eye = nullptr;
    std::size_t row = 0;
    Point2* keypoint = nullptr;
  };

  Sight SightOf(KeyFrameId keyframe, std::int32_t row) const {
    const std::uint32_t at = keyframes_.Find(keyframe.value());
    if (at == kNoRow || map_.view_of_row[at] == kNoRow) return {};
    Sight sight{&eyes_[map_.view_of_row[at]], static_cast<std::size_t>(row)};
    if (sight.row >= sight.eye->left()) {
      sight.row -= sight.eye->left();
      ++sight.eye;
    }
    sight.keypoint = sight.eye->KeypointAt(sight.row);
    return sight;
  }

  void CountSlots() {
    constexpr std::size_t kGrain = 16;
    std::atomic<std::uint64_t> slots = 0;
    detail::ParallelFor(map_.views.size(), kGrain, options_.threads, [&](std::size_t begin, std::size_t end) {
      std::uint64_t count = 0;
      for (std::size_t view = begin; view < end; ++view) count += CountSlots(map_.views[view], model_.images[view]);
      slots += count;
    });
    unheld_.slots += slots - std::min<std::uint64_t>(slots, unheld_.alone - alone_before_);  // which are told
  }

  static std::uint64_t CountSlots(const View& view, const Image& image) {
    const std::size_t first = KeypointsOf(view).first_row;
    const Column<MapPointId>& slots = view.keyframe->features.map_points;
    std::uint64_t count = 0;
    for (std::size_t row = 0; row < image.points.size() && first + row < slots.size(); ++row)
      count += slots[first + row] && image.points[row].point != slots[first + row].value() ? 1 : 0;
    return count;
  }

  // What is the same keypoint in both images of a fisheye pair is told by the point that both see, and by it alone.
  void CountMatches() {
    for (std::size_t view = 1; view < map_.views.size(); ++view) {
      if (!map_.views[view].right) continue;
      const Column<std::int32_t>& matches = map_.views[view].keyframe->features.right_of_left;
      const Column<Point2>&left = model_.images[view - 1].points, &right = model_.images[view].points;
      for (std::size_t row = 0; row < matches.size(); ++row) {
        const auto match = static_cast<std::size_t>(matches[row]);
        if (matches[row] < 0) continue;
        const bool seen = row < left.size() && match < right.size() && left[row].point != kNoPoint &&
                          left[row].point == right[match].point;
        unheld_.matches += seen ? 0 : 1;
      }
    }
  }

  const Outline& outline_;
  const MapOutline& map_;
  const WriteOptions& options_;
  Unheld& unheld_;  // of all models
  const std::uint64_t alone_before_;
  const IdTable keyframes_;
  Model model_;
  std::vector<Eye> eyes_;  // of Model::images
};

}  // namespace

Model ModelOf(const Outline& outline, const MapOutline& map, const WriteOptions& options, Unheld& unheld) {
  return Maker(outline, map, options, unheld).Make();
}

IdTable PointRowsOf(const Model& model) {
  std::uint64_t lowest = kNoPoint, highest = 0;
  for (const Point& point : model.points) {
    lowest = std::min(lowest, point.id);
    highest = std::max(highest, point.id);
  }
  IdTable rows(lowest, highest, model.points.size());
  for (std::uint32_t row = 0; row < model.points.size(); ++row) rows.Insert(model.points[row].id, row);
  return rows;
}

void WarnOfLeftOut(const Outline& outline, const Unheld& unheld, Notices& notices) {
  if (outline.not_finite > 0)
    notices.Warn(Concat(Counted(outline.not_finite, "keyframe"), " left out, whose pose is none, or not finite"));
  if (unheld.strange_points > 0)
    notices.Warn(
        Concat(Counted(unheld.strange_points, "point"), " left out, not finite, or with the id of another one"));
}

void Tell(const Outline& outline, const Unheld& unheld, std::string_view format, bool with_database, Notices& notices) {
  const auto lose = [&](std::uint64_t count, std::string_view noun, std::string_view why) {
    if (count > 0) notices.Lose(Concat("left out: ", Counted(count, noun), " ", why));
  };
  lose(outline.bad_keyframes, "keyframe", "flagged bad");
  lose(outline.not_finite, "keyframe", "whose pose is not finite");
  lose(unheld.bad_points, "point", "flagged bad");
  lose(unheld.strange_points, "point", "not finite, or with the id of another one");
  lose(unheld.observations, "observation", "by a keypoint that is not there, or that another point has");
  lose(unheld.alone, "observation", "of points that no other image sees, at which COLMAP's bundle adjustment stops");
  if (unheld.slots > 0)
    notices.Lose(Concat("see no point now, since the point does not name them: ", Counted(unheld.slots, "keypoint")));
  if (unheld.stereo > 0)
    notices.Lose(Concat(format, " cannot hold the right columns and depths of stereo and depth cameras (",
                        detail::Thousands(unheld.stereo), ")"));
  if (unheld.matches > 0)
    notices.Lose(Concat(format, " cannot hold matches of left and right keypoints that see no point (",
                        detail::Thousands(unheld.matches), ")"));
  if (unheld.descriptors > 0 && !with_database)
    notices.Lose(
        Concat(format, " cannot hold descriptors without a database (", detail::Thousands(unheld.descriptors), ")"));
  if (unheld.keypoints > 0)
    notices.Lose(Concat(format, " cannot hold ", with_database ? "scores" : "scales, angles and scores",
                        " of keypoints (", detail::Thousands(unheld.keypoints), ")"));
  if (outline.renumbered)
    notices.Warn("the ids of the keyframes do not fit into those of images: images are numbered from 1 on");
  if (outline.without_picture > 0)
    notices.Warn(Concat(Counted(outline.without_picture, "keyframe"),
                        " without a picture file near in time; named by timestamp"));
}

}  // namespace slamdb::colmap
