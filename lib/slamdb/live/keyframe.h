// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include "slamdb/live/listed.h"
#include "slamdb/live/post_load.h"
#include "slamdb/live/runtime.h"
#include "slamdb/model/keyframe.h"
#include "slamdb/model/vocabulary_tree.h"

namespace slamdb::live {

class Frame;
class GeometricCamera;
class Map;
class MapPoint;

// A posed image of a map that is being built: ORB-SLAM3's class KeyFrame, with its names. Poses are slamdb::Rigid3f
// with unit quaternions, named target_from_source in comments. All methods are thread-safe; runtime.h states the order
// of the locks. Where ORB-SLAM3 orders keyframes by address, ids order them here.
//
// `new` makes it; Map::AddKeyFrame takes it over, and it then lives until the map goes, also when it is flagged bad.
class KeyFrame : public Listed {
 public:
  // Of a frame: pose, features, the points that it sees, cameras. Its own id; no links in the graph yet, and no
  // observation in the points.
  KeyFrame(Frame& F, Map* pMap);
  ~KeyFrame() = default;

  // ---- Pose (keyframe.cc)
  void SetPose(const Rigid3f& Tcw);             // left camera_from_world
  void SetVelocity(const Eigen::Vector3f& Vw);  // m/s, world
  Rigid3f GetPose();
  Rigid3f GetPoseInverse();
  Eigen::Vector3f GetCameraCenter();
  Eigen::Vector3f GetRightCameraCenter();  // fisheye stereo
  Rigid3f GetRightPose();                  // right camera_from_world
  Eigen::Matrix3f GetRotation();
  Eigen::Vector3f GetTranslation();
  Rigid3f GetImuPose();  // world_from_body; world_from_camera without IMU
  Eigen::Vector3f GetImuPosition();
  Eigen::Vector3f GetVelocity();
  bool isVelocitySet();

  // ---- Inertial (keyframe.cc)
  void SetNewBias(const ImuBias& bias);  // also in its preintegration
  ImuBias GetImuBias();
  ImuPreintegration GetImuPreintegrated();  // since the keyframe before: mpImuPreintegrated
  void SetImuPreintegrated(const ImuPreintegration& preintegration);

  // ---- Features (keyframe_features.cc). Constant once the keyframe is in a map; the point slots are not in here.
  const Features& features() const { return features_; }
  const ScalePyramid& pyramid() const { return record_.pyramid; }
  const Intrinsics& intrinsics() const { return record_.intrinsics; }
  const ImageBounds& bounds() const { return record_.bounds; }
  // Computes bag of words and feature vector if there are none. Before the keyframe is added to a map.
  void ComputeBoW(const VocabularyTree& vocabulary);
  // Rows of keypoints within `r` pixels in x and y of a place in the (right) image.
  std::vector<std::size_t> GetFeaturesInArea(float x, float y, float r, bool bRight = false) const;
  bool IsInImage(float x, float y) const;
  // The world position of a keypoint with depth. False when it has none.
  bool UnprojectStereo(int i, Eigen::Vector3f& x3D);

  // ---- Point slots (keyframe_features.cc): the point that each keypoint sees
  void AddMapPoint(MapPoint* pMP, std::size_t idx);
  void EraseMapPointMatch(int idx);
  void EraseMapPointMatch(MapPoint* pMP);
  void ReplaceMapPointMatch(int idx, MapPoint* pMP);
  std::set<MapPoint*> GetMapPoints();  // good ones
  std::vector<MapPoint*> GetMapPointMatches();
  int TrackedMapPoints(int minObs);  // good points with at least so many observations
  MapPoint* GetMapPoint(std::size_t idx);
  int GetNumberMPs();  // slots that are taken
  // Camera z of the points that it sees, sorted: element (n - 1) / q. -1 when it sees none.
  float ComputeSceneMedianDepth(int q);
  int WeightOfObservation(int left, int right) const;  // what it adds to MapPoint::nObs; -1: not seen there
  void RequireRow(std::size_t row) const;              // throws Error when there is no such keypoint
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

  // ---- Spanning tree, loop and merge edges (keyframe_graph.cc)
  void SetFirstConnection(bool bFirst);
  void AddChild(KeyFrame* pKF);
  void EraseChild(KeyFrame* pKF);
  void ChangeParent(KeyFrame* pKF);  // throws Error for itself
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
  // observations, and gives its children new parents. GetPoseFromParent() then says where it was.
  void SetBadFlag();
  bool isBad() { return bad_; }
  Rigid3f GetPoseFromParent();  // camera_from_parent, mTcp

  Map* GetMap() { return map_; }
  void UpdateMap(Map* pMap);  // the pointer only: mnOriginMapId stays

  // Tells the checkpointer that a public member of the first group was written.
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

  // ---- Tracking and local mapping.
  long unsigned int mnTrackReferenceForFrame = 0, mnFuseTargetForKF = 0;
  long unsigned int mnBALocalForKF = 0, mnBAFixedForKF = 0;
  long unsigned int mnNumberOfOpt = 0;

  // ---- Place recognition.
  long unsigned int mnLoopQuery = 0, mnRelocQuery = 0, mnMergeQuery = 0, mnPlaceRecognitionQuery = 0;
  int mnLoopWords = 0, mnRelocWords = 0, mnMergeWords = 0, mnPlaceRecognitionWords = 0;
  float mLoopScore = 0, mRelocScore = 0, mMergeScore = 0, mPlaceRecognitionScore = 0;
  bool mbCurrentPlaceRecognition = false;

  // ---- Loop closing, global bundle adjustment, merging.
  Rigid3f mTcwGBA, mTcwBefGBA, mTcwMerge, mTcwBefMerge, mTwcBefMerge;
  Eigen::Vector3f mVwbGBA = Eigen::Vector3f::Zero(), mVwbBefGBA = Eigen::Vector3f::Zero();
  Eigen::Vector3f mVwbMerge = Eigen::Vector3f::Zero();
  ImuBias mBiasGBA, mBiasMerge;
  long unsigned int mnBAGlobalForKF = 0, mnBALocalForMerge = 0;

 private:
  friend struct Bridge;

  struct Covisible {
    KeyFrame* keyframe;
    int weight;
  };

  // Of a record, whose links Link() makes pointers of.
  KeyFrame(slamdb::KeyFrame record, Map* map);
  // What has no target, and all links of a bad keyframe, stays in `record_` and `unresolved_slots_`.
  // The cameras are there already.
  void Link(const LinkTargets& targets, PostLoadReport& report);
  using Miss = std::function<void(LinkKind kind, std::uint64_t target)>;
  void LinkSlots(const LinkTargets& targets, const Miss& miss);
  void LinkKeyFrames(const LinkTargets& targets, const Miss& miss);
  void LinkConnections(const LinkTargets& targets, const Miss& miss);

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

  Runtime& runtime_;
  std::atomic<Map*> map_;
  std::atomic<bool> bad_ = false;

  std::mutex mutex_pose_;    // mMutexPose: pose, velocity, biases and preintegration in the record
  slamdb::KeyFrame record_;  // but for what stands below; its links are those without a target
  Features features_;

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
