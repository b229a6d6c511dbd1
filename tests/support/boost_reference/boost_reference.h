// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

// Reads and writes ORB-SLAM3 v1.0 atlas files with stock Boost.Serialization, the way a SLAM system does it: one heap
// object per pointer, a std::vector or std::map per container, a file stream. It is the oracle of the codec's tests and
// the speed the codec has to beat, so it is plain on purpose. Written from the description of the format; members carry
// the archive's names and stand in the archive's order, and their C++ types are part of the format: Boost numbers
// classes by type, so `unsigned long` here may not become `uint64_t` on a machine where that is another type.
namespace slamdb::reference {

// bool in ORB-SLAM3. A byte is archived alike, and stays defined where ORB-SLAM3 saves uninitialised memory.
using Bool = unsigned char;

// cv::Mat: archived by a helper function, not as a class.
struct Mat {
  int cols = 0, rows = 0, type = 0;
  Bool continuous = 0;
  std::vector<unsigned char> data;

  std::size_t RowBytes() const;
};

// cv::KeyPoint.
struct KeyPoint {
  float angle, response, size, x, y;
  int class_id, octave;
};

// Sophus::SE3f.
struct Se3 {
  float w = 1, x = 0, y = 0, z = 0;
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();
};

// DBoW2::BowVector and FeatureVector: classes of their own in the archive, with the std::map as base object.
class BowVector : public std::map<unsigned int, double> {};
class FeatureVector : public std::map<unsigned int, std::vector<unsigned int>> {};

// Abstract, as in ORB-SLAM3: a concrete base would be archived differently.
class GeometricCamera {
 public:
  virtual ~GeometricCamera() = default;
  virtual bool IsFisheye() const = 0;

  unsigned int mnId = 0;
  unsigned int mnType = 0;
  std::vector<float> mvParameters;
};

class Pinhole : public GeometricCamera {
 public:
  bool IsFisheye() const override { return false; }
};

class KannalaBrandt8 : public GeometricCamera {
 public:
  bool IsFisheye() const override { return true; }
  float precision = 1e-6F;
};

struct Bias {
  float bax = 0, bay = 0, baz = 0, bwx = 0, bwy = 0, bwz = 0;
};

struct Calib {
  using Diagonal = Eigen::Matrix<float, 6, 1>;
  Se3 mTcb, mTbc;
  Diagonal Cov = Diagonal::Zero(), CovWalk = Diagonal::Zero();
  Bool mbIsSet = 0;
};

struct Preintegrated {
  struct integrable {
    Eigen::Vector3f a, w;
    float t;
  };
  using Matrix15 = Eigen::Matrix<float, 15, 15>;
  using Vector6 = Eigen::Matrix<float, 6, 1>;

  float dT = 0;
  Matrix15 C = Matrix15::Zero(), Info = Matrix15::Zero();
  Vector6 Nga = Vector6::Zero(), NgaWalk = Vector6::Zero();
  Bias b;
  Eigen::Matrix3f dR = Eigen::Matrix3f::Zero();
  Eigen::Vector3f dV = Eigen::Vector3f::Zero(), dP = Eigen::Vector3f::Zero();
  Eigen::Matrix3f JRg = Eigen::Matrix3f::Zero(), JVg = Eigen::Matrix3f::Zero(), JVa = Eigen::Matrix3f::Zero();
  Eigen::Matrix3f JPg = Eigen::Matrix3f::Zero(), JPa = Eigen::Matrix3f::Zero();
  Eigen::Vector3f avgA = Eigen::Vector3f::Zero(), avgW = Eigen::Vector3f::Zero();
  Bias bu;
  Vector6 db = Vector6::Zero();
  std::vector<integrable> mvMeasurements;
};

struct MapPoint {
  unsigned long mnId = 0;
  long mnFirstKFid = 0, mnFirstFrame = 0;
  int nObs = 0;
  Eigen::Vector3f mWorldPos = Eigen::Vector3f::Zero(), mNormalVector = Eigen::Vector3f::Zero();
  std::map<unsigned long, int> mBackupObservationsId1, mBackupObservationsId2;
  Mat mDescriptor;
  unsigned long mBackupRefKFId = 0;
  Bool mbBad = 0;
  long long mBackupReplacedId = -1;
  float mfMinDistance = 0, mfMaxDistance = 0;
};

struct KeyFrame {
  using Grid = std::vector<std::vector<std::vector<std::size_t>>>;

  unsigned long mnId = 0, mnFrameId = 0;
  double mTimeStamp = 0;
  int mnGridCols = 64, mnGridRows = 48;
  float mfGridElementWidthInv = 0, mfGridElementHeightInv = 0, mfScale = 0;
  float fx = 0, fy = 0, invfx = 0, invfy = 0, cx = 0, cy = 0, mbf = 0, mb = 0, mThDepth = 0;
  Mat mDistCoef;
  int N = 0;
  std::vector<KeyPoint> mvKeys, mvKeysUn;
  std::vector<float> mvuRight, mvDepth;
  Mat mDescriptors;
  BowVector mBowVec;
  FeatureVector mFeatVec;
  Se3 mTcp;
  int mnScaleLevels = 0;
  float mfScaleFactor = 0, mfLogScaleFactor = 0;
  std::vector<float> mvScaleFactors, mvLevelSigma2, mvInvLevelSigma2;
  int mnMinX = 0, mnMinY = 0, mnMaxX = 0, mnMaxY = 0;
  Eigen::Matrix3f mK_ = Eigen::Matrix3f::Identity();
  Se3 mTcw;
  std::vector<long long> mvBackupMapPointsId;
  Grid mGrid;
  std::map<unsigned long, int> mBackupConnectedKeyFrameIdWeights;
  Bool mbFirstConnection = 0;
  long long mBackupParentId = -1;
  std::vector<unsigned long> mvBackupChildrensId, mvBackupLoopEdgesId, mvBackupMergeEdgesId;
  Bool mbNotErase = 0, mbToBeErased = 0, mbBad = 0;
  float mHalfBaseline = 0;
  unsigned int mnOriginMapId = 0, mnBackupIdCamera = 0, mnBackupIdCamera2 = 0;
  std::vector<int> mvLeftToRightMatch, mvRightToLeftMatch;
  int NLeft = -1, NRight = -1;
  Se3 mTlr;
  std::vector<KeyPoint> mvKeysRight;
  Grid mGridRight;
  Bias mImuBias;
  Preintegrated mBackupImuPreintegrated;
  Calib mImuCalib;
  long long mBackupPrevKFId = -1, mBackupNextKFId = -1;
  Bool bImu = 0;
  Eigen::Vector3f mVw = Eigen::Vector3f::Zero(), mOwb = Eigen::Vector3f::Zero();
  Bool mbHasVelocity = 0;
};

struct Map {
  unsigned long mnId = 0, mnInitKFid = 0, mnMaxKFid = 0;
  int mnBigChangeIdx = 0;
  std::vector<KeyFrame*> mvpBackupKeyFrames;
  std::vector<MapPoint*> mvpBackupMapPoints;
  std::vector<unsigned long> mvBackupKeyFrameOriginsId;
  unsigned long mnBackupKFinitialID = 0, mnBackupKFlowerID = 0;
  Bool mbImuInitialized = 0, mbIsInertial = 0, mbIMU_BA1 = 0, mbIMU_BA2 = 0;
};

struct Atlas {
  std::vector<Map*> mvpBackupMaps;
  std::vector<GeometricCamera*> mvpCameras;
  unsigned long nNextMapId = 0, nNextFrameId = 0, nNextKeyFrameId = 0, nNextMapPointId = 0, nNextCameraId = 0;
  unsigned long mnLastInitKFidMap = 0;
};

// What a file holds. Owns the atlas and everything it points at, each object once however often it is listed.
struct Session {
  std::string vocabulary_name, vocabulary_checksum;
  Atlas* atlas = nullptr;

  Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session();
};

enum class Encoding { kBinary, kText };

// Throws what Boost throws (boost::archive::archive_exception and the standard library's exceptions); a damaged file
// can also crash it. Neither looks at the file's end.
std::unique_ptr<Session> Load(const std::string& path, Encoding encoding);

// The library version that Save writes and the newest that Load takes.
unsigned int ArchiveVersion();

// Replaces the file in place, with the library version of the Boost it is compiled with.
void Save(const Session& session, const std::string& path, Encoding encoding);

}  // namespace slamdb::reference
