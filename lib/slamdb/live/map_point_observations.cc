// SPDX-License-Identifier: BSD-3-Clause
// Who sees a map point: observations, going bad, being replaced, the descriptor that follows from them.
#include <algorithm>

#include "slamdb/live/detail/own.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"
#include "slamdb/model/derive.h"

namespace slamdb::live {

using Lock = std::lock_guard<std::mutex>;

Observer* MapPoint::FindObserver(const KeyFrame* keyframe) {
  return std::lower_bound(observations_.begin(), observations_.end(), keyframe->mnId,
                          [](const Observer& observer, std::uint64_t id) { return observer.keyframe->mnId < id; });
}

bool MapPoint::Has(const Observer* observer, const KeyFrame* keyframe) const {
  return observer != observations_.end() && observer->keyframe == keyframe;
}

std::vector<Observer> MapPoint::CopyObservers() {
  const Lock lock(mutex_features_);
  return {observations_.begin(), observations_.end()};
}

void MapPoint::AddObservation(KeyFrame* pKF, int idx) {
  RequireOwn(pKF, runtime(), "the keyframe");
  pKF->RequireRow(static_cast<std::size_t>(idx));
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_features_);
    if (unresolved_ != nullptr)
      std::erase_if(unresolved_->observations,
                    [&](const Observation& observation) { return observation.keyframe.value() == pKF->mnId; });
    auto observer = FindObserver(pKF);
    if (!Has(observer, pKF)) observer = observations_.Insert(observer, {pKF});
    const int before = pKF->WeightOfObservation(observer->left, observer->right);
    (pKF->NLeft != -1 && idx >= pKF->NLeft ? observer->right : observer->left) = idx;
    nObs += pKF->WeightOfObservation(observer->left, observer->right) - before;
  }
  MarkChanged();
}

void MapPoint::EraseObservation(KeyFrame* pKF) {
  if (pKF == nullptr) return;
  const Change change(runtime().gate);
  bool too_few = false;
  {
    const Lock lock(mutex_features_);
    const auto observer = FindObserver(pKF);
    if (!Has(observer, pKF)) return;
    nObs -= pKF->WeightOfObservation(observer->left, observer->right);
    observations_.Erase(observer);
    if (reference_ == pKF) reference_ = observations_.empty() ? nullptr : observations_.begin()->keyframe;
    too_few = nObs <= 2;
  }
  MarkChanged();
  if (too_few) SetBadFlag();
}

std::map<KeyFrame*, std::tuple<int, int>> MapPoint::GetObservations() {
  std::map<KeyFrame*, std::tuple<int, int>> observations;
  for (const Observer& observer : CopyObservers()) observations[observer.keyframe] = {observer.left, observer.right};
  return observations;
}

int MapPoint::Observations() {
  const Lock lock(mutex_features_);
  return nObs;
}

std::tuple<int, int> MapPoint::GetIndexInKeyFrame(KeyFrame* pKF) {
  if (pKF == nullptr) return {-1, -1};
  const Lock lock(mutex_features_);
  const auto observer = FindObserver(pKF);
  if (!Has(observer, pKF)) return {-1, -1};
  return {observer->left, observer->right};
}

bool MapPoint::IsInKeyFrame(KeyFrame* pKF) {
  if (pKF == nullptr) return false;
  const Lock lock(mutex_features_);
  return Has(FindObserver(pKF), pKF);
}

void MapPoint::SetBadFlag() {
  const Change change(runtime().gate);
  std::vector<Observer> observers;
  {
    const Lock lock(mutex_features_);
    bad_ = true;
    observers = observations_.Take();
  }
  for (const Observer& observer : observers) {
    if (observer.left >= 0) observer.keyframe->EraseMapPointMatch(observer.left);
    if (observer.right >= 0) observer.keyframe->EraseMapPointMatch(observer.right);
  }
  if (Map* map = map_; map != nullptr) map->EraseMapPoint(this);
}

void MapPoint::Replace(MapPoint* pMP) {
  RequireOwn(pMP, runtime(), "the point");
  if (pMP == this || pMP->mnId == mnId) return;
  const Change change(runtime().gate);
  std::vector<Observer> observers;
  {
    const Lock lock(mutex_features_);
    observers = observations_.Take();
    bad_ = true;
    replaced_ = pMP;
  }
  for (const Observer& observer : observers) {
    const bool is_free = !pMP->IsInKeyFrame(observer.keyframe);
    for (const std::int32_t row : {observer.left, observer.right}) {
      if (row < 0) continue;
      if (is_free) {
        observer.keyframe->ReplaceMapPointMatch(row, pMP);
        pMP->AddObservation(observer.keyframe, row);
      } else {
        observer.keyframe->EraseMapPointMatch(row);
      }
    }
  }
  pMP->IncreaseFound(found_);
  pMP->IncreaseVisible(visible_);
  pMP->ComputeDistinctiveDescriptors();
  if (Map* map = map_; map != nullptr) map->EraseMapPoint(this);
}

void MapPoint::ComputeDistinctiveDescriptors() {
  std::vector<Observer> observers;
  {
    const Lock lock(mutex_features_);
    if (bad_) return;
    observers = {observations_.begin(), observations_.end()};
  }
  std::vector<Descriptor> descriptors;
  descriptors.reserve(observers.size());
  for (const Observer& observer : observers) {
    if (observer.keyframe->isBad()) continue;
    const Column<Descriptor>& rows = observer.keyframe->features().descriptors;
    for (const std::int32_t row : {observer.left, observer.right})
      if (row >= 0 && static_cast<std::size_t>(row) < rows.size())
        descriptors.push_back(rows[static_cast<std::size_t>(row)]);
  }
  if (descriptors.empty()) return;
  const Descriptor best = descriptors[MostDistinctiveDescriptor(descriptors)];
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_features_);
    descriptor_ = best;
    if (descriptor_form_ != MatrixForm::kUsualNotContinuous) descriptor_form_ = MatrixForm::kUsual;
  }
  MarkChanged();
}

}  // namespace slamdb::live
