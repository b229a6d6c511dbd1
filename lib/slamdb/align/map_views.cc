// SPDX-License-Identifier: BSD-3-Clause
// 1. Views: keyframes that are good, posed and have a camera that projects.
// 2. Points that are good, somewhere finite, and have a descriptor.
// 3. Sightings that hold: their view is there, and their row in its columns.
#include "slamdb/align/detail/map_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/index.h"
#include "slamdb/model/statistics.h"
#include "slamdb/model/up.h"

namespace slamdb::detail {
namespace {

constexpr int kMostCells = 256;  // along an axis: keypoints of a damaged file may lie anywhere
constexpr std::int32_t kMostOctaves = 32;

// factor^octave as ORB-SLAM3 makes pyramids; of one level where the file says nothing that can be.
std::vector<double> ScalesOf(const ScalePyramid& pyramid) {
  const auto factor = static_cast<double>(pyramid.factor);
  std::vector<double> scales{1};
  if (!(factor > 1 && factor <= 4)) return scales;
  while (scales.size() < static_cast<std::size_t>(std::clamp(pyramid.levels, 1, kMostOctaves)))
    scales.push_back(scales.back() * factor);
  return scales;
}

Eigen::AlignedBox2d FrameOf(const ImageBounds& bounds, std::span<const Keypoint> keypoints) {
  if (bounds.min_x < bounds.max_x && bounds.min_y < bounds.max_y)
    return {Eigen::Vector2d(bounds.min_x, bounds.min_y), Eigen::Vector2d(bounds.max_x, bounds.max_y)};
  Eigen::AlignedBox2d frame;
  for (const Keypoint& keypoint : keypoints)
    frame.extend(Eigen::Vector2f(keypoint.x, keypoint.y).cast<double>().eval());
  return frame;
}

// A wide one where the lens bends: by its equidistant approximation, and half as much again.
double HalfAngle(const View& view) {
  double angle = 0;
  for (const auto corner : {Eigen::AlignedBox2d::BottomLeft, Eigen::AlignedBox2d::BottomRight,
                            Eigen::AlignedBox2d::TopLeft, Eigen::AlignedBox2d::TopRight}) {
    const Eigen::Vector2d pixel = view.frame.corner(corner);
    const double radius =
        Eigen::Vector2d((pixel.x() - view.lens.cx) / view.lens.fx, (pixel.y() - view.lens.cy) / view.lens.fy).norm();
    angle = std::max(angle, view.lens.model == CameraModel::kPinhole ? std::atan(radius) : 1.5 * radius);
  }
  return std::min(angle, std::numbers::pi);
}

void SetPose(View& view, const Rigid3f& camera_from_world) {
  view.rotation = camera_from_world.rotation.cast<double>().normalized().toRotationMatrix();
  view.translation = camera_from_world.translation.cast<double>();
  view.center = -view.rotation.transpose() * view.translation;
}

// Against gravity where an IMU tells it: z, as ORB-SLAM3 has it, unless the map was turned since.
std::optional<Eigen::Vector3d> UpByGravity(const Map& map) {
  constexpr double kTurned = 0.9986;  // cosine of 3 degrees: more than the IMU's data is off by
  const auto gravity = GravityByInertia(map);
  if (!gravity || !gravity->allFinite() || gravity->isZero()) return std::nullopt;
  const Eigen::Vector3d up = -gravity->normalized();
  return up.z() > kTurned ? Eigen::Vector3d::UnitZ() : up;
}

}  // namespace

void SetFeatures(View& view, const Column<Keypoint>& keypoints, std::span<const Descriptor> descriptors) {
  const std::size_t count = std::min(keypoints.size(), descriptors.size());
  view.keypoints = std::span(keypoints).first(count);
  view.descriptors = descriptors.first(count);
  view.cells = KeypointCells(view.keypoints);
}

void SetPicture(View& view, const ImageBounds& bounds, const ScalePyramid& pyramid) {
  view.scales = ScalesOf(pyramid);
  view.log_factor = view.scales.size() > 1 ? std::log(view.scales[1]) : 0;
  view.frame = FrameOf(bounds, view.keypoints);
  view.half_angle = HalfAngle(view);
}

KeypointCells::KeypointCells(std::span<const Keypoint> keypoints) : keypoints_(keypoints) {
  Eigen::AlignedBox2d extent;
  for (const Keypoint& keypoint : keypoints)
    if (const Eigen::Vector2d at = PixelOf(keypoint); at.allFinite()) extent.extend(at);
  if (extent.isEmpty()) return;
  low_ = extent.min().array();
  cells_ = (extent.sizes().array() / kCell).min(kMostCells - 1).cast<int>() + 1;
  const auto cell_of = [&](const Keypoint& keypoint) {
    const Eigen::Array2d at = (PixelOf(keypoint).array() - low_) / kCell;
    const Eigen::Array2i cell = at.max(0).min((cells_ - 1).cast<double>()).cast<int>();
    return static_cast<std::size_t>(cell.y() * cells_.x() + cell.x());
  };
  begins_.assign(static_cast<std::size_t>(cells_.prod()) + 1, 0);
  for (const Keypoint& keypoint : keypoints)
    if (PixelOf(keypoint).allFinite()) ++begins_[cell_of(keypoint) + 1];
  for (std::size_t cell = 1; cell < begins_.size(); ++cell) begins_[cell] += begins_[cell - 1];
  rows_.resize(begins_.back());
  std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
  for (std::size_t row = 0; row < keypoints.size(); ++row)
    if (PixelOf(keypoints[row]).allFinite()) rows_[next[cell_of(keypoints[row])]++] = static_cast<std::uint32_t>(row);
}

double View::ScaleOf(std::int32_t octave) const {
  return scales[static_cast<std::size_t>(std::clamp<std::int64_t>(octave, 0, std::ssize(scales) - 1))];
}

MapViews::MapViews(const Atlas& atlas, std::size_t map, int threads) : map_(&atlas.maps[map]) {
  metric_ = IsMetric(*map_);
  up_ = UpByGravity(*map_);
  AddViews(atlas);
  AddPoints();
  AddSightings();
  FindDepths(threads);
  GroupPoints();
}

void MapViews::AddViews(const Atlas& atlas) {
  const AtlasIndex index(atlas);
  left_view_.assign(map_->keyframes.size(), kNoRow);
  for (std::uint32_t row = 0; row < map_->keyframes.size(); ++row) {
    const KeyFrame& keyframe = map_->keyframes[row];
    const Camera* camera = index.FindCamera(keyframe.camera);
    const std::optional<Lens> lens = camera != nullptr ? Lens::Of(*camera) : std::nullopt;
    if (keyframe.bad || !lens || !detail::IsPose(keyframe.camera_from_world)) continue;
    const Features& features = keyframe.features;
    const std::span<const Descriptor> descriptors(features.descriptors);
    const bool pair = features.is_fisheye_stereo();
    const std::size_t left =
        pair ? std::min<std::size_t>(static_cast<std::size_t>(features.left_count), descriptors.size())
             : descriptors.size();
    View view{.keyframe = row, .lens = *lens};
    SetPose(view, keyframe.camera_from_world);
    SetFeatures(view, pair ? features.keypoints : features.undistorted, descriptors.first(left));
    SetPicture(view, keyframe.bounds, keyframe.pyramid);
    left_view_[row] = static_cast<std::uint32_t>(views_.size());
    views_.push_back(view);
    const Camera* right_camera = pair ? index.FindCamera(keyframe.right_camera) : nullptr;
    const std::optional<Lens> right_lens = right_camera != nullptr ? Lens::Of(*right_camera) : std::nullopt;
    if (!right_lens || !detail::IsPose(keyframe.left_from_right)) continue;
    view.right = true;
    view.lens = *right_lens;
    SetPose(view, RightCameraFromWorld(keyframe));
    SetFeatures(view, features.right_keypoints, descriptors.subspan(left));
    SetPicture(view, keyframe.bounds, keyframe.pyramid);
    views_.push_back(std::move(view));
  }
}

void MapViews::AddPoints() {
  const IdTable keyframes = KeyFrameTable(*map_);
  for (std::uint32_t row = 0; row < map_->points.size(); ++row) {
    const MapPoint& point = map_->points[row];
    if (point.bad || !point.has_descriptor() || !point.position.allFinite()) continue;
    ViewedPoint viewed{.row = row, .position = point.position.cast<double>(), .descriptor = &point.descriptor};
    const Eigen::Vector3d normal = point.normal.cast<double>();
    viewed.normal = normal.allFinite() && normal.norm() > 0 ? normal.normalized() : Eigen::Vector3d::Zero();
    const std::uint32_t reference = keyframes.Find(point.reference.value());
    if (reference != kNoRow && left_view_[reference] != kNoRow) {
      const double focal = views_[left_view_[reference]].lens.fx;
      viewed.near = static_cast<double>(point.min_distance) / focal;
      viewed.far = static_cast<double>(point.max_distance) / focal;
    }
    points_.push_back(viewed);
  }
}

void MapViews::AddSightings() {
  const IdTable keyframes = KeyFrameTable(*map_);
  point_begins_.assign(points_.size() + 1, 0);
  view_begins_.assign(views_.size() + 1, 0);
  std::vector<std::size_t> seen_at(map_->keyframes.size(), points_.size());  // the last point that it saw
  for (std::size_t point = 0; point < points_.size(); ++point) {
    for (const Observation& observation : map_->points[points_[point].row].observations) {
      const std::uint32_t keyframe = keyframes.Find(observation.keyframe.value());
      const std::uint32_t left = keyframe == kNoRow ? kNoRow : left_view_[keyframe];
      if (left == kNoRow || std::exchange(seen_at[keyframe], point) == point) continue;
      const auto add = [&](std::uint32_t view, std::int64_t row) {
        if (row < 0 || row >= std::ssize(views_[view].keypoints)) return;
        sightings_.push_back({view, static_cast<std::uint32_t>(row)});
        ++view_begins_[view + 1];
      };
      add(left, observation.left);
      if (left + 1 < views_.size() && views_[left + 1].right && observation.right >= 0)
        add(left + 1, observation.right - std::int64_t{map_->keyframes[keyframe].features.left_count});
    }
    point_begins_[point + 1] = sightings_.size();
  }
  for (std::size_t view = 1; view < view_begins_.size(); ++view) view_begins_[view] += view_begins_[view - 1];
  seen_.resize(sightings_.size());
  std::vector<std::size_t> next(view_begins_.begin(), view_begins_.end() - 1);
  for (std::uint32_t point = 0; point < points_.size(); ++point)
    for (const Sighting& sighting : SightingsOf(point)) seen_[next[sighting.view]++] = {point, sighting.keypoint};
  keypoint_begins_.push_back(0);
  for (const View& view : views_) keypoint_begins_.push_back(keypoint_begins_.back() + view.keypoints.size());
  point_at_.assign(keypoint_begins_.back(), kNoRow);
  for (std::uint32_t view = 0; view < views_.size(); ++view)
    for (const Seen& seen : SeenBy(view)) point_at_[keypoint_begins_[view] + seen.keypoint] = seen.point;
}

void MapViews::GroupPoints() {
  groups_.resize(views_.size());
  for (std::uint32_t point = 0; point < points_.size(); ++point)
    if (const auto sightings = SightingsOf(point); !sightings.empty())
      groups_[sightings.front().view].points.push_back(point);
  std::erase_if(groups_, [](const PointGroup& group) { return group.points.empty(); });
  for (PointGroup& group : groups_) {
    for (const std::uint32_t point : group.points) group.center += points_[point].position;
    group.center /= static_cast<double>(group.points.size());
    for (const std::uint32_t point : group.points)
      group.radius = std::max(group.radius, (points_[point].position - group.center).norm());
  }
}

void MapViews::FindDepths(int threads) {
  ParallelFor(views_.size(), 16, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t view = begin; view < end; ++view) {
      std::vector<double> depths;
      for (const Seen& seen : SeenBy(static_cast<std::uint32_t>(view)))
        depths.push_back(views_[view].CameraFromWorld(points_[seen.point].position).z());
      views_[view].median_depth = std::max(0.0, MedianOf(std::move(depths)));
    }
  });
  std::vector<double> depths;
  for (const View& view : views_)
    if (view.median_depth > 0) depths.push_back(view.median_depth);
  median_depth_ = MedianOf(std::move(depths));
}

std::vector<MapViews::Covisible> MapViews::Covisibles(std::uint32_t view) const {
  std::unordered_map<std::uint32_t, std::uint32_t> shared;  // by left view
  for (const Seen& seen : SeenBy(view))
    for (const Sighting& sighting : SightingsOf(seen.point))
      if (!views_[sighting.view].right && sighting.view != view) ++shared[sighting.view];
  std::vector<Covisible> covisibles;
  for (const auto& [other, points] : shared) covisibles.push_back({other, points});
  std::ranges::sort(covisibles, {}, &Covisible::view);
  return covisibles;
}

std::vector<std::uint32_t> MapViews::BestCovisibles(std::uint32_t view, std::size_t count) const {
  std::vector<Covisible> neighbours = Covisibles(view);
  std::ranges::stable_sort(neighbours, std::greater(), &Covisible::shared);
  std::vector<std::uint32_t> best;
  for (const Covisible& neighbour : std::span(neighbours).first(std::min(count, neighbours.size())))
    best.push_back(neighbour.view);
  return best;
}

}  // namespace slamdb::detail
