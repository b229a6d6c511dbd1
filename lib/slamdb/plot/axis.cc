// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/detail/axis.h"

#include <algorithm>
#include <cmath>

#include "slamdb/base/detail/concat.h"

namespace slamdb::plot {
namespace {

// A tick's number: as many decimals as the step has, and groups of three digits.
std::string LabelOf(double value, double step) {
  constexpr double kPlain = 1e6, kTiny = 1e-4;
  if (value == 0) return "0";
  if (std::abs(value) >= kPlain || step < kTiny) return detail::Digits(value);
  const int decimals = step >= 1 ? 0 : static_cast<int>(std::ceil(-std::log10(step) - 1e-9));
  if (decimals == 0) {
    const std::string digits = detail::Thousands(static_cast<std::uint64_t>(std::llround(std::abs(value))));
    return value < 0 ? "\u2212" + digits : digits;
  }
  const std::string digits = detail::Fixed(std::abs(value), decimals);
  return value < 0 ? "\u2212" + digits : digits;
}

}  // namespace

double NiceStep(double least) {
  if (!(least > 0) || !std::isfinite(least)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

std::vector<Tick> TicksOf(const Range& range, double step) {
  constexpr double kMost = 500;
  std::vector<Tick> ticks;
  if (!(range.size() > 0) || !(range.size() / step < kMost)) return ticks;
  const double tolerance = 1e-9 * range.size();
  for (double count = std::ceil((range.low - tolerance) / step); count * step <= range.high + tolerance; ++count)
    ticks.push_back({count * step, LabelOf(count * step, step)});
  return ticks;
}

LegendEntry LineEntry(const std::string& word, const Color& color) {
  return {word, [color](Canvas& canvas, const Spot& at) { canvas.Line(at - Spot(7, 0), at + Spot(6, 0), color, 2); }};
}

namespace {

// Draws all entries, or the first ones and an ellipsis, between `left` and the right end of the box; returns where they
// begin.
double DrawLegend(Canvas& canvas, const Theme& theme, const Box& box, double left, Legend legend) {
  constexpr double kSign = 18, kBetween = 14;
  const TextStyle style = Letters{theme}.Tick(Anchor::kStart);
  const LegendEntry ellipsis{"\u2026", nullptr};
  const auto width = [&](const LegendEntry& entry) {
    return (entry.draw ? kSign : 0) + canvas.WidthOf(entry.word, style) + kBetween;
  };
  const auto width_of = [&](std::size_t count) {
    double sum = (count < legend.size() ? width(ellipsis) : 0) - kBetween;
    for (std::size_t i = 0; i < count; ++i) sum += width(legend[i]);
    return sum;
  };
  std::size_t shown = legend.size();
  while (shown > 0 && left + width_of(shown) > box.right()) --shown;
  if (shown == 0) return box.right();
  const double begin = box.right() - width_of(shown);
  if (shown < legend.size()) {
    legend.resize(shown);
    legend.push_back(ellipsis);
  }
  double at = begin;
  for (const LegendEntry& entry : legend) {
    if (entry.draw) entry.draw(canvas, Spot(at + 7, box.top + 8));
    canvas.Text({at + (entry.draw ? kSign : 0), box.top + 12}, entry.word, style);
    at += width(entry);
  }
  return begin;
}

}  // namespace

void DrawHeading(Canvas& canvas, const Theme& theme, const Box& box, const std::string& heading,
                 const std::string& remark, const Legend& legend) {
  const Letters letters{theme};
  const Spot foot(box.left, box.top + 12);
  canvas.Text(foot, heading, letters.Heading());
  const double left = box.left + canvas.WidthOf(heading, letters.Heading()) + 8;
  double right = DrawLegend(canvas, theme, box, left, legend);
  if (right < box.right()) right -= 12;
  // What has no room beside the heading is left out rather than set across its neighbour.
  if (remark.empty() || left + canvas.WidthOf(remark, letters.Tick(Anchor::kStart)) > right + 1) return;
  canvas.Text({left, foot.y()}, remark, letters.Tick(Anchor::kStart));
}

void DrawAxisNames(Canvas& canvas, const Theme& theme, const Box& inside, const std::string& x, const std::string& y) {
  TextStyle style = Letters{theme}.Label(Anchor::kMiddle);
  canvas.Text({inside.center().x(), inside.bottom() + kTickSpace + kNameSpace - 3}, x, style);
  style.upward = true;
  canvas.Text({inside.left - kYTickSpace + 10, inside.center().y()}, y, style);
}

Diagram DrawDiagram(Canvas& canvas, const Theme& theme, const Box& box, const Range& x, const Range& y,
                    const DiagramText& text) {
  constexpr double kPixelsPerXTick = 55, kPixelsPerYTick = 36;
  const Letters letters{theme};
  DrawHeading(canvas, theme, box, text.heading, text.remark, text.legend);
  Diagram diagram;
  diagram.inside = box.Without(kYTickSpace, kHeadingHeight, 4, kTickSpace + kNameSpace);
  const Box& inside = diagram.inside;
  diagram.x = {x, {inside.left, inside.right()}};
  diagram.y = {y, {inside.bottom(), inside.top}};
  for (const Tick& tick : TicksOf(y, NiceStep(y.size() * kPixelsPerYTick / inside.height))) {
    const double at = diagram.y(tick.value);
    canvas.Line({inside.left, at}, {inside.right(), at}, theme.grid);
    canvas.Text({inside.left - 6, at + 4}, tick.label, letters.Tick(Anchor::kEnd));
  }
  for (const Tick& tick : TicksOf(x, NiceStep(x.size() * kPixelsPerXTick / inside.width))) {
    const double at = diagram.x(tick.value);
    canvas.Line({at, inside.bottom()}, {at, inside.bottom() + 4}, theme.faint_ink);
    canvas.Text({at, inside.bottom() + kTickSpace - 1}, tick.label, letters.Tick(Anchor::kMiddle));
  }
  canvas.Line({inside.left, inside.bottom()}, {inside.right(), inside.bottom()}, theme.faint_ink);
  DrawAxisNames(canvas, theme, inside, text.x_name, text.y_name);
  return diagram;
}

void DrawColorBar(Canvas& canvas, const Theme& theme, const Box& box, const std::string& low, const std::string& high,
                  const std::string& name) {
  constexpr double kHeight = 8;
  const Letters letters{theme};
  const double left = box.left + canvas.WidthOf(low, letters.Tick(Anchor::kStart)) + 6;
  const double right = box.right() - canvas.WidthOf(high, letters.Tick(Anchor::kStart)) - 6;
  const double width = (right - left) / kAmountSteps;
  const double top = box.bottom() - kHeight - 1;
  for (int step = 0; step < kAmountSteps; ++step)
    canvas.Fill({left + step * width, top, width + 0.5, kHeight}, ColorOfAmount((step + 0.5) / kAmountSteps));
  canvas.Text({box.left, box.bottom() - 1}, low, letters.Tick(Anchor::kStart));
  canvas.Text({box.right(), box.bottom() - 1}, high, letters.Tick(Anchor::kEnd));
  canvas.Text({box.center().x(), top - 5}, name, letters.Label(Anchor::kMiddle));
}

}  // namespace slamdb::plot
