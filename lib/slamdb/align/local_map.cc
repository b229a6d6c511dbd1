// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/local_map.h"

#include <unordered_set>

#include "slamdb/align/detail/prepared_map.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kMostPoints = 4000;

}  // namespace

NodeTable::NodeTable(const MapViews& map, const CommonWords& words, std::size_t map_number)
    : nodes_(map.views().size()) {
  for (std::uint32_t view = 0; view < nodes_.size(); ++view) {
    const FeatureVector* vector = words.Nodes(map_number, view);
    if (vector == nullptr) continue;
    nodes_[view].assign(map.views()[view].keypoints.size(), LocalMap::kNoNode);
    std::size_t at = 0;
    for (std::size_t i = 0; i < vector->nodes.size() && i < vector->sizes.size(); ++i)
      for (const std::size_t end = at + vector->sizes[i]; at < end && at < vector->features.size(); ++at)
        if (vector->features[at] < nodes_[view].size()) nodes_[view][vector->features[at]] = vector->nodes[i];
  }
}

LocalMap MakeLocalMap(const PreparedMap& prepared, std::uint32_t view, std::size_t neighbours) {
  const MapViews& map = prepared.views;
  LocalMap local{.view = view};
  std::unordered_set<std::uint32_t> taken;
  const auto take = [&](std::uint32_t from) {
    for (const Seen& seen : map.SeenBy(from)) {
      if (local.points.size() == kMostPoints) return;
      if (!taken.insert(seen.point).second) continue;
      const Sighting sighting{from, seen.keypoint};
      local.points.push_back({seen.point, sighting});
      local.descriptors.push_back(*map.points()[seen.point].descriptor);
      local.nodes.push_back(prepared.nodes.Of(sighting));
    }
  };
  const auto take_all = [&](std::uint32_t left) {
    for (std::uint32_t each = left; each <= map.LastViewOf(left); ++each) take(each);
  };
  take_all(view);
  for (const std::uint32_t neighbour : map.BestCovisibles(view, neighbours)) take_all(neighbour);
  return local;
}

}  // namespace slamdb::detail
