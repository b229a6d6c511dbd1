// SPDX-License-Identifier: BSD-3-Clause
// The covisibility graph as a matrix: keyframes of all maps by time, one map behind the other.
#include <algorithm>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/plot/detail/panels.h"

namespace slamdb::plot {
namespace {

constexpr std::uint32_t kNowhere = kNoRow;

// The strongest connection that falls onto each pixel.
class Matrix {
 public:
  Matrix(std::size_t keyframes, std::size_t pixels)
      : keyframes_(std::max<std::size_t>(keyframes, 1)), pixels_(pixels), weights_(pixels * pixels, 0) {}

  void Add(std::size_t from, std::size_t to, std::int32_t weight) {
    const auto [top, bottom] = PixelsOf(from);
    const auto [left, right] = PixelsOf(to);
    for (std::size_t row = top; row < bottom; ++row)
      for (std::size_t column = left; column < right; ++column) {
        std::int32_t& pixel = weights_[row * pixels_ + column];
        pixel = std::max(pixel, weight);
      }
    most_ = std::max(most_, weight);
  }

  // By the logarithm: most connections are weak.
  Raster Picture() const {
    Raster raster(pixels_, pixels_);
    for (std::size_t i = 0; i < weights_.size(); ++i)
      if (weights_[i] > 0)
        raster.Set(i % pixels_, i / pixels_, ColorOfAmount(StepOfAmount(std::log1p(weights_[i]) / std::log1p(most_))));
    return raster;
  }

  std::int32_t most() const { return most_; }

 private:
  std::pair<std::size_t, std::size_t> PixelsOf(std::size_t keyframe) const {
    const std::size_t begin = keyframe * pixels_ / keyframes_;
    return {begin, std::max(begin + 1, (keyframe + 1) * pixels_ / keyframes_)};
  }

  std::size_t keyframes_, pixels_;
  std::vector<std::int32_t> weights_;
  std::int32_t most_ = 1;
};

void AddMap(const MapScene& map, std::size_t first, Matrix& matrix) {
  const IdTable rows = KeyFrameTable(*map.map);
  std::vector<std::uint32_t> place(map.map->keyframes.size(), kNowhere);
  for (std::uint32_t i = 0; i < map.timed.size(); ++i) place[map.timed[i]] = i;
  for (std::size_t from = 0; from < map.timed.size(); ++from) {
    for (const Connection& connection : map.map->keyframes[map.timed[from]].connections) {
      const std::uint32_t row = rows.Find(connection.keyframe.value());
      if (row == kNoRow || place[row] == kNowhere || connection.weight <= 0) continue;
      matrix.Add(first + from, first + place[row], connection.weight);
    }
  }
}

// Between maps, and their names where there is room.
void DrawBorders(Canvas& canvas, const Scene& scene, const Box& inside) {
  if (scene.maps.size() < 2) return;
  const double pixels = inside.width / static_cast<double>(std::max<std::size_t>(scene.keyframes(), 1));
  TextStyle style = Letters{scene.theme}.Heading();
  style.size = 11;
  double at = 0;
  for (const MapScene& map : scene.maps) {
    const double size = pixels * static_cast<double>(map.timed.size());
    canvas.Outline({inside.left + at, inside.top + at, size, size}, map.color, 1.2);
    style.color = map.color;
    const bool fits = inside.width - at - size > canvas.WidthOf(map.name, style) + 8 && size > 9;
    if (fits) canvas.Text({inside.left + at + size + 5, inside.top + at + std::min(size, 14.0)}, map.name, style);
    at += size;
  }
}

}  // namespace

void DrawCovisibility(Canvas& canvas, const Scene& scene, const Box& box) {
  constexpr double kBarHeight = 30, kPixels = 2;
  DrawHeading(canvas, scene.theme, box, "Covisibility", "keyframes by time");
  const Box below = box.Without(0, kHeadingHeight, 0, kBarHeight);
  const double size = std::min(below.width, below.height);
  const Box inside{below.left + (below.width - size) / 2, below.top, size, size};
  Matrix matrix(scene.keyframes(), static_cast<std::size_t>(std::max(1.0, kPixels * size)));
  std::size_t first = 0;
  for (const MapScene& map : scene.maps) {
    AddMap(map, first, matrix);
    first += map.timed.size();
  }
  Raster picture = matrix.Picture();
  canvas.Image(inside, picture);
  canvas.Outline(inside, scene.theme.grid);
  DrawBorders(canvas, scene, inside);
  DrawColorBar(canvas, scene.theme, {inside.left, box.bottom() - kBarHeight, size, kBarHeight}, "1",
               detail::Thousands(static_cast<std::uint64_t>(matrix.most())), "covisibility weight");
}

}  // namespace slamdb::plot
