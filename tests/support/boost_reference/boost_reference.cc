// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/boost_reference/boost_reference.h"

#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/archive/text_iarchive.hpp>
#include <boost/archive/text_oarchive.hpp>
#include <boost/serialization/array_wrapper.hpp>
#include <boost/serialization/base_object.hpp>
#include <boost/serialization/map.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/vector.hpp>
#include <fstream>
#include <set>

namespace slamdb::reference {
namespace {

// The parts that ORB-SLAM3 archives by helper functions: no class information in the file.

template <class Archive, class Matrix>
void SerializeEigen(Archive& archive, Matrix& matrix) {
  archive& boost::serialization::make_array(matrix.data(), static_cast<std::size_t>(matrix.size()));
}

template <class Archive>
void SerializeSe3(Archive& archive, Se3& pose) {
  archive& pose.w& pose.x& pose.y& pose.z;
  SerializeEigen(archive, pose.translation);
}

template <class Archive>
void SerializeMat(Archive& archive, Mat& matrix) {
  archive& matrix.cols& matrix.rows& matrix.type& matrix.continuous;
  const std::size_t row = matrix.RowBytes();
  const std::size_t rows = static_cast<std::size_t>(matrix.rows);
  if (Archive::is_loading::value) matrix.data.resize(rows * row);
  if (matrix.continuous) {
    archive& boost::serialization::make_array(matrix.data.data(), rows * row);
  } else {
    for (std::size_t i = 0; i < rows; ++i) archive& boost::serialization::make_array(matrix.data.data() + i * row, row);
  }
}

template <class Archive>
void SerializeKeyPoints(Archive& archive, std::vector<KeyPoint>& points) {
  int count = static_cast<int>(points.size());
  archive& count;
  if (Archive::is_loading::value) points.resize(static_cast<std::size_t>(count));
  for (KeyPoint& point : points)
    archive& point.angle& point.response& point.size& point.x& point.y& point.class_id& point.octave;
}

}  // namespace

// The classes, found by Boost through argument-dependent look-up.

template <class Archive>
void serialize(Archive& archive, BowVector& words, unsigned int /*version*/) {
  archive& boost::serialization::base_object<std::map<unsigned int, double>>(words);
}

template <class Archive>
void serialize(Archive& archive, FeatureVector& nodes, unsigned int /*version*/) {
  archive& boost::serialization::base_object<std::map<unsigned int, std::vector<unsigned int>>>(nodes);
}

template <class Archive>
void serialize(Archive& archive, GeometricCamera& camera, unsigned int /*version*/) {
  archive& camera.mnId& camera.mnType& camera.mvParameters;
}

template <class Archive>
void serialize(Archive& archive, Pinhole& camera, unsigned int /*version*/) {
  archive& boost::serialization::base_object<GeometricCamera>(camera);
}

template <class Archive>
void serialize(Archive& archive, KannalaBrandt8& camera, unsigned int /*version*/) {
  archive& boost::serialization::base_object<GeometricCamera>(camera);
  archive& camera.precision;
}

template <class Archive>
void serialize(Archive& archive, Bias& bias, unsigned int /*version*/) {
  archive& bias.bax& bias.bay& bias.baz& bias.bwx& bias.bwy& bias.bwz;
}

template <class Archive>
void serialize(Archive& archive, Calib& calibration, unsigned int /*version*/) {
  SerializeSe3(archive, calibration.mTcb);
  SerializeSe3(archive, calibration.mTbc);
  SerializeEigen(archive, calibration.Cov);
  SerializeEigen(archive, calibration.CovWalk);
  archive& calibration.mbIsSet;
}

template <class Archive>
void serialize(Archive& archive, Preintegrated::integrable& sample, unsigned int /*version*/) {
  SerializeEigen(archive, sample.a);
  SerializeEigen(archive, sample.w);
  archive& sample.t;
}

template <class Archive>
void serialize(Archive& archive, Preintegrated& motion, unsigned int /*version*/) {
  archive& motion.dT;
  SerializeEigen(archive, motion.C);
  SerializeEigen(archive, motion.Info);
  SerializeEigen(archive, motion.Nga);
  SerializeEigen(archive, motion.NgaWalk);
  archive& motion.b;
  SerializeEigen(archive, motion.dR);
  SerializeEigen(archive, motion.dV);
  SerializeEigen(archive, motion.dP);
  SerializeEigen(archive, motion.JRg);
  SerializeEigen(archive, motion.JVg);
  SerializeEigen(archive, motion.JVa);
  SerializeEigen(archive, motion.JPg);
  SerializeEigen(archive, motion.JPa);
  SerializeEigen(archive, motion.avgA);
  SerializeEigen(archive, motion.avgW);
  archive& motion.bu;
  SerializeEigen(archive, motion.db);
  archive& motion.mvMeasurements;
}

template <class Archive>
void serialize(Archive& archive, MapPoint& point, unsigned int /*version*/) {
  archive& point.mnId& point.mnFirstKFid& point.mnFirstFrame& point.nObs;
  SerializeEigen(archive, point.mWorldPos);
  SerializeEigen(archive, point.mNormalVector);
  archive& point.mBackupObservationsId1& point.mBackupObservationsId2;
  SerializeMat(archive, point.mDescriptor);
  archive& point.mBackupRefKFId& point.mbBad& point.mBackupReplacedId;
  archive& point.mfMinDistance& point.mfMaxDistance;
}

namespace {

template <class Archive>
void SerializeImage(Archive& archive, KeyFrame& keyframe) {
  archive& keyframe.mnId& keyframe.mnFrameId& keyframe.mTimeStamp;
  archive& keyframe.mnGridCols& keyframe.mnGridRows;
  archive& keyframe.mfGridElementWidthInv& keyframe.mfGridElementHeightInv& keyframe.mfScale;
  archive& keyframe.fx& keyframe.fy& keyframe.invfx& keyframe.invfy& keyframe.cx& keyframe.cy;
  archive& keyframe.mbf& keyframe.mb& keyframe.mThDepth;
  SerializeMat(archive, keyframe.mDistCoef);
  archive& keyframe.N;
  SerializeKeyPoints(archive, keyframe.mvKeys);
  SerializeKeyPoints(archive, keyframe.mvKeysUn);
  archive& keyframe.mvuRight& keyframe.mvDepth;
  SerializeMat(archive, keyframe.mDescriptors);
  archive& keyframe.mBowVec& keyframe.mFeatVec;
  SerializeSe3(archive, keyframe.mTcp);
  archive& keyframe.mnScaleLevels& keyframe.mfScaleFactor& keyframe.mfLogScaleFactor;
  archive& keyframe.mvScaleFactors& keyframe.mvLevelSigma2& keyframe.mvInvLevelSigma2;
  archive& keyframe.mnMinX& keyframe.mnMinY& keyframe.mnMaxX& keyframe.mnMaxY;
  SerializeEigen(archive, keyframe.mK_);
  SerializeSe3(archive, keyframe.mTcw);
}

template <class Archive>
void SerializeGraph(Archive& archive, KeyFrame& keyframe) {
  archive& keyframe.mvBackupMapPointsId& keyframe.mGrid& keyframe.mBackupConnectedKeyFrameIdWeights;
  archive& keyframe.mbFirstConnection& keyframe.mBackupParentId;
  archive& keyframe.mvBackupChildrensId& keyframe.mvBackupLoopEdgesId& keyframe.mvBackupMergeEdgesId;
  archive& keyframe.mbNotErase& keyframe.mbToBeErased& keyframe.mbBad& keyframe.mHalfBaseline;
  archive& keyframe.mnOriginMapId& keyframe.mnBackupIdCamera& keyframe.mnBackupIdCamera2;
}

template <class Archive>
void SerializeFisheyeStereo(Archive& archive, KeyFrame& keyframe) {
  archive& keyframe.mvLeftToRightMatch& keyframe.mvRightToLeftMatch& keyframe.NLeft& keyframe.NRight;
  SerializeSe3(archive, keyframe.mTlr);
  SerializeKeyPoints(archive, keyframe.mvKeysRight);
  archive& keyframe.mGridRight;
}

template <class Archive>
void SerializeInertial(Archive& archive, KeyFrame& keyframe) {
  archive& keyframe.mImuBias& keyframe.mBackupImuPreintegrated& keyframe.mImuCalib;
  archive& keyframe.mBackupPrevKFId& keyframe.mBackupNextKFId& keyframe.bImu;
  SerializeEigen(archive, keyframe.mVw);
  SerializeEigen(archive, keyframe.mOwb);
  archive& keyframe.mbHasVelocity;
}

}  // namespace

template <class Archive>
void serialize(Archive& archive, KeyFrame& keyframe, unsigned int /*version*/) {
  SerializeImage(archive, keyframe);
  SerializeGraph(archive, keyframe);
  SerializeFisheyeStereo(archive, keyframe);
  SerializeInertial(archive, keyframe);
}

template <class Archive>
void serialize(Archive& archive, Map& map, unsigned int /*version*/) {
  archive& map.mnId& map.mnInitKFid& map.mnMaxKFid& map.mnBigChangeIdx;
  archive& map.mvpBackupKeyFrames& map.mvpBackupMapPoints& map.mvBackupKeyFrameOriginsId;
  archive& map.mnBackupKFinitialID& map.mnBackupKFlowerID;
  archive& map.mbImuInitialized& map.mbIsInertial& map.mbIMU_BA1& map.mbIMU_BA2;
}

template <class Archive>
void serialize(Archive& archive, Atlas& atlas, unsigned int /*version*/) {
  archive.template register_type<Pinhole>();
  archive.template register_type<KannalaBrandt8>();
  archive& atlas.mvpBackupMaps& atlas.mvpCameras;
  archive& atlas.nNextMapId& atlas.nNextFrameId& atlas.nNextKeyFrameId& atlas.nNextMapPointId& atlas.nNextCameraId;
  archive& atlas.mnLastInitKFidMap;
}

namespace {

template <class Archive>
std::unique_ptr<Session> LoadAs(std::istream& stream) {
  Archive archive(stream);
  auto session = std::make_unique<Session>();
  try {
    archive >> session->vocabulary_name >> session->vocabulary_checksum >> session->atlas;
  } catch (...) {
    session->atlas = nullptr;
    archive.delete_created_pointers();
    throw;
  }
  return session;
}

template <class Archive>
void SaveAs(const Session& session, std::ostream& stream) {
  Archive archive(stream);
  const Atlas* atlas = session.atlas;
  archive << session.vocabulary_name << session.vocabulary_checksum << atlas;
}

}  // namespace

std::size_t Mat::RowBytes() const {
  static constexpr std::size_t kDepthBytes[] = {1, 1, 2, 2, 4, 4, 8, 2};
  const std::size_t channels = static_cast<std::size_t>(type >> 3) + 1;
  return static_cast<std::size_t>(cols) * channels * kDepthBytes[type & 7];
}

Session::~Session() {
  if (!atlas) return;
  std::set<Map*> maps(atlas->mvpBackupMaps.begin(), atlas->mvpBackupMaps.end());
  std::set<KeyFrame*> keyframes;
  std::set<MapPoint*> points;
  for (Map* map : maps) {
    if (!map) continue;
    keyframes.insert(map->mvpBackupKeyFrames.begin(), map->mvpBackupKeyFrames.end());
    points.insert(map->mvpBackupMapPoints.begin(), map->mvpBackupMapPoints.end());
  }
  for (KeyFrame* keyframe : keyframes) delete keyframe;
  for (MapPoint* point : points) delete point;
  for (Map* map : maps) delete map;
  for (GeometricCamera* camera : std::set(atlas->mvpCameras.begin(), atlas->mvpCameras.end())) delete camera;
  delete atlas;
}

unsigned int ArchiveVersion() {
  const auto version = boost::archive::BOOST_ARCHIVE_VERSION();
  return version;
}

std::unique_ptr<Session> Load(const std::string& path, Encoding encoding) {
  std::ifstream stream(path, std::ios::binary);
  return encoding == Encoding::kText ? LoadAs<boost::archive::text_iarchive>(stream)
                                     : LoadAs<boost::archive::binary_iarchive>(stream);
}

void Save(const Session& session, const std::string& path, Encoding encoding) {
  std::ofstream stream(path, std::ios::binary);
  if (encoding == Encoding::kText) {
    SaveAs<boost::archive::text_oarchive>(session, stream);
  } else {
    SaveAs<boost::archive::binary_oarchive>(session, stream);
  }
}

}  // namespace slamdb::reference
