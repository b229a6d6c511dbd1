// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/detail/theme.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "slamdb/model/colors.h"

namespace slamdb::plot {
namespace {

constexpr Color Hex(std::uint32_t rgb) {
  return {((rgb >> 16) & 255) / 255.0, ((rgb >> 8) & 255) / 255.0, (rgb & 255) / 255.0, 1};
}

constexpr Color Of(const slamdb::Color& color) { return {color[0] / 255.0, color[1] / 255.0, color[2] / 255.0, 1}; }

// Okabe and Ito, "Color Universal Design", 2008.
constexpr Color kOrange = Hex(0xe69f00), kGreen = Hex(0x009e73), kVermillion = Hex(0xd55e00);

constexpr double kLighter = 0.25;  // on a dark page

}  // namespace

Color Mixed(const Color& a, const Color& b, double share) {
  const auto mix = [share](double from, double to) { return from + share * (to - from); };
  return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue), mix(a.alpha, b.alpha)};
}

const Theme& Theme::Light() {
  static constexpr Theme kLight{.paper = Hex(0xffffff),
                                .ink = Hex(0x1f2328),
                                .faint_ink = Hex(0x59636e),
                                .grid = Hex(0xe4e7eb),
                                .points = Hex(0x4a5663),
                                .loop = Of(kLoopColor),
                                .merge = Of(kMergeColor),
                                .start = kGreen,
                                .end = kVermillion,
                                .reference = Hex(0x8a8f98),
                                .mark = kVermillion};
  return kLight;
}

const Theme& Theme::Dark() {
  static const Theme kDark{.paper = Hex(0x0d1117),
                           .ink = Hex(0xe6edf3),
                           .faint_ink = Hex(0x9aa4af),
                           .grid = Hex(0x262c34),
                           .points = Hex(0xb4bec9),
                           .loop = Mixed(Of(kLoopColor), Hex(0xe6edf3), kLighter),
                           .merge = Mixed(Of(kMergeColor), Hex(0xe6edf3), kLighter),
                           .start = kGreen,
                           .end = kVermillion,
                           .reference = Hex(0x8a8f98),
                           .mark = kOrange};
  return kDark;
}

Color ColorOfMap(MapId id, bool dark) {
  const Color color = Of(slamdb::ColorOfMap(id));
  return dark ? Mixed(color, Theme::Dark().ink, kLighter) : color;
}

Color ColorOfAmount(double amount) { return Of(ColorOfShare(amount)); }

double StepOfAmount(double amount) {
  if (std::isnan(amount)) return 0;
  const double step = std::floor(std::clamp(amount, 0.0, 1.0) * kAmountSteps);
  return (std::min(step, kAmountSteps - 1.0) + 0.5) / kAmountSteps;
}

}  // namespace slamdb::plot
