// SPDX-License-Identifier: BSD-3-Clause
// Keyframes over time: a strip for each map, a bar for each keyframe as high as it observes points, gaps between them.
// Sessions that lie days apart are moved together, and what was left out stands between them.
#include <algorithm>
#include <cmath>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/plot/detail/panels.h"

namespace slamdb::plot {
namespace {

using detail::Concat;

constexpr double kBreak = 46;  // pixels between two pieces
constexpr double kNameWidth = 56;

// A piece of time without a break.
struct Piece {
  Range seconds, pixels;
};

std::vector<double> TimesOf(const Scene& scene) {
  std::vector<double> times;
  for (const MapScene& map : scene.maps)
    for (const std::uint32_t row : map.timed) times.push_back(map.map->keyframes[row].timestamp);
  std::ranges::sort(times);
  return times;
}

// A gap that takes more than this share of what is left of the time, and more than a minute, is a break.
std::vector<Range> PiecesOf(const std::vector<double>& times) {
  constexpr double kShare = 0.4, kLeast = 60;
  constexpr std::size_t kMostBreaks = 8;
  if (times.empty()) return {{0, 1}};
  std::vector<std::pair<double, std::size_t>> gaps;
  for (std::size_t i = 1; i < times.size(); ++i) gaps.emplace_back(times[i] - times[i - 1], i);
  std::ranges::sort(gaps, std::greater<>());
  double left = times.back() - times.front();
  std::vector<std::size_t> breaks;
  for (const auto& [gap, place] : gaps) {
    if (breaks.size() == kMostBreaks || gap < kLeast || gap < kShare * left) break;
    breaks.push_back(place);
    left -= gap;
  }
  std::ranges::sort(breaks);
  breaks.push_back(times.size());
  std::vector<Range> pieces;
  std::size_t begin = 0;
  for (const std::size_t end : breaks) {
    pieces.push_back({times[begin], times[end - 1]});
    begin = end;
  }
  return pieces;
}

std::vector<Piece> LayPieces(std::vector<Range> ranges, double left, double right) {
  double total = 0;
  for (Range& range : ranges) {
    if (!(range.size() > 0)) range = {range.low - 0.5, range.high + 0.5};
    total += range.size();
  }
  const double pixels = right - left - kBreak * static_cast<double>(ranges.size() - 1);
  std::vector<Piece> pieces;
  for (const Range& range : ranges) {
    const double width = std::max(pixels, 1.0) * range.size() / total;
    pieces.push_back({range, {left, left + width}});
    left += width + kBreak;
  }
  return pieces;
}

double PixelOf(const std::vector<Piece>& pieces, double time) {
  for (const Piece& piece : pieces)
    if (time <= piece.seconds.high) return Scale{piece.seconds, piece.pixels}(time);
  return pieces.back().pixels.high;
}

// Below the strips: ticks, what was left out where something was, the name of the axis.
double HeightOfFoot(std::size_t pieces) { return kTickSpace + (pieces > 1 ? 2 : 1) * kNameSpace; }

double HeightOfStrip(const Scene& scene) {
  return std::clamp(360.0 / static_cast<double>(std::max<std::size_t>(scene.maps.size(), 1)), 12.0, 56.0);
}

std::uint32_t MostObserved(const Scene& scene) {
  std::uint32_t most = 0;
  for (const MapScene& map : scene.maps)
    for (const std::uint32_t row : map.timed) most = std::max(most, map.observed[row]);
  return most;
}

void DrawGaps(Canvas& canvas, const Scene& scene, const MapScene& map, const std::vector<Piece>& pieces,
              const Box& strip) {
  const double gap = GapOf(*map.map, map.timed);
  const TextStyle style = Letters{scene.theme}.Tick(Anchor::kMiddle);
  for (std::size_t i = 1; i < map.timed.size(); ++i) {
    const double from = map.map->keyframes[map.timed[i - 1]].timestamp, to = map.map->keyframes[map.timed[i]].timestamp;
    if (to - from <= gap) continue;
    const double left = PixelOf(pieces, from), right = PixelOf(pieces, to);
    canvas.Fill({left, strip.top, right - left, strip.height}, scene.theme.mark.WithAlpha(0.14));
    const std::string text = detail::DurationText(to - from);
    if (canvas.WidthOf(text, style) + 4 < right - left && strip.height > 14)
      canvas.Text({(left + right) / 2, strip.center().y() + 4}, text, style);
  }
}

// Of the keyframes on one pixel the tallest.
void DrawStrip(Canvas& canvas, const MapScene& map, const std::vector<Piece>& pieces, const Box& strip, double most) {
  constexpr double kStep = 0.5;  // pixels
  const auto columns = static_cast<std::size_t>(strip.width / kStep) + 1;
  std::vector<double> heights(columns, -1);
  for (const std::uint32_t row : map.timed) {
    const double x = PixelOf(pieces, map.map->keyframes[row].timestamp) - strip.left;
    const auto column = std::min(static_cast<std::size_t>(std::max(0.0, x / kStep)), columns - 1);
    heights[column] = std::max(heights[column], std::max(2.0, (strip.height - 3) * map.observed[row] / most));
  }
  Segments bars;
  for (std::size_t column = 0; column < columns; ++column) {
    if (heights[column] < 0) continue;
    const double x = strip.left + kStep * static_cast<double>(column);
    bars.emplace_back(Spot(x, strip.bottom() - 0.5), Spot(x, strip.bottom() - heights[column]));
  }
  canvas.Lines(bars, map.color, bars.size() > 400 ? 0.6 : 1.2);
}

void DrawTimes(Canvas& canvas, const Scene& scene, const std::vector<Piece>& pieces, const Box& inside) {
  constexpr double kPixelsPerTick = 70;
  const Letters letters{scene.theme};
  const TextStyle style = letters.Tick(Anchor::kMiddle);
  double taken = inside.left - kNameWidth;  // by what was left out earlier
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece& piece = pieces[i];
    const Range since{0, piece.seconds.size()};
    const Scale scale{since, piece.pixels};
    for (const Tick& tick :
         TicksOf(since, NiceStep(since.size() * kPixelsPerTick / std::max(piece.pixels.size(), 1.0)))) {
      canvas.Line({scale(tick.value), inside.top}, {scale(tick.value), inside.bottom()}, scene.theme.grid);
      canvas.Text({scale(tick.value), inside.bottom() + kTickSpace - 2}, tick.label, style);
    }
    if (i == 0) continue;
    const double middle = piece.pixels.low - kBreak / 2;
    canvas.Fill({middle - kBreak / 2 + 4, inside.top, kBreak - 8, inside.height}, scene.theme.grid);
    const std::string left_out = detail::DurationText(piece.seconds.low - pieces[i - 1].seconds.high);
    const double half = canvas.WidthOf(left_out, style) / 2;
    if (middle - half < taken) continue;
    canvas.Text({middle, inside.bottom() + kTickSpace + kNameSpace - 4}, left_out, style);
    taken = middle + half + 4;
  }
}

}  // namespace

double HeightOfTimeline(const Scene& scene) {
  return kHeadingHeight + HeightOfStrip(scene) * static_cast<double>(std::max<std::size_t>(scene.maps.size(), 1)) +
         HeightOfFoot(PiecesOf(TimesOf(scene)).size());
}

void DrawTimeline(Canvas& canvas, const Scene& scene, const Box& box) {
  const Letters letters{scene.theme};
  const std::uint32_t observed = MostObserved(scene), most = std::max(observed, 1U);
  DrawHeading(canvas, scene.theme, box, "Keyframes over time",
              observed == 0 ? "" : Concat("height: points observed, up to ", detail::Thousands(observed)));
  const std::vector<Range> ranges = PiecesOf(TimesOf(scene));
  const Box inside = box.Without(kNameWidth, kHeadingHeight, 8, HeightOfFoot(ranges.size()));
  const std::vector<Piece> pieces = LayPieces(ranges, inside.left, inside.right());
  DrawTimes(canvas, scene, pieces, inside);
  const double height = HeightOfStrip(scene);
  double top = inside.top;
  for (const MapScene& map : scene.maps) {
    const Box strip{inside.left, top, inside.width, height};
    DrawGaps(canvas, scene, map, pieces, strip);
    DrawStrip(canvas, map, pieces, strip, most);
    canvas.Line({inside.left, strip.bottom()}, {inside.right(), strip.bottom()}, scene.theme.faint_ink, 0.6);
    TextStyle name = letters.Heading();
    name.size = 11;
    name.color = map.color;
    name.anchor = Anchor::kEnd;
    canvas.Text({inside.left - 8, strip.bottom() - 3}, map.name, name);
    top += height;
  }
  canvas.Text({inside.center().x(), inside.bottom() + HeightOfFoot(pieces.size()) - 4},
              pieces.size() > 1 ? "seconds since each beginning" : "seconds since the first keyframe",
              letters.Label(Anchor::kMiddle));
}

}  // namespace slamdb::plot
