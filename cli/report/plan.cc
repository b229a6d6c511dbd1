// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "cli/report/layout.h"
#include "slamdb/base/detail/concat.h"

namespace slamdb::cli {
namespace {

constexpr int kDotsAcross = 2, kDotsDown = 4;  // of a letter

// Letters of dots, all unset at first.
class Canvas {
 public:
  Canvas(int columns, int lines)
      : columns_(columns), lines_(lines), cells_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(lines)) {}

  int width() const { return columns_ * kDotsAcross; }
  int height() const { return lines_ * kDotsDown; }

  void Set(int x, int y) {
    // The bits of U+2800: the upper three rows first, column by column, then the lowest.
    static constexpr std::uint8_t kBits[kDotsDown][kDotsAcross] = {{1, 8}, {2, 16}, {4, 32}, {64, 128}};
    if (x < 0 || y < 0 || x >= width() || y >= height()) return;
    const auto cell = static_cast<std::size_t>(y / kDotsDown) * static_cast<std::size_t>(columns_) +
                      static_cast<std::size_t>(x / kDotsAcross);
    cells_[cell] = static_cast<std::uint8_t>(cells_[cell] | kBits[y % kDotsDown][x % kDotsAcross]);
  }

  void Line(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const Eigen::Vector2d way = b - a;
    const int steps = std::max(1, static_cast<int>(std::ceil(way.cwiseAbs().maxCoeff())));
    for (int i = 0; i <= steps; ++i) {
      const Eigen::Vector2d at = a + way * (static_cast<double>(i) / steps);
      Set(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
    }
  }

  std::string ToString(std::size_t indent) const {
    std::string text;
    for (int line = 0; line < lines_; ++line) {
      std::string row;
      std::size_t used = 0;
      for (int column = 0; column < columns_; ++column) {
        const std::uint8_t dots = cells_[static_cast<std::size_t>(line * columns_ + column)];
        row += '\xE2';
        row += static_cast<char>(0xA0 | dots >> 6);
        row += static_cast<char>(0x80 | (dots & 0x3F));
        if (dots != 0) used = row.size();
      }
      text += std::string(indent, ' ') + row.substr(0, used) + "\n";
    }
    return text;
  }

 private:
  int columns_, lines_;
  std::vector<std::uint8_t> cells_;
};

}  // namespace

std::string PlanText(const std::vector<Eigen::Vector2d>& path, const std::string& unit, std::size_t width,
                     std::size_t height) {
  constexpr std::size_t kIndent = 2;
  std::vector<Eigen::Vector2d> places;
  std::ranges::copy_if(path, std::back_inserter(places),
                       [](const Eigen::Vector2d& place) { return place.allFinite(); });
  if (places.size() < 2 || width < kIndent + 2 || height == 0) return {};
  Eigen::Vector2d low = places.front(), high = places.front();
  for (const Eigen::Vector2d& place : places) low = low.cwiseMin(place), high = high.cwiseMax(place);
  const Eigen::Vector2d extent = high - low;
  const double across = static_cast<double>((width - kIndent) * kDotsAcross - 1);
  const double down = static_cast<double>(height * kDotsDown - 1);
  const double scale = std::min(across / std::max(extent.x(), 1e-9), down / std::max(extent.y(), 1e-9));
  if (!std::isfinite(scale) || extent.maxCoeff() <= 0) return {};
  const auto cells = [](double dots, int per) { return static_cast<int>(std::floor(dots)) / per + 1; };
  Canvas canvas(cells(extent.x() * scale, kDotsAcross), cells(extent.y() * scale, kDotsDown));
  const auto dot = [&](const Eigen::Vector2d& place) {
    return Eigen::Vector2d((place.x() - low.x()) * scale, (high.y() - place.y()) * scale);  // up is up
  };
  for (std::size_t i = 1; i < places.size(); ++i) canvas.Line(dot(places[i - 1]), dot(places[i]));
  return canvas.ToString(kIndent) + std::string(kIndent, ' ') +
         detail::Concat("seen from above, ", Short(extent.x(), 3), " by ", Short(extent.y(), 3), " ", unit, "\n");
}

}  // namespace slamdb::cli
