// SPDX-License-Identifier: BSD-3-Clause
// In place of canvas.cc where Cairo is not there.
#include "slamdb/base/error.h"
#include "slamdb/plot/detail/canvas.h"

namespace slamdb::plot {

bool CanDraw() { return false; }

struct Canvas::State {};

Canvas::Canvas(double, double, PlotFormat, double) {
  throw Error(ErrorKind::kUnsupported,
              "this slamdb was built without Cairo, which draws its plots: install libcairo2-dev and build it again");
}
Canvas::~Canvas() = default;
void Canvas::Fill(const Box&, const Color&) {}
void Canvas::Outline(const Box&, const Color&, double) {}
void Canvas::Line(const Spot&, const Spot&, const Color&, double, double) {}
void Canvas::Lines(const Segments&, const Color&, double) {}
void Canvas::Path(std::span<const Spot>, const Color&, double) {}
void Canvas::Dots(std::span<const Spot>, double, const Color&) {}
void Canvas::Ring(const Spot&, double, const Color&, double) {}
void Canvas::Text(const Spot&, std::string_view, const TextStyle&) {}
double Canvas::WidthOf(std::string_view, const TextStyle&) { return 0; }
void Canvas::Image(const Box&, Raster&) {}
Canvas::Clip::Clip(Canvas& canvas, const Box&) : canvas_(canvas) {}
Canvas::Clip::~Clip() { static_cast<void>(canvas_); }
std::string Canvas::Finish(std::string_view, std::string_view, std::string_view) { return {}; }

}  // namespace slamdb::plot
