// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/edges.h"
#include "slamdb/model/detail/map_extent.h"
#include "slamdb/model/index.h"
#include "slamdb/model/sensor.h"

namespace slamdb {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

// Reorders `values`, which are finite. The mean is summed in their order before that.
template <class T>
Distribution Describe(Column<T>& values) {
  Distribution distribution;
  distribution.count = values.size();
  if (values.empty()) return distribution;
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  distribution.mean = sum / static_cast<double>(values.size());
  distribution.max = static_cast<double>(*std::max_element(values.begin(), values.end()));
  distribution.median = static_cast<double>(detail::ElementInOrder(values, values.size() / 2));
  return distribution;
}

// What projecting into a keyframe takes, looked up once.
struct Projector {
  const KeyFrame* keyframe = nullptr;
  const Camera *left = nullptr, *right = nullptr;
  Rigid3f camera_from_world, right_from_left;
};

// A point seen by one camera of a keyframe. No projector: the keyframe is not there.
struct Sight {
  Sight(const Projector* of, std::int32_t row, bool right) : projector(of), is_right(right) {
    if (of != nullptr) keypoint = ObservedKeypoint(*of->keyframe, row);
    __builtin_prefetch(keypoint);
  }

  // Pixels between the point and the keypoint; not finite when there is no such thing.
  float Error(const Eigen::Vector3f& point) const {
    if (projector == nullptr || keypoint == nullptr) return kNone;
    const Camera* camera = is_right ? projector->right : projector->left;
    if (camera == nullptr) return kNone;
    Eigen::Vector3f x = projector->camera_from_world * point;
    if (is_right) x = projector->right_from_left * x;
    const auto pixel = Project(*camera, x);
    return pixel ? (*pixel - Eigen::Vector2f(keypoint->x, keypoint->y)).norm() : kNone;
  }

  const Projector* projector;
  const Keypoint* keypoint = nullptr;
  bool is_right;
};

class MapCounter {
 public:
  MapCounter(const AtlasIndex& index, std::size_t row, int threads)
      : index_(index), row_(row), map_(index.atlas().maps[row]), threads_(threads) {}

  MapStatistics Count() {
    CopyRecorded();
    CountKeyFrames();
    result_.sensor = SensorOf(map_);
    result_.metric = IsMetric(map_);
    result_.has_imu = HasImu(map_);
    result_.up = UpOf(map_);
    MeasureTrajectory();
    CountEdges();
    CountPoints();
    if (HasKeypoints()) MeasureReprojection();
    return std::move(result_);
  }

 private:
  void CopyRecorded() {
    result_.id = map_.id;
    result_.keyframes = map_.keyframes.size();
    result_.points = map_.points.size();
    result_.landmarks = map_.landmarks.size();
    result_.imu_initialized = map_.imu_initialized;
    result_.inertial = map_.inertial;
    result_.imu_ba1 = map_.imu_ba1;
    result_.imu_ba2 = map_.imu_ba2;
    result_.initial_keyframe = map_.initial_keyframe;
    result_.lowest_keyframe = map_.lowest_keyframe;
    result_.max_keyframe_id = map_.max_keyframe_id;
  }

  void CountKeyFrames() {
    std::map<std::uint32_t, std::uint64_t> origins;
    for (const KeyFrame& keyframe : map_.keyframes) {
      if (keyframe.bad) ++result_.bad_keyframes;
      if (keyframe.features.count > 0) result_.features += static_cast<std::uint64_t>(keyframe.features.count);
      result_.largest_keyframe_id = std::max(result_.largest_keyframe_id, keyframe.id.value());
      ++origins[keyframe.origin_map];
    }
    for (const auto& [map, count] : origins) result_.origins.push_back({map, count});
  }

  void MeasureTrajectory() {
    const detail::Trajectory trajectory = detail::TrajectoryOf(map_);
    result_.begin_time = trajectory.begin_time;
    result_.end_time = trajectory.end_time;
    result_.trajectory_length = trajectory.length;
  }

  void CountEdges() {
    const auto row_of = [&](KeyFrameId id) { return index_.KeyFrameRow(row_, id); };
    result_.loop_edges = detail::EdgesOf(map_, &KeyFrame::loop_edges, row_of).size();
    result_.merge_edges = detail::EdgesOf(map_, &KeyFrame::merge_edges, row_of).size();
    std::vector<std::uint32_t> root(map_.keyframes.size());
    std::iota(root.begin(), root.end(), 0U);
    for (std::uint32_t row = 0; row < map_.keyframes.size(); ++row) {
      const KeyFrame& keyframe = map_.keyframes[row];
      for (const Connection& connection : keyframe.connections) Join(root, row, connection.keyframe);
    }
    CountComponents(root);
  }

  // An edge counts where its keyframe of the smaller row lists it, or where only the other one does.
  void Join(std::vector<std::uint32_t>& root, std::uint32_t row, KeyFrameId to) {
    const std::uint32_t other = index_.KeyFrameRow(row_, to);
    if (other == kNoRow || other == row) return;
    if (row < other || !Lists(map_.keyframes[other], map_.keyframes[row].id)) ++result_.covisibility_edges;
    if (map_.keyframes[row].bad || map_.keyframes[other].bad) return;
    root[Root(root, row)] = Root(root, other);
  }

  static bool Lists(const KeyFrame& keyframe, KeyFrameId id) {
    const auto& list = keyframe.connections;  // by id, unless the file is damaged
    const auto place = std::lower_bound(list.begin(), list.end(), id,
                                        [](const Connection& c, KeyFrameId wanted) { return c.keyframe < wanted; });
    return place != list.end() && place->keyframe == id;
  }

  // Union-find with path halving.
  static std::uint32_t Root(std::vector<std::uint32_t>& root, std::uint32_t row) {
    while (root[row] != row) row = root[row] = root[root[row]];
    return row;
  }

  void CountComponents(std::vector<std::uint32_t>& root) {
    std::vector<std::uint64_t> sizes(root.size(), 0);
    for (std::uint32_t row = 0; row < root.size(); ++row)
      if (!map_.keyframes[row].bad) ++sizes[Root(root, row)];
    for (const std::uint64_t size : sizes) {
      if (size > 0) ++result_.components;
      result_.largest_component = std::max(result_.largest_component, size);
    }
  }

  void CountPoints() {
    result_.observer_histogram.assign(MapStatistics::kHistogramSize, 0);
    Column<std::uint32_t> observers;
    observers.reserve(map_.points.size());
    for (const MapPoint& point : map_.points) {
      result_.largest_point_id = std::max(result_.largest_point_id, point.id.value());
      result_.observations += point.observations.size();
      if (point.bad) {
        ++result_.bad_points;
        continue;
      }
      if (point.position.allFinite()) result_.bounding_box.extend(point.position);
      const std::size_t count = point.observations.size();
      observers.push_back(static_cast<std::uint32_t>(count));
      ++result_.observer_histogram[std::min(count, MapStatistics::kHistogramSize - 1)];
    }
    result_.observers = Describe(observers);
  }

  // False when the atlas was read without features.
  bool HasKeypoints() const {
    return std::any_of(map_.keyframes.begin(), map_.keyframes.end(),
                       [](const KeyFrame& keyframe) { return !keyframe.features.keypoints.empty(); });
  }

  std::vector<Projector> MakeProjectors() const {
    const auto find = [&](CameraId id) {
      const std::uint32_t camera = index_.CameraRow(id);
      return camera == kNoRow ? nullptr : &index_.atlas().cameras[camera];
    };
    std::vector<Projector> projectors;
    projectors.reserve(map_.keyframes.size());
    for (const KeyFrame& keyframe : map_.keyframes) {
      projectors.push_back({&keyframe, find(keyframe.camera), find(keyframe.right_camera),
                            keyframe.camera_from_world.Normalized(), keyframe.left_from_right.Normalized().Inverse()});
    }
    return projectors;
  }

  // Threads write to places of their own: each point has one for each camera that sees it.
  void MeasureReprojection() {
    const std::vector<Projector> projectors = MakeProjectors();
    Column<std::size_t> begins(map_.points.size() + 1, 0);
    for (std::size_t row = 0; row < map_.points.size(); ++row) {
      begins[row + 1] = begins[row];
      if (map_.points[row].bad) continue;
      for (const Observation& observation : map_.points[row].observations)
        begins[row + 1] += static_cast<std::size_t>(observation.left >= 0) + (observation.right >= 0 ? 1 : 0);
    }
    Column<float> errors(begins.back());
    detail::ParallelFor(map_.points.size(), kGrain, threads_, [&](std::size_t begin, std::size_t end) {
      MeasureErrors(projectors, begin, end, errors.data() + begins[begin]);
    });
    const std::size_t seen = errors.size();
    std::erase_if(errors, [](float error) { return !std::isfinite(error); });
    result_.unprojectable = seen - errors.size();
    result_.reprojection_error = Describe(errors);
  }

  // Keypoints lie all over memory. Those of some points are found first, so that they come while others are computed.
  void MeasureErrors(const std::vector<Projector>& projectors, std::size_t begin, std::size_t end,
                     float* errors) const {
    constexpr std::size_t kPoints = 16;
    std::vector<Sight> sights;
    for (; begin < end; begin += kPoints) {
      const std::span points(map_.points.data() + begin, std::min(kPoints, end - begin));
      sights.clear();
      for (const MapPoint& point : points)
        if (!point.bad) AddSights(projectors, point, sights);
      auto sight = sights.cbegin();
      for (const MapPoint& point : points) {
        if (point.bad) continue;
        for (const Observation& observation : point.observations) {
          if (observation.left >= 0) *errors++ = (sight++)->Error(point.position);
          if (observation.right >= 0) *errors++ = (sight++)->Error(point.position);
        }
      }
    }
  }

  void AddSights(const std::vector<Projector>& projectors, const MapPoint& point, std::vector<Sight>& sights) const {
    for (const Observation& observation : point.observations) {
      const std::uint32_t row = index_.KeyFrameRow(row_, observation.keyframe);
      const Projector* const projector = row == kNoRow ? nullptr : &projectors[row];
      if (observation.left >= 0) sights.emplace_back(projector, observation.left, false);
      if (observation.right >= 0) sights.emplace_back(projector, observation.right, true);
    }
  }

  const AtlasIndex& index_;
  const std::size_t row_;
  const Map& map_;
  const int threads_;
  MapStatistics result_;
};

}  // namespace

std::string SensorText(MapSensor sensor, bool has_imu) {
  constexpr std::array<std::string_view, 4> kTexts = {"no keyframes", "monocular", "stereo or RGB-D", "fisheye stereo"};
  return std::string(kTexts.at(static_cast<std::size_t>(sensor))) + (has_imu ? " with IMU" : "");
}

AtlasStatistics ComputeStatistics(const Atlas& atlas, int threads) {
  const AtlasIndex index(atlas);
  AtlasStatistics total;
  total.cameras = atlas.cameras.size();
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    const MapStatistics& map = total.maps.emplace_back(MapCounter(index, row, threads).Count());
    total.keyframes += map.keyframes;
    total.points += map.points;
    total.bad_keyframes += map.bad_keyframes;
    total.bad_points += map.bad_points;
    total.features += map.features;
    total.observations += map.observations;
    total.covisibility_edges += map.covisibility_edges;
    total.loop_edges += map.loop_edges;
    total.merge_edges += map.merge_edges;
    total.trajectory_length += map.trajectory_length;
  }
  return total;
}

}  // namespace slamdb
