// SPDX-License-Identifier: BSD-3-Clause
// 1. The extents of each map on the page: its path, and all points but the few that are far from the rest.
// 2. One cell for all maps, or a row of cells each behind the other, in as many rows as show them largest.
#include <algorithm>
#include <array>
#include <cmath>

#include "slamdb/base/detail/median.h"
#include "slamdb/plot/detail/view.h"

namespace slamdb::plot {
namespace {

constexpr double kGap = 14;          // pixels between cells
constexpr double kCellHeading = 20;  // above each of several cells
constexpr double kAir = 0.06;        // of the extents, around them

struct Extents {
  Range x, y;
};

using Axes = Eigen::Matrix<double, 2, 3>;

Axes AxesOf(const Frame& frame, View view) {
  Axes axes;
  axes << frame.axes_from_world.row(0), frame.axes_from_world.row(view == View::kPlan ? 1 : 2);
  return axes;
}

Range United(const Range& a, const Range& b) { return {std::min(a.low, b.low), std::max(a.high, b.high)}; }

Range Grown(const Range& range, double by) { return {range.low - by, range.high + by}; }

Extents WithAir(const Range& x, const Range& y) {
  const double size = std::max(x.size(), y.size());
  // Everything at one place: a millimetre around it, or what single precision can tell apart there.
  const double least = std::max(kAir * size, 1e-3 * std::max({1.0, std::abs(x.low), std::abs(y.low)}));
  const double air = size > 0 ? kAir * size : least;
  return {Grown(x, air), Grown(y, air)};
}

// Of all points, unless few of them would make the rest small: those stay outside that are far from where most are, or
// stretch what all but a thousandth at each end take.
std::array<Range, 2> RangesOfPoints(const MapScene& map, const Axes& axes) {
  std::array<std::vector<double>, 2> places;
  for (const MapPoint& point : map.map->points) {
    if (point.bad || !point.position.allFinite()) continue;
    const Eigen::Vector2d at = axes * point.position.cast<double>();
    places[0].push_back(at.x());
    places[1].push_back(at.y());
  }
  std::array<Range, 2> ranges{Range{1, 0}, Range{1, 0}};
  if (places[0].empty()) return ranges;
  constexpr double kAround = 1, kRim = 0.05, kStretch = 1.25;  // of where most are, and of all but a thousandth
  for (int i = 0; i < 2; ++i) {
    const auto [low, high] = std::ranges::minmax(places[i]);
    const Range most{detail::QuantileOf(places[i], 0.1), detail::QuantileOf(places[i], 0.9)};
    const Range near = Grown(most, kAround * most.size());
    const Range nearly{std::max(detail::QuantileOf(places[i], 0.001), near.low),
                       std::min(detail::QuantileOf(places[i], 0.999), near.high)};
    const Range within = Grown(nearly, kRim * nearly.size());
    ranges[i] = high - low <= kStretch * nearly.size() ? Range{low, high}
                                                       : Range{std::max(low, within.low), std::min(high, within.high)};
  }
  return ranges;
}

Extents ExtentsOf(const MapScene& map, const Axes& axes, Shown shown) {
  std::array<std::vector<double>, 2> places;
  for (const Stop& stop : map.path) {
    const Eigen::Vector2d at = axes * stop.center;
    places[0].push_back(at.x());
    places[1].push_back(at.y());
  }
  const std::array<Range, 2> none{Range{1, 0}, Range{1, 0}};
  const std::array<Range, 2> points = shown == Shown::kAll ? RangesOfPoints(map, axes) : none;
  std::array<Range, 2> ranges = points;
  if (!map.path.empty()) {
    ranges = {RangeOfMost(places[0]), RangeOfMost(places[1])};
    for (int i = 0; i < 2; ++i)
      if (points[i].size() >= 0) ranges[i] = United(ranges[i], points[i]);
  }
  if (ranges[0].size() < 0) ranges = {Range{-1, 1}, Range{-1, 1}};
  return WithAir(ranges[0], ranges[1]);
}

std::vector<Extents> AllExtents(const Scene& scene, const std::vector<Axes>& axes, Shown shown) {
  std::vector<Extents> extents;
  for (std::size_t i = 0; i < scene.maps.size(); ++i) extents.push_back(ExtentsOf(scene.maps[i], axes[i], shown));
  return extents;
}

// The axes that each map is drawn by: its own, or all by those of the first.
std::vector<Axes> AllAxes(const Scene& scene, View view) {
  std::vector<Axes> axes;
  for (const MapScene& map : scene.maps)
    axes.push_back(AxesOf(scene.options.together ? scene.maps.front().frame : map.frame, view));
  return axes;
}

bool IsOneCell(const Scene& scene) { return scene.maps.size() <= 1 || scene.options.together; }

Extents UnitedExtents(const std::vector<Extents>& extents) {
  if (extents.empty()) return {{-1, 1}, {-1, 1}};
  Extents all = extents.front();
  for (const Extents& one : extents) all = {United(all.x, one.x), United(all.y, one.y)};
  return all;
}

Cell CellOf(const Box& box, double scale, const Extents& extents, const Axes& axes, std::vector<std::size_t> maps) {
  return {.box = box,
          .scale = scale,
          .middle = {(extents.x.low + extents.x.high) / 2, (extents.y.low + extents.y.high) / 2},
          .maps = std::move(maps),
          .axes = axes};
}

struct Rows {
  std::size_t columns = 1;
  double scale = 0;
};

// How many pixels a metre gets in rows of so many cells.
double ScaleOfRows(const std::vector<Extents>& extents, const Box& box, std::size_t columns) {
  double widest = 0, heights = 0, rows = 0;
  for (std::size_t begin = 0; begin < extents.size(); begin += columns, ++rows) {
    double width = 0, height = 0;
    for (std::size_t i = begin; i < std::min(begin + columns, extents.size()); ++i) {
      width += extents[i].x.size();
      height = std::max(height, extents[i].y.size());
    }
    widest = std::max(widest, width);
    heights += height;
  }
  const double free_width = std::max(1.0, box.width - kGap * static_cast<double>(columns - 1));
  const double free_height = std::max(1.0, box.height - kCellHeading * rows - kGap * (rows - 1));
  return std::min(free_width / widest, free_height / heights);
}

Rows BestRows(const std::vector<Extents>& extents, const Box& box) {
  Rows best;
  for (std::size_t columns = 1; columns <= extents.size(); ++columns)
    if (const double scale = ScaleOfRows(extents, box, columns); scale > best.scale) best = {columns, scale};
  return best;
}

std::vector<Cell> CellsInRows(const std::vector<Extents>& extents, const std::vector<Axes>& axes, const Box& box) {
  const Rows rows = BestRows(extents, box);
  std::vector<Cell> cells;
  double top = box.top;
  for (std::size_t begin = 0; begin < extents.size(); begin += rows.columns) {
    const std::size_t end = std::min(begin + rows.columns, extents.size());
    double width = 0, height = 0;
    for (std::size_t i = begin; i < end; ++i) {
      width += rows.scale * extents[i].x.size();
      height = std::max(height, rows.scale * extents[i].y.size());
    }
    // What is left of the width goes to all of the row alike.
    const auto count = static_cast<double>(end - begin);
    const double more = std::max(0.0, (box.width - width - kGap * (count - 1)) / count);
    double left = box.left;
    for (std::size_t i = begin; i < end; ++i) {
      const Box place{left, top + kCellHeading, rows.scale * extents[i].x.size() + more, height};
      cells.push_back(CellOf(place, rows.scale, extents[i], axes[i], {i}));
      left += place.width + kGap;
    }
    top += kCellHeading + height + kGap;
  }
  return cells;
}

}  // namespace

Range RangeOfMost(std::vector<double>& values) {
  if (values.empty()) return {0, 0};
  std::ranges::sort(values);
  const Range all{values.front(), values.back()};
  constexpr std::size_t kEnoughToTell = 5;
  constexpr double kFarOff = 50;
  if (values.size() < kEnoughToTell) return all;
  const Range most{values[values.size() / 10], values[values.size() - 1 - values.size() / 10]};
  if (!(all.size() > kFarOff * most.size())) return all;
  if (most.size() > 0) return Grown(most, most.size());
  return all.size() > 1e4 * std::max(1.0, std::abs(most.low)) ? Grown(most, 1) : all;
}

Cell FitCell(const Box& box, Range right, Range up, const Axes& axes) {
  const Extents all = WithAir(right, up);
  return CellOf(box, std::min(box.width / all.x.size(), box.height / all.y.size()), all, axes, {});
}

std::vector<Cell> LayCells(const Scene& scene, View view, const Box& box, Shown shown) {
  const std::vector<Axes> axes = AllAxes(scene, view);
  const std::vector<Extents> extents = AllExtents(scene, axes, shown);
  if (!IsOneCell(scene)) return CellsInRows(extents, axes, box);
  const Extents all = UnitedExtents(extents);
  std::vector<std::size_t> maps;
  for (std::size_t i = 0; i < scene.maps.size(); ++i) maps.push_back(i);
  const double scale = std::min(box.width / all.x.size(), box.height / all.y.size());
  return {CellOf(box, scale, all, axes.empty() ? AxesOf(Frame(), view) : axes.front(), std::move(maps))};
}

double HeightOfView(const Scene& scene, View view, double width) {
  const double least = view == View::kPlan ? 0.36 : 0.16, most = view == View::kPlan ? 0.75 : 0.34;
  const std::vector<Axes> axes = AllAxes(scene, view);
  const std::vector<Extents> extents = AllExtents(scene, axes, Shown::kAll);
  if (!IsOneCell(scene)) {
    const Box room{0, kHeadingHeight, width, width * (view == View::kPlan ? 0.62 : 0.36)};
    return CellsInRows(extents, axes, room).back().box.bottom() + 1;
  }
  const Extents all = UnitedExtents(extents);
  const double inside = width - kYTickSpace;
  return kHeadingHeight + kTickSpace + kNameSpace + inside * std::clamp(all.y.size() / all.x.size(), least, most);
}

}  // namespace slamdb::plot
