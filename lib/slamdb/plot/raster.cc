// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "slamdb/plot/detail/canvas.h"

namespace slamdb::plot {

void Raster::Set(std::size_t column, std::size_t row, const Color& color) {
  const auto byte = [&](double value) { return static_cast<std::uint32_t>(std::lround(255 * value)); };
  pixels_[row * width_ + column] = byte(color.alpha) << 24 | byte(color.red * color.alpha) << 16 |
                                   byte(color.green * color.alpha) << 8 | byte(color.blue * color.alpha);
}

}  // namespace slamdb::plot
