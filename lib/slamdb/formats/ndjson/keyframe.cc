// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "slamdb/formats/ndjson/detail/append.h"
#include "slamdb/formats/ndjson/detail/names.h"
#include "slamdb/formats/ndjson/json.h"

namespace slamdb {
namespace {

constexpr std::int32_t kOpenCvFloat = 5;  // CV_32FC1

void AppendKeypoints(JsonAppender& json, std::string_view name, const Column<Keypoint>& keypoints) {
  json.BeginObject(name);
  json.Array("x", keypoints, [](const Keypoint& keypoint) { return keypoint.x; });
  json.Array("y", keypoints, [](const Keypoint& keypoint) { return keypoint.y; });
  json.Array("size", keypoints, [](const Keypoint& keypoint) { return keypoint.size; });
  json.Array("angle", keypoints, [](const Keypoint& keypoint) { return keypoint.angle; });
  json.Array("response", keypoints, [](const Keypoint& keypoint) { return keypoint.response; });
  json.Array("octave", keypoints, [](const Keypoint& keypoint) { return keypoint.octave; });
  json.Array("class_id", keypoints, [](const Keypoint& keypoint) { return keypoint.class_id; });
  json.EndObject();
}

void AppendGrid(JsonAppender& json, std::string_view name, const FeatureGrid& grid) {
  json.BeginObject(name);
  json.Array("column_sizes", grid.column_sizes);
  json.Array("cell_sizes", grid.cell_sizes);
  json.Array("keypoints", grid.keypoints);
  json.EndObject();
}

void AppendFeatures(JsonAppender& json, const Features& features) {
  json.BeginObject("features");
  json.Field("count", features.count);
  json.Field("left_count", features.left_count);
  json.Field("right_count", features.right_count);
  AppendKeypoints(json, "keypoints", features.keypoints);
  AppendKeypoints(json, "undistorted", features.undistorted);
  json.Array("right_x", features.right_x);
  json.Array("depth", features.depth);
  json.Array("descriptors", features.descriptors);
  json.Field("descriptors_form", NameOf(features.descriptors_form));
  json.Array("map_points", features.map_points);
  AppendKeypoints(json, "right_keypoints", features.right_keypoints);
  json.Array("right_of_left", features.right_of_left);
  json.Array("left_of_right", features.left_of_right);
  AppendGrid(json, "grid", features.grid);
  AppendGrid(json, "right_grid", features.right_grid);
  json.BeginObject("bag_of_words");
  json.Array("words", features.bag_of_words.words);
  json.Array("weights", features.bag_of_words.weights);
  json.EndObject();
  json.BeginObject("feature_vector");
  json.Array("nodes", features.feature_vector.nodes);
  json.Array("sizes", features.feature_vector.sizes);
  json.Array("features", features.feature_vector.features);
  json.EndObject();
  json.EndObject();
}

// 32-bit floats as numbers, any other type as the bytes that it is.
void AppendMatrix(JsonAppender& json, std::string_view name, const Matrix& matrix) {
  json.BeginObject(name);
  json.Field("rows", matrix.rows);
  json.Field("columns", matrix.columns);
  json.Field("type", matrix.type);
  json.Field("continuous", matrix.continuous);
  if (matrix.type == kOpenCvFloat && matrix.data.size() % sizeof(float) == 0) {
    Column<float> values(matrix.data.size() / sizeof(float));
    if (!values.empty()) std::memcpy(values.data(), matrix.data.data(), matrix.data.size());
    json.Array("values", values);
  } else {
    json.Hex("bytes", matrix.data.data(), matrix.data.size());
  }
  json.EndObject();
}

void AppendIntrinsics(JsonAppender& json, const Intrinsics& intrinsics) {
  json.BeginObject("intrinsics");
  json.Field("fx", intrinsics.fx);
  json.Field("fy", intrinsics.fy);
  json.Field("inverse_fx", intrinsics.inverse_fx);
  json.Field("inverse_fy", intrinsics.inverse_fy);
  json.Field("cx", intrinsics.cx);
  json.Field("cy", intrinsics.cy);
  json.Field("baseline_fx", intrinsics.baseline_fx);
  json.Field("baseline", intrinsics.baseline);
  json.Field("depth_threshold", intrinsics.depth_threshold);
  json.EndObject();
}

void AppendBounds(JsonAppender& json, const ImageBounds& bounds) {
  json.BeginObject("bounds");
  json.Field("grid_columns", bounds.grid_columns);
  json.Field("grid_rows", bounds.grid_rows);
  json.Field("inverse_cell_width", bounds.inverse_cell_width);
  json.Field("inverse_cell_height", bounds.inverse_cell_height);
  json.Field("min_x", bounds.min_x);
  json.Field("min_y", bounds.min_y);
  json.Field("max_x", bounds.max_x);
  json.Field("max_y", bounds.max_y);
  json.EndObject();
}

void AppendPyramid(JsonAppender& json, const ScalePyramid& pyramid) {
  json.BeginObject("pyramid");
  json.Field("levels", pyramid.levels);
  json.Field("factor", pyramid.factor);
  json.Field("log_factor", pyramid.log_factor);
  json.Array("factors", pyramid.factors);
  json.Array("sigma2", pyramid.sigma2);
  json.Array("inverse_sigma2", pyramid.inverse_sigma2);
  json.EndObject();
}

void AppendBias(JsonAppender& json, std::string_view name, const ImuBias& bias) {
  json.BeginObject(name);
  json.Field("accelerometer", bias.accelerometer);
  json.Field("gyroscope", bias.gyroscope);
  json.EndObject();
}

void AppendPreintegration(JsonAppender& json, const ImuPreintegration& preintegration) {
  json.BeginObject("preintegration");
  json.Field("duration", preintegration.duration);
  json.Field("covariance", preintegration.covariance);
  json.Field("information", preintegration.information);
  json.Field("noise", preintegration.noise);
  json.Field("walk_noise", preintegration.walk_noise);
  AppendBias(json, "bias", preintegration.bias);
  json.Field("rotation", preintegration.rotation);
  json.Field("velocity", preintegration.velocity);
  json.Field("position", preintegration.position);
  json.Field("rotation_by_gyro", preintegration.rotation_by_gyro);
  json.Field("velocity_by_gyro", preintegration.velocity_by_gyro);
  json.Field("velocity_by_acc", preintegration.velocity_by_acc);
  json.Field("position_by_gyro", preintegration.position_by_gyro);
  json.Field("position_by_acc", preintegration.position_by_acc);
  json.Field("mean_acceleration", preintegration.mean_acceleration);
  json.Field("mean_angular_velocity", preintegration.mean_angular_velocity);
  AppendBias(json, "updated_bias", preintegration.updated_bias);
  json.Field("bias_change", preintegration.bias_change);
  json.BeginArray("measurements");
  for (const ImuMeasurement& measurement : preintegration.measurements) {
    json.BeginObject();
    json.Field("acceleration", measurement.acceleration);
    json.Field("angular_velocity", measurement.angular_velocity);
    json.Field("duration", measurement.duration);
    json.EndObject();
  }
  json.EndArray();
  json.EndObject();
}

void AppendCalibration(JsonAppender& json, const ImuCalibration& calibration) {
  json.BeginObject("imu_calibration");
  json.Field("camera_from_body", calibration.camera_from_body);
  json.Field("body_from_camera", calibration.body_from_camera);
  json.Field("noise", calibration.noise);
  json.Field("walk_noise", calibration.walk_noise);
  json.Field("is_set", calibration.is_set);
  json.EndObject();
}

void AppendCameraPart(JsonAppender& json, const KeyFrame& keyframe) {
  json.Field("camera", keyframe.camera);
  json.Field("right_camera", keyframe.right_camera);
  AppendIntrinsics(json, keyframe.intrinsics);
  json.Field("calibration_matrix", keyframe.calibration_matrix);
  AppendMatrix(json, "distortion", keyframe.distortion);
  json.Field("half_baseline", keyframe.half_baseline);
  json.Field("left_from_right", keyframe.left_from_right);
  AppendBounds(json, keyframe.bounds);
  AppendPyramid(json, keyframe.pyramid);
}

void AppendGraphPart(JsonAppender& json, const KeyFrame& keyframe) {
  json.BeginArray("connections");
  for (const Connection& connection : keyframe.connections) {
    json.BeginObject();
    json.Field("keyframe", connection.keyframe);
    json.Field("weight", connection.weight);
    json.EndObject();
  }
  json.EndArray();
  json.Field("first_connection", keyframe.first_connection);
  json.Field("parent", keyframe.parent);
  json.Array("children", keyframe.children);
  json.Array("loop_edges", keyframe.loop_edges);
  json.Array("merge_edges", keyframe.merge_edges);
  json.Field("not_erase", keyframe.not_erase);
  json.Field("to_be_erased", keyframe.to_be_erased);
  json.Field("bad", keyframe.bad);
  json.Field("origin_map", keyframe.origin_map);
}

void AppendInertialPart(JsonAppender& json, const KeyFrame& keyframe) {
  AppendBias(json, "imu_bias", keyframe.imu_bias);
  AppendPreintegration(json, keyframe.preintegration);
  AppendCalibration(json, keyframe.imu_calibration);
  json.Field("previous", keyframe.previous);
  json.Field("next", keyframe.next);
  json.Field("imu_initialized", keyframe.imu_initialized);
  json.Field("velocity", keyframe.velocity);
  json.Field("body_position", keyframe.body_position);
  json.Field("has_velocity", keyframe.has_velocity);
}

}  // namespace

void AppendJson(std::string& out, const KeyFrame& keyframe, std::optional<MapId> map) {
  JsonAppender json(out);
  json.BeginObject();
  json.Field("type", "keyframe");
  if (map) json.Field("map", *map);
  json.Field("id", keyframe.id);
  json.Field("frame_id", keyframe.frame_id);
  json.Field("timestamp", keyframe.timestamp);
  json.Field("camera_from_world", keyframe.camera_from_world);
  json.Field("camera_from_parent", keyframe.camera_from_parent);
  json.Field("merge_scale", keyframe.merge_scale);
  AppendCameraPart(json, keyframe);
  AppendFeatures(json, keyframe.features);
  AppendGraphPart(json, keyframe);
  AppendInertialPart(json, keyframe);
  json.EndObject();
}

}  // namespace slamdb
