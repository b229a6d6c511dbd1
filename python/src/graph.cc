// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <string>

#include "python/src/map_in_atlas.h"
#include "python/src/module.h"
#include "python/src/reopen.h"
#include "slamdb/build/links.h"
#include "slamdb/model/sensor.h"

// What a map records of itself, and its graphs. slamdb/graphs.py makes matrices of them.
namespace slamdb::python {

namespace py = pybind11;

namespace {

using MapClass = py::class_<MapInAtlas>;

py::array PairArray(const std::vector<KeyFrameEdge>& pairs) {
  auto array = NewArray<std::uint64_t>({static_cast<py::ssize_t>(pairs.size()), py::ssize_t{2}});
  std::uint64_t* at = array.mutable_data();
  for (const auto& [one, other] : pairs) {
    *at++ = one.value();
    *at++ = other.value();
  }
  return ReadOnly(std::move(array));
}

template <Flag Map::*Member>
bool FlagOf(const MapInAtlas& m) {
  return static_cast<bool>((*m.map()).*Member);
}

void DefineRecords(MapClass map) {
  map.def_property_readonly(
         "sensor", [](const MapInAtlas& m) { return SensorText(SensorOf(*m.map()), HasImu(*m.map())); },
         "`monocular`, `stereo or RGB-D with IMU`, ...: judged by what most keyframes hold")
      .def_property_readonly(
          "initial_keyframe", [](const MapInAtlas& m) { return IdOrNone(m.map()->initial_keyframe); },
          "id of the keyframe that bundle adjustment fixes, or None")
      .def_property_readonly(
          "root_keyframe", [](const MapInAtlas& m) { return IdOrNone(m.map()->first_keyframe); },
          "id of the root of the spanning tree, or None")
      .def_property_readonly(
          "lowest_keyframe", [](const MapInAtlas& m) { return IdOrNone(m.map()->lowest_keyframe); },
          "the lowest id of its keyframes, or None")
      .def_property_readonly(
          "origin_keyframes",
          [](const MapInAtlas& m) {
            std::vector<std::uint64_t> ids;
            const auto recorded = m.map();
            for (const KeyFrameId id : recorded->origins) ids.push_back(id.value());
            return ids;
          },
          "ids of the roots for global bundle adjustment")
      .def_property_readonly(
          "max_keyframe_id", [](const MapInAtlas& m) { return m.map()->max_keyframe_id; },
          "the largest id that a keyframe of it ever had")
      .def_property_readonly(
          "big_change_index", [](const MapInAtlas& m) { return m.map()->big_change_index; },
          "how often loops were closed and the like")
      .def_property_readonly("imu_ba1", &FlagOf<&Map::imu_ba1>, "whether the first inertial bundle adjustment was done")
      .def_property_readonly("imu_ba2", &FlagOf<&Map::imu_ba2>, "whether the second one was");
}

void DefineEdges(MapClass map) {
  map.def_property_readonly(
         "loop_edges", [](const MapInAtlas& m) { return PairArray(EdgesOf(*m.map(), EdgeKind::kLoop)); },
         "(E, 2) uint64, computed: ids of keyframes, each edge once, the smaller id first")
      .def_property_readonly(
          "merge_edges", [](const MapInAtlas& m) { return PairArray(EdgesOf(*m.map(), EdgeKind::kMerge)); },
          "(E, 2) uint64, computed: likewise")
      .def(
          "essential_graph",
          [](const MapInAtlas& m, int min_weight) { return PairArray(EssentialEdges(*m.map(), min_weight)); },
          py::kw_only(), py::arg("min_weight") = 100,
          "(E, 2) uint64: edges of the graph that loops are closed with, as ids of keyframes: spanning tree, loop and\n"
          "merge edges, covisibility of at least `min_weight` points, and with an IMU what follows in time")
      .def(
          "covisibility",
          [](const py::object& self) { return py::module_::import("slamdb.graphs").attr("covisibility")(self); },
          "(N, N) scipy.sparse.csr_matrix of int32: how many points the keyframe of a row shares with that of a "
          "column,\n"
          "as recorded: both sides of an edge may differ. Needs scipy; KeyFrames.connections has the same without it.")
      .def(
          "spanning_tree",
          [](const py::object& self) { return py::module_::import("slamdb.graphs").attr("spanning_tree")(self); },
          "(N,) int64: row of each keyframe's parent; -1: it has none");
}

}  // namespace

void DefineGraphs(py::module_& module) {
  const auto map = Reopen<MapClass>(module, "Map");
  DefineRecords(map);
  DefineEdges(map);
}

}  // namespace slamdb::python
