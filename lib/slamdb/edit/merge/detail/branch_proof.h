// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/edit/merge/three_way.h"
#include "slamdb/model/atlas.h"

// The proof that a merge of three atlases lost nothing that it does not name.
namespace slamdb::detail {

// What is in an atlas, by keys that mean the same in all of them.
struct Inventory {
  struct Sighting {
    std::uint64_t keyframe = 0, keypoint = 0, point = 0;
  };
  struct Edge {
    std::uint64_t first = 0, second = 0;
    bool merges = false;
    friend auto operator<=>(const Edge&, const Edge&) = default;
  };
  std::vector<std::pair<std::uint64_t, std::uint64_t>> keyframes;  // id, rows of features; ascending
  std::vector<std::uint64_t> points;                               // ascending
  std::vector<Sighting> sightings;                                 // by keyframe and keypoint, ascending
  std::vector<Sighting> claims;  // likewise: what points say that no keypoint confirms
  std::vector<Edge> edges;       // ascending, each once

  explicit Inventory(const Atlas& atlas);

 private:
  void AddClaims(const Map& map);
};

// Holds the result against what went into it, key by key, and fills the ledgers of the report. Each thing of the inputs
// is in the result, or a side deleted it, or it went into a point that is there, or led nowhere.
// `cleared`: keypoints that fusing emptied.
//
// Throws Error (kInternal) naming the first thing of which none of that holds.
void Prove(const Inventory& base, const Inventory& ours, const Inventory& theirs, const Inventory& result,
           std::uint64_t cleared, ThreeWayReport& report);

}  // namespace slamdb::detail
