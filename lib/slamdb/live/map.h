// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/live/keyframe_database.h"
#include "slamdb/live/listed.h"
#include "slamdb/live/post_load.h"
#include "slamdb/live/runtime.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/similarity.h"

namespace slamdb::live {

class Atlas;
class GeometricCamera;
class KeyFrame;
class MapPoint;

// Keyframes and points in one world frame: ORB-SLAM3's class Map, with its names.
// Atlas::CreateNewMap makes maps, and the atlas owns them.
// A map owns what was added to it, until it goes itself or another map takes it over.
// Lists are in the order in which objects came.
//
// All methods are thread-safe; runtime.h states the order of the locks.
// Erasing what is null or of another atlas does nothing; adding it throws Error (kUsage).
class SLAMDB_EXPORT Map {
 public:
  ~Map();
  Map(const Map&) = delete;
  Map& operator=(const Map&) = delete;

  // Takes the object over, from another map if it is there. The first keyframe of an empty map is its initial one.
  void AddKeyFrame(KeyFrame* pKF);
  void AddMapPoint(MapPoint* pMP);
  // No longer lists it; it lives on until the map goes.
  void EraseKeyFrame(KeyFrame* pKF);
  void EraseMapPoint(MapPoint* pMP);

  std::vector<KeyFrame*> GetAllKeyFrames();
  std::vector<MapPoint*> GetAllMapPoints();
  long unsigned int KeyFramesInMap();
  long unsigned int MapPointsInMap();

  // The points that tracking draws.
  void SetReferenceMapPoints(const std::vector<MapPoint*>& vpMPs);
  std::vector<MapPoint*> GetReferenceMapPoints();

  long unsigned int GetId() const { return id_; }
  void ChangeId(long unsigned int nId);
  long unsigned int GetInitKFid();
  void SetInitKFid(long unsigned int initKFif);
  long unsigned int GetMaxKFid();    // never decreases
  KeyFrame* GetOriginKF();           // the initial keyframe; null: none yet
  long unsigned int GetLowerKFID();  // least id of a keyframe; 0: none

  bool IsInUse() const { return is_in_use_; }
  void SetCurrentMap() { is_in_use_ = true; }
  void SetStoredMap() { is_in_use_ = false; }
  bool IsBad() const { return is_bad_; }
  void SetBad() { is_bad_ = true; }

  void InformNewBigChange();
  int GetLastBigChangeIdx();
  int GetMapChangeIndex() const { return change_index_; }
  void IncreaseChangeIndex() { ++change_index_; }
  int GetLastMapChange() const { return last_change_; }
  void SetLastMapChange(int currentChangeId) { last_change_ = currentChangeId; }

  void SetImuInitialized();
  bool isImuInitialized();
  void SetInertialSensor();
  bool IsInertial();
  void SetIniertialBA1();  // sic, as in ORB-SLAM3
  void SetIniertialBA2();
  bool GetIniertialBA1();
  bool GetIniertialBA2();

  // Moves the map: poses and velocities of all keyframes, then positions of all points with normals and distance
  // ranges. y_from_world rotates, turns and shifts; positions are multiplied by `s` before.
  void ApplyScaledRotation(const Rigid3f& T, float s, bool bScaledVel = false);

  // Empties the map: its keyframes belong to no map, the IMU flags are reset.
  void clear();

  // Fills the mBackup members of the map, and of its keyframes and points that are not bad, with what leads to these
  // and to the cameras. Changes nothing else. While no other thread changes the map.
  void PreSave(std::set<GeometricCamera*>& spCams);
  // Adds the keyframes and points that the backup lists hold to the map, hands the keyframes vocabulary and database,
  // which may be null, finds what all their mBackup members name, and adds the keyframes to the database.
  // Clears the backup members, so a second call does nothing. Returns what dangles.
  PostLoadReport PostLoad(KeyFrameDatabase* pKFDB, ORBVocabulary* pORBVoc,
                          std::map<unsigned int, GeometricCamera*>& mpCams);

  Runtime& runtime() const { return runtime_; }
  // Whether it belongs to the live atlas of that runtime.
  bool IsOf(const Runtime& runtime) const { return &runtime_ == &runtime; }

  // ---- For clients.
  std::mutex mMutexMapUpdate, mMutexPointCreation;  // see runtime.h
  std::vector<KeyFrame*> mvpKeyFrameOrigins;        // roots for global bundle adjustment; write it inside a Change
  KeyFrame* mpFirstRegionKF = nullptr;              // not saved
  bool mbFail = false;                              // not saved

  // ---- Filled by PreSave and read by PostLoad. Ids of 2^64 - 1: none.
  std::vector<KeyFrame*> mvpBackupKeyFrames;
  std::vector<MapPoint*> mvpBackupMapPoints;
  std::vector<long unsigned int> mvBackupKeyFrameOriginsId;
  long unsigned int mnBackupKFinitialID = KeyFrameId::kNone, mnBackupKFlowerID = KeyFrameId::kNone;

 private:
  friend class Atlas;
  friend struct Bridge;

  Map(Runtime& runtime, std::uint64_t id, std::uint64_t initial_keyframe);
  Map(Runtime& runtime, slamdb::Map header);  // without its lists

  template <class Object>
  struct Objects {
    ObjectList<Object> live, erased;
  };
  template <class Object>
  bool Add(Objects<Object>& objects, Object* object);  // false: it was there
  template <class Object>
  bool Erase(Objects<Object>& objects, Object* object);  // false: it was not there
  template <class Object>
  void GiveUp(Objects<Object>& objects, Object* object);  // to another map
  void TakeOver(Listed* object);
  // Deletes what it lists; what was erased stays, since others may link to it. Returns whether there is any.
  bool DeleteListed();
  KeyFrame* FindLowest() const;
  // The last step of PostLoad: the initial and the lowest keyframe, and the origins.
  void FindBackups(const std::map<long unsigned int, KeyFrame*>& keyframes, PostLoadReport& report);
  void Forget(const KeyFrame* keyframe);  // that goes to another map
  void Forget(const MapPoint*) {}
  Objects<KeyFrame>& ObjectsOf(KeyFrame*) { return keyframes_; }
  Objects<MapPoint>& ObjectsOf(MapPoint*) { return points_; }

  // The record without lists; repeated entries only where all lists are as they were loaded. Under the closed gate.
  slamdb::Map ToHeader(bool repeated_entries) const;
  bool IsSaved() const;  // not when it is new and empty

  Runtime& runtime_;
  std::atomic<std::uint64_t> id_;
  std::atomic<bool> is_in_use_ = false, is_bad_ = false;
  std::atomic<int> change_index_ = 0, last_change_ = 0;

  std::mutex mutex_;    // mMutexMap: the members below
  slamdb::Map record_;  // without lists; first_keyframe, lowest_keyframe and origins only if their targets are missing
  Objects<KeyFrame> keyframes_;
  Objects<MapPoint> points_;
  std::vector<MapPoint*> reference_points_;
  KeyFrame *initial_ = nullptr, *lowest_ = nullptr;  // lowest_ null: not known, or there is none

  bool has_unique_ids_ = true;

  // What the checkpointer cannot take from the changed objects alone: an object came from or went to another map.
  bool is_rebuilt_ = true;
  bool lists_as_recorded_ = false;  // since it was loaded, so that the record's repeated entries hold
};

}  // namespace slamdb::live
