// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "slamdb/model/keyframe.h"

namespace slamdb::live {

class Atlas;
class GeometricCamera;
class KeyFrame;
class MapPoint;

// An image that is being tracked: what ORB-SLAM3's class Frame gives to map points and keyframes, with its names. It
// belongs to one thread.
class Frame {
 public:
  // `image` has timestamp, features, calibration, pyramid and bounds, and optionally pose and IMU data; its ids and
  // links are not used. Grids are derived where it has none. The cameras belong to the atlas, which gives the frame its
  // id.
  Frame(Atlas& atlas, slamdb::KeyFrame image, GeometricCamera* camera, GeometricCamera* camera2 = nullptr);

  void SetPose(const Rigid3f& Tcw);  // left camera_from_world
  Rigid3f GetPose() const { return image_.camera_from_world; }
  Eigen::Vector3f GetCameraCenter() const;
  Eigen::Vector3f GetRightCameraCenter() const;  // fisheye stereo
  Rigid3f GetRightPose() const;

  // The world position of a keypoint with depth. False when it has none.
  bool UnprojectStereo(int i, Eigen::Vector3f& x3D) const;

  // Whether the point should be seen: it projects into the image, from within its distance range and at a viewing angle
  // of at least that cosine to its normal. Sets the point's mTrack members.
  bool isInFrustum(MapPoint* pMP, float viewingCosLimit);

  const slamdb::KeyFrame& image() const { return image_; }

  long unsigned int mnId;
  double mTimeStamp;  // seconds
  int N, Nleft, Nright;
  std::vector<MapPoint*> mvpMapPoints;  // by keypoint; null: none
  std::vector<bool> mvbOutlier;
  KeyFrame* mpReferenceKF = nullptr;
  GeometricCamera *mpCamera, *mpCamera2;

 private:
  bool IsInView(MapPoint* point, float least_cosine, bool right);

  slamdb::KeyFrame image_;
};

}  // namespace slamdb::live
