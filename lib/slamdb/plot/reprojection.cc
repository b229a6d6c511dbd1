// SPDX-License-Identifier: BSD-3-Clause
// Where in the image points are seen beside where they project to, and by how much.
#include "slamdb/model/reprojection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/derive.h"
#include "slamdb/plot/detail/panels.h"
#include "slamdb/plot/detail/view.h"

namespace slamdb::plot {
namespace {

using detail::Concat;
using Sample = ImageErrors::Sample;

constexpr std::size_t kGrain = 4096;

void AddSamples(const MapPoint& point, const Reprojection& reprojection, std::vector<Sample>& samples) {
  if (point.bad) return;
  for (const Observation& observation : point.observations) {
    const auto [left, right] = reprojection.Of(point, observation);
    for (const auto& [error, row] : {std::pair(left, observation.left), std::pair(right, observation.right)}) {
      if (!std::isfinite(error)) continue;
      const Keypoint& keypoint = *ObservedKeypoint(*reprojection.Find(observation.keyframe), row);
      if (std::isfinite(keypoint.x) && std::isfinite(keypoint.y)) samples.push_back({keypoint.x, keypoint.y, error});
    }
  }
}

std::vector<Sample> SamplesOf(const Atlas& atlas, const Map& map, int threads) {
  const Reprojection reprojection(atlas, map);
  std::vector<std::vector<Sample>> blocks((map.points.size() + kGrain - 1) / kGrain);
  detail::ParallelFor(map.points.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) AddSamples(map.points[row], reprojection, blocks[begin / kGrain]);
  });
  std::vector<Sample> all;
  for (const std::vector<Sample>& block : blocks) all.insert(all.end(), block.begin(), block.end());
  return all;
}

Box ImageOf(const std::vector<Sample>& samples) {
  std::vector<double> x, y;
  for (const Sample& sample : samples) {
    x.push_back(sample.x);
    y.push_back(sample.y);
  }
  if (samples.empty()) return {0, 0, 640, 480};
  const Range across = RangeOfMost(x), down = RangeOfMost(y);
  return {across.low, down.low, std::max(across.size(), 1.0), std::max(down.size(), 1.0)};
}

double QuantileOf(const ImageErrors& errors, double share) {
  std::vector<float> values;
  for (const Sample& sample : errors.samples) values.push_back(sample.error);
  return detail::QuantileOf(values, share);
}

double MeanOf(const ImageErrors& errors) {
  double sum = 0;
  for (const Sample& sample : errors.samples) sum += sample.error;
  return errors.samples.empty() ? 0 : sum / static_cast<double>(errors.samples.size());
}

// Means over squares of the image.
struct MeanGrid {
  std::size_t columns = 1, rows = 1;
  std::vector<double> sums;
  std::vector<std::uint64_t> counts;

  MeanGrid(const ImageErrors& errors, std::size_t across) : columns(across) {
    const double side = errors.image.width / static_cast<double>(columns);
    rows = static_cast<std::size_t>(std::clamp(std::round(errors.image.height / side), 1.0, 500.0));
    sums.resize(columns * rows, 0);
    counts.resize(columns * rows, 0);
    for (const Sample& sample : errors.samples) {
      if (!errors.image.Has({sample.x, sample.y})) continue;
      const auto share = [](double at, double size, std::size_t cells) {
        return std::min(static_cast<std::size_t>(at / size * static_cast<double>(cells)), cells - 1);
      };
      const std::size_t cell = share(sample.y - errors.image.top, errors.image.height, rows) * columns +
                               share(sample.x - errors.image.left, errors.image.width, columns);
      sums[cell] += sample.error;
      ++counts[cell];
    }
  }
};

}  // namespace

const ImageErrors& Scene::errors() const {
  if (errors_) return *errors_;
  ImageErrors& errors = errors_.emplace();
  for (std::uint32_t map = 0; map < maps.size(); ++map)
    for (Sample sample : SamplesOf(atlas, *maps[map].map, options.threads)) {
      sample.map = map;
      errors.samples.push_back(sample);
    }
  errors.image = ImageOf(errors.samples);
  return errors;
}

void DrawReprojectionImage(Canvas& canvas, const Scene& scene, const ImageErrors& errors, const Box& box) {
  constexpr double kBarHeight = 34;
  constexpr std::size_t kSquares = 40, kPixels = 12;
  const Letters letters{scene.theme};
  DrawHeading(canvas, scene.theme, box, "Reprojection error", "mean over the image");
  const Box below = box.Without(0, kHeadingHeight, 0, kBarHeight + kTickSpace);
  const double pixels = std::min(below.width / errors.image.width, below.height / errors.image.height);
  const Box inside{below.left + (below.width - pixels * errors.image.width) / 2, below.top, pixels * errors.image.width,
                   pixels * errors.image.height};
  const MeanGrid grid(errors, kSquares);
  std::vector<double> means;
  for (std::size_t cell = 0; cell < grid.sums.size(); ++cell)
    if (grid.counts[cell] > 0) means.push_back(grid.sums[cell] / static_cast<double>(grid.counts[cell]));
  std::ranges::sort(means);
  const double top = means.empty() ? 1 : std::max(means[means.size() - 1 - means.size() / 50], 1e-6);
  Raster raster(grid.columns * kPixels, grid.rows * kPixels);
  for (std::size_t row = 0; row < raster.height(); ++row)
    for (std::size_t column = 0; column < raster.width(); ++column) {
      const std::size_t cell = row / kPixels * grid.columns + column / kPixels;
      if (grid.counts[cell] > 0)
        raster.Set(column, row,
                   ColorOfAmount(StepOfAmount(grid.sums[cell] / static_cast<double>(grid.counts[cell]) / top)));
    }
  canvas.Image(inside, raster);
  canvas.Outline(inside, scene.theme.grid);
  const auto corner = [](double x, double y) { return Concat(std::lround(x), ", ", std::lround(y)); };
  canvas.Text({inside.left, inside.bottom() + kTickSpace - 4}, corner(errors.image.left, errors.image.top),
              letters.Tick(Anchor::kStart));
  canvas.Text({inside.right(), inside.bottom() + kTickSpace - 4}, corner(errors.image.right(), errors.image.bottom()),
              letters.Tick(Anchor::kEnd));
  DrawColorBar(canvas, scene.theme, {inside.left, inside.bottom() + kTickSpace, inside.width, kBarHeight}, "0",
               means.empty() ? "" : detail::Digits(top, 2), "pixels");
}

void DrawReprojectionHistogram(Canvas& canvas, const Scene& scene, const ImageErrors& errors, const Box& box) {
  constexpr std::size_t kBins = 40;
  const double end = std::max(QuantileOf(errors, 0.99), 1e-3);
  Histogram histogram{.width = end / static_cast<double>(kBins)};
  histogram.counts.assign(std::max<std::size_t>(scene.maps.size(), 1), std::vector<std::uint64_t>(kBins, 0));
  for (const Sample& sample : errors.samples)
    if (sample.error <= end)
      ++histogram.counts[sample.map][std::min(static_cast<std::size_t>(sample.error / histogram.width), kBins - 1)];
  const bool alone = box.width > 300;
  const Diagram diagram = DrawDiagram(canvas, scene.theme, box, {0, end},
                                      {0, 1.08 * static_cast<double>(std::max<std::uint64_t>(Tallest(histogram), 1))},
                                      {.heading = alone ? "How errors are distributed" : "Reprojection error",
                                       .remark = alone ? "without the largest hundredth" : "",
                                       .x_name = "pixels",
                                       .y_name = "observations"});
  if (errors.samples.empty()) return;
  const Canvas::Clip clip(canvas, diagram.inside);
  DrawBars(canvas, scene, diagram, histogram);
  DrawMark(canvas, scene.theme, diagram, MeanOf(errors), Concat("mean ", detail::Digits(MeanOf(errors), 3)));
}

namespace {

constexpr double kGap = 24, kLeastBeside = 480, kLeastHeight = 240;

bool IsBeside(double width) { return width >= kLeastBeside; }

}  // namespace

double HeightOfReprojection(const Scene&, double width) {
  return IsBeside(width) ? std::max(0.5 * width, kLeastHeight) : 0.8 * width + kGap + kLeastHeight;
}

void DrawReprojection(Canvas& canvas, const Scene& scene, const Box& box) {
  const double half = (box.width - kGap) / 2, below = box.height - kLeastHeight;
  const bool beside = IsBeside(box.width);
  const Box image = beside ? Box{box.left, box.top, half, box.height} : Box{box.left, box.top, box.width, below - kGap};
  const Box histogram = beside ? Box{box.left + half + kGap, box.top, half, box.height}
                               : Box{box.left, box.top + below, box.width, kLeastHeight};
  DrawReprojectionImage(canvas, scene, scene.errors(), image);
  DrawReprojectionHistogram(canvas, scene, scene.errors(), histogram);
}

}  // namespace slamdb::plot
