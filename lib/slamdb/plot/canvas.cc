// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/detail/canvas.h"

#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/base/error.h"
#include "slamdb/plot/detail/svg.h"

namespace slamdb::plot {
namespace {

// Cairo counts in 1/256 pixel with 32 bits.
constexpr double kFarthest = 50000;

// On every Debian that has Cairo, by way of fontconfig; others have something like it.
constexpr const char* kFont = "DejaVu Sans";

cairo_status_t Append(void* out, const unsigned char* bytes, unsigned length) {
  static_cast<std::string*>(out)->append(reinterpret_cast<const char*>(bytes), length);
  return CAIRO_STATUS_SUCCESS;
}

void Require(cairo_status_t status) {
  if (status == CAIRO_STATUS_SUCCESS) return;
  throw Error(status == CAIRO_STATUS_NO_MEMORY ? ErrorKind::kOutOfResources : ErrorKind::kInternal,
              detail::Concat("cannot be drawn: Cairo says ", cairo_status_to_string(status)));
}

bool IsPlace(const Spot& spot) { return spot.allFinite(); }

double Near(double value) { return std::clamp(value, -kFarthest, kFarthest); }

}  // namespace

bool CanDraw() { return true; }

struct Canvas::State {
  std::string bytes;
  PlotFormat format = PlotFormat::kSvg;
  cairo_surface_t* surface = nullptr;
  cairo_t* cairo = nullptr;

  void Use(const Color& color) const { cairo_set_source_rgba(cairo, color.red, color.green, color.blue, color.alpha); }
  void Stroke(const Color& color, double width) const {
    Use(color);
    cairo_set_line_width(cairo, width);
    cairo_stroke(cairo);
  }
  void MoveTo(const Spot& spot) const { cairo_move_to(cairo, Near(spot.x()), Near(spot.y())); }
  void LineTo(const Spot& spot) const { cairo_line_to(cairo, Near(spot.x()), Near(spot.y())); }
  void Font(const TextStyle& style) const {
    cairo_select_font_face(cairo, kFont, CAIRO_FONT_SLANT_NORMAL,
                           style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, style.size);
  }
};

Canvas::Canvas(double width, double height, PlotFormat format, double scale) : state_(std::make_unique<State>()) {
  state_->format = format;
  if (format == PlotFormat::kSvg) {
    state_->surface = cairo_svg_surface_create_for_stream(Append, &state_->bytes, width, height);
    cairo_svg_surface_set_document_unit(state_->surface, CAIRO_SVG_UNIT_PX);
  } else {
    state_->surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, static_cast<int>(std::lround(width * scale)),
                                                 static_cast<int>(std::lround(height * scale)));
  }
  state_->cairo = cairo_create(state_->surface);
  if (format == PlotFormat::kPng) cairo_scale(state_->cairo, scale, scale);
  // Shapes of letters do not depend on the screen that fontconfig was set up for.
  cairo_font_options_t* font = cairo_font_options_create();
  cairo_font_options_set_antialias(font, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(font, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(font, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(state_->cairo, font);
  cairo_font_options_destroy(font);
  cairo_set_line_join(state_->cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(state_->cairo, CAIRO_LINE_CAP_ROUND);
}

Canvas::~Canvas() {
  cairo_destroy(state_->cairo);
  cairo_surface_destroy(state_->surface);
}

void Canvas::Fill(const Box& box, const Color& color) {
  state_->Use(color);
  cairo_rectangle(state_->cairo, box.left, box.top, box.width, box.height);
  cairo_fill(state_->cairo);
}

void Canvas::Outline(const Box& box, const Color& color, double width) {
  cairo_rectangle(state_->cairo, box.left, box.top, box.width, box.height);
  state_->Stroke(color, width);
}

void Canvas::Line(const Spot& from, const Spot& to, const Color& color, double width, double dash) {
  if (!IsPlace(from) || !IsPlace(to)) return;
  if (dash > 0) cairo_set_dash(state_->cairo, &dash, 1, 0);
  state_->MoveTo(from);
  state_->LineTo(to);
  state_->Stroke(color, width);
  cairo_set_dash(state_->cairo, nullptr, 0, 0);
}

void Canvas::Lines(const Segments& segments, const Color& color, double width) {
  for (const auto& [from, to] : segments) {
    if (!IsPlace(from) || !IsPlace(to)) continue;
    state_->MoveTo(from);
    state_->LineTo(to);
  }
  state_->Stroke(color, width);
}

void Canvas::Path(std::span<const Spot> spots, const Color& color, double width) {
  constexpr double kInvisible = 0.3;  // pixels: what is nearer to the last place adds bytes and nothing to see
  const Spot* last = nullptr;
  for (std::size_t i = 0; i < spots.size(); ++i) {
    if (!IsPlace(spots[i])) continue;
    if (last == nullptr) {
      state_->MoveTo(spots[i]);
    } else {
      if (i + 1 < spots.size() && (spots[i] - *last).norm() < kInvisible) continue;
      state_->LineTo(spots[i]);
    }
    last = &spots[i];
  }
  state_->Stroke(color, width);
}

void Canvas::Dots(std::span<const Spot> centers, double diameter, const Color& color) {
  for (const Spot& center : centers) {
    if (!IsPlace(center)) continue;
    state_->MoveTo(center);
    cairo_close_path(
        state_->cairo);  // a stroke of no length with round ends is a dot, and the shortest way to write it
  }
  state_->Stroke(color, diameter);
}

void Canvas::Ring(const Spot& center, double diameter, const Color& color, double width) {
  if (!IsPlace(center)) return;
  cairo_new_sub_path(state_->cairo);
  cairo_arc(state_->cairo, Near(center.x()), Near(center.y()), diameter / 2, 0, 2 * std::numbers::pi);
  state_->Stroke(color, width);
}

double Canvas::WidthOf(std::string_view text, const TextStyle& style) {
  state_->Font(style);
  cairo_text_extents_t extents{};
  cairo_text_extents(state_->cairo, detail::Visible(text).c_str(), &extents);
  return extents.x_advance;
}

void Canvas::Text(const Spot& at, std::string_view text, const TextStyle& style) {
  const double width = style.anchor == Anchor::kStart ? 0 : WidthOf(text, style);
  const double shift = style.anchor == Anchor::kMiddle ? width / 2 : width;
  cairo_save(state_->cairo);
  cairo_translate(state_->cairo, at.x(), at.y());
  if (style.upward) cairo_rotate(state_->cairo, -std::numbers::pi / 2);
  state_->Font(style);
  state_->Use(style.color);
  cairo_move_to(state_->cairo, -shift, 0);
  cairo_show_text(state_->cairo, detail::Visible(text).c_str());
  cairo_restore(state_->cairo);
  cairo_new_path(state_->cairo);
}

void Canvas::Image(const Box& box, Raster& raster) {
  if (raster.width() == 0 || raster.height() == 0) return;
  const auto width = static_cast<int>(raster.width()), height = static_cast<int>(raster.height());
  cairo_surface_t* image = cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(raster.pixels().data()),
                                                               CAIRO_FORMAT_ARGB32, width, height, 4 * width);
  Require(cairo_surface_status(image));
  cairo_save(state_->cairo);
  cairo_translate(state_->cairo, box.left, box.top);
  cairo_scale(state_->cairo, box.width / width, box.height / height);
  cairo_set_source_surface(state_->cairo, image, 0, 0);
  cairo_paint(state_->cairo);
  cairo_restore(state_->cairo);
  if (state_->format == PlotFormat::kSvg) cairo_surface_flush(state_->surface);
  cairo_surface_destroy(image);
}

Canvas::Clip::Clip(Canvas& canvas, const Box& box) : canvas_(canvas) {
  cairo_save(canvas_.state_->cairo);
  cairo_rectangle(canvas_.state_->cairo, box.left, box.top, box.width, box.height);
  cairo_clip(canvas_.state_->cairo);
}

Canvas::Clip::~Clip() { cairo_restore(canvas_.state_->cairo); }

std::string Canvas::Finish(std::string_view name, std::string_view title, std::string_view description) {
  Require(cairo_status(state_->cairo));
  if (state_->format == PlotFormat::kPng) {
    cairo_surface_flush(state_->surface);
    Require(cairo_surface_write_to_png_stream(state_->surface, Append, &state_->bytes));
    return std::move(state_->bytes);
  }
  cairo_surface_finish(state_->surface);
  Require(cairo_surface_status(state_->surface));
  return TidySvg(state_->bytes, name, title, description);
}

}  // namespace slamdb::plot
