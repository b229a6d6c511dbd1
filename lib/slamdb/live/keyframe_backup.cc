// SPDX-License-Identifier: BSD-3-Clause
// A keyframe's links as ids in its mBackup members, for programs that write and read keyframes by themselves.
#include <algorithm>
#include <utility>

#include "slamdb/live/camera.h"
#include "slamdb/live/detail/keyframe_record.h"
#include "slamdb/live/detail/link_targets.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map_point.h"

namespace slamdb::live {

using Lock = std::lock_guard<std::mutex>;

namespace {

constexpr long long int kNone = -1;
constexpr unsigned int kNoCamera = ~0U;

template <class Object>
long long int BackupOf(Object* object, const std::set<Object*>& objects) {
  return object != nullptr && objects.contains(object) ? static_cast<long long int>(object->mnId) : kNone;
}

std::vector<long unsigned int> BackupOf(const std::vector<KeyFrame*>& targets, const std::set<KeyFrame*>& keyframes) {
  std::vector<long unsigned int> ids;
  for (KeyFrame* target : targets)
    if (keyframes.contains(target)) ids.push_back(target->mnId);
  return ids;
}

unsigned int BackupOf(GeometricCamera* camera, const std::set<GeometricCamera*>& cameras) {
  return camera != nullptr && cameras.contains(camera) ? camera->GetId() : kNoCamera;
}

// What a backup member says, which says nothing afterwards.
KeyFrameId Take(long long int& backup) {
  const long long int id = std::exchange(backup, kNone);
  return id < 0 ? KeyFrameId() : KeyFrameId(static_cast<std::uint64_t>(id));
}

Column<KeyFrameId> Take(std::vector<long unsigned int>& backup) {
  Column<KeyFrameId> ids;
  for (const long unsigned int id : std::exchange(backup, {})) ids.push_back(KeyFrameId(id));
  return ids;
}

CameraId Take(unsigned int& backup) {
  const unsigned int id = std::exchange(backup, kNoCamera);
  return id == kNoCamera ? CameraId() : CameraId(id);
}

}  // namespace

void KeyFrame::PreSave(std::set<KeyFrame*>& spKF, std::set<MapPoint*>& spMP, std::set<GeometricCamera*>& spCam) {
  {
    const Lock lock(mutex_features_);
    mvBackupMapPointsId.clear();
    for (MapPoint* point : slots_) mvBackupMapPointsId.push_back(BackupOf(point, spMP));
  }
  const Lock lock(mutex_connections_);
  mBackupConnectedKeyFrameIdWeights.clear();
  for (const Covisible& covisible : connections_)
    if (spKF.contains(covisible.keyframe))
      mBackupConnectedKeyFrameIdWeights[covisible.keyframe->mnId] = covisible.weight;
  mBackupParentId = BackupOf(parent_, spKF);
  mvBackupChildrensId = BackupOf(children_, spKF);
  mvBackupLoopEdgesId = BackupOf(loop_edges_, spKF);
  mvBackupMergeEdgesId = BackupOf(merge_edges_, spKF);
  mBackupPrevKFId = BackupOf(mPrevKF, spKF);
  mBackupNextKFId = BackupOf(mNextKF, spKF);
  mnBackupIdCamera = BackupOf(mpCamera, spCam);
  mnBackupIdCamera2 = BackupOf(mpCamera2, spCam);
}

void KeyFrame::TakeBackups() {
  features_.map_points.assign(slots_.size(), MapPointId());
  const std::vector<long long int> slots = std::exchange(mvBackupMapPointsId, {});
  for (std::size_t row = 0; row < std::min(slots.size(), slots_.size()); ++row)
    if (slots[row] >= 0) features_.map_points[row] = MapPointId(static_cast<std::uint64_t>(slots[row]));
  std::fill(slots_.begin(), slots_.end(), nullptr);
  unresolved_slots_.clear();

  record_.connections.clear();
  for (const auto& [id, weight] : std::exchange(mBackupConnectedKeyFrameIdWeights, {}))
    record_.connections.push_back({KeyFrameId(id), weight});
  record_.parent = Take(mBackupParentId);
  record_.children = Take(mvBackupChildrensId);
  record_.loop_edges = Take(mvBackupLoopEdgesId);
  record_.merge_edges = Take(mvBackupMergeEdgesId);
  record_.previous = Take(mBackupPrevKFId);
  record_.next = Take(mBackupNextKFId);
  record_.camera = Take(mnBackupIdCamera);
  record_.right_camera = Take(mnBackupIdCamera2);
  connections_.clear();
  children_.clear();
  loop_edges_.clear();
  merge_edges_.clear();
  parent_ = mPrevKF = mNextKF = nullptr;
}

void KeyFrame::FindCameras(const std::map<unsigned int, GeometricCamera*>& cameras) {
  const auto find = [&](CameraId id) -> GeometricCamera* {
    const auto found = id ? cameras.find(static_cast<unsigned int>(id.value())) : cameras.end();
    return found == cameras.end() || found->second == nullptr || !found->second->IsOf(runtime()) ? nullptr
                                                                                                 : found->second;
  };
  mpCamera = find(record_.camera);
  mpCamera2 = find(record_.right_camera);
}

PostLoadReport KeyFrame::PostLoad(std::map<long unsigned int, KeyFrame*>& mpKFid,
                                  std::map<long unsigned int, MapPoint*>& mpMPid,
                                  std::map<unsigned int, GeometricCamera*>& mpCamId) {
  PostLoadReport report;
  const Change change(runtime().gate);
  {
    const Lock features(mutex_features_);
    const Lock connections(mutex_connections_);
    TakeBackups();
    FindCameras(mpCamId);
    Link(IdMaps{mpKFid, mpMPid, runtime()}, report);
  }
  MarkChanged();
  return report;
}

}  // namespace slamdb::live
