// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/atlas.h"

// Every recorded field of an entity by name, once.
// What hashes, compares, prints, keeps and restores entities field by field walks through these.
// The groups in `fields` are for those that need a part.
// A new field of the model needs its line here.
// tests/model/fields_test.cc holds every component to every field.
namespace slamdb {

// The member that a chain of member pointers leads to: Member(keyframe, &KeyFrame::features, &Features::depth).
template <class Entity, class... Members>
auto& Member(Entity& entity, Members... members) {
  return (entity.*....*members);
}

namespace fields {

// What .osa files hold of a point, in the order of the header; hashes and JSON keep it.
template <class Visit>
void ForEachArchivedPointField(const Visit& visit) {
  visit("id", &MapPoint::id);
  visit("first_keyframe", &MapPoint::first_keyframe);
  visit("first_frame", &MapPoint::first_frame);
  visit("observation_count", &MapPoint::observation_count);
  visit("position", &MapPoint::position);
  visit("normal", &MapPoint::normal);
  visit("observations", &MapPoint::observations);
  visit("descriptor", &MapPoint::descriptor);
  visit("descriptor_form", &MapPoint::descriptor_form);
  visit("bad", &MapPoint::bad);
  visit("reference", &MapPoint::reference);
  visit("replaced_by", &MapPoint::replaced_by);
  visit("min_distance", &MapPoint::min_distance);
  visit("max_distance", &MapPoint::max_distance);
}

// And what they do not: MapPoint::has_tracking.
template <class Visit>
void ForEachTrackingField(const Visit& visit) {
  visit("origin_map", &MapPoint::origin_map);
  visit("visible_count", &MapPoint::visible_count);
  visit("found_count", &MapPoint::found_count);
}

}  // namespace fields

// visit(name, members...) for every field of a point.
template <class Visit>
void ForEachField(const MapPoint*, const Visit& visit) {
  fields::ForEachArchivedPointField(visit);
  fields::ForEachTrackingField(visit);
  visit("carried", &MapPoint::carried);
}

template <class Visit>
void ForEachField(const Camera*, const Visit& visit) {
  visit("id", &Camera::id);
  visit("model", &Camera::model);
  visit("recorded_type", &Camera::recorded_type);
  visit("parameters", &Camera::parameters);
  visit("precision", &Camera::precision);
  visit("carried", &Camera::carried);
}

// Without the lists of keyframes, points and landmarks.
template <class Visit>
void ForEachField(const Map*, const Visit& visit) {
  visit("id", &Map::id);
  visit("initial_keyframe", &Map::initial_keyframe);
  visit("max_keyframe_id", &Map::max_keyframe_id);
  visit("big_change_index", &Map::big_change_index);
  visit("repeated_keyframes", &Map::repeated_keyframes);
  visit("repeated_points", &Map::repeated_points);
  visit("origins", &Map::origins);
  visit("first_keyframe", &Map::first_keyframe);
  visit("lowest_keyframe", &Map::lowest_keyframe);
  visit("imu_initialized", &Map::imu_initialized);
  visit("inertial", &Map::inertial);
  visit("imu_ba1", &Map::imu_ba1);
  visit("imu_ba2", &Map::imu_ba2);
  visit("carried", &Map::carried);
}

namespace fields {

template <class Visit>
void ForEachVocabularyField(const Visit& visit) {
  visit("vocabulary.name", &Atlas::vocabulary, &Vocabulary::name);
  visit("vocabulary.checksum", &Atlas::vocabulary, &Vocabulary::checksum);
}

template <class Visit>
void ForEachCounterField(const Visit& visit) {
  visit("next_ids.map", &Atlas::next_ids, &Counters::map);
  visit("next_ids.frame", &Atlas::next_ids, &Counters::frame);
  visit("next_ids.keyframe", &Atlas::next_ids, &Counters::keyframe);
  visit("next_ids.map_point", &Atlas::next_ids, &Counters::map_point);
  visit("next_ids.camera", &Atlas::next_ids, &Counters::camera);
  visit("next_ids.initial_keyframe", &Atlas::next_ids, &Counters::initial_keyframe);
}

template <class Visit>
void ForEachHeadField(const Visit& visit) {
  ForEachVocabularyField(visit);
  ForEachCounterField(visit);
}

template <class Visit>
void ForEachRepeatedField(const Visit& visit) {
  visit("repeated_maps", &Atlas::repeated_maps);
  visit("repeated_cameras", &Atlas::repeated_cameras);
}

// The layout of a fork, and what only it has.
template <class Visit>
void ForEachForkField(const Visit& visit) {
  visit("layout", &Atlas::layout);
  visit("carried", &Atlas::carried);
}

// How an atlas is written down, which is not what it says: not in ForEachField.
template <class Visit>
void ForEachEncodingField(const Visit& visit) {
  visit("encoding.text", &Atlas::encoding, &ArchiveEncoding::text);
  visit("encoding.boost_version", &Atlas::encoding, &ArchiveEncoding::boost_version);
  visit("encoding.long_bytes", &Atlas::encoding, &ArchiveEncoding::long_bytes);
  visit("encoding.size_bytes", &Atlas::encoding, &ArchiveEncoding::size_bytes);
}

}  // namespace fields

// Without the lists of maps and cameras, and without the encoding.
template <class Visit>
void ForEachField(const Atlas*, const Visit& visit) {
  fields::ForEachHeadField(visit);
  fields::ForEachRepeatedField(visit);
  fields::ForEachForkField(visit);
}

template <class Visit>
void ForEachField(const FeatureDescriptor*, const Visit& visit) {
  visit("kind", &FeatureDescriptor::kind);
  visit("bytes", &FeatureDescriptor::bytes);
}

template <class Visit>
void ForEachField(const LandmarkFeature*, const Visit& visit) {
  visit("x", &LandmarkFeature::x);
  visit("y", &LandmarkFeature::y);
  visit("keypoint_id", &LandmarkFeature::keypoint_id);
  visit("type", &LandmarkFeature::type);
  visit("track_status", &LandmarkFeature::track_status);
  visit("response", &LandmarkFeature::response);
  visit("orientation", &LandmarkFeature::orientation);
  visit("octave", &LandmarkFeature::octave);
  visit("user_flags", &LandmarkFeature::user_flags);
  visit("depth", &LandmarkFeature::depth);
  visit("initial_depth", &LandmarkFeature::initial_depth);
  visit("position_in_camera", &LandmarkFeature::position_in_camera);
  visit("patch_size", &LandmarkFeature::patch_size);
  visit("has_patch", &LandmarkFeature::has_patch);
  visit("patch", &LandmarkFeature::patch);
  visit("spin_image_rows", &LandmarkFeature::spin_image_rows);
  visit("polar_images_without_rotation", &LandmarkFeature::polar_images_without_rotation);
  visit("descriptors", &LandmarkFeature::descriptors);
}

template <class Visit>
void ForEachField(const Landmark*, const Visit& visit) {
  visit("id", &Landmark::id);
  visit("mean", &Landmark::mean);
  visit("normal", &Landmark::normal);
  visit("cov_11", &Landmark::cov_11);
  visit("cov_22", &Landmark::cov_22);
  visit("cov_33", &Landmark::cov_33);
  visit("cov_12", &Landmark::cov_12);
  visit("cov_13", &Landmark::cov_13);
  visit("cov_23", &Landmark::cov_23);
  visit("last_seen", &Landmark::last_seen);
  visit("seen_count", &Landmark::seen_count);
  visit("features", &Landmark::features);
}

namespace fields {

template <class Visit>
void ForEachCameraField(const Visit& visit) {
  visit("camera", &KeyFrame::camera);
  visit("right_camera", &KeyFrame::right_camera);
  visit("intrinsics.fx", &KeyFrame::intrinsics, &Intrinsics::fx);
  visit("intrinsics.fy", &KeyFrame::intrinsics, &Intrinsics::fy);
  visit("intrinsics.inverse_fx", &KeyFrame::intrinsics, &Intrinsics::inverse_fx);
  visit("intrinsics.inverse_fy", &KeyFrame::intrinsics, &Intrinsics::inverse_fy);
  visit("intrinsics.cx", &KeyFrame::intrinsics, &Intrinsics::cx);
  visit("intrinsics.cy", &KeyFrame::intrinsics, &Intrinsics::cy);
  visit("intrinsics.baseline_fx", &KeyFrame::intrinsics, &Intrinsics::baseline_fx);
  visit("intrinsics.baseline", &KeyFrame::intrinsics, &Intrinsics::baseline);
  visit("intrinsics.depth_threshold", &KeyFrame::intrinsics, &Intrinsics::depth_threshold);
  visit("calibration_matrix", &KeyFrame::calibration_matrix);
  visit("distortion.rows", &KeyFrame::distortion, &Matrix::rows);
  visit("distortion.columns", &KeyFrame::distortion, &Matrix::columns);
  visit("distortion.type", &KeyFrame::distortion, &Matrix::type);
  visit("distortion.continuous", &KeyFrame::distortion, &Matrix::continuous);
  visit("distortion.data", &KeyFrame::distortion, &Matrix::data);
  visit("half_baseline", &KeyFrame::half_baseline);
  visit("left_from_right", &KeyFrame::left_from_right);
  visit("bounds.grid_columns", &KeyFrame::bounds, &ImageBounds::grid_columns);
  visit("bounds.grid_rows", &KeyFrame::bounds, &ImageBounds::grid_rows);
  visit("bounds.inverse_cell_width", &KeyFrame::bounds, &ImageBounds::inverse_cell_width);
  visit("bounds.inverse_cell_height", &KeyFrame::bounds, &ImageBounds::inverse_cell_height);
  visit("bounds.min_x", &KeyFrame::bounds, &ImageBounds::min_x);
  visit("bounds.min_y", &KeyFrame::bounds, &ImageBounds::min_y);
  visit("bounds.max_x", &KeyFrame::bounds, &ImageBounds::max_x);
  visit("bounds.max_y", &KeyFrame::bounds, &ImageBounds::max_y);
  visit("pyramid.levels", &KeyFrame::pyramid, &ScalePyramid::levels);
  visit("pyramid.factor", &KeyFrame::pyramid, &ScalePyramid::factor);
  visit("pyramid.log_factor", &KeyFrame::pyramid, &ScalePyramid::log_factor);
  visit("pyramid.factors", &KeyFrame::pyramid, &ScalePyramid::factors);
  visit("pyramid.sigma2", &KeyFrame::pyramid, &ScalePyramid::sigma2);
  visit("pyramid.inverse_sigma2", &KeyFrame::pyramid, &ScalePyramid::inverse_sigma2);
}

template <class Visit>
void ForEachFeatureField(const Visit& visit) {
  const auto features = &KeyFrame::features;
  visit("features.count", features, &Features::count);
  visit("features.left_count", features, &Features::left_count);
  visit("features.right_count", features, &Features::right_count);
  visit("features.keypoints", features, &Features::keypoints);
  visit("features.undistorted", features, &Features::undistorted);
  visit("features.right_x", features, &Features::right_x);
  visit("features.depth", features, &Features::depth);
  visit("features.descriptors", features, &Features::descriptors);
  visit("features.descriptors_form", features, &Features::descriptors_form);
  visit("features.map_points", features, &Features::map_points);
  visit("features.right_keypoints", features, &Features::right_keypoints);
  visit("features.right_of_left", features, &Features::right_of_left);
  visit("features.left_of_right", features, &Features::left_of_right);
  visit("features.grid.column_sizes", features, &Features::grid, &FeatureGrid::column_sizes);
  visit("features.grid.cell_sizes", features, &Features::grid, &FeatureGrid::cell_sizes);
  visit("features.grid.keypoints", features, &Features::grid, &FeatureGrid::keypoints);
  visit("features.right_grid.column_sizes", features, &Features::right_grid, &FeatureGrid::column_sizes);
  visit("features.right_grid.cell_sizes", features, &Features::right_grid, &FeatureGrid::cell_sizes);
  visit("features.right_grid.keypoints", features, &Features::right_grid, &FeatureGrid::keypoints);
}

template <class Visit>
void ForEachWordField(const Visit& visit) {
  const auto features = &KeyFrame::features;
  visit("features.bag_of_words.words", features, &Features::bag_of_words, &BagOfWords::words);
  visit("features.bag_of_words.weights", features, &Features::bag_of_words, &BagOfWords::weights);
  visit("features.feature_vector.nodes", features, &Features::feature_vector, &FeatureVector::nodes);
  visit("features.feature_vector.sizes", features, &Features::feature_vector, &FeatureVector::sizes);
  visit("features.feature_vector.features", features, &Features::feature_vector, &FeatureVector::features);
}

template <class Visit>
void ForEachPreintegrationField(const Visit& visit) {
  const auto imu = &KeyFrame::preintegration;
  visit("preintegration.duration", imu, &ImuPreintegration::duration);
  visit("preintegration.covariance", imu, &ImuPreintegration::covariance);
  visit("preintegration.information", imu, &ImuPreintegration::information);
  visit("preintegration.noise", imu, &ImuPreintegration::noise);
  visit("preintegration.walk_noise", imu, &ImuPreintegration::walk_noise);
  visit("preintegration.bias.accelerometer", imu, &ImuPreintegration::bias, &ImuBias::accelerometer);
  visit("preintegration.bias.gyroscope", imu, &ImuPreintegration::bias, &ImuBias::gyroscope);
  visit("preintegration.rotation", imu, &ImuPreintegration::rotation);
  visit("preintegration.velocity", imu, &ImuPreintegration::velocity);
  visit("preintegration.position", imu, &ImuPreintegration::position);
  visit("preintegration.rotation_by_gyro", imu, &ImuPreintegration::rotation_by_gyro);
  visit("preintegration.velocity_by_gyro", imu, &ImuPreintegration::velocity_by_gyro);
  visit("preintegration.velocity_by_acc", imu, &ImuPreintegration::velocity_by_acc);
  visit("preintegration.position_by_gyro", imu, &ImuPreintegration::position_by_gyro);
  visit("preintegration.position_by_acc", imu, &ImuPreintegration::position_by_acc);
  visit("preintegration.mean_acceleration", imu, &ImuPreintegration::mean_acceleration);
  visit("preintegration.mean_angular_velocity", imu, &ImuPreintegration::mean_angular_velocity);
  visit("preintegration.updated_bias.accelerometer", imu, &ImuPreintegration::updated_bias, &ImuBias::accelerometer);
  visit("preintegration.updated_bias.gyroscope", imu, &ImuPreintegration::updated_bias, &ImuBias::gyroscope);
  visit("preintegration.bias_change", imu, &ImuPreintegration::bias_change);
  visit("preintegration.measurements", imu, &ImuPreintegration::measurements);
}

template <class Visit>
void ForEachImuCalibrationField(const Visit& visit) {
  const auto calibration = &KeyFrame::imu_calibration;
  visit("imu_calibration.camera_from_body", calibration, &ImuCalibration::camera_from_body);
  visit("imu_calibration.body_from_camera", calibration, &ImuCalibration::body_from_camera);
  visit("imu_calibration.noise", calibration, &ImuCalibration::noise);
  visit("imu_calibration.walk_noise", calibration, &ImuCalibration::walk_noise);
  visit("imu_calibration.is_set", calibration, &ImuCalibration::is_set);
}

template <class Visit>
void ForEachInertialField(const Visit& visit) {
  visit("imu_bias.accelerometer", &KeyFrame::imu_bias, &ImuBias::accelerometer);
  visit("imu_bias.gyroscope", &KeyFrame::imu_bias, &ImuBias::gyroscope);
  ForEachPreintegrationField(visit);
  ForEachImuCalibrationField(visit);
}

template <class Visit>
void ForEachMotionField(const Visit& visit) {
  visit("imu_initialized", &KeyFrame::imu_initialized);
  visit("velocity", &KeyFrame::velocity);
  visit("body_position", &KeyFrame::body_position);
  visit("has_velocity", &KeyFrame::has_velocity);
}

}  // namespace fields

template <class Visit>
void ForEachField(const KeyFrame*, const Visit& visit) {
  visit("id", &KeyFrame::id);
  visit("frame_id", &KeyFrame::frame_id);
  visit("timestamp", &KeyFrame::timestamp);
  visit("camera_from_world", &KeyFrame::camera_from_world);
  visit("camera_from_parent", &KeyFrame::camera_from_parent);
  visit("merge_scale", &KeyFrame::merge_scale);
  fields::ForEachCameraField(visit);
  fields::ForEachFeatureField(visit);
  fields::ForEachWordField(visit);
  visit("connections", &KeyFrame::connections);
  visit("first_connection", &KeyFrame::first_connection);
  visit("parent", &KeyFrame::parent);
  visit("children", &KeyFrame::children);
  visit("loop_edges", &KeyFrame::loop_edges);
  visit("merge_edges", &KeyFrame::merge_edges);
  visit("not_erase", &KeyFrame::not_erase);
  visit("to_be_erased", &KeyFrame::to_be_erased);
  visit("bad", &KeyFrame::bad);
  visit("origin_map", &KeyFrame::origin_map);
  fields::ForEachInertialField(visit);
  visit("previous", &KeyFrame::previous);
  visit("next", &KeyFrame::next);
  fields::ForEachMotionField(visit);
  visit("carried", &KeyFrame::carried);
}

}  // namespace slamdb
