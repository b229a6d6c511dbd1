// SPDX-License-Identifier: BSD-3-Clause
// What a map lists in its mBackup members, for programs that write and read maps by themselves.
#include <algorithm>
#include <utility>

#include "slamdb/live/camera.h"
#include "slamdb/live/detail/own.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"

namespace slamdb::live {

using Lock = std::lock_guard<std::mutex>;

namespace {

template <class Object>
std::set<Object*> SetOf(const std::vector<Object*>& objects) {
  return {objects.begin(), objects.end()};
}

template <class Object>
std::vector<Object*> Good(std::vector<Object*> objects) {
  std::erase_if(objects, [](Object* object) { return object->isBad(); });
  return objects;
}

// What an archive brought, without null pointers and objects of another atlas.
template <class Object>
std::vector<Object*> Usable(std::vector<Object*> objects, const Runtime& runtime) {
  std::erase_if(objects, [&](Object* object) {
    return object == nullptr || !(object->IsOf(runtime) || object->IsOf(NoAtlas()));
  });
  return objects;
}

template <class Object>
std::map<long unsigned int, Object*> ById(const std::vector<Object*>& objects) {
  std::map<long unsigned int, Object*> by_id;
  for (Object* object : objects) by_id.emplace(object->mnId, object);
  return by_id;
}

}  // namespace

void Map::PreSave(std::set<GeometricCamera*>& spCams) {
  mvpBackupKeyFrames = Good(GetAllKeyFrames());
  mvpBackupMapPoints = Good(GetAllMapPoints());
  std::set<KeyFrame*> keyframes = SetOf(mvpBackupKeyFrames);
  std::set<MapPoint*> points = SetOf(mvpBackupMapPoints);
  for (MapPoint* point : mvpBackupMapPoints) point->PreSave(keyframes, points);
  for (KeyFrame* keyframe : mvpBackupKeyFrames) keyframe->PreSave(keyframes, points, spCams);
  const auto id_of = [&](KeyFrame* keyframe) {
    return keyframe != nullptr && keyframes.contains(keyframe) ? keyframe->mnId : KeyFrameId::kNone;
  };
  const Lock lock(mutex_);
  mvBackupKeyFrameOriginsId.clear();
  for (KeyFrame* origin : mvpKeyFrameOrigins)
    if (keyframes.contains(origin)) mvBackupKeyFrameOriginsId.push_back(origin->mnId);
  mnBackupKFinitialID = id_of(initial_);
  mnBackupKFlowerID = id_of(FindLowest());
}

PostLoadReport Map::PostLoad(KeyFrameDatabase* pKFDB, ORBVocabulary* pORBVoc,
                             std::map<unsigned int, GeometricCamera*>& mpCams) {
  const Change change(runtime_.gate);
  const std::vector<KeyFrame*> keyframes = Usable(std::exchange(mvpBackupKeyFrames, {}), runtime_);
  const std::vector<MapPoint*> points = Usable(std::exchange(mvpBackupMapPoints, {}), runtime_);
  for (MapPoint* point : points) point->UpdateMap(this);
  for (KeyFrame* keyframe : keyframes) keyframe->UpdateMap(this);
  std::map<long unsigned int, KeyFrame*> keyframe_by_id = ById(keyframes);
  std::map<long unsigned int, MapPoint*> point_by_id = ById(points);

  PostLoadReport report;
  for (MapPoint* point : points) {
    AddMapPoint(point);
    report.Append(point->PostLoad(keyframe_by_id, point_by_id));
  }
  for (KeyFrame* keyframe : keyframes) {
    AddKeyFrame(keyframe);
    keyframe->SetORBVocabulary(pORBVoc);
    keyframe->SetKeyFrameDatabase(pKFDB);
    report.Append(keyframe->PostLoad(keyframe_by_id, point_by_id, mpCams));
    if (pKFDB != nullptr) pKFDB->add(keyframe);
  }
  if (keyframes.empty()) return report;
  FindBackups(keyframe_by_id, report);
  return report;
}

void Map::FindBackups(const std::map<long unsigned int, KeyFrame*>& keyframes, PostLoadReport& report) {
  const auto find = [&](long unsigned int id, LinkKind kind) -> KeyFrame* {
    const auto found = keyframes.find(id);
    if (found != keyframes.end()) return found->second;
    report.Add({kind, MapId(id_), {}, {}, id});
    return nullptr;
  };
  const Lock lock(mutex_);
  KeyFrame* initial = find(std::exchange(mnBackupKFinitialID, KeyFrameId::kNone), LinkKind::kInitialKeyFrame);
  KeyFrame* lowest = find(std::exchange(mnBackupKFlowerID, KeyFrameId::kNone), LinkKind::kLowestKeyFrame);
  if (initial != nullptr) initial_ = initial;
  if (lowest != nullptr) lowest_ = lowest;
  mvpKeyFrameOrigins.clear();
  for (const long unsigned int id : std::exchange(mvBackupKeyFrameOriginsId, {}))
    if (KeyFrame* origin = find(id, LinkKind::kOrigin); origin != nullptr) mvpKeyFrameOrigins.push_back(origin);
}

}  // namespace slamdb::live
