// SPDX-License-Identifier: BSD-3-Clause
// The trajectory, coloured by time; or laid onto a reference, coloured by its distance from it, which a diagram below
// shows over time.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/model/detail/gaps.h"
#include "slamdb/plot/detail/panels.h"
#include "slamdb/plot/detail/view.h"

namespace slamdb::plot {
namespace {

using detail::Concat;

constexpr double kDiagramHeight = 150, kBarHeight = 34;

// A trajectory that was laid onto the reference.
struct Laid {
  const TrajectoryEvaluation& evaluation;
  std::string name;
  Color color;

  const std::vector<PairedPose>& poses() const { return evaluation.poses; }
  // Whether a pose is on the way from the one before it, and no gap is between.
  bool Follows(std::size_t pose) const {
    return pose > 0 && poses()[pose].timestamp - poses()[pose - 1].timestamp <= evaluation.coverage.gap_limit;
  }
};

struct Comparison {
  const PlotReference& reference;
  std::vector<Laid> laid;
  Frame frame;  // of the reference
  double most = 0;
};

// x and y of a reference whose z is up, as most have it; else its own spreads.
Frame FrameOfReference(const std::vector<TrajectoryPose>& reference, const Eigen::Vector3d& up) {
  constexpr double kUpright = 0.98;  // cosine: the up of a map without inertia is rough
  if (up.z() > kUpright) {
    Frame frame;
    frame.names = {"x of the reference", "y of the reference", "z of the reference"};
    frame.how = "x and y of the reference";
    return frame;
  }
  std::vector<Eigen::Vector3d> places;
  for (const TrajectoryPose& pose : reference)
    if (pose.position.allFinite()) places.push_back(pose.position);
  return FrameOfSpreads({.direction = up}, places);
}

const MapScene* FindMap(const Scene& scene, const TrajectoryEvaluation& evaluation) {
  if (evaluation.maps.empty()) return nullptr;
  const auto found =
      std::ranges::find(scene.maps, evaluation.maps.front(), [](const MapScene& map) { return map.map->id; });
  return found == scene.maps.end() ? nullptr : &*found;
}

Comparison Compare(const Scene& scene) {
  Comparison comparison{.reference = *scene.options.reference};
  for (const TrajectoryEvaluation& evaluation : comparison.reference.evaluation.evaluations) {
    const MapScene* map = FindMap(scene, evaluation);
    const std::size_t maps = evaluation.maps.size();
    comparison.laid.push_back({evaluation,
                               map == nullptr ? std::string("trajectory")
                               : maps == 1    ? map->name
                                              : detail::Counted(maps, "map"),
                               map == nullptr ? ColorOfMap(MapId(0), scene.options.dark) : map->color});
    comparison.most = std::max(comparison.most, evaluation.absolute.translation.max);
  }
  if (comparison.laid.empty()) throw Error(ErrorKind::kNotPossible, "there is no evaluation beside the reference");
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const TrajectoryEvaluation& first = comparison.laid.front().evaluation;
  if (const MapScene* map = FindMap(scene, first))
    up = first.alignment.reference_from_estimate.rotation *
         Eigen::Vector3d(map->frame.axes_from_world.row(2).transpose());
  comparison.frame = FrameOfReference(comparison.reference.poses, up);
  return comparison;
}

// A line whose pieces have colours, of as few colours as amounts have steps.
class ColoredLine {
 public:
  void Add(const Spot& from, const Spot& to, double amount) {
    pieces_[static_cast<std::size_t>(StepOfAmount(amount) * kAmountSteps)].emplace_back(from, to);
  }
  void Draw(Canvas& canvas, double width) const {
    for (std::size_t step = 0; step < pieces_.size(); ++step)
      if (!pieces_[step].empty())
        canvas.Lines(pieces_[step], ColorOfAmount((static_cast<double>(step) + 0.5) / kAmountSteps), width);
  }

 private:
  std::array<Segments, kAmountSteps> pieces_;
};

Cell CellOf(const Comparison& comparison, const Box& box) {
  Eigen::Matrix<double, 2, 3> axes;
  axes << comparison.frame.axes_from_world.row(0), comparison.frame.axes_from_world.row(1);
  std::array<std::vector<double>, 2> places;
  const auto add = [&](const Eigen::Vector3d& place) {
    if (!place.allFinite()) return;
    const Eigen::Vector2d at = axes * place;
    places[0].push_back(at.x());
    places[1].push_back(at.y());
  };
  for (const TrajectoryPose& pose : comparison.reference.poses) add(pose.position);
  for (const Laid& laid : comparison.laid)
    for (const PairedPose& pose : laid.poses()) add(pose.position);
  return FitCell(box, RangeOfMost(places[0]), RangeOfMost(places[1]), axes);
}

// All of it, also where nothing is held against it; without the ways over gaps.
void DrawReference(Canvas& canvas, const Theme& theme, std::vector<TrajectoryPose> poses, const Cell& cell) {
  std::erase_if(poses, [](const TrajectoryPose& pose) { return !std::isfinite(pose.timestamp); });
  std::ranges::stable_sort(poses, {}, &TrajectoryPose::timestamp);
  std::vector<double> times;
  for (const TrajectoryPose& pose : poses) times.push_back(pose.timestamp);
  const double gap = detail::GapBetween(times);
  Spots piece;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i > 0 && times[i] - times[i - 1] > gap) {
      canvas.Path(piece, theme.reference, 3.5);
      piece.clear();
    }
    piece.push_back(cell(poses[i].position));
  }
  canvas.Path(piece, theme.reference, 3.5);
}

void DrawBoth(Canvas& canvas, const Scene& scene, const Comparison& comparison, const Cell& cell) {
  const Canvas::Clip clip(canvas, cell.box);
  DrawReference(canvas, scene.theme, comparison.reference.poses, cell);
  ColoredLine line;
  for (const Laid& laid : comparison.laid)
    for (std::size_t i = 1; i < laid.poses().size(); ++i) {
      const PairedPose &from = laid.poses()[i - 1], &to = laid.poses()[i];
      const double error = (from.translation_error + to.translation_error) / 2;
      if (laid.Follows(i)) line.Add(cell(from.position), cell(to.position), error / std::max(comparison.most, 1e-12));
    }
  line.Draw(canvas, 2);
  for (const Laid& laid : comparison.laid)
    DrawEnds(canvas, scene.theme, cell(laid.poses().front().position), cell(laid.poses().back().position));
}

// What the error is, in the words of `slamdb evaluate`.
std::string FiguresOf(const Laid& laid, const std::string& unit, double width) {
  constexpr double kLeastForAll = 560;
  const ErrorStatistics& numbers = laid.evaluation.absolute.translation;
  if (width < kLeastForAll) return Concat("rmse ", detail::Digits(numbers.rmse, 4), " ", unit);
  return Concat("rmse ", detail::Digits(numbers.rmse, 4), " ", unit, ", median ", detail::Digits(numbers.median, 4),
                " ", unit, ", max ", detail::Digits(numbers.max, 4), " ", unit, " of ",
                detail::Counted(laid.poses().size(), "pair"));
}

// The names of the trajectories where there are several, with what each has.
Legend LegendOf(const Comparison& comparison) {
  Legend legend;
  if (comparison.laid.size() < 2) return legend;
  for (const Laid& laid : comparison.laid)
    legend.push_back(
        LineEntry(Concat(laid.name, ": rmse ", detail::Digits(laid.evaluation.absolute.translation.rmse, 4), " ",
                         comparison.reference.unit),
                  laid.color));
  return legend;
}

void DrawErrors(Canvas& canvas, const Scene& scene, const Comparison& comparison, const Box& box) {
  double begin = std::numeric_limits<double>::infinity(), end = -begin;
  for (const Laid& laid : comparison.laid) {
    begin = std::min(begin, laid.poses().front().timestamp);
    end = std::max(end, laid.poses().back().timestamp);
  }
  const bool alone = comparison.laid.size() == 1;
  const std::string& unit = comparison.reference.unit;
  const Diagram diagram = DrawDiagram(canvas, scene.theme, box, {0, std::max(end - begin, 1e-3)},
                                      {0, comparison.most > 0 ? 1.08 * comparison.most : 1},
                                      {.heading = "Error over time",
                                       .remark = alone ? FiguresOf(comparison.laid.front(), unit, box.width) : "",
                                       .x_name = "seconds since the first pair",
                                       .y_name = "error (" + unit + ")",
                                       .legend = LegendOf(comparison)});
  for (const Laid& laid : comparison.laid) {
    Segments line;
    Spots lone;
    const auto spot = [&](const PairedPose& pose) { return diagram(pose.timestamp - begin, pose.translation_error); };
    for (std::size_t i = 0; i < laid.poses().size(); ++i)
      if (laid.Follows(i))
        line.emplace_back(spot(laid.poses()[i - 1]), spot(laid.poses()[i]));
      else
        lone.push_back(spot(laid.poses()[i]));
    canvas.Lines(line, laid.color, 1.4);
    canvas.Dots(lone, 3, laid.color);
    const double level = diagram.y(laid.evaluation.absolute.translation.rmse);
    const Color& color = alone ? scene.theme.mark : laid.color;
    canvas.Line({diagram.inside.left, level}, {diagram.inside.right(), level}, color, 1.2, 4);
    if (alone)
      canvas.Text({diagram.inside.right() - 3, level - 4}, "rmse",
                  {.color = color, .size = 11, .anchor = Anchor::kEnd});
  }
}

void DrawComparison(Canvas& canvas, const Scene& scene, const Box& box) {
  const Comparison comparison = Compare(scene);
  const std::string& unit = comparison.reference.unit;
  Legend legend = LegendOfEnds(scene.theme);
  legend.push_back(LineEntry("reference", scene.theme.reference));
  DrawHeading(canvas, scene.theme, box, "Trajectory and reference", comparison.frame.how, legend);
  const Box plan{box.left, box.top, box.width, box.height - kDiagramHeight - kBarHeight - 16};
  const Cell cell = CellOf(comparison, plan.Without(kYTickSpace, kHeadingHeight, 1, kTickSpace + kNameSpace));
  const auto named = [&](int axis) { return Concat(comparison.frame.names.at(axis), " (", unit, ")"); };
  DrawMetricFrame(canvas, scene.theme, cell, {named(0), named(1)});
  DrawBoth(canvas, scene, comparison, cell);
  Spots busy;
  for (const TrajectoryPose& pose : comparison.reference.poses) busy.push_back(cell(pose.position));
  for (const Laid& laid : comparison.laid)
    for (const PairedPose& pose : laid.poses()) busy.push_back(cell(pose.position));
  DrawScaleBar(canvas, scene.theme, cell, busy, unit);
  const Box bar{box.left + kYTickSpace, plan.bottom() + 2, box.width - kYTickSpace, kBarHeight - 4};
  DrawColorBar(canvas, scene.theme, bar, "0", Concat(detail::Digits(comparison.most, 2), " ", unit),
               "error, along the trajectory");
  DrawErrors(canvas, scene, comparison, {box.left, box.bottom() - kDiagramHeight, box.width, kDiagramHeight});
}

void DrawAlone(Canvas& canvas, const Scene& scene, const Box& box) {
  DrawHeading(canvas, scene.theme, box, "Trajectory", scene.maps.empty() ? "" : scene.maps.front().frame.how,
              LegendOfEnds(scene.theme));
  const bool alone = scene.maps.size() <= 1 || scene.options.together;
  const Box inside =
      box.Without(alone ? kYTickSpace : 0, kHeadingHeight, 1, kBarHeight + (alone ? kTickSpace + kNameSpace : 4));
  double longest = 0;
  for (const Cell& cell : LayCells(scene, View::kPlan, inside, Shown::kPaths)) {
    DrawFrameOfCell(canvas, scene, View::kPlan, cell);
    const Canvas::Clip clip(canvas, cell.box);
    for (const std::size_t place : cell.maps) {
      const MapScene& map = scene.maps[place];
      if (map.path.empty()) continue;
      const double begin = map.path.front().keyframe->timestamp;
      const double span = map.path.back().keyframe->timestamp - begin;
      longest = std::max(longest, span);
      ColoredLine line;
      for (std::size_t i = 1; i < map.path.size(); ++i)
        if (map.path[i].follows)
          line.Add(cell(map.path[i - 1].center), cell(map.path[i].center),
                   (map.path[i].keyframe->timestamp - begin) / span);
      line.Draw(canvas, 2.2);
      DrawEnds(canvas, scene.theme, cell(map.path.front().center), cell(map.path.back().center));
    }
  }
  DrawColorBar(canvas, scene.theme, {inside.left, box.bottom() - kBarHeight, inside.width, kBarHeight - 2}, "0",
               detail::DurationText(longest),
               scene.maps.size() > 1 ? "time since the first keyframe of each map" : "time since the first keyframe");
}

}  // namespace

double HeightOfTrajectory(const Scene& scene, double width) {
  const double plan = HeightOfView(scene, View::kPlan, width);
  return !scene.options.reference ? plan + kBarHeight
                                  : kHeadingHeight + 0.62 * width + kBarHeight + kDiagramHeight + 16;
}

std::string ErrorText(const Scene& scene) {
  if (!scene.options.reference) return {};
  const Comparison comparison = Compare(scene);
  std::string text;
  for (const Laid& laid : comparison.laid)
    text += Concat(text.empty() ? "" : ", ", comparison.laid.size() > 1 ? laid.name + " " : "", "rmse ",
                   detail::Digits(laid.evaluation.absolute.translation.rmse, 4), " ", comparison.reference.unit);
  return text;
}

void DrawTrajectory(Canvas& canvas, const Scene& scene, const Box& box) {
  if (!scene.options.reference)
    DrawAlone(canvas, scene, box);
  else
    DrawComparison(canvas, scene, box);
}

}  // namespace slamdb::plot
