// SPDX-License-Identifier: BSD-3-Clause
// What a first look should see of an atlas.
#include "slamdb/plot/detail/panels.h"
#include "slamdb/plot/detail/view.h"

namespace slamdb::plot {
namespace {

constexpr double kGap = 18, kSmallPanel = 230;

}  // namespace

double HeightOfOverview(const Scene& scene, double width) {
  return HeightOfView(scene, View::kPlan, width) + HeightOfView(scene, View::kSide, width) + kSmallPanel +
         HeightOfTimeline(scene) + 3 * kGap;
}

void DrawOverview(Canvas& canvas, const Scene& scene, const Box& box) {
  double top = box.top;
  for (const View view : {View::kPlan, View::kSide}) {
    const double height = HeightOfView(scene, view, box.width);
    DrawView(canvas, scene, view, {box.left, top, box.width, height});
    top += height + kGap;
  }
  const double width = (box.width - 2 * kGap) / 3;
  DrawTracks(canvas, scene, {box.left, top, width, kSmallPanel});
  DrawReprojectionHistogram(canvas, scene, ErrorsOf(scene), {box.left + width + kGap, top, width, kSmallPanel});
  DrawCovisibility(canvas, scene, {box.left + 2 * (width + kGap), top, width, kSmallPanel});
  DrawTimeline(canvas, scene, {box.left, top + kSmallPanel + kGap, box.width, HeightOfTimeline(scene)});
}

}  // namespace slamdb::plot
