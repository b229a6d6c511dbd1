// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/edit/ids/id_map.h"
#include "slamdb/model/index.h"

// Which point of one atlas is which of another, by keypoints that see both. Ids of keyframes must mean the same in
// both.
namespace slamdb::detail {

// Who stands in another atlas at the keypoints that see a point.
struct PointVote {
  MapPointId most;                       // whom most of them see there; of equals the lowest id
  std::size_t votes = 0, keypoints = 0;  // that see it, of those whose keyframe is there
  std::size_t all = 0;                   // whether their keyframes are there or not
  bool Carried() const { return votes > 0 && 2 * votes >= keypoints; }
};
PointVote VoteOn(const MapPoint& point, const AtlasIndex& other);

// {id in the base, id in the side}, ascending: of equal ids, and a keypoint sees both; or none of the base's sees
// another one, and the first keyframe and frame are the same. In a side that was renumbered, where keypoints mostly see
// other points than those of equal id, those that most keypoints see. And landmarks (branch_landmarks.h).
std::vector<IdPair> MatchPointsOfBase(const AtlasIndex& base, const AtlasIndex& side);

// {id in theirs, id in ours}, ascending: of points that are not in the base, those that most keypoints of theirs see in
// ours. And landmarks.
std::vector<IdPair> MatchNewPoints(const AtlasIndex& theirs, const AtlasIndex& ours,
                                   const std::vector<IdPair>& base_in_theirs, const std::vector<IdPair>& base_in_ours);

}  // namespace slamdb::detail
