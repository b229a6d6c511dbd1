// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/index.h"

namespace slamdb {

// A part of an atlas: one flag for each row of its lists, 1 = in the part.
struct Subset {
  struct MapRows {
    std::vector<std::uint8_t> keyframes, points, landmarks;
  };
  std::vector<MapRows> maps;  // by row of Atlas::maps

  SLAMDB_EXPORT static Subset Everything(const Atlas& atlas);
  SLAMDB_EXPORT static Subset Nothing(const Atlas& atlas);
};

// ORB-SLAM3's MapPoint::EraseObservation culls a point that is left with so many observations or fewer.
inline constexpr std::int32_t kCulledAt = 2;

// What to do with what crosses the border of a part.
enum class Border {
  kStrict,  // the part as it is: references that leave it are dropped, and points that nothing measures any more
  kCompletePoints,  // the part grows by all keyframes that observe a point of it
  kSmart,           // as strict, but points go as soon as ORB-SLAM3 would cull them for what they lost; grows by none
};

// Changes `subset` by the rule of the border so that KeepSubset leaves a sound atlas.
// A point that loses observers stays
//   with kStrict  when two keyframes, or one with depth, still observe it
//   with kSmart   when its observations still add up to more than 2 (MapPoint::EraseObservation)
// `index` is of the atlas.
//
// Throws Error (kUsage) when the subset is not of this atlas.
// Cost: linear. `threads` 0: every core.
SLAMDB_EXPORT void SettleBorder(const AtlasIndex& index, Border border, Subset& subset, int threads = 0);
// The same of one map alone, a row of Atlas::maps.
SLAMDB_EXPORT void SettleBorder(const AtlasIndex& index, std::uint32_t map, Border border, Subset::MapRows& rows,
                                int threads = 0);

// How many entities there are.
struct EntityCounts {
  std::uint64_t maps = 0, keyframes = 0, points = 0, landmarks = 0;
  friend bool operator==(const EntityCounts&, const EntityCounts&) = default;
};
[[nodiscard]] SLAMDB_EXPORT EntityCounts CountEntities(const Atlas& atlas);

// What KeepSubset took away.
struct SubsetReport {
  EntityCounts before, after;                                                     // of the atlas
  std::uint64_t maps = 0, keyframes = 0, points = 0, landmarks = 0, cameras = 0;  // entities
  std::uint64_t observations = 0, slots = 0, edges = 0;                           // references out of the kept part
  std::uint64_t new_references = 0, new_parents = 0;  // keyframes chosen in place of removed ones
  std::uint64_t joined = 0;                           // inertial preintegrations over a gap

  // What another cut took away, right after this one.
  SLAMDB_EXPORT SubsetReport& operator+=(const SubsetReport& next);
  friend bool operator==(const SubsetReport&, const SubsetReport&) = default;
};

// As reports of verbs have it: `before`, `after`, `cut`, `chosen`.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const SubsetReport& report);

// Removes everything outside `subset` and closes what is left:
//   observations, slots, covisibility, loop and merge edges that lead out are erased, and counts made right
//   points get another reference keyframe, of their observers that with the lowest id
//   keyframes get another parent, as AdoptOrphans finds it
//   previous and next link over the gap; preintegrations are joined, or end there when measurements are missing
//   initial, lowest and origin keyframes are chosen anew where they are gone; the lowest id becomes the root
//   maps without keyframes and landmarks go
//   points that no kept keyframe observes go, and cameras that lose their last keyframe
// References that dangled before are treated like those that lead out.
// Once anything is removed, null and repeated entries of lists go too.
// Covisibility weights, normals, descriptors and distance ranges stay as recorded.
// Counters stay: ids are never handed out twice.
// A sound atlas stays sound; a subset of everything changes nothing in one.
//
// Throws Error (kUsage) when the subset is not of this atlas.
// Cost: linear, in place. `threads` 0: every core; the result is the same for any number.
SLAMDB_EXPORT SubsetReport KeepSubset(Atlas& atlas, const Subset& subset, int threads = 0);

}  // namespace slamdb
