// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "python/src/keyframe_row.h"
#include "python/src/module.h"
#include "python/src/poses.h"
#include "python/src/row_class.h"

namespace slamdb::python {

namespace py = pybind11;

namespace {

// world_from_camera: 4 x 4 matrices by rows.
py::array Poses(const KeyFramesInMap& keyframes) {
  const auto list = keyframes.list();
  auto poses = NewArray<double>({static_cast<py::ssize_t>(list->size()), py::ssize_t{4}, py::ssize_t{4}});
  double* at = poses.mutable_data();
  for (const KeyFrame& keyframe : *list) {
    at = std::copy_n(MatrixByRows(keyframe.camera_from_world.Normalized().Inverse()).data(), 16, at);
  }
  return ReadOnly(std::move(poses));
}

py::array Centers(const KeyFramesInMap& keyframes) {
  const auto list = keyframes.list();
  auto centers = NewArray<float>({static_cast<py::ssize_t>(list->size()), py::ssize_t{3}});
  float* at = centers.mutable_data();
  for (const KeyFrame& keyframe : *list)
    at = std::copy_n(keyframe.camera_from_world.Normalized().Center().data(), 3, at);
  return ReadOnly(std::move(centers));
}

void DefineColumns(py::class_<KeyFramesInMap>& keyframes) {
  keyframes.def_property_readonly("ids", FixedMembers<std::uint64_t>(&KeyFrame::id), "(N,) uint64: KeyFrame::mnId")
      .def_property_readonly("timestamps", Members<double>(&KeyFrame::timestamp), "(N,) float64, writable: seconds")
      .def_property_readonly("camera_from_world", Members<float>(&KeyFrame::camera_from_world, 7),
                             "(N, 7) float32, writable: Tcw of the left camera, qx qy qz qw tx ty tz, as recorded")
      .def_property_readonly("poses", &Poses, "(N, 4, 4) float64, computed: world from (left) camera, Twc")
      .def_property_readonly("centers", &Centers, "(N, 3) float32, computed: camera centres in the world")
      .def_property_readonly("parents", FixedMembers<std::uint64_t>(&KeyFrame::parent),
                             "(N,) uint64: ids of parents in the spanning tree; NONE for its root")
      .def_property_readonly("velocities", Members<float>(&KeyFrame::velocity, 3),
                             "(N, 3) float32, writable: m/s, world; of maps with an IMU")
      .def_property_readonly("bad", &FlagsOf<&KeyFrame::bad, KeyFramesInMap>, "(N,) bool, computed: culled");
}

// Made when it is asked for, so that importing slamdb does not import numpy.
py::dtype KeypointType() {
  RequireNumpy();
  py::list names, formats, offsets;
  const auto add = [&](const char* name, const char* format, std::size_t offset) {
    names.append(name);
    formats.append(format);
    offsets.append(offset);
  };
  add("angle", "f4", offsetof(Keypoint, angle));
  add("response", "f4", offsetof(Keypoint, response));
  add("size", "f4", offsetof(Keypoint, size));
  add("x", "f4", offsetof(Keypoint, x));
  add("y", "f4", offsetof(Keypoint, y));
  add("class_id", "i4", offsetof(Keypoint, class_id));
  add("octave", "i4", offsetof(Keypoint, octave));
  return {names, formats, offsets, sizeof(Keypoint)};
}

template <auto Member>
py::array KeypointColumn(const FeaturesOfKeyFrame& features) {
  const Column<Keypoint>& column = features.of.entity->features.*Member;
  return ViewOf(features.of.kept, KeypointType(),
                {column.data(), {static_cast<py::ssize_t>(column.size())}, {sizeof(Keypoint)}});
}

std::string TextOf(const FeaturesOfKeyFrame& of) {
  const Features& features = of.of.entity->features;
  const std::size_t right = features.right_keypoints.size();
  return "<slamdb.Features: " + Counted(features.keypoints.size(), "keypoint") +
         (right > 0 ? ", " + std::to_string(right) + " right" : "") + " of keyframe " +
         std::to_string(of.of.entity->id.value()) + ">";
}

void DefineFeatures(py::module_& module) {
  py::class_<FeaturesOfKeyFrame> features(module, "Features", R"(The features of a keyframe as columns.

N: how many keypoints there are; M: in the right image of a fisheye pair, otherwise 0.
Row r of N is keypoint r. Columns of (N + M,) have the right keypoints behind the left ones: row N + r is right keypoint
r.)");
  DefineIdentity(features, [](const FeaturesOfKeyFrame& f) { return KeyOf(f.of); });
  features
      .def_property_readonly(
          "keypoints", &KeypointColumn<&Features::keypoints>,
          "(N,) structured (angle, response, size, x, y, class_id, octave), writable: as detected, pixels")
      .def_property_readonly("undistorted", &KeypointColumn<&Features::undistorted>,
                             "(N,) structured, writable: lens distortion removed")
      .def_property_readonly("right_keypoints", &KeypointColumn<&Features::right_keypoints>,
                             "(M,) structured, writable: of the right camera of a fisheye pair")
      .def_property_readonly(
          "descriptors", &FeatureColumn<std::uint8_t, &Features::descriptors>,
          "(N + M, 32) uint8, writable: ORB descriptors, those of right keypoints behind the left ones")
      .def_property_readonly(
          "map_points", &FeatureColumn<std::uint64_t, &Features::map_points>,
          "(N + M,) uint64, writable: ids of the points that keypoints see, the right ones behind the left "
          "ones; NONE where they see none")
      .def_property_readonly("right_x", &FeatureColumn<float, &Features::right_x>,
                             "(N,) float32, writable: column in the right image, negative: none")
      .def_property_readonly("depth", &FeatureColumn<float, &Features::depth>,
                             "(N,) float32, writable: metres, negative: none")
      .def(
          "__len__", [](const FeaturesOfKeyFrame& f) { return f.of.entity->features.map_points.size(); }, "N + M")
      .def("__repr__", &TextOf);
}

template <class Value, class Read>
py::dict DictOf(const Column<Value>& column, Read read) {
  py::dict dict;
  for (const Value& value : column) read(dict, value);
  return dict;
}

void DefineKeyFrame(py::module_& module) {
  using KeyFrameRow = Row<KeyFrame>;
  py::class_<KeyFrameRow> keyframe(module, "KeyFrame", "One keyframe: a posed image.");
  DefineIdentity(keyframe);
  keyframe.def_property_readonly("id", [](const KeyFrameRow& k) { return k.entity->id.value(); })
      .def_property_readonly("frame_id", [](const KeyFrameRow& k) { return k.entity->frame_id; })
      .def_property_readonly(
          "timestamp", [](const KeyFrameRow& k) { return k.entity->timestamp; }, "seconds")
      .def_property_readonly("bad", [](const KeyFrameRow& k) { return static_cast<bool>(k.entity->bad); })
      .def_property_readonly(
          "camera", [](const KeyFrameRow& k) { return IdOrNone(k.entity->camera); }, "id, or None")
      .def_property_readonly(
          "parent", [](const KeyFrameRow& k) { return IdOrNone(k.entity->parent); },
          "id of the parent in the spanning tree, or None")
      .def_property_readonly("features", [](const KeyFrameRow& k) { return FeaturesOfKeyFrame{k}; })
      .def_property_readonly(
          "connections",
          [](const KeyFrameRow& k) {
            return DictOf(k.entity->connections, [](py::dict& dict, const Connection& connection) {
              dict[py::int_(connection.keyframe.value())] = connection.weight;
            });
          },
          "{keyframe id: points in common}: the covisibility graph")
      .def("__repr__",
           [](const KeyFrameRow& k) { return "<slamdb.KeyFrame " + std::to_string(k.entity->id.value()) + ">"; });
}

}  // namespace

void DefineKeyFrames(py::module_& module) {
  py::class_<KeyFramesInMap> keyframes(
      module, "KeyFrames", "The keyframes of a map: columns as numpy arrays over its memory, rows as KeyFrame.");
  DefineColumns(keyframes);
  DefineFeatures(module);
  DefineKeyFrame(module);
  DefineRowContainer<KeyFrame>(module, keyframes, "keyframe", "KeyFrameIterator");
}

}  // namespace slamdb::python
