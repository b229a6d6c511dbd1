// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/ids.h"
#include "slamdb/model/similarity.h"

namespace slamdb {

// What detector a feature is of.
// MRPT: TKeyPointMethod, by its numbers; files may hold others.
enum class FeatureType : std::int32_t {
  kNotDefined = -1,
  kKlt = 0,
  kHarris = 1,
  kSift = 3,
  kSurf = 4,
  kBeacon = 5,
  kFast = 6,
  kOrb = 10,
  kAkaze = 11,
  kLsd = 12,
};

// The kinds of descriptor that a feature may carry, in the order in which MRPT stores them.
enum class DescriptorKind : std::uint8_t { kSift, kSurf, kSpinImage, kPolarImage, kLogPolarImage, kOrb, kBld, kLatch };

struct FeatureDescriptor {
  DescriptorKind kind = DescriptorKind::kOrb;
  // The descriptor's numbers:
  //   SIFT, ORB, BLD, LATCH    one byte each
  //   SURF, spin images        little-endian floats
  //   polar images             the CMatrixF object as it stands in MRPT's stream
  std::vector<std::uint8_t> bytes;
  friend bool operator==(const FeatureDescriptor&, const FeatureDescriptor&) = default;
};

// A keypoint of an image with its descriptors. mrpt::vision::CFeature
struct SLAMDB_EXPORT LandmarkFeature {
  static constexpr std::uint64_t kNoKeypoint = std::numeric_limits<std::uint64_t>::max();

  float x = 0, y = 0;                       // pixels                         keypoint.pt
  std::uint64_t keypoint_id = kNoKeypoint;  //                                keypoint.ID
  FeatureType type = FeatureType::kNotDefined;
  std::uint32_t track_status = 0;  // 0 idle, 1 out of bounds, 5 tracked, 10 lost
  float response = 0;              // detector score                 keypoint.response
  float orientation = 0;           // radians
  std::uint8_t octave = 0;         // pyramid level                  keypoint.octave
  std::uint8_t user_flags = 0;
  double depth = 0, initial_depth = 0;                           // metres
  Eigen::Vector3d position_in_camera = Eigen::Vector3d::Zero();  // p3D
  std::uint16_t patch_size = 21;                                 // pixels                         patchSize
  bool has_patch = false;
  std::vector<std::uint8_t> patch;             // the CImage object as it stands in MRPT's stream
  std::uint16_t spin_image_rows = 0;           //                                SpinImg_range_rows
  bool polar_images_without_rotation = false;  //                                polarImgsNoRotation
  std::vector<FeatureDescriptor> descriptors;  // at most one of each kind, ascending

  const FeatureDescriptor* FindDescriptor(DescriptorKind kind) const;  // null: it has none
};

// A position with its uncertainty. mrpt::poses::CPointPDFGaussian
struct GaussianPoint {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // symmetric
};

// A 3D point with a Gaussian position and the image features that show it.
// Everything that MRPT stores is kept, whether slamdb has a use for it or not.
// MRPT: mrpt::maps::CLandmark, its name at the right.
//
// Rules of ids, as in MRPT:
//   whoever makes a map (a server, slamdb) assigns them; a client may ignore them and leave none
//   equal ids are one landmark
//   landmarks with different ids, or none, may be one all the same
struct SLAMDB_EXPORT Landmark {
  LandmarkId id;                                     //                                                   ID
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();    // world, metres or map units         pose_mean
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit vector to its sensors, against a MapPoint's; or 0
  // Upper triangle of the covariance of the mean, metres^2. Zero: not known.     pose_cov_11 22 33 12 13 23
  double cov_11 = 0, cov_22 = 0, cov_33 = 0, cov_12 = 0, cov_13 = 0, cov_23 = 0;
  std::uint64_t last_seen = 0;            // 100 ns since 1601-01-01 UTC; 0: not known         timestampLastSeen
  std::uint32_t seen_count = 0;           //                                                   seenTimesCount
  std::vector<LandmarkFeature> features;  // one, or two for stereo; the first decides the type

  // Has an id that is handed out: not none, and not below 0 in MRPT, whose ids are signed.
  bool is_numbered() const { return id && id.value() <= std::numeric_limits<std::uint64_t>::max() / 2; }

  GaussianPoint pose() const;                // getPose
  void set_pose(const GaussianPoint& pose);  // setPose; of the covariance the upper triangle counts
  // That of the first feature.    getType
  //
  // Throws Error (kNotPossible) when there is none.
  FeatureType type() const;
  // Leaves exactly one feature, the first if there is one, and returns it.    createOneFeature
  LandmarkFeature& CreateOneFeature();
};

// Moves landmarks as TransformMap (edit/frame/transform.h) moves points:
//   means                                  by the similarity
//   covariances                            by scale^2 R C R^T
//   normals                                by R
//   depths and positions in the camera     by the scale
// Does not check the transform.
SLAMDB_EXPORT void TransformLandmarks(std::span<Landmark> landmarks, const Similarity3d& target_from_source);

// Seconds since 1970 as MRPT's ticks, rounded to 100 ns, and back.
// Not finite, or outside the years 1601 to 30828: 0.
SLAMDB_EXPORT std::uint64_t TicksOfSeconds(double seconds);
SLAMDB_EXPORT double SecondsOfTicks(std::uint64_t ticks);

}  // namespace slamdb
