// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"

// How the ids of a keyframe's record become pointers. A template over what finds the targets.
namespace slamdb::live {

template <class Targets>
void KeyFrame::Link(const Targets& targets, PostLoadReport& report) {
  const Miss miss = [&](LinkKind kind, std::uint64_t target) {
    const Map* map = map_;
    report.Add({kind, map == nullptr ? MapId() : MapId(map->GetId()), KeyFrameId(mnId), {}, target});
  };
  LinkSlots(targets, miss);
  if (bad_) return;
  if (mpCamera == nullptr) miss(LinkKind::kCamera, record_.camera.value());
  if (mpCamera2 == nullptr && record_.right_camera) miss(LinkKind::kRightCamera, record_.right_camera.value());
  LinkKeyFrames(targets, miss);
  LinkConnections(targets, miss);
}

template <class Targets>
void KeyFrame::LinkSlots(const Targets& targets, const Miss& miss) {
  for (std::size_t row = 0; row < slots_.size(); ++row) {
    const MapPointId id = features_.map_points[row];
    if (!id) continue;
    slots_[row] = bad_ ? nullptr : targets.Find(id);
    if (slots_[row] != nullptr) continue;
    unresolved_slots_.emplace_back(row, id);
    if (!bad_) miss(LinkKind::kSlot, id.value());
  }
  features_.map_points = {};
}

template <class Targets>
void KeyFrame::LinkKeyFrames(const Targets& targets, const Miss& miss) {
  const auto link = [&](KeyFrameId& id, KeyFrame*& target, LinkKind kind) {
    if (!id) return;
    target = targets.Find(id);
    if (target == nullptr) return miss(kind, id.value());
    id = {};
  };
  link(record_.parent, parent_, LinkKind::kParent);
  link(record_.previous, mPrevKF, LinkKind::kPrevious);
  link(record_.next, mNextKF, LinkKind::kNext);
  const auto link_all = [&](Column<KeyFrameId>& ids, std::vector<KeyFrame*>& found, LinkKind kind) {
    Column<KeyFrameId> unresolved;
    for (const KeyFrameId id : ids) {
      if (KeyFrame* target = targets.Find(id); target != nullptr) {
        found.push_back(target);
      } else {
        unresolved.push_back(id);
        miss(kind, id.value());
      }
    }
    ids = std::move(unresolved);
  };
  link_all(record_.children, children_, LinkKind::kChild);
  link_all(record_.loop_edges, loop_edges_, LinkKind::kLoopEdge);
  link_all(record_.merge_edges, merge_edges_, LinkKind::kMergeEdge);
}

template <class Targets>
void KeyFrame::LinkConnections(const Targets& targets, const Miss& miss) {
  Column<Connection> unresolved;
  for (const Connection& connection : record_.connections) {
    KeyFrame* target = targets.Find(connection.keyframe);
    if (target != nullptr && (connections_.empty() || connections_.back().keyframe->mnId < target->mnId)) {
      connections_.push_back({target, connection.weight});
    } else {
      unresolved.push_back(connection);
      miss(LinkKind::kConnection, connection.keyframe.value());
    }
  }
  record_.connections = std::move(unresolved);
  OrderCovisibles();
}

}  // namespace slamdb::live
