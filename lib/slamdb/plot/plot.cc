// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/plot/detail/page.h"
#include "slamdb/plot/detail/panels.h"
#include "slamdb/plot/detail/view.h"

namespace slamdb {
namespace {

using detail::Concat;
using namespace plot;

struct Kind {
  PlotKind kind;
  std::string_view name;
  double (*height)(const Scene& scene, double width);
  ViewCounts (*draw)(Canvas& canvas, const Scene& scene, const Box& box);
};

// A panel that counts nothing, as a Kind's function.
template <void (*Draw)(Canvas&, const Scene&, const Box&)>
ViewCounts Drawn(Canvas& canvas, const Scene& scene, const Box& box) {
  Draw(canvas, scene, box);
  return {};
}

template <View view>
ViewCounts DrawnView(Canvas& canvas, const Scene& scene, const Box& box) {
  return DrawView(canvas, scene, view, box);
}
template <View view>
double ViewHeight(const Scene& scene, double width) {
  return HeightOfView(scene, view, width);
}

double DiagramHeight(const Scene&, double width) { return std::clamp(0.42 * width, 180.0, 420.0); }
double SquareHeight(const Scene&, double width) { return std::min(width, 640.0) + 54; }
double TimelineHeight(const Scene& scene, double) { return HeightOfTimeline(scene); }

constexpr std::array kKinds = {
    Kind{PlotKind::kOverview, "overview", HeightOfOverview, DrawOverview},
    Kind{PlotKind::kPlan, "plan", ViewHeight<View::kPlan>, DrawnView<View::kPlan>},
    Kind{PlotKind::kSide, "side", ViewHeight<View::kSide>, DrawnView<View::kSide>},
    Kind{PlotKind::kCovisibility, "covisibility", SquareHeight, Drawn<DrawCovisibility>},
    Kind{PlotKind::kTracks, "tracks", DiagramHeight, Drawn<DrawTracks>},
    Kind{PlotKind::kObservations, "observations", DiagramHeight, Drawn<DrawObservations>},
    Kind{PlotKind::kReprojection, "reprojection", HeightOfReprojection, Drawn<DrawReprojection>},
    Kind{PlotKind::kTimeline, "timeline", TimelineHeight, Drawn<DrawTimeline>},
    Kind{PlotKind::kTrajectory, "trajectory", HeightOfTrajectory, Drawn<DrawTrajectory>},
};

const Kind& KindOf(PlotKind kind) { return *std::ranges::find(kKinds, kind, &Kind::kind); }

// `2 maps, 431 keyframes, 21,334 points, 52.3 m in 141 s`
std::string Summary(const Scene& scene) {
  std::size_t points = 0;
  double length = 0, seconds = 0;
  for (const MapScene& map : scene.maps) {
    points += map.map->points.size();
    for (std::size_t i = 1; i < map.path.size(); ++i) length += (map.path[i].center - map.path[i - 1].center).norm();
    if (!map.timed.empty())
      seconds += map.map->keyframes[map.timed.back()].timestamp - map.map->keyframes[map.timed.front()].timestamp;
  }
  return Concat(detail::Counted(scene.maps.size(), "map"), ", ", detail::Counted(scene.keyframes(), "keyframe"), ", ",
                detail::Counted(points, "point"), ", ", detail::Digits(length, 3), " ", scene.unit(), " in ",
                detail::DurationText(seconds),
                scene.other_maps == 0 ? "" : Concat("; ", detail::Counted(scene.other_maps, "map"), " not shown"));
}

// One picture of a scene that has its options.
Plot Draw(const Scene& scene) {
  const PlotOptions& options = scene.options;
  const Kind& kind = KindOf(options.kind);
  std::string summary = Summary(scene);
  if (options.kind == PlotKind::kTrajectory && options.reference) summary += "; " + ErrorText(scene);
  const double top = TopOfPage(options);
  const double width = options.width - 2 * kMargin;
  const double height = std::ceil(kind.height(scene, width));
  Plot result{.width = static_cast<double>(options.width), .height = top + height + kMargin, .text = summary};
  Canvas canvas(result.width, result.height, options.format, options.scale);
  canvas.Fill({0, 0, result.width, result.height}, scene.theme.paper);
  if (!options.title.empty()) DrawTitle(canvas, scene.theme, options.title, summary, result.width);
  const ViewCounts counts = kind.draw(canvas, scene, {kMargin, top, width, height});
  result.points = counts.points;
  result.left_out = counts.left_out;
  if (counts.left_out > 0)
    result.text += Concat("; ", detail::Counted(counts.left_out, "point"), " outside of the frame");
  result.bytes = canvas.Finish(Concat(kind.name, options.dark ? "-dark" : ""),
                               Concat(options.title.empty() ? "atlas" : options.title, ": ", kind.name), result.text);
  return result;
}

}  // namespace

std::string_view NameOf(PlotKind kind) { return KindOf(kind).name; }

std::optional<PlotKind> PlotKindByName(std::string_view name) {
  const auto found = std::ranges::find(kKinds, name, &Kind::name);
  return found == kKinds.end() ? std::nullopt : std::optional(found->kind);
}

std::span<const PlotKind> PlotKinds() {
  static constexpr auto kAll = [] {
    std::array<PlotKind, kKinds.size()> all{};
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = kKinds[i].kind;
    return all;
  }();
  return kAll;
}

bool CanPlot() { return CanDraw(); }

PlotFormat PlotFormatOf(const std::string& path) {
  if (path.ends_with(".png")) return PlotFormat::kPng;
  if (path.ends_with(".svg") || IsSpecialFile(path)) return PlotFormat::kSvg;
  throw Error(ErrorKind::kUsage, "a plot is an .svg or a .png, which " + path + " does not say");
}

Plot DrawPlot(const Atlas& atlas, const PlotOptions& options) {
  return std::move(DrawPlots(atlas, std::span(&options, 1)).front());
}

std::vector<Plot> DrawPlots(const Atlas& atlas, std::span<const PlotOptions> pictures) {
  std::vector<Plot> plots;
  for (const PlotOptions& options : pictures) RequireSizes(options);
  if (pictures.empty()) return plots;
  Scene scene = SceneOf(atlas, pictures.front());
  for (const PlotOptions& options : pictures) {
    Redress(scene, options);
    plots.push_back(Draw(scene));
  }
  return plots;
}

Plot DrawThumbnail(const Atlas& atlas, int width, int height, bool dark) {
  const Scene scene = SceneOf(atlas, {.format = PlotFormat::kPng, .dark = dark});
  Plot result{.width = static_cast<double>(width), .height = static_cast<double>(height), .text = Summary(scene)};
  Canvas canvas(width, height, PlotFormat::kPng, 1);
  const ViewCounts counts = DrawView(canvas, scene, View::kPlan, {2, 2, width - 4.0, height - 4.0}, Detail::kBare);
  result.points = counts.points;
  result.bytes = canvas.Finish("thumbnail", "", "");
  return result;
}

}  // namespace slamdb
