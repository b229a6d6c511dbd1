// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"

// How the ids of a point's record become pointers. Private to the folder: a template over what finds the targets.
namespace slamdb::live {

template <class Targets>
void MapPoint::Link(const slamdb::MapPoint& record, const Targets& targets, PostLoadReport& report) {
  slamdb::MapPoint rest;
  bool complete = true;
  const auto miss = [&](LinkKind kind, std::uint64_t target) {
    report.Add({kind, MapId(map_.load()->GetId()), {}, MapPointId(mnId), target});
    complete = false;
  };
  observations_.clear();
  observations_.reserve(record.observations.size());
  for (const Observation& observation : record.observations) {
    KeyFrame* keyframe = bad_ ? nullptr : targets.Find(observation.keyframe);
    if (keyframe != nullptr && !keyframe->isBad() && keyframe->HasRows(observation) &&
        (observations_.empty() || observations_.back().keyframe->mnId < observation.keyframe.value())) {
      observations_.push_back({keyframe, observation.left, observation.right});
    } else {
      if (!bad_) miss(LinkKind::kObservation, observation.keyframe.value());
      complete = false;
      rest.observations.push_back(observation);
    }
  }
  reference_ = bad_ ? nullptr : targets.Find(record.reference);
  replaced_ = bad_ ? nullptr : targets.Find(record.replaced_by);
  if (reference_ == nullptr) rest.reference = record.reference;
  if (replaced_ == nullptr) rest.replaced_by = record.replaced_by;
  if (bad_) {
    complete = false;
  } else {
    if (reference_ == nullptr) miss(LinkKind::kReference, record.reference.value());
    if (replaced_ == nullptr && record.replaced_by) miss(LinkKind::kReplacement, record.replaced_by.value());
  }
  unresolved_ = complete ? nullptr : std::make_unique<slamdb::MapPoint>(std::move(rest));
}

}  // namespace slamdb::live
