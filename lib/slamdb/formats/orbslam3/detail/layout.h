// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/orbslam3/detail/class_table.h"
#include "slamdb/model/atlas.h"

// The members of ORB-SLAM3's classes in archive order, under the archive's own names: the one description that reading,
// skipping and writing, binary and text, follow. An archive has one function for each kind of wire value; `Entity` is
// const when it writes. Pointer lists, which change the object table, are the business of reader.cc and writer.cc.
namespace slamdb::orbslam3 {

// What a stretch of the file is about, for `size on disk by part`.
enum class Part : std::uint8_t {
  kKeyFrame,  // poses, camera and everything of a keyframe that is none of the others
  kKeypoints,
  kStereo,
  kDescriptors,
  kBagOfWords,
  kMatches,
  kGrid,
  kGraph,
  kInertial,
  kMapPoint,
  kObservations,
  kOther,
  kCount,
};

template <class Archive, class Entity>
void LayoutBias(Archive& archive, const char* name, Entity& bias) {
  archive.Floats(name, bias.accelerometer);
  archive.Floats(name, bias.gyroscope);
}

template <class Archive, class Entity>
void LayoutPreintegration(Archive& archive, Entity& imu) {
  archive.ClassInfo(WireClass::kPreintegrated);
  archive.Float("dT", imu.duration);
  archive.Floats("C", imu.covariance);
  archive.Floats("Info", imu.information);
  archive.Floats("Nga", imu.noise);
  archive.Floats("NgaWalk", imu.walk_noise);
  archive.ClassInfo(WireClass::kBias);
  LayoutBias(archive, "b", imu.bias);
  archive.Floats("dR", imu.rotation);
  archive.Floats("dV", imu.velocity);
  archive.Floats("dP", imu.position);
  archive.Floats("JRg", imu.rotation_by_gyro);
  archive.Floats("JVg", imu.velocity_by_gyro);
  archive.Floats("JVa", imu.velocity_by_acc);
  archive.Floats("JPg", imu.position_by_gyro);
  archive.Floats("JPa", imu.position_by_acc);
  archive.Floats("avgA", imu.mean_acceleration);
  archive.Floats("avgW", imu.mean_angular_velocity);
  LayoutBias(archive, "bu", imu.updated_bias);
  archive.Floats("db", imu.bias_change);
  archive.Measurements("mvMeasurements", imu.measurements);
}

template <class Archive, class Entity>
void LayoutCalibration(Archive& archive, Entity& calibration) {
  archive.ClassInfo(WireClass::kCalib);
  archive.Pose("mTcb", calibration.camera_from_body);
  archive.Pose("mTbc", calibration.body_from_camera);
  archive.Floats("Cov", calibration.noise);
  archive.Floats("CovWalk", calibration.walk_noise);
  archive.Bool("mbIsSet", calibration.is_set);
}

template <class Archive, class Entity>
void LayoutIntrinsics(Archive& archive, Entity& intrinsics) {
  archive.Float("fx", intrinsics.fx);
  archive.Float("fy", intrinsics.fy);
  archive.Float("invfx", intrinsics.inverse_fx);
  archive.Float("invfy", intrinsics.inverse_fy);
  archive.Float("cx", intrinsics.cx);
  archive.Float("cy", intrinsics.cy);
  archive.Float("mbf", intrinsics.baseline_fx);
  archive.Float("mb", intrinsics.baseline);
  archive.Float("mThDepth", intrinsics.depth_threshold);
}

template <class Archive, class Entity>
void LayoutPyramid(Archive& archive, Entity& pyramid) {
  archive.Int("mnScaleLevels", pyramid.levels);
  archive.Float("mfScaleFactor", pyramid.factor);
  archive.Float("mfLogScaleFactor", pyramid.log_factor);
  archive.FloatVector("mvScaleFactors", pyramid.factors);
  archive.FloatVector("mvLevelSigma2", pyramid.sigma2);
  archive.FloatVector("mvInvLevelSigma2", pyramid.inverse_sigma2);
}

// Members 1 to 41: identity, camera and features of the left or only image.
template <class Archive, class Entity>
void LayoutKeyFrameFeatures(Archive& archive, Entity& keyframe) {
  auto& features = keyframe.features;
  auto& bounds = keyframe.bounds;
  archive.Begin(Part::kKeyFrame);
  archive.Identity("mnId", keyframe.id);
  archive.UnsignedLong("mnFrameId", keyframe.frame_id);
  archive.Double("mTimeStamp", keyframe.timestamp);
  archive.Int("mnGridCols", bounds.grid_columns);
  archive.Int("mnGridRows", bounds.grid_rows);
  archive.Float("mfGridElementWidthInv", bounds.inverse_cell_width);
  archive.Float("mfGridElementHeightInv", bounds.inverse_cell_height);
  archive.Float("mfScale", keyframe.merge_scale);
  LayoutIntrinsics(archive, keyframe.intrinsics);
  archive.MatrixValue("mDistCoef", keyframe.distortion);
  archive.Int("N", features.count);
  archive.Begin(Part::kKeypoints);
  archive.Keypoints("mvKeys", features.keypoints);
  archive.Keypoints("mvKeysUn", features.undistorted);
  archive.Begin(Part::kStereo);
  archive.FloatVector("mvuRight", features.right_x);
  archive.FloatVector("mvDepth", features.depth);
  archive.Begin(Part::kDescriptors);
  archive.Descriptors("mDescriptors", features.descriptors, features.descriptors_form);
  archive.Begin(Part::kBagOfWords);
  archive.Bow("mBowVec", features.bag_of_words);
  archive.FeatureMap("mFeatVec", features.feature_vector);
  archive.Begin(Part::kKeyFrame);
  archive.Pose("mTcp", keyframe.camera_from_parent);
  LayoutPyramid(archive, keyframe.pyramid);
  archive.Int("mnMinX", bounds.min_x);
  archive.Int("mnMinY", bounds.min_y);
  archive.Int("mnMaxX", bounds.max_x);
  archive.Int("mnMaxY", bounds.max_y);
  archive.Floats("mK_", keyframe.calibration_matrix);
  archive.Pose("mTcw", keyframe.camera_from_world);
  archive.Begin(Part::kMatches);
  archive.LongLongVector("mvBackupMapPointsId", features.map_points);
  archive.Begin(Part::kGrid);
  archive.Grid("mGrid", features.grid);
}

// Members 42 to 54: the graph.
template <class Archive, class Entity>
void LayoutKeyFrameGraph(Archive& archive, Entity& keyframe) {
  archive.Begin(Part::kGraph);
  archive.Connections("mBackupConnectedKeyFrameIdWeights", keyframe.connections);
  archive.Bool("mbFirstConnection", keyframe.first_connection);
  archive.LongLong("mBackupParentId", keyframe.parent);
  archive.UnsignedLongVector("mvBackupChildrensId", keyframe.children);
  archive.UnsignedLongVector("mvBackupLoopEdgesId", keyframe.loop_edges);
  archive.UnsignedLongVector("mvBackupMergeEdgesId", keyframe.merge_edges);
  archive.Bool("mbNotErase", keyframe.not_erase);
  archive.Bool("mbToBeErased", keyframe.to_be_erased);
  archive.Bool("mbBad", keyframe.bad);
  archive.Begin(Part::kKeyFrame);
  archive.Float("mHalfBaseline", keyframe.half_baseline);
  archive.Unsigned("mnOriginMapId", keyframe.origin_map);
  archive.CameraReference("mnBackupIdCamera", keyframe.camera);
  archive.CameraReference("mnBackupIdCamera2", keyframe.right_camera);
}

// Members 55 to 70: the right image and the inertial state.
template <class Archive, class Entity>
void LayoutKeyFrameRightAndInertial(Archive& archive, Entity& keyframe) {
  auto& features = keyframe.features;
  archive.Begin(Part::kStereo);
  archive.IntVector("mvLeftToRightMatch", features.right_of_left);
  archive.IntVector("mvRightToLeftMatch", features.left_of_right);
  archive.Int("NLeft", features.left_count);
  archive.Int("NRight", features.right_count);
  archive.Pose("mTlr", keyframe.left_from_right);
  archive.Begin(Part::kKeypoints);
  archive.Keypoints("mvKeysRight", features.right_keypoints);
  archive.Begin(Part::kGrid);
  archive.Grid("mGridRight", features.right_grid);
  archive.Begin(Part::kInertial);
  archive.ClassInfo(WireClass::kBias);
  LayoutBias(archive, "mImuBias", keyframe.imu_bias);
  LayoutPreintegration(archive, keyframe.preintegration);
  LayoutCalibration(archive, keyframe.imu_calibration);
  archive.LongLong("mBackupPrevKFId", keyframe.previous);
  archive.LongLong("mBackupNextKFId", keyframe.next);
  archive.Bool("bImu", keyframe.imu_initialized);
  archive.Floats("mVw", keyframe.velocity);
  archive.Floats("mOwb", keyframe.body_position);
  archive.Bool("mbHasVelocity", keyframe.has_velocity);
}

template <class Archive, class Entity>
void LayoutKeyFrame(Archive& archive, Entity& keyframe) {
  LayoutKeyFrameFeatures(archive, keyframe);
  LayoutKeyFrameGraph(archive, keyframe);
  LayoutKeyFrameRightAndInertial(archive, keyframe);
  archive.Begin(Part::kOther);
}

template <class Archive, class Entity>
void LayoutMapPoint(Archive& archive, Entity& point) {
  archive.Begin(Part::kMapPoint);
  archive.Identity("mnId", point.id);
  archive.Long("mnFirstKFid", point.first_keyframe);
  archive.Long("mnFirstFrame", point.first_frame);
  archive.Int("nObs", point.observation_count);
  archive.Floats("mWorldPos", point.position);
  archive.Floats("mNormalVector", point.normal);
  archive.Begin(Part::kObservations);
  archive.Observations("mBackupObservationsId1", "mBackupObservationsId2", point.observations);
  archive.Begin(Part::kMapPoint);
  archive.PointDescriptor("mDescriptor", point.descriptor, point.descriptor_form);
  archive.UnsignedLong("mBackupRefKFId", point.reference);
  archive.Bool("mbBad", point.bad);
  archive.LongLong("mBackupReplacedId", point.replaced_by);
  archive.Float("mfMinDistance", point.min_distance);
  archive.Float("mfMaxDistance", point.max_distance);
  archive.Begin(Part::kOther);
}

// Members 1 to 4 of a map; its keyframe and map point lists follow.
template <class Archive, class Entity>
void LayoutMapHead(Archive& archive, Entity& map) {
  archive.UnsignedLong("mnId", map.id);
  archive.UnsignedLong("mnInitKFid", map.initial_keyframe);
  archive.UnsignedLong("mnMaxKFid", map.max_keyframe_id);
  archive.Int("mnBigChangeIdx", map.big_change_index);
}

// Members 7 to 13 of a map, behind the lists.
template <class Archive, class Entity>
void LayoutMapTail(Archive& archive, Entity& map) {
  archive.UnsignedLongVector("mvBackupKeyFrameOriginsId", map.origins);
  archive.UnsignedLong("mnBackupKFinitialID", map.first_keyframe);
  archive.UnsignedLong("mnBackupKFlowerID", map.lowest_keyframe);
  archive.Bool("mbImuInitialized", map.imu_initialized);
  archive.Bool("mbIsInertial", map.inertial);
  archive.Bool("mbIMU_BA1", map.imu_ba1);
  archive.Bool("mbIMU_BA2", map.imu_ba2);
}

template <class Archive, class Entity>
void LayoutCamera(Archive& archive, Entity& camera) {
  archive.ClassInfo(WireClass::kGeometricCamera);
  archive.CameraReference("mnId", camera.id);
  archive.Unsigned("mnType", camera.recorded_type);
  archive.FloatVector("mvParameters", camera.parameters);
  if (camera.model == CameraModel::kKannalaBrandt8) archive.Float("precision", camera.precision);
}

template <class Archive, class Entity>
void LayoutCounters(Archive& archive, Entity& counters) {
  archive.UnsignedLong("Map::nNextId", counters.map);
  archive.UnsignedLong("Frame::nNextId", counters.frame);
  archive.UnsignedLong("KeyFrame::nNextId", counters.keyframe);
  archive.UnsignedLong("MapPoint::nNextId", counters.map_point);
  archive.UnsignedLong("GeometricCamera::nNextId", counters.camera);
  archive.UnsignedLong("mnLastInitKFidMap", counters.initial_keyframe);
}

}  // namespace slamdb::orbslam3
