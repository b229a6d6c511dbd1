// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slamdb/model/atlas.h"
#include "slamdb/model/detail/lens.h"
#include "slamdb/model/similarity.h"

namespace slamdb::detail {

inline Eigen::Vector2d PixelOf(const Keypoint& keypoint) {
  return {static_cast<double>(keypoint.x), static_cast<double>(keypoint.y)};
}

// The keypoints of a picture by the cell that they are in, for look-up by place.
class KeypointCells {
 public:
  KeypointCells() = default;
  explicit KeypointCells(std::span<const Keypoint> keypoints);

  // Calls visit(row) for keypoints less than `radius` pixels in x and in y from a place, cell by cell.
  template <class Visit>
  void VisitNear(const Eigen::Vector2d& place, double radius, const Visit& visit) const;

 private:
  static constexpr double kCell = 24;  // pixels

  std::span<const Keypoint> keypoints_;
  Eigen::Array2d low_ = Eigen::Array2d::Zero();  // of the keypoints, pixels
  Eigen::Array2i cells_ = Eigen::Array2i::Zero();
  std::vector<std::uint32_t> begins_, rows_;  // of cell y * cells_.x() + x: [begins_[cell], begins_[cell + 1]) of rows_
};

// One picture of a keyframe: the left one, or the right one of a fisheye pair.
struct View {
  std::uint32_t keyframe = 0;  // row in the map's list
  bool right = false;
  Lens lens;
  Eigen::Matrix3d rotation;     // camera_from_world
  Eigen::Vector3d translation;  // camera_from_world
  Eigen::Vector3d center;       // in the world
  Eigen::AlignedBox2d frame;    // the picture, pixels as the lens projects
  std::span<const Keypoint> keypoints;
  std::span<const Descriptor> descriptors;  // as many
  std::vector<double> scales;               // of the octaves: factor^octave
  double log_factor = 0;
  KeypointCells cells;
  double half_angle = 0;    // of the cone about the optical axis that the picture lies in, radians
  double median_depth = 0;  // of the points that it sees, map units; 0: it sees none

  Eigen::Vector3d CameraFromWorld(const Eigen::Vector3d& point) const { return rotation * point + translation; }
  double ScaleOf(std::int32_t octave) const;
  // The direction that the camera looks in, in the world.
  Eigen::Vector3d axis() const { return rotation.row(2).transpose(); }
};

// How two cameras lie to each other whose maps lie as a transform says: in lengths of the first map; the scale is one
// of these per length of the second.
inline Similarity3d BetweenCameras(const View& first, const View& second, const Similarity3d& first_from_second) {
  const auto world_from_camera = [](const View& view) {
    return Similarity3d{1, Eigen::Quaterniond(view.rotation).conjugate(), view.center};
  };
  return world_from_camera(first).Inverse() * first_from_second * world_from_camera(second);
}

// Keypoints with their descriptors; as many as both columns have.
void SetFeatures(View& view, const Column<Keypoint>& keypoints, std::span<const Descriptor> descriptors);
// Behind the lens and SetFeatures, whose extent is the picture where the bounds are none.
void SetPicture(View& view, const ImageBounds& bounds, const ScalePyramid& pyramid);

// A map point as others look for it.
struct ViewedPoint {
  std::uint32_t row = 0;  // in the map's list
  Eigen::Vector3d position;
  Eigen::Vector3d normal;    // mean viewing direction, unit length; zero: unknown
  double near = 0, far = 0;  // distances from where it is found, divided by the focal length of the reference keyframe
  const Descriptor* descriptor = nullptr;
};

// Points that were first seen in one view, for leaving out many at once.
struct PointGroup {
  std::vector<std::uint32_t> points;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0;  // all of them are within
};

// "Keypoint `keypoint` of view `view`", and "point `point` is keypoint `keypoint`".
struct Sighting {
  std::uint32_t view, keypoint;
};
struct Seen {
  std::uint32_t point, keypoint;
};

// A map as aligning sees it: good keyframes with finite poses, good points with descriptors, and sightings that hold.
// Refers to the atlas, which must outlive it and keep its lists as they are.
// Constant after construction: safe to use from many threads.
// Cost: linear.
class MapViews {
 public:
  MapViews(const Atlas& atlas, std::size_t map, int threads = 0);

  const Map& map() const { return *map_; }
  std::span<const View> views() const { return views_; }
  std::span<const ViewedPoint> points() const { return points_; }
  std::span<const PointGroup> groups() const { return groups_; }  // of all points that are seen
  const KeyFrame& KeyFrameOf(const View& view) const { return map_->keyframes[view.keyframe]; }

  // Of a left view: itself, or the right one of its pair.
  std::uint32_t LastViewOf(std::uint32_t left) const {
    return left + 1 < views_.size() && views_[left + 1].right ? left + 1 : left;
  }
  // The left view of a keyframe's row, or kNoRow.
  std::uint32_t LeftView(std::uint32_t keyframe) const { return left_view_[keyframe]; }
  std::span<const Sighting> SightingsOf(std::uint32_t point) const {
    return std::span(sightings_).subspan(point_begins_[point], point_begins_[point + 1] - point_begins_[point]);
  }
  std::span<const Seen> SeenBy(std::uint32_t view) const {
    return std::span(seen_).subspan(view_begins_[view], view_begins_[view + 1] - view_begins_[view]);
  }
  // The point that a keypoint is, or kNoRow.
  std::uint32_t PointAt(const Sighting& sighting) const {
    return point_at_[keypoint_begins_[sighting.view] + sighting.keypoint];
  }

  // The left views that share points with a left view, by row, and how many; counted from sightings.
  struct Covisible {
    std::uint32_t view, shared;
  };
  std::vector<Covisible> Covisibles(std::uint32_t view) const;
  // Those that share most, the most first, then by row.
  std::vector<std::uint32_t> BestCovisibles(std::uint32_t view, std::size_t count) const;

  bool metric() const { return metric_; }                           // lengths are metres
  const std::optional<Eigen::Vector3d>& up() const { return up_; }  // where an IMU knows it; world, unit length
  double median_depth() const { return median_depth_; }             // of views

 private:
  void AddViews(const Atlas& atlas);
  void AddPoints();
  void AddSightings();
  void FindDepths(int threads);
  void GroupPoints();

  const Map* map_;
  std::vector<View> views_;  // keyframe by keyframe, left before right
  std::vector<std::uint32_t> left_view_;
  std::vector<ViewedPoint> points_;
  std::vector<PointGroup> groups_;
  std::vector<std::size_t> point_begins_, view_begins_;
  std::vector<Sighting> sightings_;
  std::vector<Seen> seen_;
  std::vector<std::size_t> keypoint_begins_;  // of view v: [keypoint_begins_[v], keypoint_begins_[v + 1]) of point_at_
  std::vector<std::uint32_t> point_at_;
  bool metric_ = false;
  std::optional<Eigen::Vector3d> up_;
  double median_depth_ = 0;
};

template <class Visit>
void KeypointCells::VisitNear(const Eigen::Vector2d& place, double radius, const Visit& visit) const {
  const Eigen::Array2d begin = (place.array() - radius - low_) / kCell, end = (place.array() + radius - low_) / kCell;
  const Eigen::Array2d last = cells_.cast<double>() - 1;
  if (cells_.x() == 0 || !((begin <= last + 1).all() && (end >= 0).all())) return;
  const Eigen::Array2i from = begin.max(0).min(last).cast<int>(), to = end.max(0).min(last).cast<int>();
  for (int y = from.y(); y <= to.y(); ++y)
    for (int x = from.x(); x <= to.x(); ++x) {
      const auto cell = static_cast<std::size_t>(y * cells_.x() + x);
      for (std::uint32_t i = begins_[cell]; i < begins_[cell + 1]; ++i) {
        const Keypoint& keypoint = keypoints_[rows_[i]];
        if (std::abs(static_cast<double>(keypoint.x) - place.x()) < radius &&
            std::abs(static_cast<double>(keypoint.y) - place.y()) < radius)
          visit(rows_[i]);
      }
    }
}

}  // namespace slamdb::detail
