// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "slamdb/plot/detail/canvas.h"

// Scales with their ticks, and the frame of a diagram.
namespace slamdb::plot {

struct Range {
  double low = 0, high = 1;
  double size() const { return high - low; }
};

// 1, 2 or 5 times a power of ten: the smallest that is at least `least`. 1 for what is not a positive number.
double NiceStep(double least);

struct Tick {
  double value;
  std::string label;  // `12,000`, `0.25`
};

// The multiples of the step inside the range; none when that would be more than a page has room for.
std::vector<Tick> TicksOf(const Range& range, double step);

// From values to pixels, straight; the range may stand on its head.
struct Scale {
  Range values, pixels;
  double operator()(double value) const {
    return pixels.low + (value - values.low) * (pixels.high - pixels.low) / values.size();
  }
};

// How letters are set, everywhere.
struct Letters {
  const Theme& theme;
  TextStyle Tick(Anchor anchor) const { return {.color = theme.faint_ink, .size = 11, .anchor = anchor}; }
  TextStyle Label(Anchor anchor) const { return {.color = theme.ink, .size = 11, .anchor = anchor}; }
  TextStyle Heading() const { return {.color = theme.ink, .size = 12, .bold = true}; }
};

inline constexpr double kHeadingHeight = 24;               // above a panel
inline constexpr double kTickSpace = 17, kNameSpace = 17;  // below the x axis
inline constexpr double kYTickSpace = 60;                  // left of the y axis

// What a sign means: the word, and what draws the sign in the middle of a square of 14 pixels.
struct LegendEntry {
  std::string word;
  std::function<void(Canvas& canvas, const Spot& middle)> draw;
};
using Legend = std::vector<LegendEntry>;
LegendEntry LineEntry(const std::string& word, const Color& color);

// At the top of the box `heading` in bold, the remark behind it, and the legend at the right. Where there is no room
// for all, the end of the legend becomes an ellipsis, and the remark is left out.
void DrawHeading(Canvas& canvas, const Theme& theme, const Box& box, const std::string& heading,
                 const std::string& remark, const Legend& legend = {});

// A diagram with a heading above, ticks and names at its axes; what is left inside is `inside`.
struct Diagram {
  Box inside;
  Scale x, y;

  Spot operator()(double at_x, double at_y) const { return {x(at_x), y(at_y)}; }
};
struct DiagramText {
  std::string heading, remark, x_name, y_name;
  Legend legend;
};
Diagram DrawDiagram(Canvas& canvas, const Theme& theme, const Box& box, const Range& x, const Range& y,
                    const DiagramText& text);

// Below the box, and upward at its left.
void DrawAxisNames(Canvas& canvas, const Theme& theme, const Box& inside, const std::string& x, const std::string& y);

// A bar of the colours of amounts with its range at the ends and its name between them, along the bottom of the box.
void DrawColorBar(Canvas& canvas, const Theme& theme, const Box& box, const std::string& low, const std::string& high,
                  const std::string& name);

}  // namespace slamdb::plot
