// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/point_colors.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/up.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kRowsPerBlock = 8192;

// The id of the keyframe that made a point, which grows as the map does; of one that a frame made, of the first that
// sees it.
float AgeOf(const MapPoint& point) {
  if (point.first_keyframe >= 0) return static_cast<float>(point.first_keyframe);
  KeyFrameId first;
  for (const Observation& observation : point.observations) first = std::min(first, observation.keyframe);
  return first ? static_cast<float>(first.value()) : std::numeric_limits<float>::quiet_NaN();
}

float ValueOf(const PointRows& points, std::size_t row, PointColor by, const std::vector<Eigen::Vector3f>& upward) {
  const MapPoint& point = *points[row].point;
  switch (by) {
    case PointColor::kMap:
      break;
    case PointColor::kError:
      return points.mean_error(points[row]);
    case PointColor::kObservations:
      return static_cast<float>(point.observations.size());
    case PointColor::kHeight:
      return upward[points[row].map].dot(point.position) + 0.F;  // no negative zero
    case PointColor::kAge:
      return AgeOf(point);
  }
  return 0;
}

// The nearest element, so that of a small cloud the ends are the least and the largest.
float Percentile(std::vector<float>& values, double share) {
  const long row = std::lround(share * static_cast<double>(values.size() - 1));
  return ElementInOrder(values, static_cast<std::size_t>(row));
}

}  // namespace

PointColors::PointColors(const PointRows& points, const WriteOptions& options)
    : points_(points), by_(options.of<PointCloudOptions>().color) {
  if (by_ == PointColor::kMap) return;
  std::vector<Eigen::Vector3f> upward;
  for (const Up& up : UpsOf(points.maps())) upward.emplace_back(up.direction.cast<float>());
  values_.resize(points.size());
  ParallelFor(points.size(), kRowsPerBlock, options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) values_[row] = ValueOf(points, row, by_, upward);
  });
  std::vector<float> finite;
  finite.reserve(values_.size());
  std::ranges::copy_if(values_, std::back_inserter(finite), [](float value) { return std::isfinite(value); });
  if (finite.empty()) return;
  low_ = Percentile(finite, 0.02);
  high_ = Percentile(finite, 0.98);
  if (high_ > low_) scale_ = 1 / (high_ - low_);
}

std::string PointColors::Legend() const {
  const auto range = [&](std::string_view what, std::string_view unit) {
    return Concat(what, " from ", Digits(low_, 4), " (violet) to ", Digits(high_, 4), unit, " (yellow)");
  };
  switch (by_) {
    case PointColor::kMap:
      break;
    case PointColor::kError:
      return range("reprojection error", " pixels");
    case PointColor::kObservations:
      return range("observations", "");
    case PointColor::kHeight:
      return range("height", "");
    case PointColor::kAge:
      return range("age: made by kf", "");
  }
  return "map";
}

void PointColors::Tell(Notices& notices) const {
  if (by_ != PointColor::kMap && points_.size() > 0) notices.Note("colours tell " + Legend());
}

}  // namespace slamdb::detail
