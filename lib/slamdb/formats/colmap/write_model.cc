// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
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
  std::uint64_t count = 0;
  const std::size_t rows = std::max(features.right_x.size(), features.depth.size());
  for (std::size_t row = 0; row < rows; ++row)
    count += (row < features.right_x.size() && features.right_x[row] >= 0) ||
                     (row < features.depth.size() && features.depth[row] > 0)
                 ? 1
                 : 0;
  return count;
}

// Makes one model.
class Maker {
 public:
  Maker(const Outline& outline, const MapOutline& map, const WriteOptions& options, Unheld& unheld)
      : outline_(outline), map_(map), options_(options), unheld_(unheld), keyframes_(KeyFrameTable(*map.map)) {}

  Model Make() {
    AddCameras();
    AddImages();
    AddFrames();
    AddPoints();
    CountSlots();
    CountMatches();
    AddErrors();
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
    image.points.resize(keypoints.size());
    for (std::size_t row = 0; row < keypoints.size(); ++row)
      image.points[row] = {static_cast<double>(keypoints[row].x) + kHalfPixel,
                           static_cast<double>(keypoints[row].y) + kHalfPixel, kNoPoint};
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

  void AddPoints() {
    const IdTable rows = PointTable(*map_.map);
    const Column<MapPoint>& points = map_.map->points;
    model_.points.reserve(points.size());
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
    Point written{.id = point.id.value(), .color = kNoColor, .track_begin = model_.tracks.size()};
    for (std::size_t axis = 0; axis < 3; ++axis)
      written.position[axis] = static_cast<double>(point.position[static_cast<Eigen::Index>(axis)]);
    for (const Observation& observation : point.observations) {
      if (observation.left >= 0) See(written.id, SpotOf(observation.keyframe, observation.left));
      if (observation.right >= 0) See(written.id, SpotOf(observation.keyframe, observation.right));
    }
    if (model_.tracks.size() == written.track_begin + 1) ForgetLast();
    written.track_length = model_.tracks.size() - written.track_begin;
    model_.points.push_back(written);
  }

  // COLMAP's bundle adjustment ends the program at points that one image alone sees.
  void ForgetLast() {
    model_.images[view_of_element_.back()].points[model_.tracks.back().row].point = kNoPoint;
    view_of_element_.pop_back();
    model_.tracks.pop_back();
    ++unheld_.alone;
  }

  // A keypoint of an image; kNoRow: none.
  struct Spot {
    std::uint32_t view = kNoRow;
    std::size_t row = 0;
  };

  Spot SpotOf(KeyFrameId keyframe, std::int32_t row) const {
    const std::uint32_t at = keyframes_.Find(keyframe.value());
    if (at == kNoRow || map_.view_of_row[at] == kNoRow) return {};
    Spot spot{map_.view_of_row[at], static_cast<std::size_t>(row)};
    const Features& features = map_.views[spot.view].keyframe->features;
    const auto left = static_cast<std::size_t>(std::max(features.left_count, 0));
    if (features.is_fisheye_stereo() && spot.row >= left) {
      spot.row -= left;
      ++spot.view;
    }
    return spot.row < model_.images[spot.view].points.size() ? spot : Spot();
  }

  void See(std::uint64_t point, const Spot& spot) {
    if (spot.view == kNoRow || model_.images[spot.view].points[spot.row].point != kNoPoint) {
      ++unheld_.observations;
      return;
    }
    model_.images[spot.view].points[spot.row].point = point;
    view_of_element_.push_back(spot.view);
    model_.tracks.push_back({map_.views[spot.view].image, static_cast<std::uint32_t>(spot.row)});
  }

  void CountSlots() {
    for (std::size_t view = 0; view < map_.views.size(); ++view) {
      const View& seen = map_.views[view];
      const std::size_t first = KeypointsOf(seen).first_row;
      const Column<MapPointId>& slots = seen.keyframe->features.map_points;
      const Column<Point2>& points = model_.images[view].points;
      for (std::size_t row = 0; row < points.size() && first + row < slots.size(); ++row)
        if (slots[first + row] && points[row].point != slots[first + row].value()) ++unheld_.slots;
    }
    unheld_.slots -= std::min(unheld_.slots, unheld_.alone);  // which were told
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

  // As COLMAP has them: in the image as it is, means over the track; -1 where there is none.
  void AddErrors() {
    constexpr std::size_t kGrain = 4096;
    std::vector<Eye> eyes;
    for (const Image& image : model_.images)
      eyes.emplace_back(image, *std::ranges::find(model_.cameras, image.camera, &Camera::id));
    detail::ParallelFor(model_.points.size(), kGrain, options_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) model_.points[row].error = MeanError(model_.points[row], eyes);
    });
  }

  // An image as what projects points into it.
  class Eye {
   public:
    Eye(const Image& image, const Camera& camera)
        : image_(image),
          camera_(camera),
          rotation_(RotationOf(image.camera_from_world).normalized().toRotationMatrix()),
          translation_(TranslationOf(image.camera_from_world)) {}

    // Infinite behind the camera.
    double Error(const Eigen::Vector3d& point, const Point2& keypoint) const {
      const std::optional<Eigen::Vector2d> seen = SeenBy(camera_, rotation_ * point + translation_);
      return seen ? (*seen - Eigen::Vector2d(keypoint.x, keypoint.y)).norm() : std::numeric_limits<double>::infinity();
    }
    const Image& image() const { return image_; }

   private:
    const Image& image_;
    const Camera& camera_;
    Eigen::Matrix3d rotation_;
    Eigen::Vector3d translation_;
  };

  double MeanError(const Point& point, const std::vector<Eye>& eyes) const {
    const Eigen::Map<const Eigen::Vector3d> position(point.position.data());
    double sum = 0;
    std::uint64_t count = 0;
    for (std::uint64_t at = point.track_begin; at < point.track_begin + point.track_length; ++at) {
      const Eye& eye = eyes[view_of_element_[at]];
      const double error = eye.Error(position, eye.image().points[model_.tracks[at].row]);
      if (!std::isfinite(error)) continue;
      sum += error;
      ++count;
    }
    return count == 0 ? -1 : sum / static_cast<double>(count);
  }

  const Outline& outline_;
  const MapOutline& map_;
  const WriteOptions& options_;
  Unheld& unheld_;
  const IdTable keyframes_;
  Model model_;
  std::vector<std::uint32_t> view_of_element_;  // of Model::tracks
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
