// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/atlas.h"

#include <algorithm>

#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/live/bridge.h"
#include "slamdb/live/detail/own.h"
#include "slamdb/live/detail/snapshot.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"

namespace slamdb::live {

using Lock = std::lock_guard<std::mutex>;

namespace {

// What a map answers; nothing, 0 or false when there is none, since asking makes none.
template <class Value>
Value Ask(Map* map, Value (Map::*question)()) {
  return map == nullptr ? Value() : (map->*question)();
}

template <class Object>
Map& MapOf(Object& object) {
  Map* map = object.GetMap();
  if (map == nullptr) throw Error(ErrorKind::kUsage, "what is added to the atlas is of no map: UpdateMap gives it one");
  return *map;
}

}  // namespace

Atlas::Atlas() = default;
Atlas::~Atlas() = default;

Atlas::Loaded Atlas::Load(const std::string& location, const ReadOptions& options) {
  if (!options.selection.everything() || options.features != FeatureColumns::kAll)
    throw Error(ErrorKind::kUsage, location, "", "a live atlas is read whole, or saving it would lose the rest");
  Notices notices;
  LiveAtlas live = FromModel(ReadAtlas(location, options, &notices), options.threads);
  return {std::move(live.atlas), std::move(live.report), std::move(notices)};
}

Notices Atlas::Save(const std::string& location, const WriteOptions& options) {
  Notices notices;
  WriteAtlas(ToModel(*this, options.threads), location, options, &notices);
  return notices;
}

// ---- maps

std::uint64_t Atlas::NextInitialKeyFrame() const {
  const std::uint64_t next = record_.next_ids.initial_keyframe;
  const std::uint64_t last = current_ == nullptr ? 0 : current_->GetMaxKFid();
  return next < last ? last + 1 : next;
}

void Atlas::StoreCurrent() {
  if (current_ == nullptr) return;
  record_.next_ids.initial_keyframe = NextInitialKeyFrame();
  current_->SetStoredMap();
}

void Atlas::CreateNewMap() {
  const Change change(runtime_.gate);
  const Lock lock(mutex_);
  StoreCurrent();
  maps_.emplace_back(new Map(runtime_, runtime_.map_ids.Next(), record_.next_ids.initial_keyframe));
  current_ = maps_.back().get();
  current_->SetCurrentMap();
  lists_as_recorded_ = false;
}

void Atlas::ChangeMap(Map* pMap) {
  const Change change(runtime_.gate);
  const Lock lock(mutex_);
  if (std::none_of(maps_.begin(), maps_.end(), [&](const auto& map) { return map.get() == pMap; }))
    throw Error(ErrorKind::kUsage, "the map to change to is none of this atlas, or a bad one");
  if (current_ != nullptr) current_->SetStoredMap();
  current_ = pMap;
  current_->SetCurrentMap();
}

Map* Atlas::CurrentOrNull() {
  const Lock lock(mutex_);
  return current_;
}

Map* Atlas::GetCurrentMap() {
  if (Map* map = CurrentOrNull(); map != nullptr) return map;
  CreateNewMap();
  return CurrentOrNull();
}

std::vector<Map*> Atlas::GetAllMaps() {
  const Lock lock(mutex_);
  std::vector<Map*> maps;
  for (const auto& map : maps_) maps.push_back(map.get());
  std::stable_sort(maps.begin(), maps.end(), [](Map* a, Map* b) { return a->GetId() < b->GetId(); });
  return maps;
}

int Atlas::CountMaps() {
  const Lock lock(mutex_);
  return static_cast<int>(maps_.size());
}

long unsigned int Atlas::GetLastInitKFid() {
  const Lock lock(mutex_);
  return record_.next_ids.initial_keyframe;
}

void Atlas::SetMapBad(Map* pMap) {
  const Change change(runtime_.gate);
  const Lock lock(mutex_);
  const auto found = std::find_if(maps_.begin(), maps_.end(), [&](const auto& map) { return map.get() == pMap; });
  if (found == maps_.end()) return;
  pMap->SetBad();
  bad_maps_.push_back(std::move(*found));
  maps_.erase(found);
  if (current_ == pMap) current_ = nullptr;
  lists_as_recorded_ = false;
}

void Atlas::RemoveBadMaps() {
  const ClosedGate closed(runtime_.gate);
  const Lock lock(mutex_);
  const auto goes = [&](Map* map) {
    return std::any_of(bad_maps_.begin(), bad_maps_.end(), [&](const auto& bad) { return bad.get() == map; });
  };
  Bridge::ForgetChanges(runtime_, goes);
  for (auto& map : bad_maps_)
    if (map->DeleteListed()) buried_maps_.push_back(std::move(map));
  bad_maps_.clear();
  if (!maps_.empty()) return;
  buried_maps_.clear();
  loaded_observers_.clear();  // points of a map may go over to another one
}

void Atlas::clearMap() { GetCurrentMap()->clear(); }

void Atlas::clearAtlas() {
  {
    const Change change(runtime_.gate);
    const Lock lock(mutex_);
    for (auto& map : maps_) {
      map->SetBad();
      bad_maps_.push_back(std::move(map));
    }
    maps_.clear();
    current_ = nullptr;
    record_.next_ids.initial_keyframe = 0;
    lists_as_recorded_ = false;
  }
  RemoveBadMaps();
}

// ---- all maps

std::map<long unsigned int, KeyFrame*> Atlas::GetAtlasKeyframes() {
  std::map<long unsigned int, KeyFrame*> keyframes;
  for (Map* map : GetAllMaps())
    for (KeyFrame* keyframe : map->GetAllKeyFrames()) keyframes.emplace(keyframe->mnId, keyframe);
  return keyframes;
}

long unsigned int Atlas::GetNumLivedKF() {
  long unsigned int count = 0;
  for (Map* map : GetAllMaps()) count += map->KeyFramesInMap();
  return count;
}

long unsigned int Atlas::GetNumLivedMP() {
  long unsigned int count = 0;
  for (Map* map : GetAllMaps()) count += map->MapPointsInMap();
  return count;
}

void Atlas::PreSave() {
  const std::vector<GeometricCamera*> all = GetAllCameras();
  std::set<GeometricCamera*> cameras(all.begin(), all.end());
  for (Map* map : GetAllMaps()) map->PreSave(cameras);
}

PostLoadReport Atlas::PostLoad() {
  std::map<unsigned int, GeometricCamera*> cameras;
  for (GeometricCamera* camera : GetAllCameras()) cameras.emplace(camera->GetId(), camera);
  PostLoadReport report;
  for (Map* map : GetAllMaps()) report.Append(map->PostLoad(GetKeyFrameDatabase(), GetORBVocabulary(), cameras));
  return report;
}

// ---- the current map

void Atlas::AddKeyFrame(KeyFrame* pKF) {
  RequireOwn(pKF, runtime_, "the keyframe");
  MapOf(*pKF).AddKeyFrame(pKF);
}

void Atlas::AddMapPoint(MapPoint* pMP) {
  RequireOwn(pMP, runtime_, "the point");
  MapOf(*pMP).AddMapPoint(pMP);
}

std::vector<KeyFrame*> Atlas::GetAllKeyFrames() { return Ask(CurrentOrNull(), &Map::GetAllKeyFrames); }
std::vector<MapPoint*> Atlas::GetAllMapPoints() { return Ask(CurrentOrNull(), &Map::GetAllMapPoints); }
std::vector<MapPoint*> Atlas::GetReferenceMapPoints() { return Ask(CurrentOrNull(), &Map::GetReferenceMapPoints); }
void Atlas::SetReferenceMapPoints(const std::vector<MapPoint*>& vpMPs) {
  GetCurrentMap()->SetReferenceMapPoints(vpMPs);
}
long unsigned int Atlas::KeyFramesInMap() { return Ask(CurrentOrNull(), &Map::KeyFramesInMap); }
long unsigned int Atlas::MapPointsInMap() { return Ask(CurrentOrNull(), &Map::MapPointsInMap); }
void Atlas::InformNewBigChange() { GetCurrentMap()->InformNewBigChange(); }
int Atlas::GetLastBigChangeIdx() { return Ask(CurrentOrNull(), &Map::GetLastBigChangeIdx); }
bool Atlas::isInertial() { return Ask(CurrentOrNull(), &Map::IsInertial); }
bool Atlas::isImuInitialized() { return Ask(CurrentOrNull(), &Map::isImuInitialized); }
void Atlas::SetInertialSensor() { GetCurrentMap()->SetInertialSensor(); }
void Atlas::SetImuInitialized() { GetCurrentMap()->SetImuInitialized(); }

// ---- cameras, vocabulary

GeometricCamera* Atlas::AddCamera(GeometricCamera* pCam) {
  if (pCam == nullptr) RefuseNull("the camera");
  if (pCam->owner_ != nullptr) RequireOwn(pCam, runtime_, "the camera");
  const Change change(runtime_.gate);
  const Lock lock(mutex_);
  const auto is_it = [&](const auto& camera) { return camera.get() == pCam; };
  if (std::any_of(cameras_.begin(), cameras_.end(), is_it)) return pCam;
  pCam->owner_ = &runtime_;
  for (const auto& camera : cameras_) {
    if (!camera->IsEqual(*pCam)) continue;
    if (std::none_of(spare_cameras_.begin(), spare_cameras_.end(), is_it)) spare_cameras_.emplace_back(pCam);
    return camera.get();
  }
  cameras_.emplace_back(pCam);
  pCam->record_.id = CameraId(runtime_.camera_ids.Next());
  lists_as_recorded_ = false;
  return pCam;
}

GeometricCamera* Atlas::FindCamera(CameraId id) {
  for (const auto& camera : cameras_)
    if (camera->record().id == id && id) return camera.get();
  return nullptr;
}

std::vector<GeometricCamera*> Atlas::GetAllCameras() {
  const Lock lock(mutex_);
  std::vector<GeometricCamera*> cameras;
  for (const auto& camera : cameras_) cameras.push_back(camera.get());
  return cameras;
}

void Atlas::SetORBVocabulary(ORBVocabulary* pORBVoc) {
  const Lock lock(mutex_);
  vocabulary_ = pORBVoc;
}

ORBVocabulary* Atlas::GetORBVocabulary() {
  const Lock lock(mutex_);
  return vocabulary_;
}

void Atlas::SetKeyFrameDababase(KeyFrameDatabase* pKFDB) {
  const Lock lock(mutex_);
  database_ = pKFDB;
}

KeyFrameDatabase* Atlas::GetKeyFrameDatabase() {
  const Lock lock(mutex_);
  return database_;
}

void Atlas::SetVocabulary(Vocabulary vocabulary) {
  const Change change(runtime_.gate);
  const Lock lock(mutex_);
  record_.vocabulary = std::move(vocabulary);
}

Vocabulary Atlas::GetVocabulary() {
  const Lock lock(mutex_);
  return record_.vocabulary;
}

}  // namespace slamdb::live
