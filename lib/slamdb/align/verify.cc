// SPDX-License-Identifier: BSD-3-Clause
// For each picture: which points of the other map it must see, which of them it finds, and whether these are all over
// the picture or in one patch of it.
#include "slamdb/align/detail/verify.h"

#include <algorithm>
#include <vector>

#include "slamdb/align/detail/match_points.h"
#include "slamdb/align/detail/visibility.h"
#include "slamdb/base/detail/parallel.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kMostViews = 400;
constexpr double kLeastCosine = 0.8;  // 37 degrees from where a point was seen: descriptors stand that
constexpr double kRadius = 4;         // pixels at octave 0
constexpr double kOwnRadius = 25;     // pixels: how near own points tell the depth of the picture
constexpr double kDepthRatio = 1.15;
constexpr std::uint64_t kFewestPoints = 30;  // that a view must see to count
constexpr std::uint64_t kFewestInCell = 10;

struct Cell {
  std::uint64_t visible = 0, found = 0;
  bool has_found() const { return found >= 2 && 10 * found >= visible; }
};

class Picture {
 public:
  Picture(const View& view, std::span<const double> depths, PictureCells cells)
      : view_(view), depths_(depths), cells_(cells) {}

  SeenShare LookFor(const KnownMap& known, const Similarity3d& map_from_points) const {
    SeenShare share;
    std::vector<Cell> cells(static_cast<std::size_t>(cells_.count()));
    for (const PointGroup& group : known.views().groups()) {
      if (IsOutOfSight(view_, group, map_from_points)) continue;
      for (const std::uint32_t point : group.points)
        if (const Descriptor* descriptor = known.DescriptorOf(point))
          Look(known.views().points()[point], *descriptor, map_from_points, share, cells);
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
  // One point: whether it must be seen, and is.
  void Look(const ViewedPoint& point, const Descriptor& descriptor, const Similarity3d& map_from_points,
            SeenShare& share, std::span<Cell> cells) const {
    const auto expected = Expect(view_, point, map_from_points, kLeastCosine);
    if (!expected) return;
    const double own = OwnDepth(expected->pixel);
    if (own > 0 && expected->depth > own * kDepthRatio) return;  // hidden
    if (own > 0 && expected->depth * kDepthRatio < own) ++share.in_front;
    const bool found = FindNear(view_, *expected, descriptor, kRadius, kMostBits).has_value();
    Cell& cell = cells[CellOf(expected->pixel)];
    ++cell.visible;
    cell.found += found ? 1 : 0;
    ++share.visible;
    share.found += found ? 1 : 0;
  }

  // The depth of the nearest keypoint about a place of the picture whose depth is known; 0 where there are none.
  double OwnDepth(const Eigen::Vector2d& pixel) const {
    double nearest = 0;
    double least = kOwnRadius * kOwnRadius;
    view_.cells.VisitNear(pixel, kOwnRadius, [&](std::uint32_t row) {
      if (depths_[row] == 0) return;
      const Eigen::Vector2d place(static_cast<double>(view_.keypoints[row].x),
                                  static_cast<double>(view_.keypoints[row].y));
      const double distance = (place - pixel).squaredNorm();
      if (distance >= least) return;
      least = distance;
      nearest = depths_[row];
    });
    return nearest;
  }

  std::size_t CellOf(const Eigen::Vector2d& pixel) const {
    const Eigen::Array2d place = (pixel - view_.frame.min()).array() / view_.frame.sizes().array();
    const int column = std::clamp(static_cast<int>(place.x() * cells_.columns), 0, cells_.columns - 1);
    const int row = std::clamp(static_cast<int>(place.y() * cells_.rows), 0, cells_.rows - 1);
    return static_cast<std::size_t>(row * cells_.columns + column);
  }

  const View& view_;
  const std::span<const double> depths_;
  const PictureCells cells_;
};

// By keypoint, of the map's own points; 0 where it is none.
std::vector<double> DepthsOf(const MapViews& map, std::uint32_t view) {
  std::vector<double> depths(map.views()[view].keypoints.size(), 0);
  for (const Seen& seen : map.SeenBy(view))
    depths[seen.keypoint] = map.views()[view].CameraFromWorld(map.points()[seen.point].position).z();
  return depths;
}

}  // namespace

SeenShare LookFrom(const View& view, std::span<const double> depths, const KnownMap& points,
                   const Similarity3d& map_from_points, PictureCells cells) {
  return Picture(view, depths, cells).LookFor(points, map_from_points);
}

SeenShare LookFor(const MapViews& points, const MapViews& pictures, const Similarity3d& map_from_points, int threads) {
  const std::size_t step = pictures.views().size() / kMostViews + 1;
  std::vector<SeenShare> shares((pictures.views().size() + step - 1) / step);
  ParallelFor(shares.size(), 4, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto view = static_cast<std::uint32_t>(i * step);
      shares[i] = LookFrom(pictures.views()[view], DepthsOf(pictures, view), points, map_from_points);
    }
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
