// SPDX-License-Identifier: BSD-3-Clause
// The trajectory, coloured by time; or laid onto a reference, coloured by its distance from it, which a diagram below
// shows over time.
#include <algorithm>
#include <cmath>
#include <optional>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/detail/time_offset.h"
#include "slamdb/evaluate/error_statistics.h"
#include "slamdb/model/derive.h"
#include "slamdb/plot/detail/panels.h"
#include "slamdb/plot/detail/view.h"

namespace slamdb::plot {
namespace {

using detail::Concat;

constexpr double kDiagramHeight = 150, kBarHeight = 34;

// A keyframe beside the place of the reference at its time.
struct Compared {
  double time;
  Eigen::Vector3d at, reference;
  bool follows;

  double error() const { return (at - reference).norm(); }
};

struct Comparison {
  std::vector<Compared> stops;        // map by map
  Frame frame;                        // of the reference
  std::vector<std::string> left_out;  // maps that could not be laid onto it
};

std::vector<TimedPosition> PositionsOf(const MapScene& map, bool body) {
  std::vector<TimedPosition> positions;
  for (const Stop& stop : map.path) {
    const Eigen::Vector3d at =
        body ? Eigen::Vector3d(WorldFromBody(*stop.keyframe).translation.cast<double>()) : stop.center;
    positions.push_back({stop.keyframe->timestamp, at});
  }
  return positions;
}

void AddStops(const MapScene& map, const TrajectoryAlignment& alignment, std::span<const TimedPosition> reference,
              const TrajectoryAlignmentOptions& options, std::vector<Compared>& stops) {
  std::vector<TimedPosition> sorted(reference.begin(), reference.end());
  std::erase_if(sorted, [](const TimedPosition& sample) { return !std::isfinite(sample.timestamp); });
  std::ranges::stable_sort(sorted, {}, &TimedPosition::timestamp);
  const detail::Pairs pairs =
      detail::PairsAt(PositionsOf(map, options.body), sorted, alignment.time_offset, options.max_time_difference);
  const double gap = GapOf(*map.map, map.timed);
  for (std::size_t i = 0; i < pairs.times.size(); ++i) {
    const bool follows = i > 0 && pairs.times[i] - pairs.times[i - 1] <= gap;
    stops.push_back({pairs.times[i], alignment.reference_from_map * pairs.source[i], pairs.target[i], follows});
  }
}

// x and y of a reference whose z is up, as most have it; else its own spreads.
Frame FrameOfReference(const std::vector<Compared>& stops, const Eigen::Vector3d& up) {
  constexpr double kUpright = 0.98;  // cosine: the up of a map without inertia is rough
  if (up.z() > kUpright) {
    Frame frame;
    frame.names = {"x of the reference", "y of the reference", "z of the reference"};
    frame.how = "x and y of the reference";
    return frame;
  }
  std::vector<Eigen::Vector3d> places;
  for (const Compared& stop : stops) places.push_back(stop.reference);
  return FrameOfSpreads({.direction = up}, places);
}

Comparison Compare(const Scene& scene) {
  Comparison comparison;
  std::optional<Error> problem;
  std::optional<Eigen::Vector3d> up;
  for (const MapScene& map : scene.maps) {
    try {
      TrajectoryAlignmentOptions options = scene.options.alignment;
      options.fit.with_scale = scene.options.with_scale.value_or(!map.metric);
      const TrajectoryAlignment alignment = AlignToTrajectory(*map.map, scene.options.reference, options);
      AddStops(map, alignment, scene.options.reference, options, comparison.stops);
      if (!up) up = alignment.reference_from_map.rotation * Eigen::Vector3d(map.frame.axes_from_world.row(2));
    } catch (const Error& error) {
      problem = error;
      comparison.left_out.push_back(map.name);
    }
  }
  if (comparison.stops.empty())
    throw problem.value_or(Error(ErrorKind::kNotPossible, "there is no map to lay onto the reference"));
  comparison.frame = FrameOfReference(comparison.stops, *up);
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

ErrorStatistics StatisticsOf(const std::vector<Compared>& stops) {
  std::vector<double> errors;
  for (const Compared& stop : stops) errors.push_back(stop.error());
  return ErrorStatisticsOf(std::move(errors));
}

Cell CellOf(const Comparison& comparison, const Box& box) {
  Eigen::Matrix<double, 2, 3> axes;
  axes << comparison.frame.axes_from_world.row(0), comparison.frame.axes_from_world.row(1);
  std::array<std::vector<double>, 2> places;
  for (const Compared& stop : comparison.stops)
    for (const Eigen::Vector3d& place : {stop.at, stop.reference}) {
      const Eigen::Vector2d at = axes * place;
      places[0].push_back(at.x());
      places[1].push_back(at.y());
    }
  return FitCell(box, RangeOfMost(places[0]), RangeOfMost(places[1]), axes);
}

void DrawBoth(Canvas& canvas, const Scene& scene, const Comparison& comparison, const Cell& cell, double most) {
  const Canvas::Clip clip(canvas, cell.box);
  ColoredLine line;
  Segments reference;
  for (std::size_t i = 1; i < comparison.stops.size(); ++i) {
    const Compared &from = comparison.stops[i - 1], &to = comparison.stops[i];
    if (!to.follows) continue;
    reference.emplace_back(cell(from.reference), cell(to.reference));
    line.Add(cell(from.at), cell(to.at), (from.error() + to.error()) / 2 / most);
  }
  canvas.Lines(reference, scene.theme.reference, 3.5);
  line.Draw(canvas, 2);
}

void DrawErrors(Canvas& canvas, const Scene& scene, const Comparison& comparison, const Box& box, double rmse) {
  double begin = comparison.stops.front().time, end = begin, most = 0;
  for (const Compared& stop : comparison.stops) {
    begin = std::min(begin, stop.time);
    end = std::max(end, stop.time);
    most = std::max(most, stop.error());
  }
  const Diagram diagram =
      DrawDiagram(canvas, scene.theme, box, {0, std::max(end - begin, 1e-3)}, {0, most > 0 ? 1.08 * most : 1},
                  {.heading = "Error over time",
                   .remark = "",
                   .x_name = "seconds since the first pair",
                   .y_name = "error (" + scene.unit() + ")"});
  Segments line;
  Spots lone;
  for (std::size_t i = 0; i < comparison.stops.size(); ++i) {
    const Compared& stop = comparison.stops[i];
    const Spot at = diagram(stop.time - begin, stop.error());
    if (stop.follows)
      line.emplace_back(diagram(comparison.stops[i - 1].time - begin, comparison.stops[i - 1].error()), at);
    else
      lone.push_back(at);
  }
  canvas.Lines(line, scene.maps.front().color, 1.4);
  canvas.Dots(lone, 3, scene.maps.front().color);
  const double level = diagram.y(rmse);
  canvas.Line({diagram.inside.left, level}, {diagram.inside.right(), level}, scene.theme.mark, 1.2, 4);
  canvas.Text({diagram.inside.right() - 3, level - 4}, "rmse",
              {.color = scene.theme.mark, .size = 11, .anchor = Anchor::kEnd});
}

void DrawComparison(Canvas& canvas, const Scene& scene, const Box& box) {
  const Comparison comparison = Compare(scene);
  const ErrorStatistics numbers = StatisticsOf(comparison.stops);
  const std::string unit = " m";  // of the reference
  DrawHeading(
      canvas, scene.theme, box, "Trajectory and reference",
      Concat("rmse ", detail::Digits(numbers.rmse, 3), unit, ", median ", detail::Digits(numbers.median, 3), unit,
             ", max ", detail::Digits(numbers.max, 3), unit, "; ", detail::Counted(comparison.stops.size(), "keyframe"),
             comparison.left_out.empty() ? "" : Concat(" without ", comparison.left_out.size(), " maps")));
  const Box plan{box.left, box.top, box.width, box.height - kDiagramHeight - kBarHeight - 16};
  const Cell cell = CellOf(comparison, plan.Without(kYTickSpace, kHeadingHeight, 1, kTickSpace + kNameSpace));
  DrawMetricFrame(canvas, scene.theme, cell, {comparison.frame.names[0] + " (m)", comparison.frame.names[1] + " (m)"});
  const double most = std::max(numbers.max, 1e-12);
  DrawBoth(canvas, scene, comparison, cell, most);
  Spots busy;
  for (const Compared& stop : comparison.stops) busy.push_back(cell(stop.at));
  DrawScaleBar(canvas, scene.theme, cell, busy, "m");
  const Box bar{box.left + kYTickSpace, plan.bottom() + 2, box.width - kYTickSpace, kBarHeight - 4};
  DrawColorBar(canvas, scene.theme, bar, "0", detail::Digits(numbers.max, 2) + unit,
               "error, along the trajectory; the reference in grey");
  DrawErrors(canvas, scene, comparison, {box.left, box.bottom() - kDiagramHeight, box.width, kDiagramHeight},
             numbers.rmse);
}

void DrawAlone(Canvas& canvas, const Scene& scene, const Box& box) {
  DrawHeading(canvas, scene.theme, box, "Trajectory", scene.maps.empty() ? "" : scene.maps.front().frame.how);
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
    }
  }
  DrawColorBar(canvas, scene.theme, {inside.left, box.bottom() - kBarHeight, inside.width, kBarHeight - 2}, "0",
               detail::DurationText(longest),
               scene.maps.size() > 1 ? "time since the first keyframe of each map" : "time since the first keyframe");
}

}  // namespace

double HeightOfTrajectory(const Scene& scene, double width) {
  const double plan = HeightOfView(scene, View::kPlan, width);
  return scene.options.reference.empty() ? plan + kBarHeight
                                         : kHeadingHeight + 0.62 * width + kBarHeight + kDiagramHeight + 16;
}

void DrawTrajectory(Canvas& canvas, const Scene& scene, const Box& box) {
  if (scene.options.reference.empty())
    DrawAlone(canvas, scene, box);
  else
    DrawComparison(canvas, scene, box);
}

}  // namespace slamdb::plot
