// SPDX-License-Identifier: BSD-3-Clause
// A keyframe and its record at rest.
#include "slamdb/live/detail/keyframe_record.h"

#include <algorithm>
#include <bit>

#include "slamdb/live/camera.h"
#include "slamdb/live/detail/link_filter.h"
#include "slamdb/live/detail/link_targets.h"
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
    : Listed(map->runtime()),
      record_(std::move(record)),
      features_(std::move(record_.features)),
      mnId(record_.id.value()),
      mnFrameId(record_.frame_id),
      mTimeStamp(record_.timestamp),
      N(features_.count),
      NLeft(features_.left_count),
      NRight(features_.right_count),
      mnOriginMapId(record_.origin_map),
      mfScale(record_.merge_scale),
      bImu(record_.imu_initialized),
      mTcp(record_.camera_from_parent),
      map_(map),
      bad_(record_.bad),
      slots_(features_.map_points.size(), nullptr) {
  record_.features = {};
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
  record.camera_from_parent = mTcp;
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
