// SPDX-License-Identifier: BSD-3-Clause
// Points by keyframes that observe them, and keyframes by points that they observe.
#include <algorithm>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"
#include "slamdb/model/statistics.h"
#include "slamdb/plot/detail/panels.h"

namespace slamdb::plot {
namespace {

using detail::Concat;

constexpr std::size_t kTrackBins = MapStatistics::kHistogramSize;

// What a histogram was made of, for its median.
std::vector<std::uint32_t> TrackLengths(const MapScene& map) {
  std::vector<std::uint32_t> lengths;
  for (const MapPoint& point : map.map->points)
    if (!point.bad) lengths.push_back(static_cast<std::uint32_t>(point.observations.size()));
  return lengths;
}

std::vector<std::uint32_t> Loads(const MapScene& map) {
  std::vector<std::uint32_t> loads;
  for (std::size_t row = 0; row < map.map->keyframes.size(); ++row)
    if (!map.map->keyframes[row].bad) loads.push_back(map.observed[row]);
  return loads;
}

template <class Values>
std::vector<std::uint32_t> OfAllMaps(const Scene& scene, const Values& values) {
  std::vector<std::uint32_t> all;
  for (const MapScene& map : scene.maps) {
    const std::vector<std::uint32_t> own = values(map);
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

Range HeightOf(const Histogram& histogram) {
  return {0, 1.08 * static_cast<double>(std::max<std::uint64_t>(Tallest(histogram), 1))};
}

}  // namespace

std::uint64_t Tallest(const Histogram& histogram) {
  std::uint64_t tallest = 0;
  for (std::size_t bin = 0; bin < histogram.bins(); ++bin) {
    std::uint64_t sum = 0;
    for (const auto& counts : histogram.counts) sum += counts[bin];
    tallest = std::max(tallest, sum);
  }
  return tallest;
}

void DrawBars(Canvas& canvas, const Scene& scene, const Diagram& diagram, const Histogram& histogram) {
  for (std::size_t bin = 0; bin < histogram.bins(); ++bin) {
    const double left = diagram.x(histogram.first + histogram.width * static_cast<double>(bin));
    const double right = diagram.x(histogram.first + histogram.width * static_cast<double>(bin + 1));
    const double gap = std::min(1.0, 0.15 * (right - left));
    double below = 0;
    for (std::size_t map = 0; map < histogram.counts.size(); ++map) {
      const auto count = static_cast<double>(histogram.counts[map][bin]);
      if (count == 0) continue;
      const double top = diagram.y(below + count), bottom = diagram.y(below);
      canvas.Fill({left + gap / 2, top, right - left - gap, bottom - top}, scene.maps[map].color);
      below += count;
    }
  }
}

void DrawMark(Canvas& canvas, const Theme& theme, const Diagram& diagram, double at, const std::string& name) {
  if (!(at >= diagram.x.values.low && at <= diagram.x.values.high)) return;
  const double x = diagram.x(at);
  canvas.Line({x, diagram.inside.top}, {x, diagram.inside.bottom()}, theme.mark, 1.2, 4);
  const TextStyle right{.color = theme.mark, .size = 11};
  const bool fits = x + 5 + canvas.WidthOf(name, right) <= diagram.inside.right();
  canvas.Text({fits ? x + 5 : x - 5, diagram.inside.top + 10}, name,
              {.color = theme.mark, .size = 11, .anchor = fits ? Anchor::kStart : Anchor::kEnd});
}

Histogram TrackHistogram(const Scene& scene) {
  Histogram histogram{.first = -0.5, .open = true};
  for (const MapScene& map : scene.maps) {
    auto& counts = histogram.counts.emplace_back(kTrackBins, 0);
    for (const std::uint32_t length : TrackLengths(map)) ++counts[std::min<std::size_t>(length, kTrackBins - 1)];
  }
  return histogram;
}

void DrawTracks(Canvas& canvas, const Scene& scene, const Box& box) {
  const Histogram histogram = TrackHistogram(scene);
  std::size_t last = 8;  // bins without anything at the end are left out
  for (const auto& counts : histogram.counts)
    for (std::size_t bin = 0; bin < counts.size(); ++bin)
      if (counts[bin] > 0) last = std::max(last, bin);
  const Diagram diagram =
      DrawDiagram(canvas, scene.theme, box, {-0.5, static_cast<double>(last) + 0.5}, HeightOf(histogram),
                  {.heading = "Track lengths",
                   .remark = last + 1 == kTrackBins ? Concat("the last bar: ", last, " or more") : "",
                   .x_name = "keyframes that observe a point",
                   .y_name = "points"});
  const Canvas::Clip clip(canvas, diagram.inside);
  DrawBars(canvas, scene, diagram, histogram);
  const std::uint32_t median = detail::MedianOf(OfAllMaps(scene, TrackLengths));
  if (Tallest(histogram) > 0) DrawMark(canvas, scene.theme, diagram, median, Concat("median ", median));
}

Histogram ObservationHistogram(const Scene& scene) {
  constexpr double kMostBins = 30;
  std::uint32_t most = 0;
  for (const std::uint32_t load : OfAllMaps(scene, Loads)) most = std::max(most, load);
  Histogram histogram{.width = std::max(1.0, NiceStep((most + 1.0) / kMostBins))};
  const auto bins = static_cast<std::size_t>(std::floor(most / histogram.width)) + 1;
  for (const MapScene& map : scene.maps) {
    auto& counts = histogram.counts.emplace_back(bins, 0);
    for (const std::uint32_t load : Loads(map)) ++counts[static_cast<std::size_t>(load / histogram.width)];
  }
  return histogram;
}

void DrawObservations(Canvas& canvas, const Scene& scene, const Box& box) {
  const Histogram histogram = ObservationHistogram(scene);
  const double end = histogram.width * static_cast<double>(std::max<std::size_t>(histogram.bins(), 1));
  const Diagram diagram = DrawDiagram(
      canvas, scene.theme, box, {0, end}, HeightOf(histogram),
      {.heading = "Observations", .remark = "", .x_name = "points that a keyframe observes", .y_name = "keyframes"});
  const Canvas::Clip clip(canvas, diagram.inside);
  DrawBars(canvas, scene, diagram, histogram);
  const std::uint32_t median = detail::MedianOf(OfAllMaps(scene, Loads));
  if (Tallest(histogram) > 0) DrawMark(canvas, scene.theme, diagram, median, Concat("median ", median));
}

}  // namespace slamdb::plot
