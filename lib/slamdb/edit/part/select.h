// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <vector>

#include "slamdb/edit/part/subset.h"
#include "slamdb/export.h"

namespace slamdb {

// Where a region cuts.
enum class RegionOf {
  kBoth,     // keyframes by their camera's centre and points by their position
  kCameras,  // keyframes alone; they bring the points that they observe
  kPoints,   // points alone; they bring the keyframes that observe them
};

// The plane of a polygon, of two axes of the map; by default those that are nearest to level (UpOf): x and y where z is
// up, x and z where y is down.
enum class PlanPlane { kAuto, kXy, kXz, kYz };

// Which part of an atlas. All that is said must hold; what is left at its default holds for everything.
struct SelectOptions {
  std::optional<MapId> map;
  std::uint64_t first_keyframe = 0, last_keyframe = std::numeric_limits<std::uint64_t>::max();  // ids, inclusive
  std::vector<KeyFrameId> keyframes;                                                            // exactly these
  double begin_time = -std::numeric_limits<double>::infinity();                                 // seconds, inclusive
  double end_time = std::numeric_limits<double>::infinity();
  std::optional<std::uint32_t> session;    // keyframes that were made in the map of this id (KeyFrame::origin_map)
  std::optional<std::size_t> component;    // connected part of the covisibility graph: 1 the largest of the maps
                                           // that are selected, 2 the next
  std::size_t every = 1;                   // of what is selected, in order of time, the first of each so many
  std::optional<Eigen::AlignedBox3f> box;  // world
  std::vector<Eigen::Vector2f> polygon;    // corners in the plane of the plan; by the even-odd rule
  PlanPlane plane = PlanPlane::kAuto;
  RegionOf region = RegionOf::kBoth;  // what box and polygon cut
  bool except = false;                // everything but that part. Points go with the region only: the others stay as
                                      // long as a keyframe that stays observes them
};

// The part of the atlas, as flags; settle its border next (Extract does).
// Points are in it when a keyframe of it observes them and, where the region cuts points, they lie inside.
// Those inside also count when only keyframes with their camera outside, but otherwise selected, observe them, so that
// Border::kCompletePoints brings these.
// Landmarks are in it when they lie inside the region, where that cuts points.
// Otherwise all those of maps of which a keyframe is in it, and of the map that is asked for.
//
// Throws Error:
//   kUsage        a polygon has fewer than three corners or corners that are not finite, or `every` or `component` is 0
//   kNotPossible  a map, keyframe, session or component does not exist, or nothing is selected
// Cost: linear but for the sort that `every` needs.
[[nodiscard]] SLAMDB_EXPORT Subset Select(const AtlasIndex& index, const SelectOptions& options = {});

// A connected part of the covisibility graph, an edge counting whichever side lists it.
struct Component {
  std::uint32_t map = 0;                 // row of Atlas::maps
  std::vector<std::uint32_t> keyframes;  // rows, ascending
};

// The connected parts of one map (a row of Atlas::maps), or of all. Largest first, then by map and row.
[[nodiscard]] SLAMDB_EXPORT std::vector<Component> FindComponents(const AtlasIndex& index,
                                                                  std::optional<std::uint32_t> map = {});

}  // namespace slamdb
