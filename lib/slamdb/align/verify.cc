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

// One picture, to which points are shown one by one.
class Picture {
 public:
  Picture(const View& view, std::span<const double> depths, const Similarity3d& map_from_points, PictureCells divided)
      : view_(view),
        depths_(depths),
        map_from_points_(map_from_points),
        divided_(divided),
        cells_(static_cast<std::size_t>(divided.count())) {}

  // Whether the point must be seen, and is.
  void LookFor(const ViewedPoint& point, const Descriptor& descriptor) {
    const auto expected = Expect(view_, point, map_from_points_, kLeastCosine);
    if (!expected) return;
    const double own = OwnDepth(expected->pixel);
    if (own > 0 && expected->depth > own * kDepthRatio) return;  // hidden
    if (own > 0 && expected->depth * kDepthRatio < own) ++share_.in_front;
    const bool found = FindNear(view_, *expected, descriptor, kRadius, kMostBits).has_value();
    Cell& cell = cells_[CellOf(expected->pixel)];
    ++cell.visible;
    cell.found += found ? 1 : 0;
    ++share_.visible;
    share_.found += found ? 1 : 0;
  }

  // Nothing, if it should see too few.
  SeenShare Share() const {
    if (share_.visible < kFewestPoints) return {};
    SeenShare share = share_;
    share.views = 1;
    share.agreeing_views = 5 * share.found >= share.visible ? 1 : 0;
    for (const Cell& cell : cells_) {
      if (cell.visible < kFewestInCell) continue;
      ++share.cells;
      share.found_cells += cell.has_found() ? 1 : 0;
    }
    return share;
  }

 private:
  // The depth of the nearest keypoint about a place of the picture whose depth is known; 0 where there are none.
  double OwnDepth(const Eigen::Vector2d& pixel) const {
    double nearest = 0;
    double least = kOwnRadius * kOwnRadius;
    view_.cells.VisitNear(pixel, kOwnRadius, [&](std::uint32_t row) {
      if (depths_[row] == 0) return;
      const double distance = (PixelOf(view_.keypoints[row]) - pixel).squaredNorm();
      if (distance >= least) return;
      least = distance;
      nearest = depths_[row];
    });
    return nearest;
  }

  std::size_t CellOf(const Eigen::Vector2d& pixel) const {
    const Eigen::Array2d place = (pixel - view_.frame.min()).array() / view_.frame.sizes().array();
    const int column = std::clamp(static_cast<int>(place.x() * divided_.columns), 0, divided_.columns - 1);
    const int row = std::clamp(static_cast<int>(place.y() * divided_.rows), 0, divided_.rows - 1);
    return static_cast<std::size_t>(row * divided_.columns + column);
  }

  const View& view_;
  const std::span<const double> depths_;
  const Similarity3d& map_from_points_;
  const PictureCells divided_;
  std::vector<Cell> cells_;
  SeenShare share_;
};

// By keypoint, of the map's own points; 0 where it is none.
std::vector<double> DepthsOf(const MapViews& map, std::uint32_t view) {
  std::vector<double> depths(map.views()[view].keypoints.size(), 0);
  for (const Seen& seen : map.SeenBy(view))
    depths[seen.keypoint] = map.views()[view].CameraFromWorld(map.points()[seen.point].position).z();
  return depths;
}

SeenShare Sum(std::span<const SeenShare> shares) {
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

// The sum of share_of(view) over some views.
template <class ShareOf>
SeenShare SumOver(std::size_t views, int threads, const ShareOf& share_of) {
  std::vector<SeenShare> shares(views);
  ParallelFor(views, 4, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) shares[i] = share_of(i);
  });
  return Sum(shares);
}

}  // namespace

SeenShare LookFrom(const View& view, std::span<const double> depths, const KnownMap& points,
                   const Similarity3d& map_from_points, PictureCells cells) {
  Picture picture(view, depths, map_from_points, cells);
  for (const PointGroup& group : points.views().groups()) {
    if (IsOutOfSight(view, group, map_from_points)) continue;
    for (const std::uint32_t row : group.points)
      if (const Descriptor* descriptor = points.DescriptorOf(row))
        picture.LookFor(points.views().points()[row], *descriptor);
  }
  return picture.Share();
}

SeenShare LookFor(const MapViews& points, const MapViews& pictures, const Similarity3d& map_from_points, int threads) {
  const std::size_t step = pictures.views().size() / kMostViews + 1;
  return SumOver((pictures.views().size() + step - 1) / step, threads, [&](std::size_t i) {
    const auto view = static_cast<std::uint32_t>(i * step);
    return LookFrom(pictures.views()[view], DepthsOf(pictures, view), points, map_from_points);
  });
}

SeenShare LookFor(const MapViews& points, std::span<const std::uint32_t> some_points, const MapViews& pictures,
                  std::span<const std::uint32_t> some_views, const Similarity3d& map_from_points, int threads) {
  return SumOver(some_views.size(), threads, [&](std::size_t i) {
    const std::uint32_t view = some_views[i];
    const std::vector<double> depths = DepthsOf(pictures, view);
    Picture picture(pictures.views()[view], depths, map_from_points, {});
    for (const std::uint32_t row : some_points) picture.LookFor(points.points()[row], *points.points()[row].descriptor);
    return picture.Share();
  });
}

}  // namespace slamdb::detail
