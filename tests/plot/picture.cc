// SPDX-License-Identifier: BSD-3-Clause
#include "tests/plot/picture.h"

#include <cairo.h>

#include <cmath>
#include <cstring>
#include <set>
#include <string_view>

namespace slamdb::testing {

Picture Picture::Of(const std::string& png) {
  std::string_view left = png;
  const auto read = [](void* source, unsigned char* bytes, unsigned length) {
    auto& from = *static_cast<std::string_view*>(source);
    if (from.size() < length) return CAIRO_STATUS_READ_ERROR;
    std::memcpy(bytes, from.data(), length);
    from.remove_prefix(length);
    return CAIRO_STATUS_SUCCESS;
  };
  cairo_surface_t* surface = cairo_image_surface_create_from_png_stream(read, &left);
  Picture picture;
  if (cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS) {
    picture.width = cairo_image_surface_get_width(surface);
    picture.height = cairo_image_surface_get_height(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    const unsigned char* bytes = cairo_image_surface_get_data(surface);
    for (int row = 0; row < picture.height; ++row)
      for (int column = 0; column < picture.width; ++column) {
        std::uint32_t pixel = 0;
        std::memcpy(&pixel, bytes + row * stride + 4 * column, sizeof pixel);
        picture.pixels.push_back(pixel | 0xff000000U);
      }
  }
  cairo_surface_destroy(surface);
  return picture;
}

std::uint32_t Picture::At(double x, double y) const {
  return pixels.at(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
}

std::size_t Picture::Colors() const { return std::set(pixels.begin(), pixels.end()).size(); }

std::uint32_t Pixel(const plot::Color& color) {
  const auto byte = [](double value) { return static_cast<std::uint32_t>(std::lround(255 * value)); };
  return 0xff000000U | byte(color.red) << 16 | byte(color.green) << 8 | byte(color.blue);
}

}  // namespace slamdb::testing
