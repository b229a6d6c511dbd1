// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/edges.h"

#include <algorithm>
#include <utility>

#include "slamdb/view/detail/encode.h"

namespace slamdb::view {
namespace {

struct Partner {
  std::uint32_t row;
  std::uint32_t weight;
};

// By the lower row of the pair. Keyframes list each other, but in a damaged file only one of them may.
std::vector<std::vector<Partner>> PartnersOf(const Scene& scene) {
  std::vector<std::vector<Partner>> partners(scene.keyframes());
  std::uint32_t row = 0;
  scene.ForEachKeyFrame([&](const SceneAtlas& atlas, std::uint32_t map, const KeyFrame& keyframe) {
    for (const Connection& connection : keyframe.connections) {
      const std::int64_t other = atlas.KeyFrameRow(map, connection.keyframe);
      if (other < 0 || other == row) continue;
      const auto [low, high] = std::minmax({row, static_cast<std::uint32_t>(other)});
      partners[low].push_back({high, static_cast<std::uint32_t>(std::max(connection.weight, 0))});
    }
    ++row;
  });
  return partners;
}

std::string CovisibilityBytes(const Scene& scene) {
  VarintColumn edges;
  std::vector<std::vector<Partner>> partners = PartnersOf(scene);
  for (std::uint32_t row = 0; row < partners.size(); ++row) {
    std::vector<Partner>& mine = partners[row];
    std::ranges::stable_sort(mine, {}, &Partner::row);
    const auto same = [](const Partner& a, const Partner& b) { return a.row == b.row; };
    mine.erase(std::unique(mine.begin(), mine.end(), same), mine.end());
    edges.Add(mine.size());
    std::uint32_t last = row;
    for (const Partner& partner : mine) {
      edges.Add(partner.row - last);
      edges.Add(partner.weight);
      last = partner.row;
    }
  }
  return edges.Take();
}

std::string PairBytes(const Scene& scene, Column<KeyFrameId> KeyFrame::*list) {
  detail::RowPairs pairs;
  std::uint32_t row = 0;
  scene.ForEachKeyFrame([&](const SceneAtlas& atlas, std::uint32_t map, const KeyFrame& keyframe) {
    for (const KeyFrameId id : keyframe.*list)
      if (const std::int64_t other = atlas.KeyFrameRow(map, id); other >= 0)
        pairs.push_back(std::minmax({row, static_cast<std::uint32_t>(other)}));
    ++row;
  });
  detail::MakeDistinct(pairs);
  VarintColumn edges;
  std::int64_t last = 0;
  for (const auto& [first, second] : pairs) {
    edges.AddSigned(std::int64_t{first} - last);
    edges.AddSigned(std::int64_t{second} - first);
    last = first;
  }
  return edges.Take();
}

}  // namespace

Columns EncodeEdges(const Scene& scene) {
  return {{"edges/covisibility", CovisibilityBytes(scene)},
          {"edges/loop", PairBytes(scene, &KeyFrame::loop_edges)},
          {"edges/merge", PairBytes(scene, &KeyFrame::merge_edges)}};
}

}  // namespace slamdb::view
