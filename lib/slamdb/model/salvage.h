// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/model/atlas.h"

namespace slamdb {

// How many entries of a list could be read, of how many that the file announces.
struct SalvagedList {
  std::uint64_t listed = 0, read = 0;
};

struct SalvagedMap {
  MapId id;
  SalvagedList keyframes, points, landmarks;
  std::vector<KeyFrameId> lost_links;  // of a store: who has lost connections, children, loop and merge edges
  bool lost_head = false;  // of an ORB-SLAM3 file: its id and its initial keyframe are taken from its keyframes
};

// What could be read of a damaged file.
// Everything in the atlas was read whole; it may refer to what was not.
// Cameras, counters and the map's members that stand behind the damage are as in an atlas just made.
struct Salvage {
  Atlas atlas;
  std::vector<std::string> damage;  // where reading failed, and how, the first of it; empty: the file is whole
  // Of a store: what differs from its hash or was deleted, and was taken as it stands there, since
  // StoreReadOptions::accept_edits said so.
  std::vector<std::string> accepted;
  // What the atlas does not hold of a file of which every byte could be read, or what is in doubt.
  std::vector<std::string> losses;
  std::vector<SalvagedMap> maps;  // by row of Atlas::maps
  std::uint64_t maps_listed = 0;
  std::string undone;           // what had been done to the file, and was undone before it was read; empty: nothing
  bool lost_beginning = false;  // of an ORB-SLAM3 file: vocabulary, number of maps, head of the first map
};

}  // namespace slamdb
