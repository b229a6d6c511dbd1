// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <memory>
#include <mutex>
#include <opencv2/core/mat.hpp>
#include <set>
#include <tuple>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/live/listed.h"
#include "slamdb/live/observer_list.h"
#include "slamdb/live/post_load.h"
#include "slamdb/live/runtime.h"
#include "slamdb/model/map_point.h"

namespace slamdb {
struct ScalePyramid;
}

namespace slamdb::live {

class Frame;
class KeyFrame;
class LinkFilter;
class Map;

// A 3D point of a map that is being built: ORB-SLAM3's class MapPoint, with its names and signatures.
// World coordinates, metres or map units.
//
// All methods are thread-safe; runtime.h states the order of the locks.
// Where ORB-SLAM3 goes through keyframes by address, keyframe ids order them here, so that equal work gives equal maps.
//
// `new` makes it; Map::AddMapPoint takes it over, and it then lives until the map goes, also when it is flagged bad.
// A point that was never added is the client's to delete, once nothing refers to it.
//
// Asked about an object that is null or of another atlas, it answers that it has nothing to do with it. To be linked to
// such an object it refuses: Error (kUsage).
class SLAMDB_EXPORT MapPoint : public Listed {
 public:
  // In no map and of no atlas, without an id: for programs that read points by themselves. UpdateMap gives it both.
  // Until then it can be linked to no object of an atlas.
  MapPoint();
  // With a reference keyframe.
  // Like every constructor it adds no observation: AddObservation does, on both sides.
  MapPoint(const Eigen::Vector3f& Pos, KeyFrame* pRefKF, Map* pMap);
  // By inverse depth (1/m) along the ray of pixel `uv_init` of the host keyframe. The position is not set.
  MapPoint(double invDepth, cv::Point2f uv_init, KeyFrame* pRefKF, KeyFrame* pHostKF, Map* pMap);
  // Seen by a frame as keypoint `idxF`, whose descriptor, viewing direction and distance range it takes.
  // No reference keyframe.
  MapPoint(const Eigen::Vector3f& Pos, Map* pMap, Frame* pFrame, int idxF);
  ~MapPoint() = default;

  static void* operator new(std::size_t bytes);
  static void operator delete(void* block, std::size_t bytes);

  void SetWorldPos(const Eigen::Vector3f& Pos);
  Eigen::Vector3f GetWorldPos();

  // The mean of the unit viewing directions, so at most of length 1.
  Eigen::Vector3f GetNormal();
  void SetNormalVector(const Eigen::Vector3f& normal);

  KeyFrame* GetReferenceKeyFrame();

  // (left, right) keypoint rows by keyframe; -1: not seen in that image.
  std::map<KeyFrame*, std::tuple<int, int>> GetObservations();
  // A stereo or depth observation counts two.
  int Observations();

  // Keypoint `idx` of the keyframe sees the point; rows from KeyFrame::NLeft up are of the right image of a fisheye
  // pair. Adding an observation again does not count it again, unlike ORB-SLAM3's. Throws Error (kUsage) for a keypoint
  // that the keyframe does not have.
  void AddObservation(KeyFrame* pKF, int idx);
  // The reference keyframe, if it is this one, becomes the observer of the lowest id.
  // With two observations or less left the point is flagged bad.
  void EraseObservation(KeyFrame* pKF);

  std::tuple<int, int> GetIndexInKeyFrame(KeyFrame* pKF);  // (-1, -1): not seen
  bool IsInKeyFrame(KeyFrame* pKF);
  void PrintObservations();  // to standard output
  void PrintObservations(std::ostream& out);

  // Forgets the observations, clears the slots of the keyframes that had them, and leaves the map.
  // The counters, the reference keyframe and the descriptor stay.
  void SetBadFlag();
  bool isBad();

  // Hands all observations, and the found and visible counters, to the other point, recomputes its descriptor, and goes
  // bad. Where the other is seen by the same keyframe already, the keyframe's slot of this one is cleared.
  void Replace(MapPoint* pMP);
  MapPoint* GetReplaced();

  // Saved, but for a format that has no place for them. Take no lock and wait for nothing, not even for a save.
  void IncreaseVisible(int n = 1);
  void IncreaseFound(int n = 1);
  float GetFoundRatio();
  int GetFound();

  // Chooses the descriptor with the least median Hamming distance to all others, the first of equals.
  void ComputeDistinctiveDescriptors();
  cv::Mat GetDescriptor();  // 1 x 32, CV_8U, a copy; empty when there is none

  // Mean viewing direction over all observations, distance range from the octave in the reference keyframe.
  void UpdateNormalAndDepth();

  float GetMinDistanceInvariance();  // 0.8 of the least distance
  float GetMaxDistanceInvariance();  // 1.2 of the greatest
  // The octave at which it should appear from that distance.
  int PredictScale(const float& currentDist, KeyFrame* pKF);
  int PredictScale(const float& currentDist, Frame* pF);

  Map* GetMap();
  // The pointer only: mnOriginMapId stays, and lists of maps do not change. Null: it is of no map.
  // A point of no atlas becomes one of the map's, with a new id if it has none; before other threads know it.
  void UpdateMap(Map* pMap);

  // Fills the mBackup members with what leads to these keyframes and points. Changes nothing else.
  void PreSave(std::set<KeyFrame*>& spKF, std::set<MapPoint*>& spMP);
  // Finds what the mBackup members name; that replaces the links that it has. Clears the members afterwards, as
  // ORB-SLAM3 does, so a second call leaves the point without observations.
  // Returns what dangles. Observations() stays as it is.
  // Saving and loading whole atlases does not use these two (bridge.h).
  PostLoadReport PostLoad(std::map<long unsigned int, KeyFrame*>& mpKFid,
                          std::map<long unsigned int, MapPoint*>& mpMPid);

  // Tells the checkpointer that a public member that is saved (the first group) was written.
  void MarkChanged();

  // ---- Identification; written when made.
  long unsigned int mnId;
  long int mnFirstKFid = -1;  // -1: made by a frame
  long int mnFirstFrame = -1;
  int nObs = 0;                    // Observations()
  unsigned int mnOriginMapId = 0;  // the map it was made in

  // ---- Tracking: written by the tracking thread only. Frame::isInFrustum says what stands here after a miss.
  float mTrackProjX = 0, mTrackProjY = 0;    // pixels, left image
  float mTrackProjXR = 0, mTrackProjYR = 0;  // pixels, right image
  float mTrackDepth = 0, mTrackDepthR = 0;   // distance to the camera
  bool mbTrackInView = false, mbTrackInViewR = false;
  int mnTrackScaleLevel = 0, mnTrackScaleLevelR = 0;
  float mTrackViewCos = 0, mTrackViewCosR = 0;
  long unsigned int mnTrackReferenceForFrame = 0;
  long unsigned int mnLastFrameSeen = 0;

  // ---- Local mapping: written by the mapping thread only.
  long unsigned int mnBALocalForKF = 0;
  long unsigned int mnFuseCandidateForKF = 0;

  // ---- Loop closing and global bundle adjustment: written by the loop closing thread and the one it starts.
  long unsigned int mnLoopPointForKF = 0;
  long unsigned int mnCorrectedByKF = 0;
  long unsigned int mnCorrectedReference = 0;
  Eigen::Vector3f mPosGBA = Eigen::Vector3f::Zero();
  long unsigned int mnBAGlobalForKF = 0;
  long unsigned int mnBALocalForMerge = 0;

  // ---- Merging maps: written by the loop closing thread only.
  Eigen::Vector3f mPosMerge = Eigen::Vector3f::Zero();
  Eigen::Vector3f mNormalVectorMerge = Eigen::Vector3f::Zero();

  // ---- Inverse depth: written when made.
  double mInvDepth = 0, mInitU = 0, mInitV = 0;
  KeyFrame* mpHostKF = nullptr;

  // ---- References as ids, filled by PreSave and read by PostLoad.
  std::map<long unsigned int, int> mBackupObservationsId1, mBackupObservationsId2;  // left, right rows by keyframe id
  long unsigned int mBackupRefKFId = KeyFrameId::kNone;                             // 2^64 - 1: none
  long long int mBackupReplacedId = -1;                                             // -1: none

 private:
  friend struct Bridge;
  friend struct BoostAccess;  // boost.h
  friend class KeyFrame;      // counts observers

  // The common part of the constructors: with a new id, or that one.
  explicit MapPoint(Map& map);
  MapPoint(Map& map, std::uint64_t id);
  // With what a record says, but for its links.
  MapPoint(const slamdb::MapPoint& record, Map* map);
  // Makes pointers of the record's ids. The observers go to the end of `block`, which must have room for them and
  // outlive the point. What has no target, and all links of a bad point, stays in `unresolved_`.
  template <class Targets>
  void Link(const slamdb::MapPoint& record, const Targets& targets, Column<Observer>& block, PostLoadReport& report);

  // The record: links that pass the filter, and those that were never resolved. Under the closed gate.
  slamdb::MapPoint ToRecord(LinkFilter& links) const;
  // Between the point and a record: all but the links, and but the id that is read. Take the locks before.
  void ReadValues(const slamdb::MapPoint& record);
  void WriteValues(slamdb::MapPoint& record) const;
  void WriteUnresolved(slamdb::MapPoint& record) const;

  Observer* FindObserver(const KeyFrame* keyframe);  // where it is or belongs
  bool Has(const Observer* observer, const KeyFrame* keyframe) const;
  std::vector<Observer> CopyObservers();
  void StoreDistanceRange(float distance, int octave, const ScalePyramid& pyramid);
  int PredictScaleIn(float distance, const ScalePyramid& pyramid);

  std::atomic<Map*> map_ = nullptr;

  std::mutex mutex_position_;  // mMutexPos
  Eigen::Vector3f position_ = Eigen::Vector3f::Zero(), normal_ = Eigen::Vector3f::Zero();
  float min_distance_ = 0, max_distance_ = 0;

  std::mutex mutex_features_;  // mMutexFeatures
  ObserverList observations_;  // by keyframe id
  KeyFrame* reference_ = nullptr;
  MapPoint* replaced_ = nullptr;
  std::unique_ptr<slamdb::MapPoint> unresolved_;  // what of the loaded record has no place in the graph; usually null
  std::atomic<bool> bad_ = false;
  Flag recorded_bad_;
  Descriptor descriptor_{};
  MatrixForm descriptor_form_ = MatrixForm::kEmpty;

  // Counters of tracking change without the gate: a save may have one increment and not the next. Those that a loaded
  // record does not have begin at 1, and stay unrecorded until they change; an origin likewise.
  bool has_visible_ : 1 = true, has_found_ : 1 = true;
  std::atomic<int> visible_ = 1, found_ = 1;
  std::uint32_t assumed_origin_ = slamdb::MapPoint::kNoOrigin;
};

}  // namespace slamdb::live
