// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "slamdb/model/carried.h"
#include "slamdb/model/features.h"
#include "slamdb/model/imu.h"

namespace slamdb {

// Pinhole intrinsics of the undistorted image as ORB-SLAM3 copies them into each keyframe. Pixels.
struct Intrinsics {
  float fx = 0, fy = 0, inverse_fx = 0, inverse_fy = 0, cx = 0, cy = 0;  // fx fy invfx invfy cx cy
  float baseline_fx = 0;                                                 // baseline times fx, pixels * metres       mbf
  float baseline = 0;                                                    // metres                                   mb
  float depth_threshold = 0;  // metres; beyond it a stereo point is far  mThDepth
  friend bool operator==(const Intrinsics&, const Intrinsics&) = default;
};

// The image pyramid that features come from.
struct ScalePyramid {
  std::int32_t levels = 0;            //                           mnScaleLevels
  float factor = 0, log_factor = 0;   // between levels            mfScaleFactor, mfLogScaleFactor
  std::vector<float> factors;         // factor^level              mvScaleFactors
  std::vector<float> sigma2;          // factor^(2 level)          mvLevelSigma2
  std::vector<float> inverse_sigma2;  //                           mvInvLevelSigma2
  friend bool operator==(const ScalePyramid&, const ScalePyramid&) = default;
};

// How the image is cut into grid cells and where it ends.
struct ImageBounds {
  std::int32_t grid_columns = 0, grid_rows = 0;             // 64, 48        mnGridCols, mnGridRows
  float inverse_cell_width = 0, inverse_cell_height = 0;    // 1/pixels      mfGridElementWidthInv, ...HeightInv
  std::int32_t min_x = 0, min_y = 0, max_x = 0, max_y = 0;  // undistorted   mnMinX mnMinY mnMaxX mnMaxY
  friend bool operator==(const ImageBounds&, const ImageBounds&) = default;
};

// A neighbour in the covisibility graph: a keyframe that sees `weight` of the same map points.
struct Connection {
  KeyFrameId keyframe;
  std::int32_t weight = 0;
  friend bool operator==(const Connection&, const Connection&) = default;
};

// A posed image.
// Every field as recorded; all links are ids and may dangle.
// ORB-SLAM3: KeyFrame, its name at the right.
struct KeyFrame {
  KeyFrameId id;               //                                         mnId
  std::uint64_t frame_id = 0;  // the frame that became this keyframe     mnFrameId
  double timestamp = 0;        // seconds                                 mTimeStamp
  Rigid3f camera_from_world;   // left camera                             mTcw
  Rigid3f camera_from_parent;  // set when the keyframe went bad          mTcp
  float merge_scale = 0;       // uninitialised unless it took part in a merge   mfScale

  CameraId camera;        //                                         mnBackupIdCamera
  CameraId right_camera;  // fisheye stereo only                     mnBackupIdCamera2
  Intrinsics intrinsics;
  Eigen::Matrix3f calibration_matrix = Eigen::Matrix3f::Identity();  // the same as a matrix   mK_
  Matrix distortion;        // k1 k2 p1 p2 [k3]                        mDistCoef
  float half_baseline = 0;  // metres                                  mHalfBaseline
  Rigid3f left_from_right;  // fisheye stereo: left camera from right  mTlr
  ImageBounds bounds;
  ScalePyramid pyramid;
  Features features;

  Column<Connection> connections;  // covisibility, by keyframe id            mBackupConnectedKeyFrameIdWeights
  Flag first_connection;           // true until a parent is found            mbFirstConnection
  KeyFrameId parent;               // spanning tree; none for its root        mBackupParentId
  Column<KeyFrameId> children;     // in no order                             mvBackupChildrensId
  Column<KeyFrameId> loop_edges;   //                                         mvBackupLoopEdgesId
  Column<KeyFrameId> merge_edges;  //                                         mvBackupMergeEdgesId
  Flag not_erase;                  // must not be culled                      mbNotErase
  Flag to_be_erased;               // culled as soon as it may be             mbToBeErased
  Flag bad;                        // culled                                  mbBad
  std::uint32_t origin_map = 0;    // id of the map it was made in            mnOriginMapId

  ImuBias imu_bias;                  //                                         mImuBias
  ImuPreintegration preintegration;  //                                         mBackupImuPreintegrated
  ImuCalibration imu_calibration;    //                                         mImuCalib
  KeyFrameId previous, next;         // in time                                 mBackupPrevKFId, mBackupNextKFId
  Flag imu_initialized;              // the map was IMU-initialised             bImu
  Eigen::Vector3f velocity = Eigen::Vector3f::Zero();       // m/s, world                mVw
  Eigen::Vector3f body_position = Eigen::Vector3f::Zero();  // m, world; uninitialised without IMU   mOwb
  Flag has_velocity;                                        //                                         mbHasVelocity

  Boxed<Carried> carried;  // of a fork's file; null as a rule

  // How many keypoints have a descriptor, ORB's or another.
  std::size_t descriptor_count() const {
    if (carried && carried->descriptors.columns != 0) return static_cast<std::size_t>(carried->descriptors.rows);
    return features.descriptors.size();
  }
};

}  // namespace slamdb
