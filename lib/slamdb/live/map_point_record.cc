// SPDX-License-Identifier: BSD-3-Clause
// A map point and its record at rest.
#include "slamdb/live/detail/map_point_record.h"

#include <algorithm>
#include <utility>

#include "slamdb/live/detail/link_filter.h"
#include "slamdb/live/detail/link_targets.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"

namespace slamdb::live {

using Lock = std::lock_guard<std::mutex>;

MapPoint::MapPoint(const slamdb::MapPoint& record, Map* map) : MapPoint(*map, record.id.value()) { ReadValues(record); }

void MapPoint::ReadValues(const slamdb::MapPoint& record) {
  mnFirstKFid = record.first_keyframe;
  mnFirstFrame = record.first_frame;
  nObs = record.observation_count;
  position_ = record.position;
  normal_ = record.normal;
  min_distance_ = record.min_distance;
  max_distance_ = record.max_distance;
  descriptor_ = record.descriptor;
  descriptor_form_ = record.descriptor_form;
  recorded_bad_ = record.bad;
  bad_ = record.bad;
  has_visible_ = record.visible_count != slamdb::MapPoint::kNoCount;
  has_found_ = record.found_count != slamdb::MapPoint::kNoCount;
  visible_ = has_visible_ ? record.visible_count : 1;
  found_ = has_found_ ? record.found_count : 1;
  if (record.origin_map != slamdb::MapPoint::kNoOrigin)
    mnOriginMapId = record.origin_map;
  else
    assumed_origin_ = mnOriginMapId;
}

void MapPoint::WriteValues(slamdb::MapPoint& record) const {
  record.id = MapPointId(mnId);
  record.first_keyframe = mnFirstKFid;
  record.first_frame = mnFirstFrame;
  record.observation_count = nObs;
  // An origin that nobody recorded is taken for the map that lists the point, so it is recorded once that is another.
  Map* const map = map_;
  if (mnOriginMapId != assumed_origin_ || (map != nullptr && map->GetId() != mnOriginMapId))
    record.origin_map = mnOriginMapId;
  if (const int visible = visible_; has_visible_ || visible != 1) record.visible_count = visible;
  if (const int found = found_; has_found_ || found != 1) record.found_count = found;
  record.position = position_;
  record.normal = normal_;
  record.descriptor = descriptor_;
  record.descriptor_form = descriptor_form_;
  record.bad = bad_ == static_cast<bool>(recorded_bad_) ? recorded_bad_ : Flag(bad_);
  record.min_distance = min_distance_;
  record.max_distance = max_distance_;
}

slamdb::MapPoint MapPoint::ToRecord(LinkFilter& links) const {
  slamdb::MapPoint record;
  WriteValues(record);
  record.observations.reserve(observations_.size());
  for (const Observer& observer : observations_)
    if (links.Has(observer.keyframe))
      record.observations.push_back({KeyFrameId(observer.keyframe->mnId), observer.left, observer.right});
  if (replaced_ != nullptr && links.Has(replaced_)) record.replaced_by = MapPointId(replaced_->mnId);
  if (unresolved_ != nullptr) WriteUnresolved(record);
  if (reference_ != nullptr && links.Has(reference_))
    record.reference = KeyFrameId(reference_->mnId);
  else if (reference_ != nullptr && !record.observations.empty())  // culled, though no observer of the point
    record.reference = record.observations.front().keyframe;
  return record;
}

void MapPoint::WriteUnresolved(slamdb::MapPoint& record) const {
  if (reference_ == nullptr) record.reference = unresolved_->reference;
  if (replaced_ == nullptr) record.replaced_by = unresolved_->replaced_by;
  const auto middle = static_cast<std::ptrdiff_t>(record.observations.size());
  record.observations.insert(record.observations.end(), unresolved_->observations.begin(),
                             unresolved_->observations.end());
  std::inplace_merge(record.observations.begin(), record.observations.begin() + middle, record.observations.end(),
                     [](const Observation& a, const Observation& b) { return a.keyframe < b.keyframe; });
}

void MapPoint::PreSave(std::set<KeyFrame*>& spKF, std::set<MapPoint*>& spMP) {
  const Lock lock(mutex_features_);
  mBackupObservationsId1.clear();
  mBackupObservationsId2.clear();
  for (const Observer& observer : observations_) {
    if (!spKF.contains(observer.keyframe)) continue;
    mBackupObservationsId1[observer.keyframe->mnId] = observer.left;
    mBackupObservationsId2[observer.keyframe->mnId] = observer.right;
  }
  const bool has_reference = reference_ != nullptr && spKF.contains(reference_);
  const bool is_replaced = replaced_ != nullptr && spMP.contains(replaced_);
  mBackupRefKFId = has_reference ? reference_->mnId : KeyFrameId::kNone;
  mBackupReplacedId = is_replaced ? static_cast<long long int>(replaced_->mnId) : -1;
}

PostLoadReport MapPoint::PostLoad(std::map<long unsigned int, KeyFrame*>& mpKFid,
                                  std::map<long unsigned int, MapPoint*>& mpMPid) {
  PostLoadReport report;
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_features_);
    slamdb::MapPoint record;
    record.reference = KeyFrameId(std::exchange(mBackupRefKFId, KeyFrameId::kNone));
    if (const long long int replaced_by = std::exchange(mBackupReplacedId, -1); replaced_by >= 0)
      record.replaced_by = MapPointId(static_cast<std::uint64_t>(replaced_by));
    for (const auto& [keyframe, left] : mBackupObservationsId1) {
      const auto right = mBackupObservationsId2.find(keyframe);
      record.observations.push_back(
          {KeyFrameId(keyframe), left, right == mBackupObservationsId2.end() ? -1 : right->second});
    }
    mBackupObservationsId1.clear();
    mBackupObservationsId2.clear();
    Column<Observer> observers;
    observers.reserve(record.observations.size());
    Link(record, IdMaps{mpKFid, mpMPid, runtime()}, observers, report);
    observations_.Own();
  }
  MarkChanged();
  return report;
}

}  // namespace slamdb::live
