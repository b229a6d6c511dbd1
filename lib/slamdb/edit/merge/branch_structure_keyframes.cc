// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "slamdb/edit/merge/detail/branch_structure_merge.h"

namespace slamdb::detail {
namespace {

MapPointId Unless(bool deletes, MapPointId now, MapPointId before) { return deletes && !now ? before : now; }

}  // namespace

void StructureMerge::MergeKeypoints() {
  slots_.resize(ours_map_.keyframes.size() + theirs_map_.keyframes.size());
  listed_.resize(slots_.size());
  for (std::uint32_t row = 0; row < ours_map_.keyframes.size(); ++row) {
    if (gone_keyframes_[row]) continue;
    const std::uint32_t there = theirs_.Row(ours_map_.keyframes[row].id);
    slots_[row] = ours_.sightings.Of(row);
    listed_[row].resize(slots_[row].size());
    for (std::size_t slot = 0; slot < slots_[row].size(); ++slot) MergeKeypoint(row, there, slot);
    Settle(ours_map_.keyframes[row], slots_[row], listed_[row]);
  }
  for (std::uint32_t row = 0; row < theirs_map_.keyframes.size(); ++row) {
    if (!taken_keyframes_[row]) continue;
    const std::size_t to = ours_map_.keyframes.size() + row;
    slots_[to] = theirs_.sightings.Of(row);
    listed_[to].resize(slots_[to].size());
    for (std::size_t slot = 0; slot < slots_[to].size(); ++slot)
      listed_[to][slot] = theirs_.sightings.IsListed(row, slot);
    Settle(theirs_map_.keyframes[row], slots_[to], listed_[to]);
  }
}

void StructureMerge::MergeKeypoint(std::uint32_t row, std::uint32_t there, std::size_t slot) {
  MapPointId& result = slots_[row][slot];
  std::uint8_t& listed = listed_[row][slot];
  listed = ours_.sightings.IsListed(row, slot);
  if (there == kNoRow) return;
  const KeyFrameId keyframe = ours_map_.keyframes[row].id;
  const std::uint32_t in_base = base_.Row(keyframe);
  const MapPointId before = base_.sightings.Of(in_base, slot), ours = Unless(Deletes(ours_, before), result, before),
                   theirs = Unless(Deletes(theirs_, before), theirs_.sightings.Of(there, slot), before);
  const bool take = PickKeypoint(in_base != kNoRow ? &before : nullptr, ours, theirs, keyframe, slot);
  const auto lists = [&](const View& view, std::uint32_t of) {
    return view.sightings.Of(of, slot) == result && view.sightings.IsListed(of, slot);
  };
  result = take ? theirs : ours;
  listed = lists(ours_, row) || lists(theirs_, there) || lists(base_, in_base);
}

bool StructureMerge::Deletes(const View& side, MapPointId before) {
  const Class* of = FindClass(before);
  return of != nullptr && of->fate == Fate::kKept && (&side == &ours_ ? of->ours : of->theirs) == kNoRow;
}

bool StructureMerge::PickKeypoint(const MapPointId* before, MapPointId ours, MapPointId theirs, KeyFrameId keyframe,
                                  std::size_t slot) {
  if (ours == theirs || (before && theirs == *before)) return false;
  if ((before && ours == *before) || !ours) return true;
  if (!theirs) return false;
  const bool take = options_.prefer == BranchSide::kTheirs;
  Conflict({.keyframe = keyframe, .feature = static_cast<std::int64_t>(slot)}, "point", options_.prefer);
  report_.coincide.emplace_back(take ? theirs : ours, take ? ours : theirs);
  return take;
}

void StructureMerge::Settle(const KeyFrame& keyframe, std::vector<MapPointId>& slots, Flags& listed) {
  std::vector<std::pair<MapPointId, std::size_t>> seen;
  for (std::size_t slot = 0; slot < slots.size(); ++slot) {
    if (!slots[slot]) continue;
    const Class* of = FindClass(slots[slot]);
    if (of == nullptr) ++report_.dangling;
    if (of == nullptr || of->fate == Fate::kGone)
      slots[slot] = {};
    else if (listed[slot])
      seen.emplace_back(slots[slot], slot);
  }
  std::ranges::sort(seen);
  for (std::size_t i = 1; i < seen.size(); ++i)
    if (seen[i].first == seen[i - 1].first &&
        IsRight(keyframe, seen[i].second) == IsRight(keyframe, seen[i - 1].second)) {
      slots[seen[i].second] = {};
      seen[i].second = seen[i - 1].second;
    }
}

void StructureMerge::MergeKeyFrames() {
  std::size_t at = 0;
  for (; at < ours_map_.keyframes.size(); ++at) {
    KeyFrame& keyframe = ours_map_.keyframes[at];
    if (gone_keyframes_[at]) continue;
    if (const KeyFrame* there = theirs_.Find(keyframe.id)) MergeFields(keyframe, *there);
    SetSlots(keyframe, slots_[at]);
  }
  own_keyframes_ = at;
  for (std::uint32_t row = 0; row < theirs_map_.keyframes.size(); ++row) {
    if (!taken_keyframes_[row]) continue;
    KeyFrame& keyframe = ours_map_.keyframes.emplace_back(theirs_map_.keyframes[row]);
    gone_keyframes_.push_back(0);
    SetSlots(keyframe, slots_[own_keyframes_ + row]);
    if (own_keyframes_ + row != ours_map_.keyframes.size() - 1) {
      slots_[ours_map_.keyframes.size() - 1] = std::move(slots_[own_keyframes_ + row]);
      listed_[ours_map_.keyframes.size() - 1] = std::move(listed_[own_keyframes_ + row]);
    }
  }
  slots_.resize(ours_map_.keyframes.size());
  listed_.resize(ours_map_.keyframes.size());
  CutUnlinked();
}

void StructureMerge::CutUnlinked() {
  if (unlinked_.empty()) return;
  const IdTable rows = KeyFrameTable(ours_map_);
  for (const Unlinked& each : unlinked_)
    if (const std::uint32_t row = rows.Find(each.keyframe.value());
        row != kNoRow && ours_map_.keyframes[row].*each.field == each.other)
      ours_map_.keyframes[row].*each.field = {};
}

void StructureMerge::SetSlots(KeyFrame& keyframe, const std::vector<MapPointId>& slots) {
  Column<MapPointId>& points = keyframe.features.map_points;
  if (std::ranges::equal(points, slots)) return;
  points.assign(slots.begin(), slots.end());
  changed_ = true;
}

KeyFrameId StructureMerge::Restored(const View& side, KeyFrameId before, KeyFrameId now) const {
  return before && before != now && !side.Find(before) && Stays(before) ? before : now;
}

bool StructureMerge::Take(Pick pick, const KeyFrame& keyframe, std::string_view what) {
  if (pick == Pick::kOurs) return false;
  const bool take = pick == Pick::kTheirs || options_.prefer == BranchSide::kTheirs;
  if (pick == Pick::kConflict) Conflict({.keyframe = keyframe.id}, what, options_.prefer);
  changed_ |= take;
  report_.took_any |= take;
  return take;
}

void StructureMerge::MergeFields(KeyFrame& ours, const KeyFrame& theirs) {
  const KeyFrame* before = base_.map ? base_.Find(ours.id) : nullptr;
  const auto group = [&](std::string_view what, const auto& walk) { MergeGroup(before, theirs, what, walk, ours); };
  group("camera", [](const auto& visit) { fields::ForEachCameraField(visit); });
  group("features", [](const auto& visit) {
    fields::ForEachFeatureField([&](std::string_view name, auto... members) {
      if (name != "features.map_points") visit(name, members...);
    });
  });
  group("words", [](const auto& visit) { fields::ForEachWordField(visit); });
  group("imu calibration", [](const auto& visit) { fields::ForEachImuCalibrationField(visit); });
  group("members of a fork", [](const auto& visit) { visit("carried", &KeyFrame::carried); });
  group("origin map", [](const auto& visit) { visit("origin_map", &KeyFrame::origin_map); });
  group("merge scale", [](const auto& visit) { visit("merge_scale", &KeyFrame::merge_scale); });
  group("frame", [](const auto& visit) { visit("frame_id", &KeyFrame::frame_id); });
  for (const auto flag : {&KeyFrame::first_connection, &KeyFrame::not_erase, &KeyFrame::to_be_erased, &KeyFrame::bad,
                          &KeyFrame::imu_initialized, &KeyFrame::has_velocity})
    group("flags", [flag](const auto& visit) { visit("", flag); });
  static const KeyFrame kNone;  // of what both made: what one side alone tells stands
  MergeReferences(before != nullptr ? *before : kNone, theirs, ours);
  if (before != nullptr) MergeConnections(*before, theirs, ours);
  MergeEdges(before, theirs, &KeyFrame::loop_edges, ours);
  MergeEdges(before, theirs, &KeyFrame::merge_edges, ours);
}

void StructureMerge::MergeReferences(const KeyFrame& before, const KeyFrame& theirs, KeyFrame& ours) {
  const auto merge = [&](KeyFrameId KeyFrame::*field, std::string_view what) {
    const KeyFrameId was = before.*field, our = Restored(ours_, was, ours.*field),
                     their = Restored(theirs_, was, theirs.*field);
    const bool take = Take(PickOf(&was, our, their), ours, what);
    if (const KeyFrameId now = take ? their : our; now != ours.*field) {
      ours.*field = now;
      changed_ = true;
    }
    return take;
  };
  merge(&KeyFrame::parent, "parent");
  const KeyFrameId next_of_ours = ours.next;
  merge(&KeyFrame::next, "next");
  Unlink(ours, next_of_ours, theirs.next, &KeyFrame::next, &KeyFrame::previous);
  // What the IMU measured leads to the keyframe before.
  const KeyFrameId was = ours.previous;
  if (merge(&KeyFrame::previous, "previous"))
    ours.preintegration = theirs.preintegration;
  else if (ours.previous != was)
    ours.preintegration = before.preintegration;
  Unlink(ours, was, theirs.previous, &KeyFrame::previous, &KeyFrame::next);
}

void StructureMerge::Unlink(const KeyFrame& keyframe, KeyFrameId of_ours, KeyFrameId of_theirs,
                            KeyFrameId KeyFrame::*field, KeyFrameId KeyFrame::*back) {
  for (const KeyFrameId loser : {of_ours, of_theirs})
    if (loser && loser != keyframe.*field) unlinked_.push_back({loser, keyframe.id, back});
}

void StructureMerge::MergeConnections(const KeyFrame& before, const KeyFrame& theirs, KeyFrame& ours) {
  if (std::ranges::equal(before.connections, theirs.connections)) return;
  const auto find = [](const Column<Connection>& list, KeyFrameId id) -> const Connection* {
    const auto place = std::ranges::lower_bound(list, id, {}, &Connection::keyframe);
    return place != list.end() && place->keyframe == id ? &*place : nullptr;
  };
  const auto weight = [](const Connection* connection) { return connection ? connection->weight : 0; };
  Column<Connection> merged;
  const auto add = [&](KeyFrameId id) {
    const Connection *was = find(before.connections, id), *our = find(ours.connections, id),
                     *their = find(theirs.connections, id);
    const std::int32_t base = weight(was);
    const Connection* taken = PickOf(&base, weight(our), weight(their)) == Pick::kTheirs ? their : our;
    if (taken != nullptr) merged.push_back(*taken);
  };
  auto our = ours.connections.begin();
  for (const Connection& their : theirs.connections) {
    for (; our != ours.connections.end() && our->keyframe < their.keyframe; ++our) add(our->keyframe);
    if (our != ours.connections.end() && our->keyframe == their.keyframe) ++our;
    add(their.keyframe);
  }
  for (; our != ours.connections.end(); ++our) add(our->keyframe);
  if (std::ranges::equal(merged, ours.connections)) return;
  ours.connections = std::move(merged);
  changed_ = true;
}

void StructureMerge::MergeEdges(const KeyFrame* before, const KeyFrame& theirs, Column<KeyFrameId> KeyFrame::*list,
                                KeyFrame& ours) {
  const auto has = [](const Column<KeyFrameId>& edges, KeyFrameId id) {
    return std::ranges::find(edges, id) != edges.end();
  };
  const std::size_t removed = std::erase_if(ours.*list, [&](KeyFrameId id) {
    return before != nullptr && has(before->*list, id) && !has(theirs.*list, id) && theirs_.Find(id);
  });
  std::size_t added = 0;
  for (const KeyFrameId id : theirs.*list) {
    const bool was_removed = before != nullptr && has(before->*list, id) && (ours_.Find(id) || !Stays(id));
    if (has(ours.*list, id) || was_removed) continue;
    (ours.*list).push_back(id);
    ++added;
  }
  changed_ |= removed + added > 0;
  report_.took_any |= added > 0;
}

}  // namespace slamdb::detail
