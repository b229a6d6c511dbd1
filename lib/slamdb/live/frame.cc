// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/frame.h"

#include "slamdb/live/atlas.h"
#include "slamdb/live/camera.h"
#include "slamdb/live/detail/own.h"
#include "slamdb/live/map_point.h"
#include "slamdb/model/derive.h"

namespace slamdb::live {

Frame::Frame(Atlas& atlas, slamdb::KeyFrame image, GeometricCamera* camera, GeometricCamera* camera2)
    : mnId(atlas.runtime().frame_ids.Next()),
      mTimeStamp(image.timestamp),
      N(image.features.count),
      Nleft(image.features.left_count),
      Nright(image.features.right_count),
      mvpMapPoints(static_cast<std::size_t>(N), nullptr),
      mvbOutlier(static_cast<std::size_t>(N), false),
      mpCamera(camera),
      mpCamera2(camera2),
      mpORBvocabulary(atlas.GetORBVocabulary()),
      runtime_(&atlas.runtime()),
      image_(std::move(image)) {
  RequireOwn(camera, *runtime_, "the camera");
  if (camera2 != nullptr) RequireOwn(camera2, *runtime_, "the second camera");
  Features& features = image_.features;
  features.map_points.clear();
  const Column<Keypoint>& keypoints = features.is_fisheye_stereo() ? features.keypoints : features.undistorted;
  if (features.grid.empty()) features.grid = DeriveGrid(keypoints, image_.bounds);
  if (features.is_fisheye_stereo() && features.right_grid.empty())
    features.right_grid = DeriveGrid(features.right_keypoints, image_.bounds);
  SetPose(image_.camera_from_world);
}

void Frame::SetPose(const Rigid3f& Tcw) { image_.camera_from_world = Tcw.Normalized(); }

Eigen::Vector3f Frame::GetCameraCenter() const { return CameraCenter(image_); }
Eigen::Vector3f Frame::GetRightCameraCenter() const { return RightCameraCenter(image_); }
Rigid3f Frame::GetRightPose() const { return RightCameraFromWorld(image_); }

bool Frame::UnprojectStereo(int i, Eigen::Vector3f& x3D) const {
  const std::optional<Eigen::Vector3f> position = UnprojectDepth(image_.features, image_.intrinsics, i);
  if (!position) return false;
  x3D = GetPose().Inverse() * *position;
  return true;
}

bool Frame::isInFrustum(MapPoint* pMP, float viewingCosLimit) {
  RequireOwn(pMP, *runtime_, "the point");
  pMP->mTrackProjX = pMP->mTrackProjY = pMP->mTrackProjXR = pMP->mTrackProjYR = -1;
  pMP->mnTrackScaleLevel = pMP->mnTrackScaleLevelR = -1;
  pMP->mbTrackInView = mpCamera != nullptr && IsInView(pMP, viewingCosLimit, false);
  pMP->mbTrackInViewR = Nleft != -1 && mpCamera2 != nullptr && IsInView(pMP, viewingCosLimit, true);
  return pMP->mbTrackInView || pMP->mbTrackInViewR;
}

bool Frame::IsInView(MapPoint* point, float least_cosine, bool right) {
  const Eigen::Vector3f position = point->GetWorldPos();
  const Eigen::Vector3f in_camera = (right ? GetRightPose() : GetPose()) * position;
  if (!(in_camera.z() > 0)) return false;
  const Eigen::Vector2f pixel = (right ? mpCamera2 : mpCamera)->project(in_camera);
  if (!IsInsideImage(image_.bounds, pixel.x(), pixel.y())) return false;

  const Eigen::Vector3f offset = position - (right ? GetRightCameraCenter() : GetCameraCenter());
  const float distance = offset.norm();
  if (distance < point->GetMinDistanceInvariance() || distance > point->GetMaxDistanceInvariance()) return false;
  const float cosine = offset.dot(point->GetNormal()) / distance;
  if (cosine < least_cosine) return false;

  const int level = point->PredictScale(distance, this);
  if (right) {
    point->mTrackProjXR = pixel.x();
    point->mTrackProjYR = pixel.y();
    point->mTrackDepthR = distance;
    point->mnTrackScaleLevelR = level;
    point->mTrackViewCosR = cosine;
  } else {
    point->mTrackProjX = pixel.x();
    point->mTrackProjY = pixel.y();
    if (Nleft == -1) point->mTrackProjXR = pixel.x() - image_.intrinsics.baseline_fx / in_camera.z();
    point->mTrackDepth = distance;
    point->mnTrackScaleLevel = level;
    point->mTrackViewCos = cosine;
  }
  return true;
}

}  // namespace slamdb::live
