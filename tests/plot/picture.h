// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/plot/detail/theme.h"

namespace slamdb::testing {

// A PNG file, decoded.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;  // 0xAARRGGBB

  static Picture Of(const std::string& png);  // width 0: it is none
  std::uint32_t At(double x, double y) const;
  std::size_t Colors() const;  // how many there are
};

std::uint32_t Pixel(const plot::Color& color);

}  // namespace slamdb::testing
