// SPDX-License-Identifier: BSD-3-Clause
// A keyframe and its record at rest.
#include <algorithm>
#include <bit>

#include "slamdb/live/camera.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"

namespace slamdb::live {
namespace {

KeyFrameId IdOf(const KeyFrame& keyframe) { return KeyFrameId(keyframe.mnId); }

// A link to one keyframe: to what the map lists, or what was recorded when it has never been resolved.
KeyFrameId LinkOf(const KeyFrame* target, LinkFilter& links, KeyFrameId unresolved) {
  if (target == nullptr) return unresolved;
  return links.Has(target) ? IdOf(*target) : KeyFrameId();
}

// Targets that the map lists, then the ids that were never resolved.
Column<KeyFrameId> LinksOf(const std::vector<KeyFrame*>& targets, LinkFilter& links,
                           const Column<KeyFrameId>& unresolved) {
  Column<KeyFrameId> ids;
  ids.reserve(targets.size() + unresolved.size());
  for (const KeyFrame* target : targets)
    if (links.Has(target)) ids.push_back(IdOf(*target));
  ids.insert(ids.end(), unresolved.begin(), unresolved.end());
  return ids;
}

}  // namespace

KeyFrame::KeyFrame(slamdb::KeyFrame record, Map* map)
    : mnId(record.id.value()),
      mnFrameId(record.frame_id),
      mTimeStamp(record.timestamp),
      N(record.features.count),
      NLeft(record.features.left_count),
      NRight(record.features.right_count),
      mnOriginMapId(record.origin_map),
      mfScale(record.merge_scale),
      bImu(record.imu_initialized),
      runtime_(map->runtime()),
      map_(map),
      bad_(record.bad),
      record_(std::move(record)),
      features_(std::move(record_.features)),
      slots_(features_.map_points.size(), nullptr) {
  record_.features = {};
}

void KeyFrame::Link(const LinkTargets& targets, PostLoadReport& report) {
  const Miss miss = [&](LinkKind kind, std::uint64_t target) {
    report.Add({kind, MapId(GetMap()->GetId()), KeyFrameId(mnId), {}, target});
  };
  LinkSlots(targets, miss);
  if (bad_) return;
  if (mpCamera == nullptr) miss(LinkKind::kCamera, record_.camera.value());
  if (mpCamera2 == nullptr && record_.right_camera) miss(LinkKind::kRightCamera, record_.right_camera.value());
  LinkKeyFrames(targets, miss);
  LinkConnections(targets, miss);
}

void KeyFrame::LinkSlots(const LinkTargets& targets, const Miss& miss) {
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

void KeyFrame::LinkKeyFrames(const LinkTargets& targets, const Miss& miss) {
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

void KeyFrame::LinkConnections(const LinkTargets& targets, const Miss& miss) {
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

KeyFrame::PublicMembers KeyFrame::ReadPublicMembers() const {
  return {mnFrameId,
          std::bit_cast<std::uint64_t>(mTimeStamp),
          std::bit_cast<std::uint32_t>(mfScale),
          mnOriginMapId,
          bImu,
          mPrevKF,
          mNextKF,
          mpCamera,
          mpCamera2};
}

slamdb::KeyFrame KeyFrame::ToRecord(LinkFilter& links, bool features) const {
  slamdb::KeyFrame record = record_;
  if (features) record.features = features_;
  record.features.map_points.resize(slots_.size());
  for (std::size_t row = 0; row < slots_.size(); ++row)
    if (slots_[row] != nullptr && links.Has(slots_[row]))
      record.features.map_points[row] = MapPointId(slots_[row]->mnId);
  for (const auto& [row, id] : unresolved_slots_) record.features.map_points[row] = id;

  record.frame_id = mnFrameId;
  record.timestamp = mTimeStamp;
  record.origin_map = mnOriginMapId;
  record.merge_scale = mfScale;
  if (bImu != static_cast<bool>(record.imu_initialized)) record.imu_initialized = bImu;
  if (bad_ != static_cast<bool>(record.bad)) record.bad = static_cast<bool>(bad_);
  if (mpCamera != nullptr) record.camera = mpCamera->record().id;
  if (mpCamera2 != nullptr) record.right_camera = mpCamera2->record().id;
  WriteLinks(links, record);
  return record;
}

void KeyFrame::WriteLinks(LinkFilter& links, slamdb::KeyFrame& record) const {
  record.parent = LinkOf(parent_, links, record_.parent);
  record.previous = LinkOf(mPrevKF, links, record_.previous);
  record.next = LinkOf(mNextKF, links, record_.next);
  record.children = LinksOf(children_, links, record_.children);
  record.loop_edges = LinksOf(loop_edges_, links, record_.loop_edges);
  record.merge_edges = LinksOf(merge_edges_, links, record_.merge_edges);
  const auto unresolved = static_cast<std::ptrdiff_t>(record.connections.size());
  for (const Covisible& covisible : connections_)
    if (links.Has(covisible.keyframe)) record.connections.push_back({IdOf(*covisible.keyframe), covisible.weight});
  std::inplace_merge(record.connections.begin(), record.connections.begin() + unresolved, record.connections.end(),
                     [](const Connection& a, const Connection& b) { return a.keyframe < b.keyframe; });
}

}  // namespace slamdb::live
