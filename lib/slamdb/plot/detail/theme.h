// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/ids.h"

// Colours that people tell apart who see red and green alike. What they mean of a map is model/colors.h's.
namespace slamdb::plot {

struct Color {
  double red = 0, green = 0, blue = 0, alpha = 1;

  Color WithAlpha(double value) const { return {red, green, blue, value}; }
  friend bool operator==(const Color&, const Color&) = default;
};

// a + share (b - a).
Color Mixed(const Color& a, const Color& b, double share);

// The colours of everything that is no data, and of what has one meaning in all plots.
struct Theme {
  Color paper, ink, faint_ink, grid, points;
  Color loop, merge, start, end, reference, mark;

  static const Theme& Light();
  static const Theme& Dark();
};

// As slamdb::ColorOfMap; lighter on a dark page.
Color ColorOfMap(MapId id, bool dark);

// As slamdb::ColorOfShare, of an amount from 0 to 1.
Color ColorOfAmount(double amount);

// In how many steps amounts are shown: pictures of few colours are small files.
inline constexpr int kAmountSteps = 32;
// The middle of the step that an amount from 0 to 1 falls into; 0 for what is not a number.
double StepOfAmount(double amount);

}  // namespace slamdb::plot
