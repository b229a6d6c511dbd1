// SPDX-License-Identifier: BSD-3-Clause
// What a first look should see of an atlas: plan and side, then what there is to show of its observations, as many
// beside each other as the page has room for, and its keyframes over time.
#include <algorithm>

#include "slamdb/plot/detail/panels.h"
#include "slamdb/plot/detail/view.h"

namespace slamdb::plot {
namespace {

constexpr double kGap = 18, kSmallPanel = 230, kLeastWidth = 215;

using Draw = void (*)(Canvas& canvas, const Scene& scene, const Box& box);

void DrawErrors(Canvas& canvas, const Scene& scene, const Box& box) {
  DrawReprojectionHistogram(canvas, scene, scene.errors(), box);
}

// Without those that would be empty, as of a trajectory.
std::vector<Draw> SmallPanels(const Scene& scene) {
  const auto any = [&](auto list, auto has) {
    return std::ranges::any_of(scene.maps,
                               [&](const MapScene& map) { return std::ranges::any_of(map.map->*list, has); });
  };
  std::vector<Draw> panels;
  if (any(&Map::points, [](const MapPoint& point) { return !point.bad; })) panels.push_back(DrawTracks);
  if (!scene.errors().samples.empty()) panels.push_back(DrawErrors);
  if (any(&Map::keyframes, [](const KeyFrame& keyframe) { return !keyframe.bad && !keyframe.connections.empty(); }))
    panels.push_back(DrawCovisibility);
  return panels;
}

std::size_t ColumnsOf(double width) {
  return std::max<std::size_t>(1, static_cast<std::size_t>((width + kGap) / (kLeastWidth + kGap)));
}

std::size_t RowsOf(std::size_t panels, double width) { return (panels + ColumnsOf(width) - 1) / ColumnsOf(width); }

void DrawSmallPanels(Canvas& canvas, const Scene& scene, const std::vector<Draw>& panels, const Box& box) {
  const std::size_t rows = RowsOf(panels.size(), box.width);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t begin = row * panels.size() / rows, end = (row + 1) * panels.size() / rows;
    const auto count = static_cast<double>(end - begin);
    const double width = (box.width - (count - 1) * kGap) / count;
    const double top = box.top + static_cast<double>(row) * (kSmallPanel + kGap);
    for (std::size_t i = begin; i < end; ++i)
      panels[i](canvas, scene, {box.left + static_cast<double>(i - begin) * (width + kGap), top, width, kSmallPanel});
  }
}

double HeightOfSmallPanels(const Scene& scene, double width) {
  return static_cast<double>(RowsOf(SmallPanels(scene).size(), width)) * (kSmallPanel + kGap);
}

}  // namespace

double HeightOfOverview(const Scene& scene, double width) {
  return HeightOfView(scene, View::kPlan, width) + HeightOfView(scene, View::kSide, width) + 2 * kGap +
         HeightOfSmallPanels(scene, width) + HeightOfTimeline(scene);
}

ViewCounts DrawOverview(Canvas& canvas, const Scene& scene, const Box& box) {
  ViewCounts counts;
  double top = box.top;
  for (const View view : {View::kPlan, View::kSide}) {
    const double height = HeightOfView(scene, view, box.width);
    const ViewCounts drawn = DrawView(canvas, scene, view, {box.left, top, box.width, height});
    if (view == View::kPlan) counts = drawn;
    top += height + kGap;
  }
  DrawSmallPanels(canvas, scene, SmallPanels(scene), {box.left, top, box.width, 0});
  top += HeightOfSmallPanels(scene, box.width);
  DrawTimeline(canvas, scene, {box.left, top, box.width, HeightOfTimeline(scene)});
  return counts;
}

}  // namespace slamdb::plot
