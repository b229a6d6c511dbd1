// SPDX-License-Identifier: BSD-3-Clause
#include "tests/edit/merge/branched.h"

#include <set>

#include "slamdb/edit/ids/renumber.h"

namespace slamdb {
namespace {

// New keyframes and points get the ids that come next after the base, as a robot that goes on with it gives them.
void NumberAsContinued(const Atlas& base, Atlas& side) {
  IdMap ids;
  const AtlasIndex index(base);
  for (const IdKind kind : {IdKind::kKeyFrame, IdKind::kPoint, IdKind::kFrame}) {
    std::set<std::uint64_t> all;
    for (const Map& map : side.maps) {
      for (const KeyFrame& keyframe : map.keyframes)
        if (kind != IdKind::kPoint) all.insert(kind == IdKind::kFrame ? keyframe.frame_id : keyframe.id.value());
      for (const MapPoint& point : map.points)
        if (kind == IdKind::kPoint) all.insert(point.id.value());
    }
    std::uint64_t next = NextId(base.next_ids, kind);
    for (const std::uint64_t id : all) {
      const bool is_old = kind == IdKind::kPoint      ? static_cast<bool>(index.LocatePoint(MapPointId(id)))
                          : kind == IdKind::kKeyFrame ? static_cast<bool>(index.LocateKeyFrame(KeyFrameId(id)))
                                                      : id < NextId(base.next_ids, kind);
      ids[kind].push_back({id, is_old ? id : next++});
    }
  }
  // What the whole world named and the part has not.
  for (Map& map : side.maps)
    for (MapPoint& point : map.points) {
      point.first_keyframe = static_cast<std::int64_t>(point.reference.value());
      point.first_frame = 0;
    }
  ApplyIdMap(side, ids);
  side.next_ids = {};
  RaiseCounters(side);
}

}  // namespace

Branched Branch(const World& world, std::uint64_t seed) {
  const Atlas whole = SynthesizeAtlas({.sensor = world.sensor,
                                       .inertial = world.inertial,
                                       .keyframes = kOld + 2 * kNew,
                                       .points = 300,
                                       .features = 200,
                                       .loops = false,
                                       .seed = seed});
  Branched branched{Part(whole, [](std::size_t row) { return row < kOld; }),
                    Part(whole, [](std::size_t row) { return row < kOld + kNew; }),
                    Part(whole, [](std::size_t row) { return row < kOld || row >= kOld + kNew; })};
  for (Map& map : branched.base.maps)
    for (MapPoint& point : map.points) {
      point.first_keyframe = static_cast<std::int64_t>(point.reference.value());
      point.first_frame = 0;
    }
  for (Atlas* side : {&branched.ours, &branched.theirs}) NumberAsContinued(branched.base, *side);
  for (Atlas* side : {&branched.ours, &branched.theirs}) {
    const AtlasIndex base(branched.base);
    for (MapPoint& point : side->maps[0].points)
      if (const EntityRow row = base.LocatePoint(point.id))
        point.first_keyframe = branched.base.maps[0].points[row.row].first_keyframe;
  }
  return branched;
}

MapPointId NeverSeenWith(MapPointId point, const Branched& branched) {
  const auto keyframes_of = [](const Atlas& atlas, MapPointId id) {
    std::set<KeyFrameId> keyframes;
    const std::uint32_t row = PointTable(atlas.maps[0]).Find(id.value());
    if (row == kNoRow) return keyframes;
    for (const Observation& seen : atlas.maps[0].points[row].observations) keyframes.insert(seen.keyframe);
    return keyframes;
  };
  for (const MapPoint& other : branched.base.maps[0].points) {
    const auto are_apart = [&](const Atlas& atlas) {
      const auto one = keyframes_of(atlas, point), two = keyframes_of(atlas, other.id);
      return !two.empty() && std::ranges::none_of(two, [&](KeyFrameId id) { return one.contains(id); });
    };
    if (are_apart(branched.base) && are_apart(branched.ours) && are_apart(branched.theirs)) return other.id;
  }
  return {};
}

}  // namespace slamdb
