// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"

// How the ids of a point's record become pointers. A template over what finds the targets.
namespace slamdb::live {

template <class Targets>
void MapPoint::Link(const slamdb::MapPoint& record, const Targets& targets, Column<Observer>& block,
                    PostLoadReport& report) {
  unresolved_.reset();
  const auto rest = [this]() -> slamdb::MapPoint& {
    if (unresolved_ == nullptr) unresolved_ = std::make_unique<slamdb::MapPoint>();
    return *unresolved_;
  };
  const auto miss = [&](LinkKind kind, std::uint64_t target) {
    const Map* map = map_;
    if (!bad_) report.Add({kind, map == nullptr ? MapId() : MapId(map->GetId()), {}, MapPointId(mnId), target});
  };
  const std::size_t first = block.size();
  for (const Observation& observation : record.observations) {
    KeyFrame* keyframe = bad_ ? nullptr : targets.Find(observation.keyframe);
    if (keyframe != nullptr && !keyframe->isBad() && keyframe->HasRows(observation) &&
        (block.size() == first || block.back().keyframe->mnId < keyframe->mnId)) {
      block.push_back({keyframe, observation.left, observation.right});
    } else {
      rest().observations.push_back(observation);
      miss(LinkKind::kObservation, observation.keyframe.value());
    }
  }
  observations_.Place(std::span(block).subspan(first));
  reference_ = bad_ ? nullptr : targets.Find(record.reference);
  if (reference_ == nullptr) {
    rest().reference = record.reference;
    miss(LinkKind::kReference, record.reference.value());
  }
  replaced_ = bad_ ? nullptr : targets.Find(record.replaced_by);
  if (replaced_ == nullptr && record.replaced_by) {
    rest().replaced_by = record.replaced_by;
    miss(LinkKind::kReplacement, record.replaced_by.value());
  }
}

}  // namespace slamdb::live
