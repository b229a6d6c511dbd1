// SPDX-License-Identifier: BSD-3-Clause
// Three rows: plans of both maps in their own frames and in one, a histogram of the errors of matches, and two
// keyframes with the points that both see.
#include "slamdb/plot/alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/index.h"
#include "slamdb/model/statistics.h"
#include "slamdb/model/up.h"
#include "slamdb/plot/detail/axis.h"
#include "slamdb/plot/detail/page.h"
#include "slamdb/plot/detail/scene.h"

namespace slamdb {
namespace plot {
namespace {

using detail::Concat;

constexpr double kGap = 18, kPlanHeight = 330, kHistogramHeight = 170;
constexpr std::size_t kMostDots = 5000;
constexpr double kMostSigmas = 5;
constexpr int kBins = 25;

// A map on the plan.
struct Layer {
  Spots points, path;
  Color color;
};

Layer LayerOf(const Map& map, const Similarity3d& first_from_map, const Eigen::Matrix3d& axes, const Color& color) {
  Layer layer{.color = color};
  const auto place = [&](const Eigen::Vector3f& position) -> Spot {
    return (axes * (first_from_map * position.cast<double>())).head<2>();
  };
  const std::size_t step = map.points.size() / kMostDots + 1;
  for (std::size_t row = 0; row < map.points.size(); row += step)
    if (const MapPoint& point = map.points[row]; !point.bad && point.position.allFinite())
      layer.points.push_back(place(point.position));
  std::vector<const KeyFrame*> keyframes;
  for (const KeyFrame& keyframe : map.keyframes)
    if (!keyframe.bad && CameraCenter(keyframe).allFinite()) keyframes.push_back(&keyframe);
  std::ranges::stable_sort(keyframes, {}, &KeyFrame::timestamp);
  for (const KeyFrame* keyframe : keyframes) layer.path.push_back(place(CameraCenter(*keyframe)));
  return layer;
}

// The smallest range that holds most of all places, in one scale for both axes.
std::array<Range, 2> RangesOf(const std::vector<Layer>& layers, const Box& inside) {
  std::array<std::vector<double>, 2> values;
  for (const Layer& layer : layers)
    for (const Spots& spots : {layer.points, layer.path})
      for (const Spot& spot : spots)
        for (std::size_t axis = 0; axis < 2; ++axis) values[axis].push_back(spot[static_cast<Eigen::Index>(axis)]);
  std::array<Range, 2> ranges;
  double unit = 0;  // per pixel
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::ranges::sort(values[axis]);
    const std::size_t rim = values[axis].size() / 100;
    ranges[axis] = {values[axis][rim], values[axis][values[axis].size() - 1 - rim]};
    unit = std::max(unit, 1.1 * ranges[axis].size() / (axis == 0 ? inside.width : inside.height));
  }
  if (!(unit > 0)) unit = 1e-3;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double middle = (ranges[axis].low + ranges[axis].high) / 2;
    const double half = unit * (axis == 0 ? inside.width : inside.height) / 2;
    ranges[axis] = {middle - half, middle + half};
  }
  return ranges;
}

class Panels {
 public:
  Panels(MapRef first, MapRef second, const Alignment& alignment, const Theme& theme, bool dark)
      : first_(first.atlas->maps[first.map]),
        second_(second.atlas->maps[second.map]),
        alignment_(alignment),
        theme_(theme),
        colors_{ColorOfMap(MapId(0), dark), ColorOfMap(MapId(1), dark)} {}

  void DrawPlans(Canvas& canvas, const Box& box) const {
    const double width = (box.width - kGap) / 2;
    DrawPlan(canvas, {box.left, box.top, width, box.height}, {}, "Before", "as the files have them");
    DrawPlan(canvas, {box.left + width + kGap, box.top, width, box.height}, *alignment_.first_from_second, "After",
             std::string(NameOf(alignment_.verdict)));
  }

  void DrawErrors(Canvas& canvas, const Box& box) const {
    std::vector<std::uint64_t> counts(kBins, 0);
    for (const MatchedPoints& match : alignment_.matches) {
      const double share = static_cast<double>(match.error) / kMostSigmas;
      ++counts[static_cast<std::size_t>(std::clamp(share * kBins, 0.0, kBins - 1.0))];
    }
    const double highest = static_cast<double>(std::max<std::uint64_t>(1, *std::ranges::max_element(counts)));
    const Diagram diagram = DrawDiagram(canvas, theme_, box, {0, kMostSigmas}, {0, 1.08 * highest},
                                        {"Matches",
                                         Concat(alignment_.matches.size(), " of points, by their reprojection error"),
                                         "sigmas of the keypoint, in the worse picture",
                                         "matches",
                                         {}});
    for (int bin = 0; bin < kBins; ++bin) {
      const double left = diagram.x(kMostSigmas * bin / kBins), right = diagram.x(kMostSigmas * (bin + 1) / kBins);
      const double top = diagram.y(static_cast<double>(counts[static_cast<std::size_t>(bin)]));
      canvas.Fill({left + 0.5, top, right - left - 1, diagram.y(0) - top}, colors_[1]);
    }
  }

  double HeightOfPair(double width) const {
    const auto [first, second] = BestPair();
    if (first == nullptr || second == nullptr) return 0;
    return kHeadingHeight + std::max(AspectOf(*first), AspectOf(*second)) * (width - kGap) / 2;
  }

  void DrawPair(Canvas& canvas, const Box& box) const {
    const auto [first, second] = BestPair();
    if (first == nullptr || second == nullptr) return;
    const std::vector<std::pair<const Keypoint*, const Keypoint*>> seen = SeenByBoth(*first, *second);
    DrawHeading(canvas, theme_, box, Concat(ToString(first->id), " and ", ToString(second->id)),
                Concat("the pair that agrees most: ", seen.size(), " points that were matched are in both"));
    const double width = (box.width - kGap) / 2;
    const Box left{box.left, box.top + kHeadingHeight, width, width * AspectOf(*first)};
    const Box right{box.left + width + kGap, left.top, width, width * AspectOf(*second)};
    DrawKeypoints(canvas, *first, left);
    DrawKeypoints(canvas, *second, right);
    Segments lines;
    for (const auto& [one, other] : seen)
      lines.emplace_back(PlaceOf(*first, *one, left), PlaceOf(*second, *other, right));
    canvas.Lines(lines, theme_.merge.WithAlpha(0.35), 0.7);
  }

 private:
  void DrawPlan(Canvas& canvas, const Box& box, const Similarity3d& first_from_second, const std::string& heading,
                const std::string& remark) const {
    const Eigen::Matrix3d axes = UprightFrame(UpOf(first_)).axes_from_world;
    const std::vector<Layer> layers = {LayerOf(first_, {}, axes, colors_[0]),
                                       LayerOf(second_, first_from_second, axes, colors_[1])};
    const Box inside = box.Without(kYTickSpace, kHeadingHeight, 0, kTickSpace + kNameSpace);
    const auto [x, y] = RangesOf(layers, inside);
    const std::string unit = IsMetric(first_) ? "m" : "map units";
    const Diagram diagram =
        DrawDiagram(canvas, theme_, box, x, y,
                    {heading, remark, unit, unit, {LineEntry("first", colors_[0]), LineEntry("second", colors_[1])}});
    const Canvas::Clip clip(canvas, diagram.inside);
    const auto placed = [&](const Spots& spots) {
      Spots places;
      for (const Spot& spot : spots) places.push_back(diagram(spot.x(), spot.y()));
      return places;
    };
    for (const Layer& layer : layers) canvas.Dots(placed(layer.points), 1.4, layer.color.WithAlpha(0.35));
    for (const Layer& layer : layers) canvas.Path(placed(layer.path), layer.color, 1.8);
  }

  std::pair<const KeyFrame*, const KeyFrame*> BestPair() const {
    if (alignment_.pairs.empty()) return {nullptr, nullptr};
    const auto find = [](const Map& map, KeyFrameId id) {
      const std::uint32_t row = KeyFrameTable(map).Find(id.value());
      return row == kNoRow ? nullptr : &map.keyframes[row];
    };
    return {find(first_, alignment_.pairs.front().first), find(second_, alignment_.pairs.front().second)};
  }

  std::vector<std::pair<const Keypoint*, const Keypoint*>> SeenByBoth(const KeyFrame& first,
                                                                      const KeyFrame& second) const {
    std::vector<std::pair<const Keypoint*, const Keypoint*>> seen;
    const IdTable first_points = PointTable(first_), second_points = PointTable(second_);
    const auto keypoint = [](const Map& map, const IdTable& points, MapPointId id,
                             const KeyFrame& keyframe) -> const Keypoint* {
      const std::uint32_t row = points.Find(id.value());
      if (row == kNoRow) return nullptr;
      const auto& observations = map.points[row].observations;
      const auto found = std::ranges::find(observations, keyframe.id, &Observation::keyframe);
      return found == observations.end() || found->left < 0 ? nullptr : ObservedKeypoint(keyframe, found->left);
    };
    for (const MatchedPoints& match : alignment_.matches) {
      const Keypoint* one = keypoint(first_, first_points, match.first, first);
      const Keypoint* other = one == nullptr ? nullptr : keypoint(second_, second_points, match.second, second);
      if (other != nullptr) seen.emplace_back(one, other);
    }
    return seen;
  }

  static double AspectOf(const KeyFrame& keyframe) {
    const ImageBounds& bounds = keyframe.bounds;
    const double width = static_cast<double>(bounds.max_x) - bounds.min_x,
                 height = static_cast<double>(bounds.max_y) - bounds.min_y;
    return width > 0 && height > 0 ? std::clamp(height / width, 0.2, 2.0) : 0.75;
  }

  static Spot PlaceOf(const KeyFrame& keyframe, const Keypoint& keypoint, const Box& box) {
    const ImageBounds& bounds = keyframe.bounds;
    return {box.left + (static_cast<double>(keypoint.x) - bounds.min_x) /
                           (static_cast<double>(bounds.max_x) - bounds.min_x) * box.width,
            box.top + (static_cast<double>(keypoint.y) - bounds.min_y) /
                          (static_cast<double>(bounds.max_y) - bounds.min_y) * box.height};
  }

  void DrawKeypoints(Canvas& canvas, const KeyFrame& keyframe, const Box& box) const {
    const Features& features = keyframe.features;
    Spots spots;
    for (const Keypoint& keypoint : features.is_fisheye_stereo() ? features.keypoints : features.undistorted)
      spots.push_back(PlaceOf(keyframe, keypoint, box));
    canvas.Outline(box, theme_.grid);
    const Canvas::Clip clip(canvas, box);
    canvas.Dots(spots, 2, theme_.faint_ink.WithAlpha(0.6));
  }

  const Map &first_, &second_;
  const Alignment& alignment_;
  const Theme& theme_;
  const std::array<Color, 2> colors_;
};

}  // namespace
}  // namespace plot

Plot DrawAlignment(MapRef first, MapRef second, const Alignment& alignment, const PlotOptions& options) {
  using namespace plot;  // NOLINT(google-build-using-namespace): the folder's own
  RequireSizes(options);
  if (!alignment.first_from_second)
    throw Error(ErrorKind::kNotPossible, "no two keyframes agree, so there is nothing to draw");
  const Theme& theme = options.dark ? Theme::Dark() : Theme::Light();
  const Panels panels(first, second, alignment, theme, options.dark);
  const double width = options.width - 2 * kMargin, top = TopOfPage(options);
  const double height = top + kPlanHeight + kGap + kHistogramHeight + kGap + panels.HeightOfPair(width) + kMargin;
  Plot plot{.width = static_cast<double>(options.width), .height = std::ceil(height), .text = alignment.reason};
  Canvas canvas(plot.width, plot.height, options.format, options.scale);
  canvas.Fill({0, 0, plot.width, plot.height}, theme.paper);
  if (!options.title.empty()) DrawTitle(canvas, theme, options.title, alignment.reason, plot.width);
  panels.DrawPlans(canvas, {kMargin, top, width, kPlanHeight});
  panels.DrawErrors(canvas, {kMargin, top + kPlanHeight + kGap, width, kHistogramHeight});
  panels.DrawPair(canvas, {kMargin, top + kPlanHeight + kHistogramHeight + 2 * kGap, width, 0});
  plot.bytes = canvas.Finish("alignment", detail::Concat(options.title, ": alignment"), plot.text);
  return plot;
}

}  // namespace slamdb
