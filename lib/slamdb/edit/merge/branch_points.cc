// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/detail/branch_points.h"

#include <algorithm>
#include <unordered_set>

#include "slamdb/edit/merge/detail/branch_landmarks.h"

namespace slamdb::detail {
namespace {

const KeyFrame* FindKeyFrame(const AtlasIndex& index, KeyFrameId id) {
  const EntityRow place = index.LocateKeyFrame(id);
  return place ? &index.atlas().maps[place.map].keyframes[place.row] : nullptr;
}

const MapPoint* FindPoint(const AtlasIndex& index, MapPointId id) {
  const EntityRow place = index.LocatePoint(id);
  return place ? &index.atlas().maps[place.map].points[place.row] : nullptr;
}

bool SharesSighting(const MapPoint& a, const MapPoint& b) {
  return std::ranges::any_of(a.observations, [&](const Observation& seen) {
    const auto other = std::ranges::lower_bound(b.observations, seen.keyframe, {}, &Observation::keyframe);
    return other != b.observations.end() && other->keyframe == seen.keyframe &&
           ((seen.left >= 0 && seen.left == other->left) || (seen.right >= 0 && seen.right == other->right));
  });
}

// Points of equal ids.
bool IsSame(const MapPoint& base, const MapPoint& side, const AtlasIndex& of_side) {
  if (SharesSighting(base, side)) return true;
  return base.first_keyframe == side.first_keyframe && base.first_frame == side.first_frame &&
         VoteOn(base, of_side).votes == 0;
}

template <class Visit>
void ForEachPoint(const Atlas& atlas, const Visit& visit) {
  for (const Map& map : atlas.maps)
    for (const MapPoint& point : map.points) visit(point);
}

void AddLandmarks(const std::vector<IdPair>& landmarks, std::vector<IdPair>& pairs) {
  pairs.insert(pairs.end(), landmarks.begin(), landmarks.end());
  std::ranges::sort(pairs, {}, &IdPair::before);
}

// Whether ids of points say nothing in the side. Those of keyframes may be as they were all the same, as when ids that
// were dense were made dense again.
bool IsRenumbered(const AtlasIndex& base, const AtlasIndex& side) {
  std::size_t right = 0, wrong = 0;
  ForEachPoint(base.atlas(), [&](const MapPoint& point) {
    const MapPoint* same = FindPoint(side, point.id);
    if (same != nullptr && SharesSighting(point, *same))
      ++right;
    else if (VoteOn(point, side).votes > 0)
      ++wrong;
  });
  return wrong > right;
}

}  // namespace

PointVote VoteOn(const MapPoint& point, const AtlasIndex& other) {
  PointVote vote;
  std::vector<MapPointId> seen;
  for (const Observation& observation : point.observations) {
    vote.all += (observation.left >= 0 ? 1U : 0U) + (observation.right >= 0 ? 1U : 0U);
    const KeyFrame* keyframe = FindKeyFrame(other, observation.keyframe);
    if (keyframe == nullptr) continue;
    const Column<MapPointId>& slots = keyframe->features.map_points;
    for (const std::int32_t row : {observation.left, observation.right}) {
      if (row < 0 || static_cast<std::size_t>(row) >= slots.size()) continue;
      ++vote.keypoints;
      if (slots[static_cast<std::size_t>(row)]) seen.push_back(slots[static_cast<std::size_t>(row)]);
    }
  }
  std::ranges::sort(seen);
  for (auto begin = seen.begin(); begin != seen.end();) {
    const auto end = std::upper_bound(begin, seen.end(), *begin);
    if (const auto votes = static_cast<std::size_t>(end - begin); votes > vote.votes) {
      vote.votes = votes;
      vote.most = *begin;
    }
    begin = end;
  }
  return vote;
}

std::vector<IdPair> MatchPointsOfBase(const AtlasIndex& base, const AtlasIndex& side) {
  const bool renumbered = IsRenumbered(base, side);
  std::vector<IdPair> pairs;
  std::unordered_set<std::uint64_t> taken;
  ForEachPoint(base.atlas(), [&](const MapPoint& point) {
    if (!renumbered) {
      const MapPoint* same = FindPoint(side, point.id);
      if (same != nullptr && IsSame(point, *same, side)) pairs.push_back({point.id.value(), point.id.value()});
    } else if (const PointVote vote = VoteOn(point, side);
               vote.Carried() && FindPoint(side, vote.most) != nullptr && taken.insert(vote.most.value()).second) {
      pairs.push_back({point.id.value(), vote.most.value()});
    }
  });
  AddLandmarks(MatchLandmarks(base.atlas(), side.atlas(), pairs, !renumbered), pairs);
  return pairs;
}

std::vector<IdPair> MatchNewPoints(const AtlasIndex& theirs, const AtlasIndex& ours,
                                   const std::vector<IdPair>& base_in_theirs, const std::vector<IdPair>& base_in_ours) {
  std::unordered_set<std::uint64_t> known, taken;
  for (const IdPair& pair : base_in_theirs) known.insert(pair.after);
  for (const IdPair& pair : base_in_ours) taken.insert(pair.after);
  std::vector<IdPair> pairs;
  ForEachPoint(theirs.atlas(), [&](const MapPoint& point) {
    if (known.contains(point.id.value())) return;
    const MapPoint* same = FindPoint(ours, point.id);
    if (same != nullptr && SharesSighting(point, *same) && taken.insert(point.id.value()).second) {
      pairs.push_back({point.id.value(), point.id.value()});
      return;
    }
    const PointVote vote = VoteOn(point, ours);
    if (vote.votes == 0 || 2 * vote.votes <= vote.all || FindPoint(ours, vote.most) == nullptr) return;
    if (taken.insert(vote.most.value()).second) pairs.push_back({point.id.value(), vote.most.value()});
  });
  std::vector<IdPair> matched = pairs;
  for (const IdPair& pair : base_in_theirs) matched.push_back({pair.after, kNoId});
  for (const IdPair& pair : base_in_ours) matched.push_back({kNoId, pair.after});
  AddLandmarks(MatchLandmarks(theirs.atlas(), ours.atlas(), matched, /*ids_say_something=*/false), pairs);
  return pairs;
}

}  // namespace slamdb::detail
