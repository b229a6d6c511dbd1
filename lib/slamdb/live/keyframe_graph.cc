// SPDX-License-Identifier: BSD-3-Clause
// How keyframes hang together: covisibility, spanning tree, loop and merge edges, and leaving all of them.
#include <algorithm>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/live/detail/own.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"

namespace slamdb::live {
namespace {

constexpr const char* kTheKeyFrame = "the keyframe";

constexpr int kStrongWeight = 15;  // shared points of a covisible

template <class Object>
void AddOnce(std::vector<Object*>& list, Object* object) {
  if (std::find(list.begin(), list.end(), object) == list.end()) list.push_back(object);
}

std::vector<KeyFrame*> ById(std::vector<KeyFrame*> keyframes) {
  std::sort(keyframes.begin(), keyframes.end(), [](KeyFrame* a, KeyFrame* b) { return a->mnId < b->mnId; });
  return keyframes;
}

}  // namespace

using Lock = std::lock_guard<std::mutex>;

// ---- covisibility

std::vector<KeyFrame::Covisible>::iterator KeyFrame::FindConnection(const KeyFrame* keyframe) {
  return std::lower_bound(connections_.begin(), connections_.end(), keyframe->mnId,
                          [](const Covisible& covisible, std::uint64_t id) { return covisible.keyframe->mnId < id; });
}

void KeyFrame::AddConnection(KeyFrame* pKF, int weight) {
  RequireOwn(pKF, runtime(), kTheKeyFrame);
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_connections_);
    const auto place = FindConnection(pKF);
    if (place == connections_.end() || place->keyframe != pKF) {
      connections_.insert(place, {pKF, weight});
    } else if (place->weight != weight) {
      place->weight = weight;
    } else {
      return;
    }
    OrderCovisibles();
  }
  MarkChanged();
}

void KeyFrame::EraseConnection(KeyFrame* pKF) {
  if (pKF == nullptr) return;
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_connections_);
    const auto place = FindConnection(pKF);
    if (place == connections_.end() || place->keyframe != pKF) return;
    connections_.erase(place);
    OrderCovisibles();
  }
  MarkChanged();
}

void KeyFrame::UpdateBestCovisibles() {
  const Lock lock(mutex_connections_);
  OrderCovisibles();
}

void KeyFrame::OrderCovisibles() {
  ordered_.clear();
  for (const Covisible& covisible : connections_)
    if (!covisible.keyframe->isBad()) ordered_.push_back(covisible);
  std::stable_sort(ordered_.begin(), ordered_.end(), IsBetterCovisible);
}

std::vector<KeyFrame::Covisible> KeyFrame::CountSharedPoints() {
  std::vector<KeyFrame*> observers;  // one entry for each shared point
  for (MapPoint* point : GoodPoints())
    for (const Observer& observer : point->CopyObservers())
      if (observer.keyframe != this && !observer.keyframe->isBad() && observer.keyframe->GetMap() == GetMap())
        observers.push_back(observer.keyframe);
  std::vector<Covisible> counted;
  for (KeyFrame* keyframe : ById(std::move(observers))) {
    if (counted.empty() || counted.back().keyframe != keyframe) counted.push_back({keyframe, 0});
    ++counted.back().weight;
  }
  return counted;
}

void KeyFrame::UpdateConnections() {
  const Change change(runtime().gate);
  Map* const map = GetMap();
  if (map == nullptr) return;
  const std::vector<Covisible> counted = CountSharedPoints();
  if (counted.empty()) return;
  std::vector<Covisible> strong;
  for (const Covisible& covisible : counted)
    if (covisible.weight >= kStrongWeight) strong.push_back(covisible);
  if (strong.empty())
    strong.push_back(*std::max_element(counted.begin(), counted.end(),
                                       [](const Covisible& a, const Covisible& b) { return a.weight < b.weight; }));
  for (const Covisible& covisible : strong) covisible.keyframe->AddConnection(this, covisible.weight);
  std::sort(strong.begin(), strong.end(), IsBetterCovisible);

  KeyFrame* parent = nullptr;
  const bool is_root = mnId == map->GetInitKFid();
  {
    const Lock lock(mutex_connections_);
    connections_ = counted;
    ordered_ = strong;
    if (record_.first_connection && !is_root) {
      parent = parent_ = strong.front().keyframe;
      record_.first_connection = false;
    }
  }
  if (parent != nullptr) parent->AddChild(this);
  MarkChanged();
}

std::set<KeyFrame*> KeyFrame::GetConnectedKeyFrames() {
  const Lock lock(mutex_connections_);
  std::set<KeyFrame*> keyframes;
  for (const Covisible& covisible : connections_) keyframes.insert(covisible.keyframe);
  return keyframes;
}

std::vector<KeyFrame*> KeyFrame::GetVectorCovisibleKeyFrames() {
  return GetBestCovisibilityKeyFrames(std::numeric_limits<int>::max());
}

std::vector<KeyFrame*> KeyFrame::GetBestCovisibilityKeyFrames(int count) {
  const Lock lock(mutex_connections_);
  std::vector<KeyFrame*> keyframes;
  for (const Covisible& covisible : ordered_) {
    if (static_cast<int>(keyframes.size()) >= count) break;
    keyframes.push_back(covisible.keyframe);
  }
  return keyframes;
}

std::vector<KeyFrame*> KeyFrame::GetCovisiblesByWeight(int w) {
  const Lock lock(mutex_connections_);
  std::vector<KeyFrame*> keyframes;
  for (const Covisible& covisible : ordered_) {
    if (covisible.weight < w) break;
    keyframes.push_back(covisible.keyframe);
  }
  return keyframes;
}

int KeyFrame::GetWeight(KeyFrame* pKF) {
  if (pKF == nullptr) return 0;
  const Lock lock(mutex_connections_);
  const auto place = FindConnection(pKF);
  return place != connections_.end() && place->keyframe == pKF ? place->weight : 0;
}

// ---- spanning tree

void KeyFrame::SetFirstConnection(bool bFirst) {
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_connections_);
    record_.first_connection = bFirst;
  }
  MarkChanged();
}

void KeyFrame::AddChild(KeyFrame* pKF) {
  RequireOwn(pKF, runtime(), kTheKeyFrame);
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_connections_);
    AddOnce(children_, pKF);
  }
  MarkChanged();
}

void KeyFrame::EraseChild(KeyFrame* pKF) {
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_connections_);
    std::erase(children_, pKF);
  }
  MarkChanged();
}

void KeyFrame::ChangeParent(KeyFrame* pKF) {
  if (pKF == this)
    throw Error(ErrorKind::kUsage,
                slamdb::detail::Concat("kf ", mnId, " cannot be its own parent in the spanning tree"));
  if (pKF != nullptr) RequireOwn(pKF, runtime(), kTheKeyFrame);
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_connections_);
    parent_ = pKF;
  }
  if (pKF != nullptr) pKF->AddChild(this);
  MarkChanged();
}

std::set<KeyFrame*> KeyFrame::GetChilds() {
  const Lock lock(mutex_connections_);
  return {children_.begin(), children_.end()};
}

KeyFrame* KeyFrame::GetParent() {
  const Lock lock(mutex_connections_);
  return parent_;
}

bool KeyFrame::hasChild(KeyFrame* pKF) {
  const Lock lock(mutex_connections_);
  return std::find(children_.begin(), children_.end(), pKF) != children_.end();
}

// ---- loop and merge edges

void KeyFrame::AddLoopEdge(KeyFrame* pKF) {
  RequireOwn(pKF, runtime(), kTheKeyFrame);
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_connections_);
    record_.not_erase = true;
    AddOnce(loop_edges_, pKF);
  }
  MarkChanged();
}

std::set<KeyFrame*> KeyFrame::GetLoopEdges() {
  const Lock lock(mutex_connections_);
  return {loop_edges_.begin(), loop_edges_.end()};
}

void KeyFrame::AddMergeEdge(KeyFrame* pKF) {
  RequireOwn(pKF, runtime(), kTheKeyFrame);
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_connections_);
    record_.not_erase = true;
    AddOnce(merge_edges_, pKF);
  }
  MarkChanged();
}

std::set<KeyFrame*> KeyFrame::GetMergeEdges() {
  const Lock lock(mutex_connections_);
  return {merge_edges_.begin(), merge_edges_.end()};
}

// ---- going bad

void KeyFrame::SetNotErase() {
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_connections_);
    record_.not_erase = true;
  }
  MarkChanged();
}

void KeyFrame::SetErase() {
  const Change change(runtime().gate);
  bool erase = false;
  {
    const Lock lock(mutex_connections_);
    if (loop_edges_.empty()) record_.not_erase = false;
    erase = record_.to_be_erased;
  }
  MarkChanged();
  if (erase) SetBadFlag();
}

void KeyFrame::SetBadFlag() {
  const Change change(runtime().gate);
  Map* const map = GetMap();
  if (bad_ || (map != nullptr && mnId == map->GetInitKFid())) return;
  bool is_kept = false;
  {
    const Lock lock(mutex_connections_);
    is_kept = record_.not_erase;
    if (is_kept) record_.to_be_erased = true;
  }
  MarkChanged();
  if (!is_kept) LeaveGraph();
}

void KeyFrame::LeaveGraph() {
  std::vector<Covisible> connections;
  {
    const Lock lock(mutex_connections_);
    connections = connections_;
  }
  for (const Covisible& covisible : connections) covisible.keyframe->EraseConnection(this);
  for (MapPoint* point : GetMapPointMatches())
    if (point != nullptr) point->EraseObservation(this);
  GiveChildrenAway();
  KeyFrame* parent = nullptr;
  {
    const Lock lock(mutex_connections_);
    connections_.clear();
    ordered_.clear();
    children_.clear();
    parent = parent_;
  }
  if (parent != nullptr) {
    parent->EraseChild(this);
    const Rigid3f camera_from_parent = GetPose() * parent->GetPoseInverse();
    const Lock lock(mutex_pose_);
    mTcp = camera_from_parent;
  }
  bad_ = true;
  if (database_ != nullptr) database_->erase(this);
  if (Map* map = GetMap(); map != nullptr) map->EraseKeyFrame(this);
}

// Step by step, the child that shares most with the parent, or with a child that has a new parent already, goes there.
// Children that share with none of them go to the parent.
void KeyFrame::GiveChildrenAway() {
  std::vector<KeyFrame*> children, candidates;
  {
    const Lock lock(mutex_connections_);
    children = ById(children_);
    if (parent_ != nullptr) candidates.push_back(parent_);
  }
  KeyFrame* const parent = candidates.empty() ? nullptr : candidates.front();
  for (;;) {
    KeyFrame *best_child = nullptr, *best_parent = nullptr;
    int best_weight = -1;
    for (KeyFrame* child : children) {
      if (child->isBad()) continue;
      for (KeyFrame* covisible : child->GetVectorCovisibleKeyFrames()) {
        if (std::find(candidates.begin(), candidates.end(), covisible) == candidates.end()) continue;
        const int weight = child->GetWeight(covisible);
        if (weight <= best_weight) continue;
        best_weight = weight;
        best_child = child;
        best_parent = covisible;
      }
    }
    if (best_child == nullptr) break;
    best_child->ChangeParent(best_parent);
    candidates.push_back(best_child);
    std::erase(children, best_child);
  }
  for (KeyFrame* child : children)
    if (child != parent) child->ChangeParent(parent);
}

}  // namespace slamdb::live
