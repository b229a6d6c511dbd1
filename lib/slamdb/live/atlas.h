// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/live/camera.h"
#include "slamdb/live/keyframe_database.h"
#include "slamdb/live/observer_list.h"
#include "slamdb/live/post_load.h"
#include "slamdb/live/runtime.h"
#include "slamdb/model/atlas.h"

namespace slamdb::live {

class KeyFrame;
class Map;
class MapPoint;

// All maps that a SLAM system builds, with cameras and ids: ORB-SLAM3's class Atlas, with its names.
// It owns its maps and cameras, and they own the rest.
// Ids come from it, so several atlases live in one process.
//
// All methods are thread-safe. Pointers that are null or of another atlas throw Error (kUsage), but for SetMapBad,
// which does nothing.
class SLAMDB_EXPORT Atlas {
 public:
  Atlas();
  ~Atlas();
  Atlas(const Atlas&) = delete;
  Atlas& operator=(const Atlas&) = delete;

  struct Loaded;
  // Reads an atlas of any format: a file, or `store.db#name`.
  // No map of it is current: CreateNewMap() begins the session's own, ChangeMap() continues one.
  // What is in it but does not hang together is in the report.
  // Throws Error when it cannot be read, or (kUsage) the options ask for a part of it.
  [[nodiscard]] static Loaded Load(const std::string& location, const ReadOptions& options = {});

  // Writes the whole atlas as it is at one moment, to any format. Returns what the format cannot hold.
  // What changes meanwhile is not in it; changes wait while it is copied (a Checkpointer makes them wait less).
  // The file is replaced as a whole or not at all; with `options.overwrite` an atlas that is there.
  // Throws Error.
  Notices Save(const std::string& location, const WriteOptions& options = {});

  // ---- Maps
  void CreateNewMap();             // and make it the current one
  void ChangeMap(Map* pMap);       // to one of GetAllMaps()
  Map* GetCurrentMap();            // made when there is none
  std::vector<Map*> GetAllMaps();  // those that are not bad, by id
  int CountMaps();
  long unsigned int GetLastInitKFid();
  void SetMapBad(Map* pMap);
  // Deletes bad maps with everything that they list.
  // What was culled from them stays while there is any other map, since points and keyframes that went over to it may
  // link to it.
  // Not inside a Change.
  void RemoveBadMaps();
  void clearMap();    // empties the current map
  void clearAtlas();  // deletes all maps; ids go on. Not inside a Change
  bool isInertial();
  bool isImuInitialized();
  void SetInertialSensor();
  void SetImuInitialized();

  // ---- All maps that are not bad
  std::map<long unsigned int, KeyFrame*> GetAtlasKeyframes();  // by id
  long unsigned int GetNumLivedKF();
  long unsigned int GetNumLivedMP();

  // ---- The current map, or the object's own
  void AddKeyFrame(KeyFrame* pKF);
  void AddMapPoint(MapPoint* pMP);
  std::vector<KeyFrame*> GetAllKeyFrames();
  std::vector<MapPoint*> GetAllMapPoints();
  std::vector<MapPoint*> GetReferenceMapPoints();
  void SetReferenceMapPoints(const std::vector<MapPoint*>& vpMPs);
  long unsigned int KeyFramesInMap();
  long unsigned int MapPointsInMap();
  void InformNewBigChange();
  int GetLastBigChangeIdx();

  // ---- Cameras. Takes the camera over and returns it, or an equal one that is there already.
  // Throws Error (kUsage) for one that another atlas has.
  GeometricCamera* AddCamera(GeometricCamera* pCam);
  std::vector<GeometricCamera*> GetAllCameras();

  // ---- Place recognition. Not owned. What PostLoad hands to keyframes, and the vocabulary frames to theirs.
  void SetORBVocabulary(ORBVocabulary* pORBVoc);
  ORBVocabulary* GetORBVocabulary();
  void SetKeyFrameDababase(KeyFrameDatabase* pKFDB);  // sic, as in ORB-SLAM3
  KeyFrameDatabase* GetKeyFrameDatabase();

  // Map::PreSave of all maps that are not bad, with all cameras. While no other thread changes the atlas.
  // Saving and loading whole atlases does not use these two (Save, Load).
  void PreSave();
  // Map::PostLoad of the same. Returns what dangles.
  PostLoadReport PostLoad();

  // The vocabulary that bags of words refer to: its name and checksum.
  void SetVocabulary(Vocabulary vocabulary);
  Vocabulary GetVocabulary();

  Runtime& runtime() { return runtime_; }
  ChangeGate& gate() { return runtime_.gate; }

 private:
  friend struct Bridge;

  Map* CurrentOrNull();
  GeometricCamera* FindCamera(CameraId id);  // the first of that id; null: none
  // With the lock:
  std::uint64_t NextInitialKeyFrame() const;  // past the current map
  void StoreCurrent();

  Runtime runtime_;
  std::vector<Column<Observer>> loaded_observers_;  // blocks that points of loaded maps have their lists in
  std::mutex mutex_;                                // mMutexAtlas: the members below
  slamdb::Atlas record_;  // without maps and cameras: vocabulary, encoding, repeated entries, next initial keyframe
  std::vector<std::unique_ptr<Map>> maps_, bad_maps_;
  std::vector<std::unique_ptr<Map>> buried_maps_;  // removed; they keep culled objects that others may link to
  std::vector<std::unique_ptr<GeometricCamera>> cameras_, spare_cameras_;  // spare: given, but equal to another
  Map* current_ = nullptr;
  ORBVocabulary* vocabulary_ = nullptr;
  KeyFrameDatabase* database_ = nullptr;
  std::atomic<bool> has_checkpointer_ = false;
  bool lists_as_recorded_ = false;  // maps and cameras, since they were loaded
};

struct Atlas::Loaded {
  std::unique_ptr<Atlas> atlas;
  PostLoadReport report;
  Notices notices;
};

}  // namespace slamdb::live
