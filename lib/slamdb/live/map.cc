// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/map.h"

#include <algorithm>

#include "slamdb/live/detail/own.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map_point.h"

namespace slamdb::live {

using Lock = std::lock_guard<std::mutex>;

Map::Map(Runtime& runtime, std::uint64_t id, std::uint64_t initial_keyframe) : runtime_(runtime), id_(id) {
  record_.id = MapId(id);
  record_.initial_keyframe = KeyFrameId(initial_keyframe);
  record_.max_keyframe_id = initial_keyframe;
}

Map::Map(Runtime& runtime, slamdb::Map header)
    : runtime_(runtime), id_(header.id.value()), record_(std::move(header)), lists_as_recorded_(true) {}

Map::~Map() {
  DeleteListed();
  for (KeyFrame* keyframe : keyframes_.erased.ToVector()) delete keyframe;
  for (MapPoint* point : points_.erased.ToVector()) delete point;
}

bool Map::DeleteListed() {
  for (KeyFrame* keyframe : keyframes_.live.ToVector()) delete keyframe;
  for (MapPoint* point : points_.live.ToVector()) delete point;
  keyframes_.live = {};
  points_.live = {};
  reference_points_.clear();
  mvpKeyFrameOrigins.clear();
  initial_ = lowest_ = nullptr;
  return keyframes_.erased.size() + points_.erased.size() > 0;
}

// ---- lists

void Map::TakeOver(Listed* object) {
  object->owner_ = this;
  object->listed_in_ = this;
}

template <class Object>
bool Map::Add(Objects<Object>& objects, Object* object) {
  if (Map* other = object->Listed::owner_; other != nullptr && other != this) {
    other->GiveUp(other->ObjectsOf(object), object);
    object->UpdateMap(this);
    const Lock lock(mutex_);
    is_rebuilt_ = true;
  }
  const Lock lock(mutex_);
  if (object->IsListedIn(this)) return false;
  if (object->Listed::owner_ == this) {  // it was erased and comes back
    objects.erased.Remove(object);
    is_rebuilt_ = true;
  }
  objects.live.Add(object);
  TakeOver(object);
  lists_as_recorded_ = false;
  return true;
}

template <class Object>
bool Map::Erase(Objects<Object>& objects, Object* object) {
  const Lock lock(mutex_);
  if (object == nullptr || !object->IsListedIn(this)) return false;
  objects.live.Remove(object);
  objects.erased.Add(object);
  object->Listed::listed_in_ = nullptr;
  lists_as_recorded_ = false;
  return true;
}

template <class Object>
void Map::GiveUp(Objects<Object>& objects, Object* object) {
  const Lock lock(mutex_);
  (object->IsListedIn(this) ? objects.live : objects.erased).Remove(object);
  object->Listed::listed_in_ = nullptr;
  object->Listed::owner_ = nullptr;
  is_rebuilt_ = true;
  lists_as_recorded_ = false;
  Forget(object);
}

void Map::Forget(const KeyFrame* keyframe) {
  if (lowest_ == keyframe) lowest_ = nullptr;
  if (initial_ == keyframe) initial_ = FindLowest();
}

KeyFrame* Map::FindLowest() const {
  if (lowest_ != nullptr) return lowest_;
  const std::vector<KeyFrame*> all = keyframes_.live.ToVector();
  const auto least =
      std::min_element(all.begin(), all.end(), [](const KeyFrame* a, const KeyFrame* b) { return a->mnId < b->mnId; });
  return least == all.end() ? nullptr : *least;
}

void Map::AddKeyFrame(KeyFrame* pKF) {
  RequireOwn(pKF, runtime_, "the keyframe");
  const Change change(runtime_.gate);
  if (!Add(keyframes_, pKF)) return;
  {
    const Lock lock(mutex_);
    if (keyframes_.live.size() == 1) {
      record_.initial_keyframe = KeyFrameId(pKF->mnId);
      initial_ = lowest_ = pKF;
    }
    record_.max_keyframe_id = std::max<std::uint64_t>(record_.max_keyframe_id, pKF->mnId);
    if (lowest_ == nullptr) {
      lowest_ = FindLowest();
      record_.lowest_keyframe = {};  // which was missing
    }
    if (pKF->mnId < lowest_->mnId) lowest_ = pKF;
  }
  pKF->MarkChanged();
}

void Map::AddMapPoint(MapPoint* pMP) {
  RequireOwn(pMP, runtime_, "the point");
  const Change change(runtime_.gate);
  if (Add(points_, pMP)) pMP->MarkChanged();
}

void Map::EraseKeyFrame(KeyFrame* pKF) {
  const Change change(runtime_.gate);
  if (!Erase(keyframes_, pKF)) return;
  {
    const Lock lock(mutex_);
    if (lowest_ == pKF) lowest_ = nullptr;
  }
  pKF->MarkChanged();
}

void Map::EraseMapPoint(MapPoint* pMP) {
  const Change change(runtime_.gate);
  if (Erase(points_, pMP)) pMP->MarkChanged();
}

std::vector<KeyFrame*> Map::GetAllKeyFrames() {
  const Lock lock(mutex_);
  return keyframes_.live.ToVector();
}

std::vector<MapPoint*> Map::GetAllMapPoints() {
  const Lock lock(mutex_);
  return points_.live.ToVector();
}

long unsigned int Map::KeyFramesInMap() {
  const Lock lock(mutex_);
  return keyframes_.live.size();
}

long unsigned int Map::MapPointsInMap() {
  const Lock lock(mutex_);
  return points_.live.size();
}

void Map::SetReferenceMapPoints(const std::vector<MapPoint*>& vpMPs) {
  const Lock lock(mutex_);
  reference_points_ = vpMPs;
}

std::vector<MapPoint*> Map::GetReferenceMapPoints() {
  const Lock lock(mutex_);
  return reference_points_;
}

void Map::clear() {
  const Change change(runtime_.gate);
  for (MapPoint* point : GetAllMapPoints()) EraseMapPoint(point);
  for (KeyFrame* keyframe : GetAllKeyFrames()) {
    keyframe->UpdateMap(nullptr);
    EraseKeyFrame(keyframe);
  }
  const Lock lock(mutex_);
  record_.max_keyframe_id = record_.initial_keyframe.value();
  record_.imu_initialized = record_.imu_ba1 = record_.imu_ba2 = false;
  record_.origins.clear();
  record_.landmarks.clear();
  record_.first_keyframe = record_.lowest_keyframe = {};
  reference_points_.clear();
  mvpKeyFrameOrigins.clear();
  initial_ = lowest_ = nullptr;
}

// ---- identification and state

void Map::ChangeId(long unsigned int nId) {
  const Change change(runtime_.gate);
  runtime_.map_ids.Pass(nId);
  id_ = nId;
}

long unsigned int Map::GetInitKFid() {
  const Lock lock(mutex_);
  return record_.initial_keyframe.value();
}

void Map::SetInitKFid(long unsigned int initKFif) {
  const Change change(runtime_.gate);
  const Lock lock(mutex_);
  record_.initial_keyframe = KeyFrameId(initKFif);
}

long unsigned int Map::GetMaxKFid() {
  const Lock lock(mutex_);
  return record_.max_keyframe_id;
}

KeyFrame* Map::GetOriginKF() {
  const Lock lock(mutex_);
  return initial_;
}

long unsigned int Map::GetLowerKFID() {
  const Lock lock(mutex_);
  const KeyFrame* lowest = FindLowest();
  return lowest == nullptr ? 0 : lowest->mnId;
}

void Map::InformNewBigChange() {
  const Change change(runtime_.gate);
  const Lock lock(mutex_);
  ++record_.big_change_index;
}

int Map::GetLastBigChangeIdx() {
  const Lock lock(mutex_);
  return record_.big_change_index;
}

void Map::SetImuInitialized() {
  const Change change(runtime_.gate);
  const Lock lock(mutex_);
  record_.imu_initialized = true;
}

bool Map::isImuInitialized() {
  const Lock lock(mutex_);
  return record_.imu_initialized;
}

void Map::SetInertialSensor() {
  const Change change(runtime_.gate);
  const Lock lock(mutex_);
  record_.inertial = true;
}

bool Map::IsInertial() {
  const Lock lock(mutex_);
  return record_.inertial;
}

void Map::SetIniertialBA1() {
  const Change change(runtime_.gate);
  const Lock lock(mutex_);
  record_.imu_ba1 = true;
}

void Map::SetIniertialBA2() {
  const Change change(runtime_.gate);
  const Lock lock(mutex_);
  record_.imu_ba2 = true;
}

bool Map::GetIniertialBA1() {
  const Lock lock(mutex_);
  return record_.imu_ba1;
}

bool Map::GetIniertialBA2() {
  const Lock lock(mutex_);
  return record_.imu_ba2;
}

void Map::ApplyScaledRotation(const Rigid3f& T, float s, bool bScaledVel) {
  const Change change(runtime_.gate);
  const Rigid3f y_from_world = T.Normalized();
  for (KeyFrame* keyframe : GetAllKeyFrames()) {
    Rigid3f world_from_camera = keyframe->GetPoseInverse();
    world_from_camera.translation *= s;
    keyframe->SetPose((y_from_world * world_from_camera).Inverse());
    if (keyframe->isVelocitySet())
      keyframe->SetVelocity(y_from_world.rotation * keyframe->GetVelocity() * (bScaledVel ? s : 1.0F));
  }
  const std::vector<MapPoint*> points = GetAllMapPoints();
  for (MapPoint* point : points) point->SetWorldPos(y_from_world * (s * point->GetWorldPos()));
  for (MapPoint* point : points) point->UpdateNormalAndDepth();
  const Lock lock(mutex_);
  TransformLandmarks(record_.landmarks, {static_cast<double>(s), y_from_world.rotation.cast<double>(),
                                         y_from_world.translation.cast<double>()});
  ++change_index_;
}

bool Map::IsSaved() const {
  return lists_as_recorded_ || keyframes_.live.size() + points_.live.size() + record_.landmarks.size() > 0;
}

slamdb::Map Map::ToHeader(bool repeated_entries) const {
  slamdb::Map header = record_;
  header.id = MapId(id_);
  if (!repeated_entries) {
    header.repeated_keyframes.clear();
    header.repeated_points.clear();
  }
  const KeyFrame* lowest = FindLowest();
  const KeyFrame* initial = initial_ == nullptr || initial_->IsListedIn(this) ? initial_ : lowest;
  if (initial != nullptr) header.first_keyframe = KeyFrameId(initial->mnId);
  if (lowest != nullptr && !record_.lowest_keyframe) header.lowest_keyframe = KeyFrameId(lowest->mnId);
  header.origins.clear();
  for (const KeyFrame* origin : mvpKeyFrameOrigins)
    if (origin != nullptr && origin->IsListedIn(this)) header.origins.push_back(KeyFrameId(origin->mnId));
  header.origins.insert(header.origins.end(), record_.origins.begin(), record_.origins.end());
  return header;
}

}  // namespace slamdb::live
