// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>

#include "slamdb/model/carried.h"
#include "slamdb/model/features.h"
#include "slamdb/model/flag.h"

namespace slamdb {

// "This map point is keypoint `left` / `right` of that keyframe".
// ORB-SLAM3 keeps it as two maps from keyframe id to keypoint row, mBackupObservationsId1 (left) and
// mBackupObservationsId2 (right), which have the same keys.
// In a damaged file they may not: `left` or `right` is then kAbsent, which is not the same as -1.
struct Observation {
  static constexpr std::int32_t kAbsent = std::numeric_limits<std::int32_t>::min();

  KeyFrameId keyframe;
  std::int32_t left = -1;   // row of Features::keypoints; -1: not seen in the left image
  std::int32_t right = -1;  // fisheye stereo: row of Features::map_points, so left_count and up; -1: not seen

  friend bool operator==(const Observation&, const Observation&) = default;
};
static_assert(sizeof(Observation) == 16);

// A 3D point with what tracking needs to find it again.
// Every field as recorded.
// ORB-SLAM3: MapPoint, its name at the right.
struct MapPoint {
  static constexpr std::uint32_t kNoOrigin = 0xffffffff;  // origin_map: not recorded
  static constexpr std::int32_t kNoCount = -1;            // visible_count, found_count: not recorded

  MapPointId id;                       //                                  mnId
  std::int64_t first_keyframe = 0;     // made by it; -1: by a frame       mnFirstKFid
  std::int64_t first_frame = 0;        //                                  mnFirstFrame
  std::int32_t observation_count = 0;  // a stereo observation counts 2    nObs
  // These three ORB-SLAM3 has in memory only; no .osa file holds them.
  std::uint32_t origin_map = kNoOrigin;   // id of the map it was made in                             mnOriginMapId
  std::int32_t visible_count = kNoCount;  // frames in which it should have been seen, from 1 on      mnVisible
  std::int32_t found_count = kNoCount;    // frames in which it was found there, from 1 on            mnFound
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  // world, metres or map units       mWorldPos
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();    // mean unit viewing direction, so |normal| <= 1   mNormalVector
  Column<Observation> observations;                    // by keyframe id                   mBackupObservationsId1/2
  Descriptor descriptor{};                             // its most typical one             mDescriptor
  MatrixForm descriptor_form = MatrixForm::kUsual;     // kEmpty...: the point has none
  Flag bad;                                            // culled                           mbBad
  KeyFrameId reference;                      // reference keyframe; uninitialised if not in the map   mBackupRefKFId
  MapPointId replaced_by;                    // fused into                       mBackupReplacedId
  float min_distance = 0, max_distance = 0;  // scale-invariance range           mfMinDistance, mfMaxDistance
  Boxed<Carried> carried;                    // of a fork's file; null as a rule

  bool has_descriptor() const {
    return descriptor_form == MatrixForm::kUsual || descriptor_form == MatrixForm::kUsualNotContinuous;
  }
  // Whether it has one of another kind than ORB's.
  bool has_other_descriptor() const { return carried && carried->descriptors.columns != 0; }
  // Whether anything is recorded that ORB-SLAM3 has in memory only.
  bool has_tracking() const { return origin_map != kNoOrigin || visible_count != kNoCount || found_count != kNoCount; }
};

}  // namespace slamdb
