// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/boost/helpers.h"
#include "slamdb/model/atlas.h"

// The members of ORB-SLAM3's classes in archive order. formats/orbslam3 has them a second time on purpose: each side
// is the other's check.
namespace slamdb {

// Sophus::SE3f, archived by a helper function.
template <class Archive>
void serialize(Archive& archive, Rigid3f& pose, const unsigned int /*version*/) {
  auto& q = pose.rotation;
  archive& q.w() & q.x() & q.y() & q.z();
  boost_archive::Floats(archive, pose.translation);
}

template <class Archive>
void serialize(Archive& archive, Flag& flag, const unsigned int /*version*/) {
  archive& flag.recorded;
}

// cv::Mat, archived by a helper function.
template <class Archive>
void serialize(Archive& archive, Matrix& matrix, const unsigned int /*version*/) {
  boost_archive::MatrixHead head{matrix.columns, matrix.rows, matrix.type, matrix.continuous.recorded};
  boost_archive::Head(archive, head);
  if constexpr (Archive::is_loading::value) {
    matrix.columns = head.columns;
    matrix.rows = head.rows;
    matrix.type = head.type;
    matrix.continuous.recorded = head.continuous;
    matrix.data.resize(boost_archive::MatrixBytes(head));
  }
  boost_archive::Bytes(archive, matrix.data.data(), matrix.data.size());
}

}  // namespace slamdb

namespace slamdb::boost_archive {

// ORB-SLAM3 counts its classes' versions as 0.
inline void RequireVersion(unsigned int version) {
  if (version != 0)
    throw Error(ErrorKind::kUnsupported, "a Boost archive holds a class of version " + std::to_string(version) +
                                             ", expected 0: written by a fork, or by an ORB-SLAM3 later than v1.0");
}

template <class Archive>
void Members(Archive& archive, ImuBias& bias) {
  for (float* value : {bias.accelerometer.data(), bias.gyroscope.data()}) archive& value[0] & value[1] & value[2];
}

template <class Archive>
void Members(Archive& archive, ImuCalibration& calibration) {
  archive& calibration.camera_from_body& calibration.body_from_camera;
  Floats(archive, calibration.noise);
  Floats(archive, calibration.walk_noise);
  archive& calibration.is_set;
}

template <class Archive>
void Members(Archive& archive, ImuMeasurement& measurement) {
  Floats(archive, measurement.acceleration);
  Floats(archive, measurement.angular_velocity);
  archive& measurement.duration;
}

template <class Archive>
void Members(Archive& archive, ImuPreintegration& imu) {
  archive& imu.duration;
  Floats(archive, imu.covariance);
  Floats(archive, imu.information);
  Floats(archive, imu.noise);
  Floats(archive, imu.walk_noise);
  archive& imu.bias;
  Floats(archive, imu.rotation);
  Floats(archive, imu.velocity);
  Floats(archive, imu.position);
  Floats(archive, imu.rotation_by_gyro);
  Floats(archive, imu.velocity_by_gyro);
  Floats(archive, imu.velocity_by_acc);
  Floats(archive, imu.position_by_gyro);
  Floats(archive, imu.position_by_acc);
  Floats(archive, imu.mean_acceleration);
  Floats(archive, imu.mean_angular_velocity);
  archive& imu.updated_bias;
  Floats(archive, imu.bias_change);
  archive& imu.measurements;
}

template <class Archive>
void Members(Archive& archive, MapPoint& point) {
  AsNumber<unsigned long>(archive, point.id);
  archive& point.first_keyframe& point.first_frame& point.observation_count;
  Floats(archive, point.position);
  Floats(archive, point.normal);
  Observations(archive, point.observations);
  PointDescriptor(archive, point.descriptor, point.descriptor_form);
  AsNumber<unsigned long>(archive, point.reference);
  archive& point.bad;
  AsNumber<long long>(archive, point.replaced_by);
  archive& point.min_distance& point.max_distance;
}

template <class Archive>
void ImageMembers(Archive& archive, KeyFrame& keyframe) {
  ImageBounds& bounds = keyframe.bounds;
  Intrinsics& camera = keyframe.intrinsics;
  archive& bounds.grid_columns& bounds.grid_rows& bounds.inverse_cell_width& bounds.inverse_cell_height;
  archive& keyframe.merge_scale;
  archive& camera.fx& camera.fy& camera.inverse_fx& camera.inverse_fy& camera.cx& camera.cy;
  archive& camera.baseline_fx& camera.baseline& camera.depth_threshold;
  archive& keyframe.distortion;
}

template <class Archive>
void FeatureMembers(Archive& archive, Features& features) {
  archive& features.count;
  Keypoints(archive, features.keypoints);
  Keypoints(archive, features.undistorted);
  AsVector<float>(archive, features.right_x);
  AsVector<float>(archive, features.depth);
  Descriptors(archive, features.descriptors, features.descriptors_form);
  As<BowVector>(archive, features.bag_of_words);
  As<BowFeatureVector>(archive, features.feature_vector);
}

template <class Archive>
void PoseMembers(Archive& archive, KeyFrame& keyframe) {
  ScalePyramid& pyramid = keyframe.pyramid;
  ImageBounds& bounds = keyframe.bounds;
  archive& keyframe.camera_from_parent;
  archive& pyramid.levels& pyramid.factor& pyramid.log_factor;
  for (std::vector<float>* factors : {&pyramid.factors, &pyramid.sigma2, &pyramid.inverse_sigma2})
    AsVector<float>(archive, *factors);
  archive& bounds.min_x& bounds.min_y& bounds.max_x& bounds.max_y;
  Floats(archive, keyframe.calibration_matrix);
  archive& keyframe.camera_from_world;
}

template <class Archive>
void GraphMembers(Archive& archive, KeyFrame& keyframe) {
  AsVector<long long>(archive, keyframe.features.map_points);
  As<Grid>(archive, keyframe.features.grid);
  As<Weights>(archive, keyframe.connections);
  archive& keyframe.first_connection;
  AsNumber<long long>(archive, keyframe.parent);
  AsVector<unsigned long>(archive, keyframe.children);
  AsVector<unsigned long>(archive, keyframe.loop_edges);
  AsVector<unsigned long>(archive, keyframe.merge_edges);
  archive& keyframe.not_erase& keyframe.to_be_erased& keyframe.bad;
  archive& keyframe.half_baseline& keyframe.origin_map;
  AsNumber<unsigned int>(archive, keyframe.camera);
  AsNumber<unsigned int>(archive, keyframe.right_camera);
}

template <class Archive>
void RightImageMembers(Archive& archive, KeyFrame& keyframe) {
  Features& features = keyframe.features;
  AsVector<int>(archive, features.right_of_left);
  AsVector<int>(archive, features.left_of_right);
  archive& features.left_count& features.right_count;
  archive& keyframe.left_from_right;
  Keypoints(archive, features.right_keypoints);
  As<Grid>(archive, features.right_grid);
}

template <class Archive>
void InertialMembers(Archive& archive, KeyFrame& keyframe) {
  archive& keyframe.imu_bias& keyframe.preintegration& keyframe.imu_calibration;
  AsNumber<long long>(archive, keyframe.previous);
  AsNumber<long long>(archive, keyframe.next);
  archive& keyframe.imu_initialized;
  Floats(archive, keyframe.velocity);
  Floats(archive, keyframe.body_position);
  archive& keyframe.has_velocity;
}

template <class Archive>
void Members(Archive& archive, KeyFrame& keyframe) {
  AsNumber<unsigned long>(archive, keyframe.id);
  archive& keyframe.frame_id& keyframe.timestamp;
  ImageMembers(archive, keyframe);
  FeatureMembers(archive, keyframe.features);
  PoseMembers(archive, keyframe);
  GraphMembers(archive, keyframe);
  RightImageMembers(archive, keyframe);
  InertialMembers(archive, keyframe);
}

// In front of a map's lists, and behind them.
template <class Archive>
void MembersInFront(Archive& archive, Map& map) {
  AsNumber<unsigned long>(archive, map.id);
  AsNumber<unsigned long>(archive, map.initial_keyframe);
  archive& map.max_keyframe_id& map.big_change_index;
}
template <class Archive>
void MembersBehind(Archive& archive, Map& map) {
  AsVector<unsigned long>(archive, map.origins);
  AsNumber<unsigned long>(archive, map.first_keyframe);
  AsNumber<unsigned long>(archive, map.lowest_keyframe);
  archive& map.imu_initialized& map.inertial& map.imu_ba1& map.imu_ba2;
}

template <class Archive>
void Members(Archive& archive, Counters& next_ids) {
  archive& next_ids.map& next_ids.frame& next_ids.keyframe& next_ids.map_point& next_ids.camera;
  archive& next_ids.initial_keyframe;
}

}  // namespace slamdb::boost_archive
