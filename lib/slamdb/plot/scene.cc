// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/detail/scene.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "slamdb/edit/frame/gravity.h"
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

// Where most of the cameras have their upper side.
Eigen::Vector3d UpperSide(const std::vector<Stop>& path) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Stop& stop : path) {
    const Eigen::Vector3d down =
        stop.keyframe->camera_from_world.Normalized().rotation.conjugate().cast<double>() * Eigen::Vector3d::UnitY();
    if (down.allFinite()) sum -= down;
  }
  return sum;
}

// Towards a direction where that decides, or else so that its largest number is positive: the same on every machine.
Eigen::Vector3d Pointing(const Eigen::Vector3d& axis, const Eigen::Vector3d& towards) {
  constexpr double kDecides = 1e-3;
  const double along = axis.dot(towards);
  if (std::abs(along) > kDecides * towards.norm()) return along < 0 ? Eigen::Vector3d(-axis) : axis;
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0 ? Eigen::Vector3d(-axis) : axis;
}

// Of a camera's first frame: x right, z forward, y down.
Frame FrameOfCamera() {
  Frame frame;
  frame.axes_from_world << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  frame.names = {"x of the map", "z of the map", "\u2212y of the map"};
  frame.how = "x and z of the map";
  return frame;
}

}  // namespace

Frame FrameOfSpreads(const std::vector<Eigen::Vector3d>& places, const Eigen::Vector3d& upper) {
  const auto count = static_cast<double>(places.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place : places) mean += place / count;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& place : places) spread += (place - mean) * (place - mean).transpose() / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  constexpr double kLine = 1e-12;  // of squares: below it the second spread has no direction
  if (!spread.allFinite() || solver.info() != Eigen::Success ||
      !(solver.eigenvalues()[1] > kLine * solver.eigenvalues()[2]))
    return FrameOfCamera();
  const Eigen::Vector3d right = Pointing(solver.eigenvectors().col(2), Eigen::Vector3d::Zero());
  const Eigen::Vector3d up = Pointing(solver.eigenvectors().col(0), upper);
  Frame frame;
  frame.axes_from_world << right.transpose(), up.cross(right).transpose(), up.transpose();
  frame.names = {"largest spread of the trajectory", "second spread", "above that plane"};
  frame.how = "plane of the trajectory\u2019s two largest spreads";
  return frame;
}

double GapOf(const Map& map, const std::vector<std::uint32_t>& timed) {
  std::vector<double> times;
  for (const std::uint32_t row : timed) times.push_back(map.keyframes[row].timestamp);
  return detail::GapBetween(times);
}

Frame FrameOf(const Map& map, const std::vector<Stop>& path) {
  const auto up = UpByInertia(map);
  if (!up || !up->allFinite()) {
    std::vector<Eigen::Vector3d> places;
    for (const Stop& stop : path) places.push_back(stop.center);
    return FrameOfSpreads(places, UpperSide(path));
  }
  Frame frame;
  frame.axes_from_world = Eigen::Quaterniond::FromTwoVectors(*up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  frame.names = {"x", "y", "z, up"};
  frame.how = "up by gravity";
  return frame;
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

MapScene SceneOfMap(const Map& map) {
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
  shown.frame = FrameOf(map, shown.path);
  return shown;
}

}  // namespace

Scene SceneOf(const Atlas& atlas, const PlotOptions& options) {
  Scene scene{.atlas = atlas};
  for (const Map* map : MapsToShow(atlas)) scene.maps.push_back(SceneOfMap(*map));
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
