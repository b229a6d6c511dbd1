// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string>

#include "python/src/given.h"
#include "python/src/map_in_atlas.h"
#include "python/src/module.h"
#include "python/src/reopen.h"
#include "slamdb/model/index.h"

// More columns of keyframes and points, and looking up by id.
namespace slamdb::python {

namespace py = pybind11;

namespace {

using KeyFramesClass = py::class_<KeyFramesInMap>;
using PointsClass = py::class_<PointsInMap>;

// Where ids are; an unknown one is an error that tells the row.
template <class Entities>
py::array RowsOf(const Entities& entities, const IdTable& table, const py::object& ids) {
  std::vector<std::int64_t> rows;
  for (const std::uint64_t id : GivenIds(ids, "ids")) {
    const std::uint32_t row = table.Find(id);
    if (row == kNoRow)
      throw Error(ErrorKind::kNotFound, "ids: row " + std::to_string(rows.size()) + " is " + std::to_string(id) +
                                            ", which " + ToString(entities.of.id) + " does not have");
    rows.push_back(row);
  }
  return ArrayOf(rows);
}

template <class Entities, class Entity>
Row<Entity> ById(const Entities& entities, Id<Entity> id) {
  const auto list = entities.list();
  const auto found = std::ranges::find(*list, id, &Entity::id);
  if (found == list->end()) throw Error(ErrorKind::kNotFound, ToString(entities.of.id) + " has no " + ToString(id));
  return {list, &*found};
}

// World from camera, tx ty tz qx qy qz qw.
py::array PosesQuaternion(const KeyFramesInMap& keyframes) {
  const auto list = keyframes.list();
  auto poses = NewArray<double>({static_cast<py::ssize_t>(list->size()), py::ssize_t{7}});
  double* at = poses.mutable_data();
  for (const KeyFrame& keyframe : *list) {
    const Rigid3f pose = keyframe.camera_from_world.Normalized().Inverse();
    at = std::copy_n(pose.translation.data(), 3, at);
    at = std::copy_n(pose.rotation.coeffs().data(), 4, at);
  }
  return ReadOnly(std::move(poses));
}

// Compressed by rows: connection i of the keyframe in row k is at offsets[k] + i.
py::object ConnectionsOf(const KeyFramesInMap& keyframes) {
  std::vector<std::uint64_t> offsets{0}, others;
  std::vector<std::int32_t> weights;
  const auto list = keyframes.list();
  for (const KeyFrame& keyframe : *list) {
    for (const Connection& connection : keyframe.connections) {
      others.push_back(connection.keyframe.value());
      weights.push_back(connection.weight);
    }
    offsets.push_back(others.size());
  }
  const py::object make = py::module_::import("slamdb.graphs").attr("Connections");
  return make(ArrayOf(offsets), ArrayOf(others), ArrayOf(weights));
}

void DefineKeyFrameColumns(KeyFramesClass keyframes) {
  keyframes
      .def_property_readonly("poses_quaternion", &PosesQuaternion,
                             "(N, 7) float64, computed: world from (left) camera, tx ty tz qx qy qz qw")
      .def_property_readonly("connections", &ConnectionsOf,
                             "computed: the covisibility graph, compressed by rows; see Map.covisibility")
      .def_property_readonly("frame_ids", FixedMembers<std::uint64_t>(&KeyFrame::frame_id),
                             "(N,) uint64: ids of the frames that became them")
      .def_property_readonly(
          "cameras",
          [](const KeyFramesInMap& k) {
            return Computed<std::uint64_t>(*k.list(), [](const KeyFrame& keyframe) { return keyframe.camera.value(); });
          },
          "(N,) uint64, computed: ids of their (left) cameras")
      .def_property_readonly(
          "origin_maps",
          [](const KeyFramesInMap& k) {
            return Computed<std::uint32_t>(*k.list(), [](const KeyFrame& keyframe) { return keyframe.origin_map; });
          },
          "(N,) uint32, computed: ids of the maps they were made in")
      .def_property_readonly("accelerometer_biases",
                             MembersOf<KeyFramesInMap, float>(
                                 [](const KeyFrame& k) -> auto& { return k.imu_bias.accelerometer; }, 3),
                             "(N, 3) float32, writable: m/s^2")
      .def_property_readonly("gyroscope_biases",
                             MembersOf<KeyFramesInMap, float>(
                                 [](const KeyFrame& k) -> auto& { return k.imu_bias.gyroscope; }, 3),
                             "(N, 3) float32, writable: rad/s")
      .def_property_readonly("previous", FixedMembers<std::uint64_t>(&KeyFrame::previous),
                             "(N,) uint64: ids of the ones before in time; NONE: there is none")
      .def_property_readonly("next", FixedMembers<std::uint64_t>(&KeyFrame::next),
                             "(N,) uint64: ids of the ones behind in time; NONE: there is none")
      .def_property_readonly("integration_biases",
                             FixedMembersOf<KeyFramesInMap, float>(
                                 [](const KeyFrame& k) -> auto& { return k.preintegration.bias.accelerometer; }, 6),
                             "(N, 6) float32: accelerometer m/s^2, gyroscope rad/s; measurements were integrated with "
                             "them")
      .def_property_readonly("not_erase", &FlagsOf<&KeyFrame::not_erase, KeyFramesInMap>,
                             "(N,) bool, computed: those that must not be culled")
      .def_property_readonly("to_be_erased", &FlagsOf<&KeyFrame::to_be_erased, KeyFramesInMap>, "(N,) bool, computed")
      .def(
          "rows_of",
          [](const KeyFramesInMap& k, const py::object& ids) { return RowsOf(k, KeyFrameTable(*k.of.map()), ids); },
          py::arg("ids"), "(N,) int64: the rows of ids. Raises NotFoundError.")
      .def(
          "by_id", [](const KeyFramesInMap& k, std::uint64_t id) { return ById(k, KeyFrameId(id)); }, py::arg("id"),
          "The keyframe of an id; of many, `rows_of` is faster. Raises NotFoundError.");
}

void DefinePointColumns(PointsClass points) {
  points
      .def_property_readonly("first_frames", FixedMembers<std::int64_t>(&MapPoint::first_frame),
                             "(N,) int64: ids of the frames that made them")
      .def_property_readonly("weights", FixedMembers<std::int32_t>(&MapPoint::observation_count),
                             "(N,) int32: observations as ORB-SLAM3 counts them (nObs), with stereo or depth twice")
      .def(
          "rows_of",
          [](const PointsInMap& p, const py::object& ids) { return RowsOf(p, PointTable(*p.of.map()), ids); },
          py::arg("ids"), "(N,) int64: the rows of ids. Raises NotFoundError.")
      .def(
          "by_id", [](const PointsInMap& p, std::uint64_t id) { return ById(p, MapPointId(id)); }, py::arg("id"),
          "The point of an id; of many, `rows_of` is faster. Raises NotFoundError.");
}

}  // namespace

void DefineColumns(py::module_& module) {
  DefineKeyFrameColumns(Reopen<KeyFramesClass>(module, "KeyFrames"));
  DefinePointColumns(Reopen<PointsClass>(module, "Points"));
}

}  // namespace slamdb::python
