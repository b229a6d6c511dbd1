// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/align/detail/common_words.h"
#include "slamdb/align/detail/map_views.h"

namespace slamdb::detail {

// A map point, and a picture near the keyframe at hand in which it was seen.
struct LocalPoint {
  std::uint32_t point;
  Sighting sighting;
};

// What is seen from about a keyframe: its points and those of its best covisible keyframes, each once, as rows.
// At most some thousand, its own first: the work of matching grows with their square.
struct LocalMap {
  static constexpr std::uint32_t kNoNode = ~std::uint32_t{0};

  std::uint32_t view = 0;  // left
  std::vector<LocalPoint> points;
  std::vector<Descriptor> descriptors;
  std::vector<std::uint32_t> nodes;  // of the vocabulary, of the keypoint of the sighting; kNoNode: unknown
};

// The node of the vocabulary that each keypoint of the left views of a map is in.
class NodeTable {
 public:
  NodeTable(const MapViews& map, const CommonWords& words, std::size_t map_number);
  std::uint32_t Of(const Sighting& sighting) const {
    const std::vector<std::uint32_t>& nodes = nodes_[sighting.view];
    return sighting.keypoint < nodes.size() ? nodes[sighting.keypoint] : LocalMap::kNoNode;
  }

 private:
  std::vector<std::vector<std::uint32_t>> nodes_;  // by view and keypoint
};

struct PreparedMap;
LocalMap MakeLocalMap(const PreparedMap& map, std::uint32_t view, std::size_t neighbours = 8);

}  // namespace slamdb::detail
