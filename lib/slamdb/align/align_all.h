// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "slamdb/align/align.h"
#include "slamdb/export.h"

namespace slamdb {

// What was made of how two maps lie to each other.
enum class LinkUse {
  kJoins,        // it brings maps into one frame
  kCloses,       // they are in one frame by other links, which it agrees with
  kContradicts,  // other links contradict it, or the scales of metric maps that it would join
  kUnused,       // its verdict does not allow to use it
};

// `joins`, `closes`, `contradicts`, `unused`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(LinkUse use);

struct MapLink {
  std::size_t first = 0, second = 0;  // rows of the list of maps
  Alignment alignment;
  LinkUse use = LinkUse::kUnused;

  bool is_used() const { return use == LinkUse::kJoins || use == LinkUse::kCloses; }
};

// Where a map lies in the frame of the first one of its group.
struct MapPlace {
  std::size_t group = 0;  // row of the list of maps: the group's first one
  Similarity3d group_from_map;
};

// How several maps lie to each other.
struct AlignedMaps {
  std::vector<MapLink> links;    // every pair of maps that was asked for, the surest first
  std::vector<MapPlace> places;  // by row of the list of maps; what links to nothing is a group of its own
};

// Aligns every pair of maps, and brings into one frame what is linked: a maximum spanning tree, of links between metric
// maps first, then by the number of matched points. Metric maps of one frame have one scale, also where only a map
// without scale links them. A further link must close the cycle that it makes, within what the maps are bent by; one
// that does not is named.
//
// Cost: AlignMaps for every pair of maps.
[[nodiscard]] SLAMDB_EXPORT AlignedMaps AlignAllMaps(std::span<const MapRef> maps, const AlignOptions& options = {});

// The same, without the pairs of which neither map is among the first `asked` ones: how these lie in all the others.
[[nodiscard]] SLAMDB_EXPORT AlignedMaps AlignWithOthers(std::span<const MapRef> maps, std::size_t asked,
                                                        const AlignOptions& options = {});

}  // namespace slamdb
