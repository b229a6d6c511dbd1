// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/orbslam3/detail/class_table.h"
#include "slamdb/model/atlas.h"

// The members of ORB-SLAM3's classes in archive order, under the archive's own names: the one description that reading,
// skipping and writing, binary and text, follow. An archive has one function for each kind of wire value; entities are
// const when it writes. Pointer lists, which change the object table, are the business of reader.cc and writer.cc.
//
// ForEach...Member calls visit(name, step) for each member, where step(archive, name, entity) moves it between an
// archive and an entity, and visit(part) where another part begins. LayoutX runs all steps of an X one behind the
// other; what follows a fork's layout (fork_program.h) runs them in the order of that.
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

// Runs the steps of a walk.
template <class Archive, class Entity>
class StepRunner {
 public:
  StepRunner(Archive& archive, Entity& entity) : archive_(archive), entity_(entity) {}

  void operator()(Part part) const { archive_.Begin(part); }
  template <class Step>
  void operator()(const char* name, const Step& step) const {
    step(archive_, name, entity_);
  }

 private:
  Archive& archive_;
  Entity& entity_;
};

template <class Archive, class Entity>
void LayoutBias(Archive& archive, const char* name, Entity& bias) {
  archive.ClassInfo(WireClass::kBias);
  archive.Floats(name, bias.accelerometer);
  archive.Floats(name, bias.gyroscope);
}

template <class Visit>
void ForEachPreintegrationMember(const Visit& visit) {
  visit("dT", [](auto& archive, const char* name, auto& imu) { archive.Float(name, imu.duration); });
  visit("C", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.covariance); });
  visit("Info", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.information); });
  visit("Nga", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.noise); });
  visit("NgaWalk", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.walk_noise); });
  visit("b", [](auto& archive, const char* name, auto& imu) { LayoutBias(archive, name, imu.bias); });
  visit("dR", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.rotation); });
  visit("dV", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.velocity); });
  visit("dP", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.position); });
  visit("JRg", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.rotation_by_gyro); });
  visit("JVg", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.velocity_by_gyro); });
  visit("JVa", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.velocity_by_acc); });
  visit("JPg", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.position_by_gyro); });
  visit("JPa", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.position_by_acc); });
  visit("avgA", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.mean_acceleration); });
  visit("avgW", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.mean_angular_velocity); });
  visit("bu", [](auto& archive, const char* name, auto& imu) { LayoutBias(archive, name, imu.updated_bias); });
  visit("db", [](auto& archive, const char* name, auto& imu) { archive.Floats(name, imu.bias_change); });
  visit("mvMeasurements",
        [](auto& archive, const char* name, auto& imu) { archive.Measurements(name, imu.measurements); });
}

template <class Archive, class Entity>
void LayoutPreintegration(Archive& archive, Entity& imu) {
  archive.ClassInfo(WireClass::kPreintegrated);
  ForEachPreintegrationMember(StepRunner(archive, imu));
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

// In that order: identity, camera and features of the left or only image; the graph; the right image and the inertial
// state.
template <class Visit>
void ForEachKeyFrameMember(const Visit& visit) {
  visit(Part::kKeyFrame);
  visit("mnId", [](auto& archive, const char* name, auto& keyframe) { archive.Identity(name, keyframe.id); });
  visit("mnFrameId",
        [](auto& archive, const char* name, auto& keyframe) { archive.UnsignedLong(name, keyframe.frame_id); });
  visit("mTimeStamp",
        [](auto& archive, const char* name, auto& keyframe) { archive.Double(name, keyframe.timestamp); });
  visit("mnGridCols",
        [](auto& archive, const char* name, auto& keyframe) { archive.Int(name, keyframe.bounds.grid_columns); });
  visit("mnGridRows",
        [](auto& archive, const char* name, auto& keyframe) { archive.Int(name, keyframe.bounds.grid_rows); });
  visit("mfGridElementWidthInv", [](auto& archive, const char* name, auto& keyframe) {
    archive.Float(name, keyframe.bounds.inverse_cell_width);
  });
  visit("mfGridElementHeightInv", [](auto& archive, const char* name, auto& keyframe) {
    archive.Float(name, keyframe.bounds.inverse_cell_height);
  });
  visit("mfScale", [](auto& archive, const char* name, auto& keyframe) { archive.Float(name, keyframe.merge_scale); });
  visit("fx", [](auto& archive, const char* name, auto& keyframe) { archive.Float(name, keyframe.intrinsics.fx); });
  visit("fy", [](auto& archive, const char* name, auto& keyframe) { archive.Float(name, keyframe.intrinsics.fy); });
  visit("invfx",
        [](auto& archive, const char* name, auto& keyframe) { archive.Float(name, keyframe.intrinsics.inverse_fx); });
  visit("invfy",
        [](auto& archive, const char* name, auto& keyframe) { archive.Float(name, keyframe.intrinsics.inverse_fy); });
  visit("cx", [](auto& archive, const char* name, auto& keyframe) { archive.Float(name, keyframe.intrinsics.cx); });
  visit("cy", [](auto& archive, const char* name, auto& keyframe) { archive.Float(name, keyframe.intrinsics.cy); });
  visit("mbf",
        [](auto& archive, const char* name, auto& keyframe) { archive.Float(name, keyframe.intrinsics.baseline_fx); });
  visit("mb",
        [](auto& archive, const char* name, auto& keyframe) { archive.Float(name, keyframe.intrinsics.baseline); });
  visit("mThDepth", [](auto& archive, const char* name, auto& keyframe) {
    archive.Float(name, keyframe.intrinsics.depth_threshold);
  });
  visit("mDistCoef",
        [](auto& archive, const char* name, auto& keyframe) { archive.MatrixValue(name, keyframe.distortion); });
  visit("N", [](auto& archive, const char* name, auto& keyframe) { archive.Int(name, keyframe.features.count); });
  visit(Part::kKeypoints);
  visit("mvKeys",
        [](auto& archive, const char* name, auto& keyframe) { archive.Keypoints(name, keyframe.features.keypoints); });
  visit("mvKeysUn", [](auto& archive, const char* name, auto& keyframe) {
    archive.Keypoints(name, keyframe.features.undistorted);
  });
  visit(Part::kStereo);
  visit("mvuRight",
        [](auto& archive, const char* name, auto& keyframe) { archive.FloatVector(name, keyframe.features.right_x); });
  visit("mvDepth",
        [](auto& archive, const char* name, auto& keyframe) { archive.FloatVector(name, keyframe.features.depth); });
  visit(Part::kDescriptors);
  visit("mDescriptors", [](auto& archive, const char* name, auto& keyframe) {
    archive.Descriptors(name, keyframe.features.descriptors, keyframe.features.descriptors_form, keyframe.carried);
  });
  visit(Part::kBagOfWords);
  visit("mBowVec",
        [](auto& archive, const char* name, auto& keyframe) { archive.Bow(name, keyframe.features.bag_of_words); });
  visit("mFeatVec", [](auto& archive, const char* name, auto& keyframe) {
    archive.FeatureMap(name, keyframe.features.feature_vector);
  });
  visit(Part::kKeyFrame);
  visit("mTcp",
        [](auto& archive, const char* name, auto& keyframe) { archive.Pose(name, keyframe.camera_from_parent); });
  visit("mnScaleLevels",
        [](auto& archive, const char* name, auto& keyframe) { archive.Int(name, keyframe.pyramid.levels); });
  visit("mfScaleFactor",
        [](auto& archive, const char* name, auto& keyframe) { archive.Float(name, keyframe.pyramid.factor); });
  visit("mfLogScaleFactor",
        [](auto& archive, const char* name, auto& keyframe) { archive.Float(name, keyframe.pyramid.log_factor); });
  visit("mvScaleFactors",
        [](auto& archive, const char* name, auto& keyframe) { archive.FloatVector(name, keyframe.pyramid.factors); });
  visit("mvLevelSigma2",
        [](auto& archive, const char* name, auto& keyframe) { archive.FloatVector(name, keyframe.pyramid.sigma2); });
  visit("mvInvLevelSigma2", [](auto& archive, const char* name, auto& keyframe) {
    archive.FloatVector(name, keyframe.pyramid.inverse_sigma2);
  });
  visit("mnMinX", [](auto& archive, const char* name, auto& keyframe) { archive.Int(name, keyframe.bounds.min_x); });
  visit("mnMinY", [](auto& archive, const char* name, auto& keyframe) { archive.Int(name, keyframe.bounds.min_y); });
  visit("mnMaxX", [](auto& archive, const char* name, auto& keyframe) { archive.Int(name, keyframe.bounds.max_x); });
  visit("mnMaxY", [](auto& archive, const char* name, auto& keyframe) { archive.Int(name, keyframe.bounds.max_y); });
  visit("mK_",
        [](auto& archive, const char* name, auto& keyframe) { archive.Floats(name, keyframe.calibration_matrix); });
  visit("mTcw",
        [](auto& archive, const char* name, auto& keyframe) { archive.Pose(name, keyframe.camera_from_world); });
  visit(Part::kMatches);
  visit("mvBackupMapPointsId", [](auto& archive, const char* name, auto& keyframe) {
    archive.LongLongVector(name, keyframe.features.map_points);
  });
  visit(Part::kGrid);
  visit("mGrid", [](auto& archive, const char* name, auto& keyframe) { archive.Grid(name, keyframe.features.grid); });
  visit(Part::kGraph);
  visit("mBackupConnectedKeyFrameIdWeights",
        [](auto& archive, const char* name, auto& keyframe) { archive.Connections(name, keyframe.connections); });
  visit("mbFirstConnection",
        [](auto& archive, const char* name, auto& keyframe) { archive.Bool(name, keyframe.first_connection); });
  visit("mBackupParentId",
        [](auto& archive, const char* name, auto& keyframe) { archive.LongLong(name, keyframe.parent); });
  visit("mvBackupChildrensId",
        [](auto& archive, const char* name, auto& keyframe) { archive.UnsignedLongVector(name, keyframe.children); });
  visit("mvBackupLoopEdgesId",
        [](auto& archive, const char* name, auto& keyframe) { archive.UnsignedLongVector(name, keyframe.loop_edges); });
  visit("mvBackupMergeEdgesId", [](auto& archive, const char* name, auto& keyframe) {
    archive.UnsignedLongVector(name, keyframe.merge_edges);
  });
  visit("mbNotErase", [](auto& archive, const char* name, auto& keyframe) { archive.Bool(name, keyframe.not_erase); });
  visit("mbToBeErased",
        [](auto& archive, const char* name, auto& keyframe) { archive.Bool(name, keyframe.to_be_erased); });
  visit("mbBad", [](auto& archive, const char* name, auto& keyframe) { archive.Bool(name, keyframe.bad); });
  visit(Part::kKeyFrame);
  visit("mHalfBaseline",
        [](auto& archive, const char* name, auto& keyframe) { archive.Float(name, keyframe.half_baseline); });
  visit("mnOriginMapId",
        [](auto& archive, const char* name, auto& keyframe) { archive.Unsigned(name, keyframe.origin_map); });
  visit("mnBackupIdCamera",
        [](auto& archive, const char* name, auto& keyframe) { archive.CameraReference(name, keyframe.camera); });
  visit("mnBackupIdCamera2",
        [](auto& archive, const char* name, auto& keyframe) { archive.CameraReference(name, keyframe.right_camera); });
  visit(Part::kStereo);
  visit("mvLeftToRightMatch", [](auto& archive, const char* name, auto& keyframe) {
    archive.IntVector(name, keyframe.features.right_of_left);
  });
  visit("mvRightToLeftMatch", [](auto& archive, const char* name, auto& keyframe) {
    archive.IntVector(name, keyframe.features.left_of_right);
  });
  visit("NLeft",
        [](auto& archive, const char* name, auto& keyframe) { archive.Int(name, keyframe.features.left_count); });
  visit("NRight",
        [](auto& archive, const char* name, auto& keyframe) { archive.Int(name, keyframe.features.right_count); });
  visit("mTlr", [](auto& archive, const char* name, auto& keyframe) { archive.Pose(name, keyframe.left_from_right); });
  visit(Part::kKeypoints);
  visit("mvKeysRight", [](auto& archive, const char* name, auto& keyframe) {
    archive.Keypoints(name, keyframe.features.right_keypoints);
  });
  visit(Part::kGrid);
  visit("mGridRight",
        [](auto& archive, const char* name, auto& keyframe) { archive.Grid(name, keyframe.features.right_grid); });
  visit(Part::kInertial);
  visit("mImuBias",
        [](auto& archive, const char* name, auto& keyframe) { LayoutBias(archive, name, keyframe.imu_bias); });
  visit("mBackupImuPreintegrated",
        [](auto& archive, const char*, auto& keyframe) { LayoutPreintegration(archive, keyframe.preintegration); });
  visit("mImuCalib",
        [](auto& archive, const char*, auto& keyframe) { LayoutCalibration(archive, keyframe.imu_calibration); });
  visit("mBackupPrevKFId",
        [](auto& archive, const char* name, auto& keyframe) { archive.LongLong(name, keyframe.previous); });
  visit("mBackupNextKFId",
        [](auto& archive, const char* name, auto& keyframe) { archive.LongLong(name, keyframe.next); });
  visit("bImu", [](auto& archive, const char* name, auto& keyframe) { archive.Bool(name, keyframe.imu_initialized); });
  visit("mVw", [](auto& archive, const char* name, auto& keyframe) { archive.Floats(name, keyframe.velocity); });
  visit("mOwb", [](auto& archive, const char* name, auto& keyframe) { archive.Floats(name, keyframe.body_position); });
  visit("mbHasVelocity",
        [](auto& archive, const char* name, auto& keyframe) { archive.Bool(name, keyframe.has_velocity); });
}

template <class Archive, class Entity>
void LayoutKeyFrame(Archive& archive, Entity& keyframe) {
  ForEachKeyFrameMember(StepRunner(archive, keyframe));
  archive.Begin(Part::kOther);
}

// mBackupObservationsId1 moves mBackupObservationsId2 too.
template <class Visit>
void ForEachMapPointMember(const Visit& visit) {
  visit(Part::kMapPoint);
  visit("mnId", [](auto& archive, const char* name, auto& point) { archive.Identity(name, point.id); });
  visit("mnFirstKFid", [](auto& archive, const char* name, auto& point) { archive.Long(name, point.first_keyframe); });
  visit("mnFirstFrame", [](auto& archive, const char* name, auto& point) { archive.Long(name, point.first_frame); });
  visit("nObs", [](auto& archive, const char* name, auto& point) { archive.Int(name, point.observation_count); });
  visit("mWorldPos", [](auto& archive, const char* name, auto& point) { archive.Floats(name, point.position); });
  visit("mNormalVector", [](auto& archive, const char* name, auto& point) { archive.Floats(name, point.normal); });
  visit(Part::kObservations);
  visit("mBackupObservationsId1", [](auto& archive, const char* name, auto& point) {
    archive.Observations(name, "mBackupObservationsId2", point.observations);
  });
  visit(Part::kMapPoint);
  visit("mDescriptor", [](auto& archive, const char* name, auto& point) {
    archive.PointDescriptor(name, point.descriptor, point.descriptor_form, point.carried);
  });
  visit("mBackupRefKFId",
        [](auto& archive, const char* name, auto& point) { archive.UnsignedLong(name, point.reference); });
  visit("mbBad", [](auto& archive, const char* name, auto& point) { archive.Bool(name, point.bad); });
  visit("mBackupReplacedId",
        [](auto& archive, const char* name, auto& point) { archive.LongLong(name, point.replaced_by); });
  visit("mfMinDistance", [](auto& archive, const char* name, auto& point) { archive.Float(name, point.min_distance); });
  visit("mfMaxDistance", [](auto& archive, const char* name, auto& point) { archive.Float(name, point.max_distance); });
}

// What some forks write too.
template <class Visit>
void ForEachTrackingMember(const Visit& visit) {
  visit("mnOriginMapId",
        [](auto& archive, const char* name, auto& point) { archive.Unsigned(name, point.origin_map); });
  visit("mnVisible", [](auto& archive, const char* name, auto& point) { archive.Int(name, point.visible_count); });
  visit("mnFound", [](auto& archive, const char* name, auto& point) { archive.Int(name, point.found_count); });
}

template <class Archive, class Entity>
void LayoutMapPoint(Archive& archive, Entity& point) {
  ForEachMapPointMember(StepRunner(archive, point));
  archive.Begin(Part::kOther);
}

// Members 1 to 4 of a map; its keyframe and map point lists follow.
template <class Visit>
void ForEachMapHeadMember(const Visit& visit) {
  visit("mnId", [](auto& archive, const char* name, auto& map) { archive.UnsignedLong(name, map.id); });
  visit("mnInitKFid",
        [](auto& archive, const char* name, auto& map) { archive.UnsignedLong(name, map.initial_keyframe); });
  visit("mnMaxKFid",
        [](auto& archive, const char* name, auto& map) { archive.UnsignedLong(name, map.max_keyframe_id); });
  visit("mnBigChangeIdx", [](auto& archive, const char* name, auto& map) { archive.Int(name, map.big_change_index); });
}

// Members 7 to 13 of a map, behind the lists.
template <class Visit>
void ForEachMapTailMember(const Visit& visit) {
  visit("mvBackupKeyFrameOriginsId",
        [](auto& archive, const char* name, auto& map) { archive.UnsignedLongVector(name, map.origins); });
  visit("mnBackupKFinitialID",
        [](auto& archive, const char* name, auto& map) { archive.UnsignedLong(name, map.first_keyframe); });
  visit("mnBackupKFlowerID",
        [](auto& archive, const char* name, auto& map) { archive.UnsignedLong(name, map.lowest_keyframe); });
  visit("mbImuInitialized",
        [](auto& archive, const char* name, auto& map) { archive.Bool(name, map.imu_initialized); });
  visit("mbIsInertial", [](auto& archive, const char* name, auto& map) { archive.Bool(name, map.inertial); });
  visit("mbIMU_BA1", [](auto& archive, const char* name, auto& map) { archive.Bool(name, map.imu_ba1); });
  visit("mbIMU_BA2", [](auto& archive, const char* name, auto& map) { archive.Bool(name, map.imu_ba2); });
}

template <class Archive, class Entity>
void LayoutMapHead(Archive& archive, Entity& map) {
  ForEachMapHeadMember(StepRunner(archive, map));
}
template <class Archive, class Entity>
void LayoutMapTail(Archive& archive, Entity& map) {
  ForEachMapTailMember(StepRunner(archive, map));
}

// Of the base class of all cameras, and of some of them.
template <class Visit>
void ForEachCameraMember(const Visit& visit) {
  visit("mnId", [](auto& archive, const char* name, auto& camera) { archive.CameraReference(name, camera.id); });
  visit("mnType", [](auto& archive, const char* name, auto& camera) { archive.Unsigned(name, camera.recorded_type); });
  visit("mvParameters",
        [](auto& archive, const char* name, auto& camera) { archive.FloatVector(name, camera.parameters); });
}
template <class Visit>
void ForEachFisheyeMember(const Visit& visit) {
  visit("precision", [](auto& archive, const char* name, auto& camera) { archive.Float(name, camera.precision); });
}
template <class Archive, class Entity>
void LayoutCamera(Archive& archive, Entity& camera) {
  archive.ClassInfo(WireClass::kGeometricCamera);
  ForEachCameraMember(StepRunner(archive, camera));
  if (camera.model == CameraModel::kKannalaBrandt8) ForEachFisheyeMember(StepRunner(archive, camera));
}

template <class Visit>
void ForEachCounterMember(const Visit& visit) {
  visit("Map::nNextId",
        [](auto& archive, const char* name, auto& counters) { archive.UnsignedLong(name, counters.map); });
  visit("Frame::nNextId",
        [](auto& archive, const char* name, auto& counters) { archive.UnsignedLong(name, counters.frame); });
  visit("KeyFrame::nNextId",
        [](auto& archive, const char* name, auto& counters) { archive.UnsignedLong(name, counters.keyframe); });
  visit("MapPoint::nNextId",
        [](auto& archive, const char* name, auto& counters) { archive.UnsignedLong(name, counters.map_point); });
  visit("GeometricCamera::nNextId",
        [](auto& archive, const char* name, auto& counters) { archive.UnsignedLong(name, counters.camera); });
  visit("mnLastInitKFidMap",
        [](auto& archive, const char* name, auto& counters) { archive.UnsignedLong(name, counters.initial_keyframe); });
}

template <class Archive, class Entity>
void LayoutCounters(Archive& archive, Entity& counters) {
  ForEachCounterMember(StepRunner(archive, counters));
}

}  // namespace slamdb::orbslam3
