// SPDX-License-Identifier: BSD-3-Clause
// Plan and side view. Points become a picture of pixels, whose size that of the page bounds; lines stay lines.
#include "slamdb/plot/detail/view.h"

#include <algorithm>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"

namespace slamdb::plot {
namespace {

using detail::Concat;

constexpr int kDensitySteps = 6;

// How many points of which map fall onto each pixel of a cell.
class Density {
 public:
  Density(const Cell& cell, double pixels, std::size_t points)
      : cell_(cell),
        pixels_(pixels),
        width_(static_cast<std::size_t>(std::max(1.0, std::round(cell.box.width * pixels)))),
        height_(static_cast<std::size_t>(std::max(1.0, std::round(cell.box.height * pixels)))),
        counts_(width_ * height_, 0),
        maps_(width_ * height_, 0) {
    // Few points are drawn as dots that can be seen, many as single pixels.
    const double room = static_cast<double>(counts_.size()) / static_cast<double>(std::max<std::size_t>(points, 1));
    radius_ = std::clamp(static_cast<int>(std::sqrt(0.06 * room)), 0, static_cast<int>(pixels_));
  }

  // Whether the point is inside the cell.
  bool Add(const Eigen::Vector3f& position, std::uint8_t map) {
    const Spot spot = cell_(position.cast<double>());
    if (!cell_.box.Has(spot)) return false;
    const auto column = static_cast<std::ptrdiff_t>((spot.x() - cell_.box.left) * pixels_);
    const auto row = static_cast<std::ptrdiff_t>((spot.y() - cell_.box.top) * pixels_);
    for (std::ptrdiff_t y = -radius_; y <= radius_; ++y)
      for (std::ptrdiff_t x = -radius_; x <= radius_; ++x)
        if (x * x + y * y <= radius_ * radius_ + 1) Count(column + x, row + y, map);
    return true;
  }

  // Denser is more opaque, in a few steps, so that the picture is a small file.
  Raster Picture(const std::vector<Color>& colors) const {
    Raster raster(width_, height_);
    const double most = std::log1p(static_cast<double>(Most()));
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      if (counts_[i] == 0) continue;
      const double share = std::log1p(counts_[i]) / most;
      const double step = std::min(std::floor(share * kDensitySteps), kDensitySteps - 1.0) / (kDensitySteps - 1);
      raster.Set(i % width_, i / width_, colors[maps_[i]].WithAlpha(0.35 + 0.5 * step));
    }
    return raster;
  }

 private:
  void Count(std::ptrdiff_t column, std::ptrdiff_t row, std::uint8_t map) {
    if (column < 0 || row < 0 || column >= static_cast<std::ptrdiff_t>(width_) ||
        row >= static_cast<std::ptrdiff_t>(height_))
      return;
    const std::size_t place = static_cast<std::size_t>(row) * width_ + static_cast<std::size_t>(column);
    ++counts_[place];
    maps_[place] = map;
  }

  // What all but the densest hundredth of the pixels hold at most.
  std::uint32_t Most() const {
    std::vector<std::uint32_t> filled;
    for (const std::uint32_t count : counts_)
      if (count > 0) filled.push_back(count);
    if (filled.empty()) return 1;
    return detail::ElementInOrder(filled, filled.size() - 1 - filled.size() / 100);
  }

  const Cell& cell_;
  double pixels_;
  std::size_t width_, height_;
  std::vector<std::uint32_t> counts_;
  std::vector<std::uint8_t> maps_;
  std::ptrdiff_t radius_ = 0;
};

Color ColorOfPoints(const Scene& scene, const MapScene& map) {
  return scene.maps.size() == 1 ? scene.theme.points : Mixed(map.color, scene.theme.paper, 0.15);
}

// Of the picture of the points, to a pixel of the page. SVG is seen on dense screens, too.
double PixelsOfPoints(const PlotOptions& options) {
  return 1.5 * (options.format == PlotFormat::kPng ? options.scale : 1);
}

void DrawPoints(Canvas& canvas, const Scene& scene, const Cell& cell, ViewCounts& counts) {
  std::size_t points = 0;
  for (const std::size_t map : cell.maps) points += scene.maps[map].map->points.size();
  Density density(cell, PixelsOfPoints(scene.options), points);
  std::vector<Color> colors;
  for (const std::size_t map : cell.maps) {
    const auto place = static_cast<std::uint8_t>(colors.size() & 255);
    if (colors.size() < 256) colors.push_back(ColorOfPoints(scene, scene.maps[map]));
    for (const MapPoint& point : scene.maps[map].map->points) {
      if (point.bad) continue;
      ++(density.Add(point.position, place) ? counts.points : counts.left_out);
    }
  }
  if (colors.empty()) return;
  Raster picture = density.Picture(colors);
  canvas.Image(cell.box, picture);
}

// The path in one line for each piece without a gap.
std::vector<Spots> PiecesOf(const MapScene& map, const Cell& cell) {
  std::vector<Spots> pieces;
  for (const Stop& stop : map.path) {
    if (!stop.follows || pieces.empty()) pieces.emplace_back();
    pieces.back().push_back(cell(stop.center));
  }
  return pieces;
}

void DrawEdges(Canvas& canvas, const MapScene& map, const Cell& cell,
               const std::vector<std::pair<std::uint32_t, std::uint32_t>>& edges, const Color& color) {
  Segments segments;
  for (const auto& [from, to] : edges) segments.emplace_back(cell(map.path[from].center), cell(map.path[to].center));
  canvas.Lines(segments, color.WithAlpha(0.8), 1.3);
}

// Where many keyframes stand close, dots on the line would be a thicker line.
bool ShowsKeyFrames(const std::vector<Spots>& pieces, std::size_t stops) {
  double length = 0;
  for (const Spots& piece : pieces)
    for (std::size_t i = 1; i < piece.size(); ++i) length += std::min((piece[i] - piece[i - 1]).norm(), 100.0);
  constexpr double kLeastDistance = 4;
  constexpr std::size_t kMost = 1500;
  return stops <= kMost && length >= kLeastDistance * static_cast<double>(stops);
}

void DrawPath(Canvas& canvas, const Scene& scene, const MapScene& map, const Cell& cell, bool bare) {
  const double width = bare ? 1.2 : 1.8;
  const std::vector<Spots> pieces = PiecesOf(map, cell);
  if (!bare) {
    for (const Spots& piece : pieces) canvas.Path(piece, scene.theme.paper.WithAlpha(0.8), width + 2);
    for (std::size_t i = 1; i < pieces.size(); ++i)
      canvas.Line(pieces[i - 1].back(), pieces[i].front(), map.color.WithAlpha(0.7), 1, 4);
  }
  Spots lone, all;
  for (const Spots& piece : pieces) {
    canvas.Path(piece, map.color, width);
    if (piece.size() == 1) lone.push_back(piece.front());
    all.insert(all.end(), piece.begin(), piece.end());
  }
  canvas.Dots(!bare && ShowsKeyFrames(pieces, all.size()) ? all : lone, bare ? 2.5 : 4.2, map.color);
  if (bare) return;
  DrawEdges(canvas, map, cell, map.loops, scene.theme.loop);
  DrawEdges(canvas, map, cell, map.merges, scene.theme.merge);
}

void DrawDot(Canvas& canvas, const Spot& spot, double size, const Color& color) {
  const Spot place[] = {spot};
  canvas.Dots(place, size, color);
}

void DrawSquare(Canvas& canvas, const Spot& middle, double size, const Color& color) {
  canvas.Fill({middle.x() - size / 2, middle.y() - size / 2, size, size}, color);
}

// What the signs mean.
Legend LegendOf(const Scene& scene) {
  const auto has = [&](auto list) {
    return std::ranges::any_of(scene.maps, [&](const MapScene& map) { return !(map.*list).empty(); });
  };
  Legend legend;
  if (has(&MapScene::path)) legend = LegendOfEnds(scene.theme);
  if (has(&MapScene::loops)) legend.push_back(LineEntry("loop edge", scene.theme.loop));
  if (has(&MapScene::merges)) legend.push_back(LineEntry("merge edge", scene.theme.merge));
  if (scene.options.together && scene.maps.size() > 1)  // else each stands above its cell
    for (const MapScene& map : scene.maps) legend.push_back(LineEntry(map.name, map.color));
  return legend;
}

// What the cell shows: metres to the right and up.
Range RightOf(const Cell& cell) {
  const double half = cell.box.width / 2 / cell.scale;
  return {cell.middle.x() - half, cell.middle.x() + half};
}
Range UpOf(const Cell& cell) {
  const double half = cell.box.height / 2 / cell.scale;
  return {cell.middle.y() - half, cell.middle.y() + half};
}

// A grid of squares; ticks where they are asked for.
void DrawGrid(Canvas& canvas, const Theme& theme, const Cell& cell, bool with_ticks) {
  constexpr double kLeastPixels = 60;  // between its lines
  const Letters letters{theme};
  const Box& box = cell.box;
  const double step = NiceStep(kLeastPixels / cell.scale);
  for (const Tick& tick : TicksOf(RightOf(cell), step)) {
    const double at = box.center().x() + (tick.value - cell.middle.x()) * cell.scale;
    canvas.Line({at, box.top}, {at, box.bottom()}, theme.grid);
    if (with_ticks) canvas.Text({at, box.bottom() + kTickSpace - 2}, tick.label, letters.Tick(Anchor::kMiddle));
  }
  for (const Tick& tick : TicksOf(UpOf(cell), step)) {
    const double at = box.center().y() - (tick.value - cell.middle.y()) * cell.scale;
    canvas.Line({box.left, at}, {box.right(), at}, theme.grid);
    if (with_ticks) canvas.Text({box.left - 6, at + 4}, tick.label, letters.Tick(Anchor::kEnd));
  }
  canvas.Outline(box, theme.grid);
}

std::string HeadingOf(View view) { return view == View::kPlan ? "Plan" : "Side"; }

// How the axes were found; of several maps, of each, where all were found alike.
std::string RemarkOf(const Scene& scene) {
  if (scene.maps.empty()) return "there is no keyframe and no point";
  const std::string& how = scene.maps.front().frame.how;
  const bool alike = std::ranges::all_of(scene.maps, [&](const MapScene& map) { return map.frame.how == how; });
  const std::string text = alike || scene.options.together ? how : "up as each map tells it";
  return scene.maps.size() > 1 && !scene.options.together ? text + ", each map in its own frame" : text;
}

void DrawCellHeading(Canvas& canvas, const Scene& scene, const MapScene& map, const Cell& cell) {
  const Letters letters{scene.theme};
  TextStyle name = letters.Heading();
  name.color = map.color;
  name.size = 11;
  const double foot = cell.box.top - 6;
  canvas.Text({cell.box.left, foot}, map.name, name);
  const std::string counts =
      Concat(detail::Counted(map.timed.size(), "keyframe"), ", ", detail::Counted(map.map->points.size(), "point"));
  const double left = cell.box.left + canvas.WidthOf(map.name, name) + 6;
  if (left + canvas.WidthOf(counts, letters.Tick(Anchor::kStart)) < cell.box.right())
    canvas.Text({left, foot}, counts, letters.Tick(Anchor::kStart));
}

void DrawInside(Canvas& canvas, const Scene& scene, const Cell& cell, bool bare, ViewCounts& counts) {
  const Canvas::Clip clip(canvas, cell.box);
  DrawPoints(canvas, scene, cell, counts);
  for (const std::size_t map : cell.maps) DrawPath(canvas, scene, scene.maps[map], cell, bare);
  if (bare) return;
  for (const std::size_t place : cell.maps) {
    const std::vector<Stop>& path = scene.maps[place].path;
    if (!path.empty()) DrawEnds(canvas, scene.theme, cell(path.front().center), cell(path.back().center));
  }
}

}  // namespace

void DrawEnds(Canvas& canvas, const Theme& theme, const Spot& start, const Spot& end) {
  if (start != end) {
    DrawSquare(canvas, end, 11, theme.paper);
    DrawSquare(canvas, end, 8, theme.end);
  }
  DrawDot(canvas, start, 12, theme.paper);
  DrawDot(canvas, start, 9, theme.start);
}

Legend LegendOfEnds(const Theme& theme) {
  return {{"start", [&theme](Canvas& canvas, const Spot& at) { DrawDot(canvas, at, 9, theme.start); }},
          {"end", [&theme](Canvas& canvas, const Spot& at) { DrawSquare(canvas, at, 8, theme.end); }}};
}

void DrawMetricFrame(Canvas& canvas, const Theme& theme, const Cell& cell, const std::array<std::string, 2>& names) {
  DrawGrid(canvas, theme, cell, /*with_ticks=*/true);
  DrawAxisNames(canvas, theme, cell.box, names[0], names[1]);
}

void DrawFrameOfCell(Canvas& canvas, const Scene& scene, View view, const Cell& cell) {
  if (scene.maps.empty()) return;
  if (scene.maps.size() > 1 && !scene.options.together) {
    DrawGrid(canvas, scene.theme, cell, /*with_ticks=*/false);
    DrawCellHeading(canvas, scene, scene.maps[cell.maps.front()], cell);
    return;
  }
  const auto& names = scene.maps.front().frame.names;
  const std::string unit = " (" + scene.unit() + ")";
  DrawMetricFrame(canvas, scene.theme, cell, {names[0] + unit, names[view == View::kPlan ? 1 : 2] + unit});
}

namespace {

// Of the corners of a cell but the upper left the one where the fewest places lie below a box of that size; the lower
// right one of equals.
Box EmptiestCorner(const Cell& cell, std::span<const Spot> busy, const Box& size, double margin) {
  const double left = cell.box.left + margin, right = cell.box.right() - margin - size.width;
  const double top = cell.box.top + margin, bottom = cell.box.bottom() - margin - size.height;
  Box best;
  std::size_t fewest = ~std::size_t{0};
  for (const Spot& corner : {Spot(right, bottom), Spot(left, bottom), Spot(right, top)}) {
    const Box box{corner.x(), corner.y(), size.width, size.height};
    const auto covered =
        static_cast<std::size_t>(std::ranges::count_if(busy, [&](const Spot& at) { return box.Has(at); }));
    if (covered >= fewest) continue;
    fewest = covered;
    best = box;
  }
  return best;
}

}  // namespace

void DrawScaleBar(Canvas& canvas, const Theme& theme, const Cell& cell, std::span<const Spot> busy,
                  const std::string& unit) {
  constexpr double kMargin = 12, kLeast = 60;
  const double length = NiceStep(kLeast / cell.scale);
  const std::string label = detail::Digits(length) + " " + unit;
  const TextStyle style = Letters{theme}.Label(Anchor::kMiddle);
  const double pixels = length * cell.scale, room = std::max(pixels, canvas.WidthOf(label, style)) + 16;
  constexpr double kHeight = 26;
  if (room + kMargin > cell.box.width || kHeight + kMargin > cell.box.height) return;
  const Box plate = EmptiestCorner(cell, busy, {0, 0, room, kHeight}, kMargin);
  canvas.Fill(plate, theme.paper.WithAlpha(0.85));
  const double left = plate.center().x() - pixels / 2, foot = plate.bottom() - 6;
  canvas.Line({left, foot}, {left + pixels, foot}, theme.ink, 2);
  canvas.Line({left, foot - 3}, {left, foot + 3}, theme.ink, 2);
  canvas.Line({left + pixels, foot - 3}, {left + pixels, foot + 3}, theme.ink, 2);
  canvas.Text({plate.center().x(), plate.top + 12}, label, style);
}

namespace {

// Where the path goes, and some of the points.
Spots BusyPlaces(const Scene& scene, const Cell& cell) {
  constexpr std::size_t kPoints = 2000, kWeightOfPath = 20;
  Spots places;
  for (const std::size_t place : cell.maps) {
    const MapScene& map = scene.maps[place];
    for (const Stop& stop : map.path) places.insert(places.end(), kWeightOfPath, cell(stop.center));
    const std::size_t step = map.map->points.size() / kPoints + 1;
    for (std::size_t i = 0; i < map.map->points.size(); i += step)
      places.push_back(cell(map.map->points[i].position.cast<double>()));
  }
  return places;
}

// How many points are not in the cell, in the corner that no scale bar takes.
void DrawLeftOut(Canvas& canvas, const Theme& theme, const Cell& cell, const ViewCounts& counts) {
  if (counts.left_out == 0) return;
  const std::string text = Concat(detail::Thousands(counts.left_out), " of ",
                                  detail::Counted(counts.points + counts.left_out, "point"), " outside");
  const TextStyle style = Letters{theme}.Tick(Anchor::kStart);
  const double width = canvas.WidthOf(text, style) + 8;
  if (width > cell.box.width) return;
  canvas.Fill({cell.box.left + 1, cell.box.top + 1, width, 17}, theme.paper.WithAlpha(0.85));
  canvas.Text({cell.box.left + 5, cell.box.top + 13}, text, style);
}

}  // namespace

ViewCounts DrawView(Canvas& canvas, const Scene& scene, View view, const Box& box, Detail detail) {
  const bool bare = detail == Detail::kBare;
  ViewCounts counts;
  const bool alone = scene.maps.size() <= 1 || scene.options.together;
  const Box inside = bare    ? box
                     : alone ? box.Without(kYTickSpace, kHeadingHeight, 1, kTickSpace + kNameSpace)
                             : box.Without(0, kHeadingHeight, 0, 1);
  if (!bare)
    DrawHeading(canvas, scene.theme, box, HeadingOf(view), RemarkOf(scene),
                view == View::kPlan ? LegendOf(scene) : Legend());
  for (const Cell& cell : LayCells(scene, view, inside)) {
    if (!bare) DrawFrameOfCell(canvas, scene, view, cell);
    ViewCounts here;
    DrawInside(canvas, scene, cell, bare, here);
    if (!bare) DrawLeftOut(canvas, scene.theme, cell, here);
    counts.points += here.points;
    counts.left_out += here.left_out;
    if (!bare && (alone || cell.maps.front() + 1 == scene.maps.size()) && !scene.maps.empty())
      DrawScaleBar(canvas, scene.theme, cell, BusyPlaces(scene, cell), scene.unit());
  }
  return counts;
}

}  // namespace slamdb::plot
