// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "python/src/keyframe_row.h"
#include "python/src/module.h"
#include "python/src/poses.h"
#include "python/src/reopen.h"
#include "slamdb/pictures/camera_settings.h"

// More of a keyframe and of its features.
namespace slamdb::python {

namespace py = pybind11;

namespace {

using KeyFrameRow = Row<KeyFrame>;
using KeyFrameClass = py::class_<KeyFrameRow>;

// A vector of a keyframe as an array over it.
template <class MemberOf>
auto Vector(MemberOf member_of) {
  return [member_of](const KeyFrameRow& k) { return PositionView(k.kept, member_of(*k.entity)); };
}

template <Column<KeyFrameId> KeyFrame::*Ids>
py::array IdsOf(const KeyFrameRow& k) {
  return ReadOnly(ColumnView<std::uint64_t>(k.kept, k.entity->*Ids));
}

py::dict IntrinsicsOf(const KeyFrameRow& k) {
  const Intrinsics& of = k.entity->intrinsics;
  py::dict dict;
  dict["fx"] = of.fx;
  dict["fy"] = of.fy;
  dict["cx"] = of.cx;
  dict["cy"] = of.cy;
  dict["baseline"] = of.baseline;
  dict["depth_threshold"] = of.depth_threshold;
  return dict;
}

py::object ImuCalibrationOf(const KeyFrameRow& k) {
  const ImuCalibration& of = k.entity->imu_calibration;
  if (!of.is_set) return py::none();
  const auto numbers = [](const Vector6f& vector) {
    return ArrayOf(std::vector<float>(vector.data(), vector.data() + vector.size()));
  };
  py::dict dict;
  dict["body_from_camera"] = MatrixOf(of.body_from_camera);
  dict["noise"] = numbers(of.noise);
  dict["walk_noise"] = numbers(of.walk_noise);
  return dict;
}

py::object PreintegrationOf(const KeyFrameRow& k) {
  const ImuPreintegration& of = k.entity->preintegration;
  if (of.measurements.empty()) return py::none();
  py::dict dict;
  dict["duration"] = of.duration;
  dict["rotation"] = of.rotation;
  dict["velocity"] = of.velocity;
  dict["position"] = of.position;
  dict["covariance"] = of.covariance;
  return dict;
}

void DefineGeometry(KeyFrameClass keyframe) {
  keyframe
      .def_property_readonly(
          "pose", [](const KeyFrameRow& k) { return MatrixOf(k.entity->camera_from_world.Normalized().Inverse()); },
          "(4, 4) float64, computed: world from (left) camera")
      .def_property_readonly(
          "left_from_right", [](const KeyFrameRow& k) { return MatrixOf(k.entity->left_from_right.Normalized()); },
          "(4, 4) float64, computed: of a fisheye pair")
      .def_property_readonly(
          "right_camera", [](const KeyFrameRow& k) { return IdOrNone(k.entity->right_camera); },
          "id of the second camera of a fisheye pair, or None")
      .def_property_readonly("intrinsics", &IntrinsicsOf,
                             "{fx, fy, cx, cy, baseline, depth_threshold}: pixels and metres")
      .def_property_readonly(
          "distortion", [](const KeyFrameRow& k) { return ArrayOf(DistortionOf(*k.entity)); },
          "float64, computed: k1 k2 p1 p2 [k3] of a pinhole, without zeros at the end")
      .def_property_readonly(
          "image_bounds",
          [](const KeyFrameRow& k) {
            const ImageBounds& b = k.entity->bounds;
            return py::make_tuple(b.min_x, b.min_y, b.max_x, b.max_y);
          },
          "(min_x, min_y, max_x, max_y) of the undistorted image, pixels")
      .def_property_readonly("levels", [](const KeyFrameRow& k) { return k.entity->pyramid.levels; })
      .def_property_readonly("scale_factor", [](const KeyFrameRow& k) { return k.entity->pyramid.factor; });
}

void DefineMotion(KeyFrameClass keyframe) {
  keyframe
      .def_property_readonly("velocity", Vector([](KeyFrame & k) -> auto& { return k.velocity; }),
                             "(3,) float32, writable: m/s, world; of maps with an IMU")
      .def_property_readonly("accelerometer_bias",
                             Vector([](KeyFrame & k) -> auto& { return k.imu_bias.accelerometer; }),
                             "(3,) float32, writable: m/s^2")
      .def_property_readonly("gyroscope_bias", Vector([](KeyFrame & k) -> auto& { return k.imu_bias.gyroscope; }),
                             "(3,) float32, writable: rad/s")
      .def_property_readonly("imu_calibration", &ImuCalibrationOf,
                             "{body_from_camera (4, 4), noise, walk_noise (6,): variances of gyroscope and "
                             "accelerometer}, computed; None without an IMU")
      .def_property_readonly(
          "imu_measurements",
          [](const KeyFrameRow& k) {
            return ReadOnly(ColumnView<float>(k.kept, k.entity->preintegration.measurements));
          },
          "(M, 7) float32: since the keyframe before, acceleration m/s^2, angular velocity rad/s, duration s")
      .def_property_readonly("preintegration", &PreintegrationOf,
                             "{duration s, rotation (3, 3), velocity (3,), position (3,), covariance (15, 15)} of what "
                             "was measured since the\nkeyframe before, in its body's frame, computed; None without")
      .def_property_readonly(
          "previous", [](const KeyFrameRow& k) { return IdOrNone(k.entity->previous); }, "id, in time, or None")
      .def_property_readonly(
          "next", [](const KeyFrameRow& k) { return IdOrNone(k.entity->next); }, "id, in time, or None");
}

void DefineLinks(KeyFrameClass keyframe) {
  keyframe.def_property_readonly("children", &IdsOf<&KeyFrame::children>, "(N,) uint64: ids, of the spanning tree")
      .def_property_readonly("loop_edges", &IdsOf<&KeyFrame::loop_edges>, "(N,) uint64: ids")
      .def_property_readonly("merge_edges", &IdsOf<&KeyFrame::merge_edges>, "(N,) uint64: ids")
      .def_property_readonly(
          "not_erase", [](const KeyFrameRow& k) { return static_cast<bool>(k.entity->not_erase); },
          "whether it must not be culled")
      .def_property_readonly(
          "to_be_erased", [](const KeyFrameRow& k) { return static_cast<bool>(k.entity->to_be_erased); },
          "whether it is culled as soon as it may be")
      .def_property_readonly(
          "origin_map", [](const KeyFrameRow& k) { return k.entity->origin_map; }, "id of the map it was made in");
}

void DefineFeatureColumns(py::class_<FeaturesOfKeyFrame> features) {
  features
      .def_property_readonly("right_of_left", &FeatureColumn<std::int32_t, &Features::right_of_left>,
                             "(N,) int32, writable: of a fisheye pair, matching row of right_keypoints; -1: none")
      .def_property_readonly("left_of_right", &FeatureColumn<std::int32_t, &Features::left_of_right>,
                             "(M,) int32, writable: matching row of keypoints; -1: none")
      .def_property_readonly(
          "words",
          [](const FeaturesOfKeyFrame& f) {
            return ReadOnly(ColumnView<std::uint32_t>(f.of.kept, f.of.entity->features.bag_of_words.words));
          },
          "(W,) uint32: words of the vocabulary, ascending")
      .def_property_readonly(
          "word_weights",
          [](const FeaturesOfKeyFrame& f) {
            return ReadOnly(ColumnView<double>(f.of.kept, f.of.entity->features.bag_of_words.weights));
          },
          "(W,) float64: their weights, which add up to 1")
      .def_property_readonly(
          "word_nodes",
          [](const FeaturesOfKeyFrame& f) {
            const FeatureVector& vector = f.of.entity->features.feature_vector;
            std::vector<std::uint32_t> nodes(f.of.entity->features.map_points.size(), 0xffffffff);
            std::size_t at = 0;
            for (std::size_t n = 0; n < vector.nodes.size() && n < vector.sizes.size(); ++n)
              for (std::uint32_t i = 0; i < vector.sizes[n] && at < vector.features.size(); ++i)
                if (const std::uint32_t row = vector.features[at++]; row < nodes.size()) nodes[row] = vector.nodes[n];
            return ArrayOf(nodes);
          },
          "(N + M,) uint32, computed: the vocabulary node above the word of each keypoint, the right ones behind the "
          "left "
          "ones (DBoW2's feature vector); 2^32 - 1: none");
}

}  // namespace

void DefineRows(py::module_& module) {
  const auto keyframe = Reopen<KeyFrameClass>(module, "KeyFrame");
  DefineGeometry(keyframe);
  DefineMotion(keyframe);
  DefineLinks(keyframe);
  DefineFeatureColumns(Reopen<py::class_<FeaturesOfKeyFrame>>(module, "Features"));
}

}  // namespace slamdb::python
