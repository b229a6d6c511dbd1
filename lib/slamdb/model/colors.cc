// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/colors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace slamdb {

Color ColorOfMap(MapId id) {
  static constexpr std::array<Color, 10> kColors = {{{63, 144, 218},
                                                     {255, 169, 14},
                                                     {189, 31, 1},
                                                     {148, 164, 162},
                                                     {131, 45, 182},
                                                     {169, 107, 89},
                                                     {231, 99, 0},
                                                     {185, 172, 112},
                                                     {113, 117, 129},
                                                     {146, 218, 221}}};
  return kColors[id.value() % kColors.size()];
}

Color ColorOfShare(double share) {
  static constexpr std::array<Color, 16> kColors = {{{68, 1, 84},
                                                     {72, 26, 108},
                                                     {71, 47, 125},
                                                     {65, 68, 135},
                                                     {57, 86, 140},
                                                     {49, 104, 142},
                                                     {42, 120, 142},
                                                     {35, 136, 142},
                                                     {31, 152, 139},
                                                     {34, 168, 132},
                                                     {53, 183, 121},
                                                     {84, 197, 104},
                                                     {122, 209, 81},
                                                     {165, 219, 54},
                                                     {210, 226, 27},
                                                     {253, 231, 37}}};
  if (std::isnan(share)) return kNoColor;
  const double place = std::clamp(share, 0.0, 1.0) * (kColors.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), kColors.size() - 2);
  const double rest = place - static_cast<double>(below);
  Color color{};
  for (std::size_t i = 0; i < color.size(); ++i)
    color[i] = static_cast<std::uint8_t>(std::lround((1 - rest) * kColors[below][i] + rest * kColors[below + 1][i]));
  return color;
}

}  // namespace slamdb
