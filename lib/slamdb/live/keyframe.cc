// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/keyframe.h"

#include "slamdb/live/detail/own.h"
#include "slamdb/live/frame.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"
#include "slamdb/model/derive.h"

namespace slamdb::live {

using Lock = std::lock_guard<std::mutex>;

Runtime& KeyFrame::CheckedRuntime(const Frame& frame, const Map* map) {
  if (map == nullptr) RefuseNull("the map");
  RequireOwn(&frame, map->runtime(), "the frame");
  for (const MapPoint* point : frame.mvpMapPoints)
    if (point != nullptr) RequireOwn(point, map->runtime(), "a point that the frame sees");
  return map->runtime();
}

KeyFrame::KeyFrame(Frame& F, Map* pMap, KeyFrameDatabase* pKFDB)
    : Listed(CheckedRuntime(F, pMap)),
      record_(F.image()),
      features_(std::move(record_.features)),
      mnId(runtime().keyframe_ids.Next()),
      mnFrameId(F.mnId),
      mTimeStamp(F.mTimeStamp),
      N(F.N),
      NLeft(F.Nleft),
      NRight(F.Nright),
      mnOriginMapId(static_cast<unsigned int>(pMap->GetId())),
      mfScale(1),
      bImu(pMap->isImuInitialized()),
      mpCamera(F.mpCamera),
      mpCamera2(F.mpCamera2),
      map_(pMap),
      vocabulary_(F.mpORBvocabulary),
      database_(pKFDB),
      slots_(F.mvpMapPoints) {
  record_.features = {};
  record_.id = KeyFrameId(mnId);
  record_.camera = record_.right_camera = {};
  record_.connections.clear();
  record_.first_connection = true;
  record_.parent = record_.previous = record_.next = {};
  record_.children.clear();
  record_.loop_edges.clear();
  record_.merge_edges.clear();
  record_.not_erase = record_.to_be_erased = record_.bad = false;
  SetPose(record_.camera_from_world);
}

void KeyFrame::MarkChanged() {
  if (is_owned()) runtime().changed_keyframes.Add(this);
}

void KeyFrame::UpdateMap(Map* pMap) {
  if (pMap != nullptr) RequireOwn(pMap, runtime(), "the map");
  const Change change(runtime().gate);
  map_ = pMap;
  MarkChanged();
}

// ---- pose

void KeyFrame::SetPose(const Rigid3f& Tcw) {
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_pose_);
    record_.camera_from_world = Tcw.Normalized();
    if (record_.imu_calibration.is_set) record_.body_position = WorldFromBody(record_).translation;
  }
  MarkChanged();
}

void KeyFrame::SetVelocity(const Eigen::Vector3f& Vw) {
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_pose_);
    record_.velocity = Vw;
    record_.has_velocity = true;
  }
  MarkChanged();
}

Rigid3f KeyFrame::GetPose() {
  const Lock lock(mutex_pose_);
  return record_.camera_from_world.Normalized();
}

Rigid3f KeyFrame::GetPoseInverse() { return GetPose().Inverse(); }

Eigen::Vector3f KeyFrame::GetCameraCenter() {
  const Lock lock(mutex_pose_);
  return CameraCenter(record_);
}

Eigen::Vector3f KeyFrame::GetRightCameraCenter() {
  const Lock lock(mutex_pose_);
  return RightCameraCenter(record_);
}

Rigid3f KeyFrame::GetRightPose() {
  const Lock lock(mutex_pose_);
  return RightCameraFromWorld(record_);
}

Rigid3f KeyFrame::GetRightPoseInverse() { return GetRightPose().Inverse(); }
Eigen::Matrix3f KeyFrame::GetRightRotation() { return GetRightPose().rotation.toRotationMatrix(); }
Eigen::Vector3f KeyFrame::GetRightTranslation() { return GetRightPose().translation; }
Rigid3f KeyFrame::GetRelativePoseTlr() const { return record_.left_from_right.Normalized(); }
Rigid3f KeyFrame::GetRelativePoseTrl() const { return GetRelativePoseTlr().Inverse(); }

Eigen::Matrix3f KeyFrame::GetRotation() { return GetPose().rotation.toRotationMatrix(); }
Eigen::Vector3f KeyFrame::GetTranslation() { return GetPose().translation; }

Rigid3f KeyFrame::GetImuPose() {
  const Lock lock(mutex_pose_);
  return WorldFromBody(record_);
}

Eigen::Vector3f KeyFrame::GetImuPosition() { return GetImuPose().translation; }

Eigen::Matrix3f KeyFrame::GetImuRotation() { return GetImuPose().rotation.toRotationMatrix(); }

Eigen::Vector3f KeyFrame::GetVelocity() {
  const Lock lock(mutex_pose_);
  return record_.velocity;
}

bool KeyFrame::isVelocitySet() {
  const Lock lock(mutex_pose_);
  return record_.has_velocity;
}

Rigid3f KeyFrame::GetPoseFromParent() {
  const Lock lock(mutex_pose_);
  return mTcp;
}

// ---- inertial

void KeyFrame::SetNewBias(const ImuBias& bias) {
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_pose_);
    record_.imu_bias = bias;
    ImuPreintegration& imu = record_.preintegration;
    imu.updated_bias = bias;
    imu.bias_change << bias.gyroscope - imu.bias.gyroscope, bias.accelerometer - imu.bias.accelerometer;
  }
  MarkChanged();
}

ImuBias KeyFrame::GetImuBias() {
  const Lock lock(mutex_pose_);
  return record_.imu_bias;
}

Eigen::Vector3f KeyFrame::GetGyroBias() { return GetImuBias().gyroscope; }
Eigen::Vector3f KeyFrame::GetAccBias() { return GetImuBias().accelerometer; }

ImuPreintegration KeyFrame::GetImuPreintegrated() {
  const Lock lock(mutex_pose_);
  return record_.preintegration;
}

void KeyFrame::SetImuPreintegrated(const ImuPreintegration& preintegration) {
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_pose_);
    record_.preintegration = preintegration;
  }
  MarkChanged();
}

}  // namespace slamdb::live
