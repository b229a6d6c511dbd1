// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "python/src/module.h"
#include "python/src/row_class.h"

namespace slamdb::python {

namespace py = pybind11;

namespace {

using Point = Row<MapPoint>;

// Compressed by rows: observation i of point p is at offsets[p] + i.
py::tuple Observations(const PointsInMap& points) {
  const auto list = points.list();
  std::vector<std::uint64_t> offsets{0}, keyframes;
  std::vector<std::int32_t> left, right;
  offsets.reserve(list->size() + 1);
  for (const MapPoint& point : *list) offsets.push_back(offsets.back() + point.observations.size());
  for (const std::size_t count = offsets.back(); auto* column : {&left, &right}) column->reserve(count);
  keyframes.reserve(offsets.back());
  for (const MapPoint& point : *list)
    for (const Observation& observation : point.observations) {
      keyframes.push_back(observation.keyframe.value());
      left.push_back(observation.left);
      right.push_back(observation.right);
    }
  const py::object make = py::module_::import("slamdb.observations").attr("Observations");
  return make(ArrayOf(offsets), ArrayOf(keyframes), ArrayOf(left), ArrayOf(right));
}

void DefineColumns(py::class_<PointsInMap>& points) {
  points.def_property_readonly("ids", FixedMembers<std::uint64_t>(&MapPoint::id), "(N,) uint64: MapPoint::mnId")
      .def_property_readonly("positions", Members<float>(&MapPoint::position, 3),
                             "(N, 3) float32, writable: in the world frame of the map, metres or its units")
      .def_property_readonly("normals", Members<float>(&MapPoint::normal, 3),
                             "(N, 3) float32, writable: mean viewing direction, at most of unit length")
      .def_property_readonly("descriptors", Members<std::uint8_t>(&MapPoint::descriptor, 32),
                             "(N, 32) uint8, writable: ORB descriptors")
      .def_property_readonly("min_distances", Members<float>(&MapPoint::min_distance),
                             "(N,) float32, writable: scale-invariance range")
      .def_property_readonly("max_distances", Members<float>(&MapPoint::max_distance), "(N,) float32, writable")
      .def_property_readonly("first_keyframes", FixedMembers<std::int64_t>(&MapPoint::first_keyframe),
                             "(N,) int64: ids of the keyframes that made them; -1: a frame did")
      .def_property_readonly("reference_keyframes", FixedMembers<std::uint64_t>(&MapPoint::reference),
                             "(N,) uint64: ids of keyframes; NONE where there is none")
      .def_property_readonly("replaced_by", FixedMembers<std::uint64_t>(&MapPoint::replaced_by),
                             "(N,) uint64: ids of the points they were fused into; NONE as a rule")
      .def_property_readonly("bad", &FlagsOf<&MapPoint::bad, PointsInMap>, "(N,) bool, computed: culled")
      .def_property_readonly(
          "observation_counts",
          [](const PointsInMap& p) {
            return Computed<std::int64_t>(
                *p.list(), [](const MapPoint& point) { return static_cast<std::int64_t>(point.observations.size()); });
          },
          "(N,) int64, computed: how many keyframes see each")
      .def_property_readonly("observations", &Observations,
                             "computed: who sees the points, compressed by rows: those of row r are the entries from "
                             "offsets[r] to offsets[r + 1] of keyframes (ids), left and right (rows of map_points and "
                             "descriptors of their features; -1: not seen there)");
}

}  // namespace

void DefinePoints(py::module_& module) {
  py::class_<PointsInMap> points(module, "Points",
                                 "The map points of a map: columns as numpy arrays over its memory, rows as MapPoint.");
  DefineColumns(points);
  py::class_<Point> point(module, "MapPoint", "One map point.");
  DefineRowContainer<MapPoint>(module, points, "point", "PointIterator");
  DefineIdentity(point);
  point.def_property_readonly("id", [](const Point& p) { return p.entity->id.value(); })
      .def_property_readonly(
          "position", [](const Point& p) { return PositionView(p.kept, p.entity->position); },
          "(3,) float32, writable: world")
      .def_property_readonly(
          "normal", [](const Point& p) { return PositionView(p.kept, p.entity->normal); }, "(3,) float32, writable")
      .def_property_readonly(
          "descriptor",
          [](const Point& p) {
            return ViewOf(p.kept, TypeOf<std::uint8_t>(), {&p.entity->descriptor, {sizeof(Descriptor)}, {1}});
          },
          "(32,) uint8, writable: ORB descriptor")
      .def_property_readonly("bad", [](const Point& p) { return static_cast<bool>(p.entity->bad); })
      .def_property_readonly(
          "reference_keyframe", [](const Point& p) { return IdOrNone(p.entity->reference); }, "id, or None")
      .def_property_readonly(
          "observations",
          [](const Point& p) {
            py::dict observations;
            for (const Observation& o : p.entity->observations)
              observations[py::int_(o.keyframe.value())] = py::make_tuple(o.left, o.right);
            return observations;
          },
          "{keyframe id: (left, right)}: rows of map_points and descriptors of its features, -1 where it is not seen")
      .def("__repr__", [](const Point& p) { return "<slamdb.MapPoint " + std::to_string(p.entity->id.value()) + ">"; });
}

}  // namespace slamdb::python
