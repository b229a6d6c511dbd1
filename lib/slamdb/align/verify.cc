// SPDX-License-Identifier: BSD-3-Clause
// For each picture: which points of the other map it must see, which of them it finds, and whether these are all over
// the picture or in one patch of it.
#include "slamdb/align/detail/verify.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "slamdb/align/detail/match_points.h"
#include "slamdb/align/detail/visibility.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kMostViews = 400;
constexpr double kLeastCosine = 0.8;  // 37 degrees from where a point was seen: descriptors stand that
constexpr double kRadius = 4;         // pixels at octave 0
constexpr double kOwnRadius = 25;     // pixels: how near own points tell the depth of the picture
constexpr double kDepthRatio = 1.15;
constexpr std::uint64_t kFewestPoints = 30;  // that a view must see to count
constexpr int kColumns = 3, kRows = 2;
constexpr std::uint64_t kFewestInCell = 10;

struct Cell {
  std::uint64_t visible = 0, found = 0;
  bool has_found() const { return found >= 2 && 10 * found >= visible; }
};

class Picture {
 public:
  Picture(const MapViews& map, std::uint32_t view) : map_(map), number_(view), view_(map.views()[view]) {}

  SeenShare LookFor(const MapViews& other, std::span<const std::uint32_t> points,
                    const Similarity3d& map_from_points) const {
    SeenShare share;
    std::array<Cell, kColumns * kRows> cells{};
    for (const std::uint32_t row : points) {
      const ViewedPoint& point = other.points()[row];
      const auto expected = Expect(view_, point, map_from_points, kLeastCosine);
      if (!expected) continue;
      const double own = OwnDepth(expected->pixel);
      if (own > 0 && expected->depth > own * kDepthRatio) continue;  // hidden
      if (own > 0 && expected->depth * kDepthRatio < own) ++share.in_front;
      const bool found = FindNear(view_, *expected, *point.descriptor, kRadius, kMostBits).has_value();
      Cell& cell = cells[CellOf(expected->pixel)];
      ++cell.visible;
      cell.found += found ? 1 : 0;
      ++share.visible;
      share.found += found ? 1 : 0;
    }
    if (share.visible < kFewestPoints) return {};
    share.views = 1;
    share.agreeing_views = 5 * share.found >= share.visible ? 1 : 0;
    for (const Cell& cell : cells) {
      if (cell.visible < kFewestInCell) continue;
      ++share.cells;
      share.found_cells += cell.has_found() ? 1 : 0;
    }
    return share;
  }

 private:
  // The depth of the nearest of the map's own points about a place of the picture; 0 where there are none.
  double OwnDepth(const Eigen::Vector2d& pixel) const {
    double nearest = 0;
    double least = kOwnRadius * kOwnRadius;
    view_.cells.VisitNear(pixel, kOwnRadius, [&](std::uint32_t row) {
      const std::uint32_t point = map_.PointAt({number_, row});
      if (point == kNoRow) return;
      const Eigen::Vector2d place(static_cast<double>(view_.keypoints[row].x),
                                  static_cast<double>(view_.keypoints[row].y));
      const double distance = (place - pixel).squaredNorm();
      if (distance >= least) return;
      least = distance;
      nearest = view_.CameraFromWorld(map_.points()[point].position).z();
    });
    return nearest;
  }

  std::size_t CellOf(const Eigen::Vector2d& pixel) const {
    const Eigen::Array2d place = (pixel - view_.frame.min()).array() / view_.frame.sizes().array();
    const int column = std::clamp(static_cast<int>(place.x() * kColumns), 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>(place.y() * kRows), 0, kRows - 1);
    return static_cast<std::size_t>(row * kColumns + column);
  }

  const MapViews& map_;
  const std::uint32_t number_;
  const View& view_;
};

}  // namespace

SeenShare LookFor(const MapViews& points, const MapViews& pictures, const Similarity3d& map_from_points, int threads) {
  std::vector<std::uint32_t> all(points.points().size()), views;
  std::iota(all.begin(), all.end(), 0U);
  const std::size_t step = pictures.views().size() / kMostViews + 1;
  for (std::size_t view = 0; view < pictures.views().size(); view += step)
    views.push_back(static_cast<std::uint32_t>(view));
  return LookFor(points, all, pictures, views, map_from_points, threads);
}

SeenShare LookFor(const MapViews& points, std::span<const std::uint32_t> some_points, const MapViews& pictures,
                  std::span<const std::uint32_t> some_views, const Similarity3d& map_from_points, int threads) {
  std::vector<SeenShare> shares(some_views.size());
  ParallelFor(shares.size(), 4, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      shares[i] = Picture(pictures, some_views[i]).LookFor(points, some_points, map_from_points);
  });
  SeenShare sum;
  for (const SeenShare& share : shares) {
    sum.views += share.views;
    sum.agreeing_views += share.agreeing_views;
    sum.visible += share.visible;
    sum.found += share.found;
    sum.cells += share.cells;
    sum.found_cells += share.found_cells;
    sum.in_front += share.in_front;
  }
  return sum;
}

}  // namespace slamdb::detail
