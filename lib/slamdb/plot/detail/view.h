// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "slamdb/plot/detail/axis.h"
#include "slamdb/plot/detail/scene.h"

// Plan and side view: where on the page a place of a map comes to lie.
namespace slamdb::plot {

enum class View { kPlan, kSide };

// A part of the page with the same pixels to a metre in all directions, and the maps that are drawn in it.
struct Cell {
  Box box;
  double scale = 1;                  // pixels to a metre, or map unit
  Eigen::Vector2d middle = {0, 0};   // metres, at the middle of the box
  std::vector<std::size_t> maps;     // places in Scene::maps
  Eigen::Matrix<double, 2, 3> axes;  // metres on the page from the world, of the first map

  Spot operator()(const Eigen::Vector3d& world) const {
    const Eigen::Vector2d at = axes * world - middle;
    return box.center() + Spot(scale * at.x(), -scale * at.y());
  }
};

// The largest cell in a box that shows these ranges with some air around them.
Cell FitCell(const Box& box, Range right, Range up, const Eigen::Matrix<double, 2, 3>& axes);

// Lays the cells of a view into a box: one, or one for each map, all of one scale.
enum class Shown { kAll, kPaths };
std::vector<Cell> LayCells(const Scene& scene, View view, const Box& box, Shown shown = Shown::kAll);

// The height that lets a view of that width show everything without much empty space.
double HeightOfView(const Scene& scene, View view, double width);

// What is drawn of it: all, or points and paths without words, grid and axes.
enum class Detail { kAll, kBare };
struct ViewCounts {
  std::size_t points = 0, left_out = 0;
};
ViewCounts DrawView(Canvas& canvas, const Scene& scene, View view, const Box& box, Detail detail = Detail::kAll);

// What stands around a cell: grid, ticks and names of axes when it is the only one, the name of its map otherwise.
void DrawFrameOfCell(Canvas& canvas, const Scene& scene, View view, const Cell& cell);

// Where a trajectory begins and where it ends, and the legend of that.
void DrawEnds(Canvas& canvas, const Theme& theme, const Spot& start, const Spot& end);
Legend LegendOfEnds(const Theme& theme);

void DrawMetricFrame(Canvas& canvas, const Theme& theme, const Cell& cell, const std::array<std::string, 2>& names);
// In the corner where it covers the fewest of the busy places.
void DrawScaleBar(Canvas& canvas, const Theme& theme, const Cell& cell, std::span<const Spot> busy,
                  const std::string& unit);

// The range that most of the values are in: without those so far off that nothing else could be seen. Sorts them.
Range RangeOfMost(std::vector<double>& values);

}  // namespace slamdb::plot
