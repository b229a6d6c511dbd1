// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/derive.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <numeric>

#include "slamdb/base/detail/median.h"
#include "slamdb/model/detail/distortion.h"

namespace slamdb {
namespace {

constexpr std::size_t kPinholeParameters = 4;
constexpr std::size_t kKannalaBrandtParameters = 8;

// Far beyond any real grid (64 x 48): dimensions of a damaged file must not ask for memory.
constexpr std::int64_t kMostCells = std::int64_t{1} << 20;

[[gnu::always_inline]] inline int CountBits(const Descriptor& a, const Descriptor& b) {
  std::array<std::uint64_t, 4> left, right;
  std::memcpy(left.data(), a.data(), sizeof left);
  std::memcpy(right.data(), b.data(), sizeof right);
  int distance = 0;
  for (std::size_t i = 0; i < left.size(); ++i) distance += std::popcount(left[i] ^ right[i]);
  return distance;
}

// Without the instruction counting takes four times as long; every processor of the last fifteen years has it.
#if defined(__x86_64__)
[[gnu::target("popcnt")]] int DistanceByPopcount(const Descriptor& a, const Descriptor& b) { return CountBits(a, b); }
const bool kHasPopcount = __builtin_cpu_supports("popcnt") != 0;
#else
int DistanceByPopcount(const Descriptor& a, const Descriptor& b) { return CountBits(a, b); }
constexpr bool kHasPopcount = false;
#endif

bool HasParameters(const Camera& camera) {
  switch (camera.model) {
    case CameraModel::kPinhole:
      return camera.parameters.size() == kPinholeParameters;
    case CameraModel::kKannalaBrandt8:
      return camera.parameters.size() == kKannalaBrandtParameters;
    case CameraModel::kEquirectangular:
      return false;
  }
  return false;
}

// Newton's method for the angle of a radius, at most ten steps as in ORB-SLAM3.
float KannalaBrandtAngle(const float* k, float radius, float precision) {
  float theta = radius;
  for (int step = 0; step < 10; ++step) {
    const float change = (detail::KannalaBrandtRadius(k, theta) - radius) / detail::KannalaBrandtSlope(k, theta);
    theta -= change;
    if (std::abs(change) < precision) break;
  }
  return theta;
}

// How many cells a grid of these bounds has; 0 when it cannot be one.
std::int64_t CellCount(const ImageBounds& bounds) {
  if (bounds.grid_columns <= 0 || bounds.grid_rows <= 0) return 0;
  const std::int64_t cells = std::int64_t{bounds.grid_columns} * bounds.grid_rows;
  return cells <= kMostCells ? cells : 0;
}

// std::round for values above -0.5, without the call; -1 for all others and from `end` up, NaN included.
std::int32_t RoundBelow(float value, std::int32_t end) {
  if (!(value > -0.5F && value < static_cast<float>(end))) return -1;
  const auto whole = static_cast<std::int32_t>(value);
  const std::int32_t rounded = whole + (value - static_cast<float>(whole) >= 0.5F ? 1 : 0);
  return rounded < end ? rounded : -1;
}

// The cell of a keypoint, column after column; -1 outside the image.
std::int64_t CellOf(const Keypoint& keypoint, const ImageBounds& bounds) {
  const float x = (keypoint.x - static_cast<float>(bounds.min_x)) * bounds.inverse_cell_width;
  const float y = (keypoint.y - static_cast<float>(bounds.min_y)) * bounds.inverse_cell_height;
  const std::int32_t column = RoundBelow(x, bounds.grid_columns);
  const std::int32_t row = RoundBelow(y, bounds.grid_rows);
  return column < 0 || row < 0 ? -1 : std::int64_t{column} * bounds.grid_rows + row;
}

// The cells along one axis that may hold what is within `radius` of `place`; none when first > last.
struct CellRange {
  std::int32_t first, last;
};
CellRange CellsNear(float place, float radius, float inverse_size, std::int32_t count) {
  const float first = std::floor((place - radius) * inverse_size), last = std::ceil((place + radius) * inverse_size);
  const auto end = static_cast<float>(count);
  if (!(first < end && last >= 0)) return {0, -1};
  return {static_cast<std::int32_t>(std::max(first, 0.0F)), static_cast<std::int32_t>(std::min(last, end - 1))};
}

}  // namespace

std::optional<Eigen::Vector2f> Project(const Camera& camera, const Eigen::Vector3f& x_in_camera) {
  if (!HasParameters(camera)) return std::nullopt;
  const float* p = camera.parameters.data();
  const float x = x_in_camera.x(), y = x_in_camera.y(), z = x_in_camera.z();
  if (camera.model == CameraModel::kPinhole) {
    if (!(z > 0)) return std::nullopt;
    return Eigen::Vector2f(p[0] * x / z + p[2], p[1] * y / z + p[3]);
  }
  const float off_axis = std::sqrt(x * x + y * y);
  if (off_axis == 0) return Eigen::Vector2f(p[2], p[3]);
  const float radius = detail::KannalaBrandtRadius(p + 4, std::atan2(off_axis, z));
  return Eigen::Vector2f(p[0] * radius * (x / off_axis) + p[2], p[1] * radius * (y / off_axis) + p[3]);
}

Eigen::Vector3f Unproject(const Camera& camera, const Eigen::Vector2f& pixel) {
  if (!HasParameters(camera)) return Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  const float* p = camera.parameters.data();
  const float x = (pixel.x() - p[2]) / p[0], y = (pixel.y() - p[3]) / p[1];
  if (camera.model == CameraModel::kPinhole) return {x, y, 1};
  const float radius = std::sqrt(x * x + y * y);
  if (!(radius > 1e-8F)) return {x, y, 1};
  constexpr float kRightAngle = std::numbers::pi_v<float> / 2;  // the ray of anything wider has no z = 1
  const float theta = KannalaBrandtAngle(p + 4, std::min(radius, kRightAngle), camera.precision);
  const float scale = std::tan(theta) / radius;
  return {x * scale, y * scale, 1};
}

Eigen::Vector3f CameraCenter(const KeyFrame& keyframe) { return keyframe.camera_from_world.Normalized().Center(); }

Eigen::Vector3f RightCameraCenter(const KeyFrame& keyframe) {
  return keyframe.camera_from_world.Normalized().Inverse() * keyframe.left_from_right.translation;
}

Rigid3f RightCameraFromWorld(const KeyFrame& keyframe) {
  return keyframe.left_from_right.Normalized().Inverse() * keyframe.camera_from_world.Normalized();
}

Rigid3f WorldFromBody(const KeyFrame& keyframe) {
  const Rigid3f world_from_camera = keyframe.camera_from_world.Normalized().Inverse();
  if (!keyframe.imu_calibration.is_set) return world_from_camera;
  return world_from_camera * keyframe.imu_calibration.camera_from_body.Normalized();
}

const Keypoint* ObservedKeypoint(const Features& features, std::int32_t row) {
  const bool is_right = features.is_fisheye_stereo() && row >= features.left_count;
  const Column<Keypoint>& column = is_right                       ? features.right_keypoints
                                   : features.is_fisheye_stereo() ? features.keypoints
                                                                  : features.undistorted;
  const std::int64_t place = is_right ? std::int64_t{row} - features.left_count : row;
  if (place < 0 || static_cast<std::uint64_t>(place) >= column.size()) return nullptr;
  return &column[static_cast<std::size_t>(place)];
}

std::optional<Eigen::Vector3f> UnprojectDepth(const Features& features, const Intrinsics& intrinsics,
                                              std::int32_t row) {
  const auto place = static_cast<std::size_t>(row);
  if (row < 0 || place >= features.depth.size() || place >= features.keypoints.size()) return std::nullopt;
  const float z = features.depth[place];
  if (!(z > 0)) return std::nullopt;
  const Keypoint& keypoint = features.keypoints[place];
  return Eigen::Vector3f((keypoint.x - intrinsics.cx) * z * intrinsics.inverse_fx,
                         (keypoint.y - intrinsics.cy) * z * intrinsics.inverse_fy, z);
}

bool IsInsideImage(const ImageBounds& bounds, float x, float y) {
  return x >= static_cast<float>(bounds.min_x) && x < static_cast<float>(bounds.max_x) &&
         y >= static_cast<float>(bounds.min_y) && y < static_cast<float>(bounds.max_y);
}

std::vector<std::size_t> KeypointsInArea(const Column<Keypoint>& keypoints, const FeatureGrid& grid,
                                         const ImageBounds& bounds, float x, float y, float radius) {
  std::vector<std::size_t> rows;
  const std::int64_t cells = CellCount(bounds);
  if (cells == 0 || static_cast<std::uint64_t>(cells) != grid.cell_sizes.size()) return rows;
  const CellRange columns =
      CellsNear(x - static_cast<float>(bounds.min_x), radius, bounds.inverse_cell_width, bounds.grid_columns);
  const CellRange cell_rows =
      CellsNear(y - static_cast<float>(bounds.min_y), radius, bounds.inverse_cell_height, bounds.grid_rows);
  std::size_t entry = 0, cell = 0;
  for (std::int32_t column = 0; column <= columns.last; ++column) {
    for (std::int32_t row = 0; row < bounds.grid_rows; ++row, ++cell) {
      const std::size_t end = std::min<std::size_t>(entry + grid.cell_sizes[cell], grid.keypoints.size());
      const bool is_near = column >= columns.first && row >= cell_rows.first && row <= cell_rows.last;
      for (; is_near && entry < end; ++entry) {
        const std::uint64_t keypoint = grid.keypoints[entry];
        if (keypoint < keypoints.size() && std::abs(keypoints[keypoint].x - x) < radius &&
            std::abs(keypoints[keypoint].y - y) < radius)
          rows.push_back(keypoint);
      }
      entry = end;
    }
  }
  return rows;
}

std::int32_t ObservationWeight(const Features& features, bool has_second_camera, const Observation& observation) {
  std::int32_t weight = observation.right >= 0 ? 1 : 0;
  if (observation.left < 0) return weight;
  const Column<float>& right_x = features.right_x;
  const auto left = static_cast<std::size_t>(observation.left);
  const bool has_depth = !has_second_camera && left < right_x.size() && right_x[left] >= 0;
  return weight + (has_depth ? 2 : 1);
}

int HammingDistance(const Descriptor& a, const Descriptor& b) {
  return kHasPopcount ? DistanceByPopcount(a, b) : CountBits(a, b);
}

std::size_t MostDistinctiveDescriptor(const std::vector<Descriptor>& descriptors) {
  const std::size_t count = descriptors.size();
  if (count <= 2) return 0;
  std::vector<int> distances(count);
  std::size_t best = 0;
  int best_median = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) distances[j] = HammingDistance(descriptors[i], descriptors[j]);
    const int median = detail::ElementInOrder(distances, (count - 1) / 2);
    if (median < best_median) {
      best_median = median;
      best = i;
    }
  }
  return best;
}

FeatureGrid DeriveGrid(const Column<Keypoint>& keypoints, const ImageBounds& bounds) {
  FeatureGrid grid;
  const auto cells = static_cast<std::size_t>(CellCount(bounds));
  if (cells == 0) return grid;
  grid.column_sizes.resize(static_cast<std::size_t>(bounds.grid_columns), static_cast<std::uint32_t>(bounds.grid_rows));
  grid.cell_sizes.resize(cells, 0);
  std::vector<std::int32_t> cell_of(keypoints.size());
  for (std::size_t row = 0; row < keypoints.size(); ++row) {
    cell_of[row] = static_cast<std::int32_t>(CellOf(keypoints[row], bounds));
    if (cell_of[row] >= 0) ++grid.cell_sizes[static_cast<std::size_t>(cell_of[row])];
  }
  std::vector<std::size_t> next(cells);
  std::exclusive_scan(grid.cell_sizes.begin(), grid.cell_sizes.end(), next.begin(), std::size_t{0});
  grid.keypoints.resize(next.back() + grid.cell_sizes.back());
  for (std::size_t row = 0; row < keypoints.size(); ++row) {
    if (cell_of[row] >= 0) grid.keypoints[next[static_cast<std::size_t>(cell_of[row])]++] = row;
  }
  return grid;
}

bool IsDerivedGrid(const FeatureGrid& grid, const Column<Keypoint>& keypoints, const ImageBounds& bounds) {
  if (grid.cell_sizes.size() != static_cast<std::size_t>(CellCount(bounds))) return false;
  return grid == DeriveGrid(keypoints, bounds);
}

ScalePyramid DerivePyramid(std::int32_t levels, float factor) {
  ScalePyramid pyramid;
  pyramid.levels = levels;
  pyramid.factor = factor;
  pyramid.log_factor = std::log(factor);
  float scale = 1;
  for (std::int32_t level = 0; level < levels; ++level) {
    pyramid.factors.push_back(scale);
    pyramid.sigma2.push_back(scale * scale);
    pyramid.inverse_sigma2.push_back(1 / (scale * scale));
    scale *= factor;
  }
  return pyramid;
}

DistanceRange DeriveDistanceRange(float distance, std::int32_t octave, const ScalePyramid& pyramid) {
  if (octave < 0 || static_cast<std::size_t>(octave) >= pyramid.factors.size()) return {};
  const float max = distance * pyramid.factors[static_cast<std::size_t>(octave)];
  return {max / pyramid.factors.back(), max};
}

std::int32_t PredictScale(float max_distance, float distance, const ScalePyramid& pyramid) {
  const float level = std::ceil(std::log(max_distance / distance) / pyramid.log_factor);
  const auto highest = static_cast<float>(std::max(pyramid.levels - 1, 0));
  return level > 0 ? static_cast<std::int32_t>(std::min(level, highest)) : 0;  // NaN too
}

Eigen::Vector3f MeanViewingDirection(const Eigen::Vector3f& position, std::span<const Eigen::Vector3f> centers) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  if (centers.empty()) return sum;
  for (const Eigen::Vector3f& center : centers) {
    const Eigen::Vector3f direction = position - center;
    sum += direction / direction.norm();
  }
  return sum / static_cast<float>(centers.size());
}

}  // namespace slamdb
