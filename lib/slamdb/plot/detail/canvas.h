// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slamdb/plot/detail/geometry.h"
#include "slamdb/plot/detail/theme.h"
#include "slamdb/plot/plot.h"

namespace slamdb::plot {

// A picture of pixels, row after row from the top.
class Raster {
 public:
  Raster(std::size_t width, std::size_t height) : width_(width), height_(height), pixels_(width * height, 0) {}

  std::size_t width() const { return width_; }
  std::size_t height() const { return height_; }
  void Set(std::size_t column, std::size_t row, const Color& color);
  // 0xAARRGGBB, multiplied by alpha.
  std::span<std::uint32_t> pixels() { return pixels_; }

 private:
  std::size_t width_, height_;
  std::vector<std::uint32_t> pixels_;
};

enum class Anchor { kStart, kMiddle, kEnd };

struct TextStyle {
  Color color;
  double size = 11;
  bool bold = false;
  Anchor anchor = Anchor::kStart;
  bool upward = false;  // turned by a quarter, for the names of y axes
};

// Whether there is a library to draw with.
bool CanDraw();

using Segments = std::vector<std::pair<Spot, Spot>>;

// What is drawn on: one page of SVG, or of pixels. The only place that knows Cairo.
// Places that are far off the page are pulled near it; what is not a number is left out.
class Canvas {
 public:
  // Throws Error (kUnsupported) when slamdb was built without Cairo.
  Canvas(double width, double height, PlotFormat format, double scale);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  void Fill(const Box& box, const Color& color);
  void Outline(const Box& box, const Color& color, double width = 1);
  void Line(const Spot& from, const Spot& to, const Color& color, double width = 1, double dash = 0);
  void Lines(const Segments& segments, const Color& color, double width = 1);
  void Path(std::span<const Spot> spots, const Color& color, double width);  // one line through all of them
  void Dots(std::span<const Spot> centers, double diameter, const Color& color);
  void Ring(const Spot& center, double diameter, const Color& color, double width);
  // On the line through `at`, which is the foot of its letters.
  void Text(const Spot& at, std::string_view text, const TextStyle& style);
  double WidthOf(std::string_view text, const TextStyle& style);
  void Image(const Box& box, Raster& raster);
  // What is drawn until the end of the guard is cut off at the box.
  class [[nodiscard]] Clip {
   public:
    Clip(Canvas& canvas, const Box& box);
    ~Clip();
    Clip(const Clip&) = delete;
    Clip& operator=(const Clip&) = delete;

   private:
    Canvas& canvas_;
  };

  // The file. Only SVG holds these: `name` in front of its ids, title and description for those who cannot see it.
  std::string Finish(std::string_view name, std::string_view title, std::string_view description);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slamdb::plot
