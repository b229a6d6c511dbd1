// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/detail/theme.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace slamdb::plot {
namespace {

constexpr Color Hex(std::uint32_t rgb) {
  return {((rgb >> 16) & 255) / 255.0, ((rgb >> 8) & 255) / 255.0, (rgb & 255) / 255.0, 1};
}

// Okabe and Ito, "Color Universal Design", 2008.
constexpr Color kOrange = Hex(0xe69f00), kSkyBlue = Hex(0x56b4e9), kGreen = Hex(0x009e73), kBlue = Hex(0x0072b2),
                kVermillion = Hex(0xd55e00), kPurple = Hex(0xcc79a7), kGrey = Hex(0x8a8f98);

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
                                .loop = kVermillion,
                                .merge = kPurple,
                                .start = kGreen,
                                .end = kVermillion,
                                .reference = Hex(0x8a8f98),
                                .mark = kVermillion};
  return kLight;
}

const Theme& Theme::Dark() {
  static constexpr Theme kDark{.paper = Hex(0x0d1117),
                               .ink = Hex(0xe6edf3),
                               .faint_ink = Hex(0x9aa4af),
                               .grid = Hex(0x262c34),
                               .points = Hex(0xb4bec9),
                               .loop = kVermillion,
                               .merge = kPurple,
                               .start = kGreen,
                               .end = kVermillion,
                               .reference = Hex(0x8a8f98),
                               .mark = kOrange};
  return kDark;
}

Color ColorOfKind(std::size_t place) {
  static constexpr std::array kColors = {kBlue, kOrange, kGreen, kPurple, kSkyBlue, kVermillion, kGrey};
  return kColors[place % kColors.size()];
}

Color ColorOfAmount(double amount) {
  // viridis of matplotlib (Smith, van der Walt, Firing), at nine places.
  static constexpr std::array kColors = {Hex(0x440154), Hex(0x472d7b), Hex(0x3b528b), Hex(0x2c728e), Hex(0x21918c),
                                         Hex(0x28ae80), Hex(0x5ec962), Hex(0xaddc30), Hex(0xfde725)};
  const double at = std::clamp(amount, 0.0, 1.0) * (kColors.size() - 1);
  const auto place = std::min(static_cast<std::size_t>(at), kColors.size() - 2);
  return Mixed(kColors[place], kColors[place + 1], at - static_cast<double>(place));
}

double StepOfAmount(double amount) {
  if (std::isnan(amount)) return 0;
  const double step = std::floor(std::clamp(amount, 0.0, 1.0) * kAmountSteps);
  return (std::min(step, kAmountSteps - 1.0) + 0.5) / kAmountSteps;
}

}  // namespace slamdb::plot
