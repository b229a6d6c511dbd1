// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/serialization/array.hpp>
#include <boost/serialization/base_object.hpp>
#include <boost/serialization/map.hpp>
#include <boost/serialization/vector.hpp>
#include <map>
#include <string>
#include <vector>

// A program's own classes, whose members have ORB-SLAM3's types and stand in its order. Nothing of slamdb is in them.
namespace orb {

struct Mat {
  int cols = 32, rows = 1, type = 0;
  bool continuous = true;
  std::vector<unsigned char> data = std::vector<unsigned char>(32, 7);

  template <class Archive>
  void Members(Archive& archive) {
    archive& cols& rows& type& continuous;
    archive& boost::serialization::make_array(data.data(), data.size());
  }
};

struct MapPoint {
  unsigned long mnId = 0;
  long mnFirstKFid = 0, mnFirstFrame = 0;
  int nObs = 0;
  float mWorldPos[3] = {}, mNormalVector[3] = {};
  std::map<unsigned long, int> mBackupObservationsId1, mBackupObservationsId2;
  Mat mDescriptor;
  unsigned long mBackupRefKFId = 0;
  bool mbBad = false;
  long long mBackupReplacedId = -1;
  float mfMinDistance = 0, mfMaxDistance = 0;

  template <class Archive>
  void serialize(Archive& archive, const unsigned int /*version*/) {
    archive& mnId& mnFirstKFid& mnFirstFrame& nObs;
    archive& boost::serialization::make_array(mWorldPos, 3);
    archive& boost::serialization::make_array(mNormalVector, 3);
    archive& mBackupObservationsId1& mBackupObservationsId2;
    mDescriptor.Members(archive);
    archive& mBackupRefKFId& mbBad& mBackupReplacedId& mfMinDistance& mfMaxDistance;
  }
};

class GeometricCamera {
 public:
  virtual ~GeometricCamera() = default;
  virtual float Uncertainty() const = 0;

  unsigned int mnId = 0, mnType = 0;
  std::vector<float> mvParameters;

  template <class Archive>
  void serialize(Archive& archive, const unsigned int /*version*/) {
    archive& mnId& mnType& mvParameters;
  }
};

class Pinhole : public GeometricCamera {
 public:
  float Uncertainty() const override { return 1; }

  template <class Archive>
  void serialize(Archive& archive, const unsigned int /*version*/) {
    archive& boost::serialization::base_object<GeometricCamera>(*this);
  }
};

class KannalaBrandt8 : public GeometricCamera {
 public:
  float precision = 1e-6F;
  float Uncertainty() const override { return 2; }

  template <class Archive>
  void serialize(Archive& archive, const unsigned int /*version*/) {
    archive& boost::serialization::base_object<GeometricCamera>(*this);
    archive& precision;
  }
};

// A camera as an atlas holds it.
struct CameraHolder {
  GeometricCamera* camera = nullptr;

  template <class Archive>
  void serialize(Archive& archive, const unsigned int /*version*/) {
    archive.template register_type<Pinhole>();
    archive.template register_type<KannalaBrandt8>();
    archive& camera;
  }
};

inline MapPoint MakePoint(unsigned long id) {
  MapPoint point;
  point.mnId = id;
  point.mnFirstKFid = -1;
  point.mnFirstFrame = 12;
  point.nObs = 3;
  for (int i = 0; i < 3; ++i) {
    point.mWorldPos[i] = 0.5F + static_cast<float>(i) + static_cast<float>(id);
    point.mNormalVector[i] = -0.25F * static_cast<float>(i);
  }
  point.mBackupObservationsId1 = {{4, 17}, {9, -1}};
  point.mBackupObservationsId2 = {{4, -1}, {9, 33}};
  for (unsigned char& byte : point.mDescriptor.data) byte = static_cast<unsigned char>(byte * 37 + id);
  point.mBackupRefKFId = 9;
  point.mBackupReplacedId = 88;
  point.mfMinDistance = 1.5F;
  point.mfMaxDistance = 6;
  return point;
}

}  // namespace orb
