// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <ratio>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/landmark.h"

// Landmarks with the names of MRPT 2 (mrpt::maps::CLandmark, mrpt::vision::CFeature), for programs that are written
// against them.
// Needs no MRPT.
// slamdb::Landmark holds the same; the conversions lose nothing either way.
//
// Types differ where MRPT's would lose what files hold: covariances are double, types and track statuses 32 bits wide.
// Images and polar images are the objects as they stand in MRPT's stream.
// Members that MRPT has but never stores are left out: response, track_status and x2, y2 of CFeature, user_flags of its
// keypoint.
namespace slamdb::mrpt {

using TLandmarkID = std::int64_t;
inline constexpr TLandmarkID INVALID_LANDMARK_ID = -1;  // NOLINT(readability-identifier-naming): MRPT's name

using TFeatureID = std::uint64_t;

// Ticks of 100 ns since 1601-01-01 UTC.
struct Clock {
  using rep = std::int64_t;
  using period = std::ratio<1, 10'000'000>;
  using duration = std::chrono::duration<rep, period>;
  using time_point = std::chrono::time_point<Clock>;
  static constexpr bool is_steady = false;

  // Seconds since 1970-01-01 UTC, rounded to 100 ns; what is outside the years 1601 to 30828 is INVALID_TIMESTAMP.
  [[nodiscard]] static time_point fromDouble(double seconds) {
    return time_point(duration(static_cast<rep>(TicksOfSeconds(seconds))));
  }
  [[nodiscard]] static double toDouble(time_point time) {
    return SecondsOfTicks(static_cast<std::uint64_t>(time.time_since_epoch().count()));
  }
};
using TTimeStamp = Clock::time_point;
inline constexpr TTimeStamp INVALID_TIMESTAMP{};  // NOLINT(readability-identifier-naming): MRPT's name

enum TKeyPointMethod : std::int32_t {
  featNotDefined = -1,
  featKLT = 0,
  featHarris = 1,
  featSIFT = 3,
  featSURF = 4,
  featBeacon = 5,
  featFAST = 6,
  featORB = 10,
  featAKAZE = 11,
  featLSD = 12,
};

enum TFeatureTrackStatus : std::uint32_t { status_IDLE = 0, status_OOB = 1, status_TRACKED = 5, status_LOST = 10 };

struct TPoint3D {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const TPoint3D&, const TPoint3D&) = default;
};

struct TPixelCoordf {
  float x = 0, y = 0;
  friend bool operator==(const TPixelCoordf&, const TPixelCoordf&) = default;
};

struct TKeyPointf {
  TPixelCoordf pt;  // pixels
  TFeatureID ID{static_cast<TFeatureID>(-1)};
  TFeatureTrackStatus track_status{status_IDLE};
  float response{0};
  std::uint8_t octave{0};
  friend bool operator==(const TKeyPointf&, const TKeyPointf&) = default;
};

// A feature of an image with its descriptors.
struct CFeature {
  struct TDescriptors {
    std::optional<std::vector<std::uint8_t>> SIFT;
    std::optional<std::vector<float>> SURF, SpinImg;
    std::uint16_t SpinImg_range_rows{0};
    std::optional<std::vector<std::uint8_t>> PolarImg, LogPolarImg;  // CMatrixF objects of the stream
    bool polarImgsNoRotation{false};
    std::optional<std::vector<std::uint8_t>> ORB, BLD, LATCH;

    bool hasDescriptorSIFT() const { return SIFT.has_value(); }
    bool hasDescriptorSURF() const { return SURF.has_value(); }
    bool hasDescriptorSpinImg() const { return SpinImg.has_value(); }
    bool hasDescriptorPolarImg() const { return PolarImg.has_value(); }
    bool hasDescriptorLogPolarImg() const { return LogPolarImg.has_value(); }
    bool hasDescriptorORB() const { return ORB.has_value(); }
    bool hasDescriptorBLD() const { return BLD.has_value(); }
    bool hasDescriptorLATCH() const { return LATCH.has_value(); }
    friend bool operator==(const TDescriptors&, const TDescriptors&) = default;
  };

  TKeyPointf keypoint;
  std::optional<std::vector<std::uint8_t>> patch;  // a CImage object of the stream
  std::uint16_t patchSize{21};                     // pixels
  TKeyPointMethod type{featNotDefined};
  float orientation{0};  // radians
  std::uint8_t user_flags{0};
  double depth{0}, initialDepth{0};  // metres
  TPoint3D p3D;                      // metres, in the camera
  TDescriptors descriptors;

  TKeyPointMethod get_type() const { return type; }
  friend bool operator==(const CFeature&, const CFeature&) = default;
};

// A point with its uncertainty.
struct CPointPDFGaussian {
  TPoint3D mean;
  Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();
};

// A 3D point with a Gaussian position and the image features that show it: one, or two for a stereo pair, the left one
// first.
//
// Frame: the world. Units: metres.
class SLAMDB_EXPORT CLandmark {
 public:
  using TLandmarkID = slamdb::mrpt::TLandmarkID;

  CLandmark() = default;
  // Of a landmark of slamdb.
  //
  // Throws Error (kDamaged) when a descriptor of floats has no whole number of them.
  explicit CLandmark(const Landmark& landmark);
  // The same as a landmark of slamdb.
  [[nodiscard]] Landmark ToLandmark() const;

  std::vector<CFeature> features;  // the first decides the type
  TPoint3D pose_mean;
  TPoint3D normal;                                           // unit vector to the sensor, or zero
  double pose_cov_11 = 0, pose_cov_22 = 0, pose_cov_33 = 0;  // metres^2; all zero: not known
  double pose_cov_12 = 0, pose_cov_13 = 0, pose_cov_23 = 0;
  TLandmarkID ID = INVALID_LANDMARK_ID;
  TTimeStamp timestampLastSeen{INVALID_TIMESTAMP};
  std::uint32_t seenTimesCount = 0;

  // The mean, and the whole symmetric covariance.
  void getPose(CPointPDFGaussian& p) const;
  void getPose(TPoint3D& p, Eigen::MatrixXd& COV) const;
  // Of the covariance the upper triangle counts.
  void setPose(const CPointPDFGaussian& p);
  // That of the first feature.
  //
  // Throws Error (kNotPossible) when there is none.
  TKeyPointMethod getType() const;
  // Leaves exactly one feature, the first if there is one.
  void createOneFeature() { features.resize(1); }

  friend bool operator==(const CLandmark&, const CLandmark&) = default;
};

// The landmarks of a map.
// Without MRPT's grid over them, and so without its isToBeModified and hasBeenModified.
class SLAMDB_EXPORT CLandmarksMap {
 public:
  class SLAMDB_EXPORT TCustomSequenceLandmarks {
   public:
    using iterator = std::vector<CLandmark>::iterator;
    using const_iterator = std::vector<CLandmark>::const_iterator;
    iterator begin() { return landmarks_.begin(); }
    iterator end() { return landmarks_.end(); }
    const_iterator begin() const { return landmarks_.begin(); }
    const_iterator end() const { return landmarks_.end(); }
    std::size_t size() const { return landmarks_.size(); }
    void clear() { landmarks_.clear(); }
    void push_back(const CLandmark& lm) { landmarks_.push_back(lm); }
    // Null: there is none at that place.
    CLandmark* get(unsigned int indx) { return indx < size() ? &landmarks_[indx] : nullptr; }
    const CLandmark* get(unsigned int indx) const { return indx < size() ? &landmarks_[indx] : nullptr; }
    void erase(unsigned int indx);  // nothing, where there is none
    // The first of that id; null: there is none.
    //
    // Cost: linear.
    const CLandmark* getByID(TLandmarkID ID) const;

   private:
    std::vector<CLandmark> landmarks_;
  };

  CLandmarksMap() = default;
  // Of those of a map of slamdb (Map::landmarks).
  //
  // Throws Error as CLandmark does.
  explicit CLandmarksMap(const std::vector<Landmark>& landmarks);
  [[nodiscard]] std::vector<Landmark> ToLandmarks() const;

  std::size_t size() const { return landmarks.size(); }

  TCustomSequenceLandmarks landmarks;
};

}  // namespace slamdb::mrpt
