// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/detail/scene.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "slamdb/model/derive.h"
#include "slamdb/model/detail/edges.h"
#include "slamdb/model/detail/gaps.h"
#include "slamdb/model/statistics.h"

namespace slamdb::plot {
namespace {

std::vector<std::uint32_t> RowsByTime(const Map& map) {
  std::vector<std::uint32_t> rows;
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row)
    if (!map.keyframes[row].bad && std::isfinite(map.keyframes[row].timestamp)) rows.push_back(row);
  std::ranges::stable_sort(rows, {}, [&](std::uint32_t row) { return map.keyframes[row].timestamp; });
  return rows;
}

std::vector<Stop> PathOf(const Map& map, const std::vector<std::uint32_t>& timed) {
  const double gap = GapOf(map, timed);
  std::vector<Stop> path;
  for (const std::uint32_t row : timed) {
    const KeyFrame& keyframe = map.keyframes[row];
    const Eigen::Vector3f center = CameraCenter(keyframe);
    if (!center.allFinite()) continue;
    const bool follows = !path.empty() && keyframe.timestamp - path.back().keyframe->timestamp <= gap;
    path.push_back({.keyframe = &keyframe, .row = row, .center = center.cast<double>(), .follows = follows});
  }
  return path;
}

std::vector<std::uint32_t> CountObserved(const Map& map, const IdTable& rows) {
  std::vector<std::uint32_t> counts(map.keyframes.size(), 0);
  for (const MapPoint& point : map.points) {
    if (point.bad) continue;
    for (const Observation& observation : point.observations) {
      const std::uint32_t row = rows.Find(observation.keyframe.value());
      if (row != kNoRow) ++counts[row];
    }
  }
  return counts;
}

// Those between keyframes that have a place, by it.
detail::RowPairs EdgesOf(const Map& map, const std::vector<std::uint32_t>& place_of_row, const IdTable& rows,
                         Column<KeyFrameId> KeyFrame::*list) {
  detail::RowPairs edges = detail::EdgesOf(map, list, [&](KeyFrameId id) { return rows.Find(id.value()); });
  for (auto& [from, to] : edges) std::tie(from, to) = std::minmax({place_of_row[from], place_of_row[to]});
  std::erase_if(edges, [](const auto& edge) { return edge.second == kNoRow; });
  return edges;
}

std::string HowText(UpMethod method) {
  switch (method) {
    case UpMethod::kInertia:
      return "up by gravity";
    case UpMethod::kFrame:
      return "up by z of the map";
    case UpMethod::kCameras:
      return "up by the cameras";
    case UpMethod::kPath:
      return "up by the path";
    case UpMethod::kConvention:
      break;
  }
  return "up by convention";
}

std::string AxisName(const Eigen::Vector3d& direction, std::string_view otherwise) {
  const std::optional<std::string> axis = NearAxis(direction);
  if (!axis) return std::string(otherwise);
  return (axis->front() == '-' ? "\u2212" + axis->substr(1) : *axis) + " of the map";
}

// The turn in the plane that brings the largest spread to the right; nullopt where there is none, or it is all of it.
std::optional<Eigen::Matrix2d> TurnOfSpreads(const std::vector<Eigen::Vector2d>& places) {
  constexpr double kLine = 1e-12;  // of squares: below it there is one spread alone
  const auto count = static_cast<double>(places.size());
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& place : places) mean += place / count;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& place : places) spread += (place - mean) * (place - mean).transpose() / count;
  if (!spread.allFinite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread);
  if (!(solver.eigenvalues()[0] > kLine * solver.eigenvalues()[1])) return std::nullopt;
  Eigen::Vector2d right = solver.eigenvectors().col(1);
  if (right[std::abs(right.x()) < std::abs(right.y()) ? 1 : 0] < 0) right = -right;  // the same on every machine
  return Eigen::Matrix2d{{right.x(), right.y()}, {-right.y(), right.x()}};
}

}  // namespace

Frame UprightFrame(const Up& up) {
  Frame frame;
  frame.axes_from_world = UprightFromMap(up.direction).toRotationMatrix();
  if (NearAxis(up.direction) == "z")
    frame.names = {"x", "y", "z, up"};
  else
    frame.names = {AxisName(frame.axes_from_world.row(0), "right"), AxisName(frame.axes_from_world.row(1), "forward"),
                   AxisName(frame.axes_from_world.row(2), "up")};
  frame.how = HowText(up.method);
  return frame;
}

Frame FrameOfSpreads(const Up& up, const std::vector<Eigen::Vector3d>& places) {
  Frame frame = UprightFrame(up);
  std::vector<Eigen::Vector2d> level;
  for (const Eigen::Vector3d& place : places) level.emplace_back((frame.axes_from_world * place).head<2>());
  const std::optional<Eigen::Matrix2d> turn = TurnOfSpreads(level);
  if (!turn) return frame;
  frame.axes_from_world.topRows<2>() = (*turn * frame.axes_from_world.topRows<2>()).eval();
  frame.names = {"largest level spread of the trajectory", "second spread", "up"};
  return frame;
}

Frame FrameOf(const Up& up, const std::vector<Stop>& path) {
  const bool has_axes = up.method == UpMethod::kInertia || NearAxis(up.direction) == "z";
  if (has_axes) return UprightFrame(up);
  std::vector<Eigen::Vector3d> places;
  for (const Stop& stop : path) places.push_back(stop.center);
  return FrameOfSpreads(up, places);
}

double GapOf(const Map& map, const std::vector<std::uint32_t>& timed) {
  std::vector<double> times;
  for (const std::uint32_t row : timed) times.push_back(map.keyframes[row].timestamp);
  return detail::GapBetween(times);
}

namespace {

// A page has no room for more.
constexpr std::size_t kMostMaps = 64;

// Those with keyframes or points, in their order; of very many those with the most.
std::vector<const Map*> MapsToShow(const Atlas& atlas) {
  std::vector<const Map*> maps;
  for (const Map& map : atlas.maps)
    if (!map.keyframes.empty() || !map.points.empty()) maps.push_back(&map);
  if (maps.size() <= kMostMaps) return maps;
  std::ranges::stable_sort(maps, std::greater<>(),
                           [](const Map* map) { return std::pair(map->keyframes.size(), map->points.size()); });
  maps.resize(kMostMaps);
  std::ranges::sort(maps);  // they stand in one list
  return maps;
}

MapScene SceneOfMap(const Map& map, const Up& up) {
  const IdTable rows = KeyFrameTable(map);
  MapScene shown{.map = &map, .name = ToString(map.id)};
  shown.metric = IsMetric(map);
  shown.timed = RowsByTime(map);
  shown.path = PathOf(map, shown.timed);
  shown.observed = CountObserved(map, rows);
  std::vector<std::uint32_t> place_of_row(map.keyframes.size(), kNoRow);
  for (std::uint32_t i = 0; i < shown.path.size(); ++i) place_of_row[shown.path[i].row] = i;
  shown.loops = EdgesOf(map, place_of_row, rows, &KeyFrame::loop_edges);
  shown.merges = EdgesOf(map, place_of_row, rows, &KeyFrame::merge_edges);
  shown.frame = FrameOf(up, shown.path);
  return shown;
}

}  // namespace

Scene SceneOf(const Atlas& atlas, const PlotOptions& options) {
  Scene scene{.atlas = atlas};
  const std::vector<const Map*> maps = MapsToShow(atlas);
  const std::vector<Up> ups = UpsOf(maps, options.together);
  for (std::size_t row = 0; row < maps.size(); ++row) scene.maps.push_back(SceneOfMap(*maps[row], ups[row]));
  for (const Map& map : atlas.maps) scene.other_maps += !map.keyframes.empty() || !map.points.empty() ? 1 : 0;
  scene.other_maps -= scene.maps.size();
  Redress(scene, options);
  return scene;
}

void Redress(Scene& scene, const PlotOptions& options) {
  scene.options = options;
  scene.theme = options.dark ? Theme::Dark() : Theme::Light();
  for (MapScene& map : scene.maps) map.color = ColorOfMap(map.map->id, options.dark);
}

std::size_t Scene::keyframes() const {
  std::size_t count = 0;
  for (const MapScene& map : maps) count += map.timed.size();
  return count;
}

std::string Scene::unit() const { return std::ranges::all_of(maps, &MapScene::metric) ? "m" : "map units"; }

}  // namespace slamdb::plot
