// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/live/feature_views.h"
#include "slamdb/live/keyframe_database.h"
#include "slamdb/live/listed.h"
#include "slamdb/live/opencv.h"
#include "slamdb/live/post_load.h"
#include "slamdb/live/runtime.h"
#include "slamdb/model/keyframe.h"
#include "slamdb/model/map_point.h"

namespace slamdb::live {

class Frame;
class GeometricCamera;
class LinkFilter;
class Map;
class MapPoint;

// A posed image of a map that is being built: ORB-SLAM3's class KeyFrame, with its names.
// Poses are slamdb::Rigid3f with unit quaternions, named target_from_source in comments.
//
// All methods are thread-safe; runtime.h states the order of the locks.
// Where ORB-SLAM3 orders keyframes by address, ids order them here.
//
// `new` makes it; Map::AddKeyFrame takes it over, and it then lives until the map goes, also when it is flagged bad.
//
// Asked about an object that is null or of another atlas, it answers that it has nothing to do with it. To be linked to
// such an object it refuses: Error (kUsage).
class SLAMDB_EXPORT KeyFrame : public Listed {
  // What the views among the public members look at, and so in front of them.
  slamdb::KeyFrame record_;  // but for what stands elsewhere; its links are those without a target
  Features features_;

 public:
  // Of a frame: pose, features, the points that it sees, cameras, vocabulary.
  // Its own id; no links in the graph yet, and no observation in the points.
  // The database, if any, learns when the keyframe goes bad.
  KeyFrame(Frame& F, Map* pMap, KeyFrameDatabase* pKFDB = nullptr);
  ~KeyFrame() = default;

  // ---- Pose (keyframe.cc)
  void SetPose(const Rigid3f& Tcw);             // left camera_from_world
  void SetVelocity(const Eigen::Vector3f& Vw);  // m/s, world
  Rigid3f GetPose();
  Rigid3f GetPoseInverse();
  Eigen::Vector3f GetCameraCenter();
  Eigen::Matrix3f GetRotation();
  Eigen::Vector3f GetTranslation();
  // Of a fisheye pair.
  Rigid3f GetRightPose();         // right camera_from_world
  Rigid3f GetRightPoseInverse();  // world_from_right_camera
  Eigen::Vector3f GetRightCameraCenter();
  Eigen::Matrix3f GetRightRotation();
  Eigen::Vector3f GetRightTranslation();
  Rigid3f GetRelativePoseTlr() const;  // left_from_right
  Rigid3f GetRelativePoseTrl() const;  // right_from_left
  // Of the body, world_from_body; of the camera without IMU.
  Rigid3f GetImuPose();
  Eigen::Vector3f GetImuPosition();
  Eigen::Matrix3f GetImuRotation();
  Eigen::Vector3f GetVelocity();
  bool isVelocitySet();

  // ---- Inertial (keyframe.cc)
  void SetNewBias(const ImuBias& bias);  // also in its preintegration
  ImuBias GetImuBias();
  Eigen::Vector3f GetGyroBias();            // rad/s
  Eigen::Vector3f GetAccBias();             // m/s^2
  ImuPreintegration GetImuPreintegrated();  // since the keyframe before
  void SetImuPreintegrated(const ImuPreintegration& preintegration);

  // ---- Features (keyframe_features.cc). Constant once the keyframe is in a map; the point slots are not in here.
  const Features& features() const { return features_; }
  const ScalePyramid& pyramid() const { return record_.pyramid; }
  const Intrinsics& intrinsics() const { return record_.intrinsics; }
  const ImageBounds& bounds() const { return record_.bounds; }
  // Computes bag of words and feature vector if there are none. Before the keyframe is added to a map.
  void ComputeBoW(const VocabularyTree& vocabulary);
  // With the vocabulary that was set. Throws Error (kUsage) when there is none.
  void ComputeBoW();
  // Not owned. Before other threads know the keyframe.
  void SetORBVocabulary(ORBVocabulary* pORBVoc) { vocabulary_ = pORBVoc; }
  void SetKeyFrameDatabase(KeyFrameDatabase* pKFDB) { database_ = pKFDB; }
  // Rows of keypoints within `r` pixels in x and y of a place in the (right) image.
  std::vector<std::size_t> GetFeaturesInArea(float x, float y, float r, bool bRight = false) const;
  bool IsInImage(float x, float y) const;
  // The world position of a keypoint with depth. False when it has none.
  bool UnprojectStereo(int i, Eigen::Vector3f& x3D);
  // Where the point is in the image by fx, fy, cx, cy, with the lens distortion of mDistCoef and without: `kp`.
  // False when it is behind the camera, or outside the undistorted image. (u, v) is the place without distortion,
  // except that ProjectPointDistort gives the one with it.
  bool ProjectPointDistort(MapPoint* pMP, cv::Point2f& kp, float& u, float& v);
  bool ProjectPointUnDistort(MapPoint* pMP, cv::Point2f& kp, float& u, float& v);

  // ---- Point slots (keyframe_features.cc): the point that each keypoint sees.
  // Those with a row throw Error (kUsage) when there is no such keypoint.
  void AddMapPoint(MapPoint* pMP, std::size_t idx);  // null clears the slot
  void EraseMapPointMatch(int idx);
  void EraseMapPointMatch(MapPoint* pMP);
  void ReplaceMapPointMatch(int idx, MapPoint* pMP);
  std::set<MapPoint*> GetMapPoints();  // good ones
  std::vector<MapPoint*> GetMapPointMatches();
  int TrackedMapPoints(int minObs);        // good points with at least so many observations
  MapPoint* GetMapPoint(std::size_t idx);  // null: none
  int GetNumberMPs();                      // slots that are taken
  // Camera z of the points that it sees, sorted: element (n - 1) / q. -1 when it sees none.
  float ComputeSceneMedianDepth(int q);
  int WeightOfObservation(int left, int right) const;  // what it adds to MapPoint::nObs; -1: not seen there
  void RequireRow(std::size_t row) const;              // throws Error (kUsage) when there is no such keypoint
  bool HasRows(const Observation& observation) const;  // whether it has those keypoints

  // ---- Covisibility (keyframe_graph.cc)
  void AddConnection(KeyFrame* pKF, int weight);
  void EraseConnection(KeyFrame* pKF);
  // Counts the points shared with other keyframes of the map. Those that share 15, or the best one, become ordered
  // covisibles, both ways; the best becomes the parent of a keyframe that has none.
  void UpdateConnections();
  void UpdateBestCovisibles();
  std::set<KeyFrame*> GetConnectedKeyFrames();
  std::vector<KeyFrame*> GetVectorCovisibleKeyFrames();  // by falling weight, equal weights by falling id
  std::vector<KeyFrame*> GetBestCovisibilityKeyFrames(int count);
  std::vector<KeyFrame*> GetCovisiblesByWeight(int w);  // of at least that weight
  int GetWeight(KeyFrame* pKF);                         // 0: not connected
  static bool weightComp(int a, int b) { return a > b; }
  static bool lId(KeyFrame* pKF1, KeyFrame* pKF2) { return pKF1->mnId < pKF2->mnId; }  // neither null

  // ---- Spanning tree, loop and merge edges (keyframe_graph.cc)
  void SetFirstConnection(bool bFirst);
  void AddChild(KeyFrame* pKF);
  void EraseChild(KeyFrame* pKF);
  void ChangeParent(KeyFrame* pKF);  // null: none. Throws Error (kUsage) for itself
  std::set<KeyFrame*> GetChilds();
  KeyFrame* GetParent();
  bool hasChild(KeyFrame* pKF);
  void AddLoopEdge(KeyFrame* pKF);
  std::set<KeyFrame*> GetLoopEdges();
  void AddMergeEdge(KeyFrame* pKF);
  std::set<KeyFrame*> GetMergeEdges();

  // ---- Going bad (keyframe_graph.cc)
  void SetNotErase();
  void SetErase();
  // Leaves the map, unless it is the map's initial keyframe or must not be erased now: erases its connections and
  // observations, and gives its children new parents. mTcp then says where it was.
  void SetBadFlag();
  bool isBad() { return bad_; }
  Rigid3f GetPoseFromParent();  // mTcp

  Map* GetMap() { return map_; }
  void UpdateMap(Map* pMap);  // the pointer only: mnOriginMapId stays, and lists of maps do not change. Null: of no map

  // Fills the mBackup members with what leads to these keyframes, points and cameras. Changes nothing else.
  void PreSave(std::set<KeyFrame*>& spKF, std::set<MapPoint*>& spMP, std::set<GeometricCamera*>& spCam);
  // Finds what the mBackup members name; that replaces the links that it has. Clears the members afterwards, as
  // ORB-SLAM3 does, so a second call leaves the keyframe without links.
  // Returns what dangles.
  PostLoadReport PostLoad(std::map<long unsigned int, KeyFrame*>& mpKFid,
                          std::map<long unsigned int, MapPoint*>& mpMPid,
                          std::map<unsigned int, GeometricCamera*>& mpCamId);

  // Tells the checkpointer that a public member of the first group, or *mpImuPreintegrated, was written.
  void MarkChanged();

  // ---- Identification and what is saved with it; written when made, mPrevKF and mNextKF inside a Change.
  long unsigned int mnId;
  long unsigned int mnFrameId;
  double mTimeStamp;  // seconds
  int N, NLeft, NRight;
  unsigned int mnOriginMapId;
  float mfScale;  // from merging
  bool bImu;      // the map was IMU-initialised when it was made
  KeyFrame *mPrevKF = nullptr, *mNextKF = nullptr;
  GeometricCamera *mpCamera = nullptr, *mpCamera2 = nullptr;  // null: no second camera

  // ---- Calibration; constant.
  const float &fx = record_.intrinsics.fx, &fy = record_.intrinsics.fy;                        // pixels
  const float &cx = record_.intrinsics.cx, &cy = record_.intrinsics.cy;                        // pixels
  const float &invfx = record_.intrinsics.inverse_fx, &invfy = record_.intrinsics.inverse_fy;  // 1/pixels
  const float& mbf = record_.intrinsics.baseline_fx;                                           // pixels * metres
  const float& mb = record_.intrinsics.baseline;                                               // metres
  const float& mThDepth = record_.intrinsics.depth_threshold;                                  // metres
  const cv::Mat mDistCoef = ViewMatrix(record_.distortion);                                    // k1 k2 p1 p2 [k3]
  const ImuCalibration& mImuCalib = record_.imu_calibration;

  // ---- Features; views on the columns, constant once the keyframe is in a map.
  const KeyPointView mvKeys{features_.keypoints};      // as detected
  const KeyPointView mvKeysUn{features_.undistorted};  // lens distortion removed
  const KeyPointView mvKeysRight{features_.right_keypoints};
  const Column<float>& mvuRight = features_.right_x;                         // column in the right image, < 0: none
  const Column<float>& mvDepth = features_.depth;                            // metres, < 0: none
  const Column<std::int32_t>& mvLeftToRightMatch = features_.right_of_left;  // -1: none
  const Column<std::int32_t>& mvRightToLeftMatch = features_.left_of_right;
  const cv::Mat mDescriptors = DescriptorMatrix(features_.descriptors);  // N x 32, CV_8U; not to be written
  const BowView mBowVec{features_.bag_of_words};
  const FeatureVectorView mFeatVec{features_.feature_vector};

  // ---- Image and pyramid; constant.
  const int& mnScaleLevels = record_.pyramid.levels;
  const float &mfScaleFactor = record_.pyramid.factor, &mfLogScaleFactor = record_.pyramid.log_factor;
  const std::vector<float>& mvScaleFactors = record_.pyramid.factors;
  const std::vector<float>& mvLevelSigma2 = record_.pyramid.sigma2;
  const std::vector<float>& mvInvLevelSigma2 = record_.pyramid.inverse_sigma2;
  const int &mnMinX = record_.bounds.min_x, &mnMinY = record_.bounds.min_y;  // pixels, undistorted
  const int &mnMaxX = record_.bounds.max_x, &mnMaxY = record_.bounds.max_y;
  const int &mnGridCols = record_.bounds.grid_columns, &mnGridRows = record_.bounds.grid_rows;
  const float& mfGridElementWidthInv = record_.bounds.inverse_cell_width;  // 1/pixels
  const float& mfGridElementHeightInv = record_.bounds.inverse_cell_height;

  // ---- Inertial. Never null; duration 0: none. To write it, begin a Change, and tell MarkChanged().
  ImuPreintegration* const mpImuPreintegrated = &record_.preintegration;

  // ---- Where it was when it went bad, camera_from_parent; identity before.
  Rigid3f mTcp;

  // ---- Tracking and local mapping.
  long unsigned int mnTrackReferenceForFrame = 0, mnFuseTargetForKF = 0;
  long unsigned int mnBALocalForKF = 0, mnBAFixedForKF = 0;
  long unsigned int mnNumberOfOpt = 0;

  // ---- Place recognition.
  long unsigned int mnLoopQuery = 0, mnRelocQuery = 0, mnMergeQuery = 0, mnPlaceRecognitionQuery = 0;
  int mnLoopWords = 0, mnRelocWords = 0, mnMergeWords = 0, mnPlaceRecognitionWords = 0;
  float mLoopScore = 0, mRelocScore = 0, mMergeScore = 0, mPlaceRecognitionScore = 0;
  bool mbCurrentPlaceRecognition = false;
  std::vector<KeyFrame*> mvpLoopCandKFs, mvpMergeCandKFs;

  // ---- Loop closing, global bundle adjustment, merging.
  Rigid3f mTcwGBA, mTcwBefGBA, mTcwMerge, mTcwBefMerge, mTwcBefMerge;
  Eigen::Vector3f mVwbGBA = Eigen::Vector3f::Zero(), mVwbBefGBA = Eigen::Vector3f::Zero();
  Eigen::Vector3f mVwbMerge = Eigen::Vector3f::Zero(), mVwbBefMerge = Eigen::Vector3f::Zero();
  ImuBias mBiasGBA, mBiasMerge;
  long unsigned int mnBAGlobalForKF = 0, mnBALocalForMerge = 0;
  long unsigned int mnMergeCorrectedForKF = 0, mnMergeForKF = 0;
  float mfScaleMerge = 0;

  // ---- Where the image comes from, for clients; not saved.
  std::string mNameFile;
  unsigned int mnDataset = 0;

  // ---- References as ids, filled by PreSave and read by PostLoad. -1, or for cameras the largest number: none.
  std::vector<long long int> mvBackupMapPointsId;  // by keypoint
  std::map<long unsigned int, int> mBackupConnectedKeyFrameIdWeights;
  long long int mBackupParentId = -1, mBackupPrevKFId = -1, mBackupNextKFId = -1;
  std::vector<long unsigned int> mvBackupChildrensId, mvBackupLoopEdgesId, mvBackupMergeEdgesId;
  unsigned int mnBackupIdCamera = ~0U, mnBackupIdCamera2 = ~0U;
  ImuPreintegration& mBackupImuPreintegrated = record_.preintegration;  // held by value anyway

 private:
  friend struct Bridge;

  struct Covisible {
    KeyFrame* keyframe;
    int weight;
  };

  // The runtime of the map. Throws Error (kUsage) when the frame, or a point that it sees, is not of the map's atlas.
  static Runtime& CheckedRuntime(const Frame& frame, const Map* map);

  // Of a record, whose links Link() makes pointers of.
  KeyFrame(slamdb::KeyFrame record, Map* map);
  // What has no target, and all links of a bad keyframe, stays in `record_` and `unresolved_slots_`.
  // The cameras are there already. Targets is LinkTargets or IdMaps (detail/link_targets.h).
  template <class Targets>
  void Link(const Targets& targets, PostLoadReport& report);
  using Miss = std::function<void(LinkKind kind, std::uint64_t target)>;
  template <class Targets>
  void LinkSlots(const Targets& targets, const Miss& miss);
  template <class Targets>
  void LinkKeyFrames(const Targets& targets, const Miss& miss);
  template <class Targets>
  void LinkConnections(const Targets& targets, const Miss& miss);
  // The two halves of PostLoad: what the backup members name goes into the record, and the links that it has go.
  void TakeBackups();
  void FindCameras(const std::map<unsigned int, GeometricCamera*>& cameras);

  // The record: links to what `map` lists, and those that were never resolved. Under the closed gate. Without
  // `features` only the point slots are in Features.
  slamdb::KeyFrame ToRecord(LinkFilter& links, bool features) const;
  void WriteLinks(LinkFilter& links, slamdb::KeyFrame& record) const;

  // The public members that are saved, for the checkpointer to see that a client wrote one.
  struct PublicMembers {
    std::uint64_t frame;
    std::uint64_t timestamp;  // its bits
    std::uint32_t scale;      // its bits
    std::uint32_t origin_map;
    bool imu;
    const KeyFrame *previous, *next;
    const GeometricCamera *camera, *camera2;
    friend bool operator==(const PublicMembers&, const PublicMembers&) = default;
  };
  PublicMembers ReadPublicMembers() const;

  // By falling weight, equal weights by falling id: ORB-SLAM3's order, with ids for addresses.
  static bool IsBetterCovisible(const Covisible& a, const Covisible& b) {
    return a.weight != b.weight ? a.weight > b.weight : a.keyframe->mnId > b.keyframe->mnId;
  }
  std::vector<Covisible>::iterator FindConnection(const KeyFrame* keyframe);
  void OrderCovisibles();  // UpdateBestCovisibles under its lock
  std::vector<Covisible> CountSharedPoints();
  void GiveChildrenAway();                         // finds new parents for them
  void LeaveGraph();                               // SetBadFlag, once it is decided
  void SetSlot(std::size_t row, MapPoint* point);  // see RequireRow
  std::vector<MapPoint*> GoodPoints();             // by slot
  std::optional<Eigen::Vector2f> ProjectUndistorted(MapPoint* point);

  std::atomic<Map*> map_;
  std::atomic<bool> bad_ = false;
  ORBVocabulary* vocabulary_ = nullptr;
  KeyFrameDatabase* database_ = nullptr;

  std::mutex mutex_pose_;  // mMutexPose: pose, velocity, biases and preintegration in the record, mTcp

  std::mutex mutex_features_;  // mMutexFeatures
  std::vector<MapPoint*> slots_;
  std::vector<std::pair<std::size_t, MapPointId>> unresolved_slots_;

  std::mutex mutex_connections_;        // mMutexConnections: links, and not_erase, to_be_erased, first_connection
  std::vector<Covisible> connections_;  // by keyframe id
  std::vector<Covisible> ordered_;      // by falling weight
  KeyFrame* parent_ = nullptr;
  std::vector<KeyFrame*> children_, loop_edges_, merge_edges_;  // in the order in which they came

  bool was_saved_ = false;  // the checkpointer has its features
  PublicMembers saved_members_{};
};

}  // namespace slamdb::live
