// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/live/keyframe_database.h"
#include "slamdb/model/keyframe.h"

namespace slamdb::live {

class Atlas;
class GeometricCamera;
class KeyFrame;
class MapPoint;
struct Runtime;

// An image that is being tracked: what ORB-SLAM3's class Frame gives to map points and keyframes, with its names.
// It belongs to one thread.
class SLAMDB_EXPORT Frame {
 public:
  // `image` has timestamp, features (FeaturesOfImage, opencv.h), calibration, pyramid and bounds, and optionally pose
  // and IMU data; its ids and links are not used. Grids are derived where it has none. The atlas gives the frame its
  // id. Throws Error (kUsage) when the first camera is null, or a camera is not of the atlas.
  Frame(Atlas& atlas, slamdb::KeyFrame image, GeometricCamera* camera, GeometricCamera* camera2 = nullptr);

  void SetPose(const Rigid3f& Tcw);  // left camera_from_world
  Rigid3f GetPose() const { return image_.camera_from_world; }
  Eigen::Vector3f GetCameraCenter() const;
  Eigen::Vector3f GetRightCameraCenter() const;  // fisheye stereo
  Rigid3f GetRightPose() const;

  // The world position of a keypoint with depth. False when it has none.
  bool UnprojectStereo(int i, Eigen::Vector3f& x3D) const;

  // Whether the point should be seen: it projects into the image, from within its distance range and at a viewing angle
  // of at least that cosine to its normal.
  // Sets the point's mTrack members. In an image that should not see it mTrackProj... and mnTrackScaleLevel... are -1,
  // and the others stay as they were. Throws Error (kUsage) when the point is null or of another atlas.
  bool isInFrustum(MapPoint* pMP, float viewingCosLimit);

  const slamdb::KeyFrame& image() const { return image_; }

  // Whether it belongs to the live atlas of that runtime.
  bool IsOf(const Runtime& runtime) const { return runtime_ == &runtime; }

  long unsigned int mnId;
  double mTimeStamp;  // seconds
  int N, Nleft, Nright;
  std::vector<MapPoint*> mvpMapPoints;  // by keypoint; null: none
  std::vector<bool> mvbOutlier;
  KeyFrame* mpReferenceKF = nullptr;
  GeometricCamera *mpCamera, *mpCamera2;
  ORBVocabulary* mpORBvocabulary;  // of the atlas; keyframes made of the frame have it

 private:
  const Runtime* runtime_;
  bool IsInView(MapPoint* point, float least_cosine, bool right);

  slamdb::KeyFrame image_;
};

}  // namespace slamdb::live
