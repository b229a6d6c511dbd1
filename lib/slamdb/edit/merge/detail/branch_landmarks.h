// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "slamdb/edit/merge/detail/branch_points.h"
#include "slamdb/edit/merge/detail/point_classes.h"
#include "slamdb/edit/merge/three_way.h"

// Landmarks of three atlases, of which ids alone tell what is what; of those without id, what they are.
namespace slamdb::detail {

// What a landmark is, whatever its id; `with_place`: and wherever it is.
std::int64_t ContentOf(const Landmark& landmark, bool with_place = true);

// {id in `from`, id in `to`}, ascending, of landmarks that are in none of the pairs given: of equal ids, where these
// say something; and those whose content no other one has.
std::vector<IdPair> MatchLandmarks(const Atlas& from, const Atlas& to, const std::vector<IdPair>& known,
                                   bool ids_say_something);

// What becomes of the landmarks of a map in three versions: told before any of these is moved.
struct LandmarkPlan {
  std::vector<std::uint8_t> ours_stays;                   // by row
  std::vector<std::uint8_t> theirs_is_new;                // by row
  std::vector<std::optional<std::uint32_t>> replacement;  // of ours by row: row of theirs that stands in its place
  std::vector<BranchConflict> conflicts;                  // without their map

  // Returns whether anything of theirs is there now.
  bool Apply(std::vector<Landmark>& ours, const std::vector<Landmark>& theirs) const;
};

using LandmarkLists = std::vector<std::span<const Landmark>>;  // of maps that become one, in the order of their rows

// With `with_places` a landmark that is elsewhere is another one, as where nothing else of the map has moved.
LandmarkPlan PlanLandmarks(const LandmarkLists& base, const LandmarkLists& ours, const LandmarkLists& theirs,
                           BranchSide prefer, bool with_places);

// Where points are, by the names of their classes: those that go by the name, or else any.
using PlacesOfPoints = std::unordered_map<std::uint64_t, Eigen::Vector3f>;
PlacesOfPoints PlacesOf(const Map& map, const PointClasses& classes);

// Of the landmarks of the result, where their points are in the side that they come from.
PlacesOfPoints PlacesBeforeMerging(const LandmarkPlan& plan, const Map& ours, const Map& theirs,
                                   const PointClasses& classes);

// Moves landmarks as far as their points have moved since.
void FollowPoints(const PlacesOfPoints& before, const PointClasses& classes, Map& map);

// The same where points were fused since: their landmarks become one, too.
void FollowFusing(const PlacesOfPoints& before, const FuseReport& fused, Map& map);

// Landmarks of points that are one become one, at the place of that.
void UniteLandmarks(const PointClasses& classes, Map& map);

// Whether a list has a landmark that the base has not, or otherwise.
bool HasOtherLandmarks(const LandmarkLists& base, std::span<const Landmark> list);

}  // namespace slamdb::detail
