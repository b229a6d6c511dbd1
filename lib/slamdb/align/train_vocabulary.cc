// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/train_vocabulary.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>
#include <vector>

#include "slamdb/model/derive.h"

namespace slamdb::detail {
namespace {

constexpr int kIterations = 4;
constexpr std::size_t kSmallestCluster = 20;  // that is divided further

using Members = std::vector<std::uint32_t>;  // rows of descriptors

// Bit i of a byte as byte i.
constexpr std::array<std::uint64_t, 256> kSpread = [] {
  std::array<std::uint64_t, 256> spread{};
  for (std::uint64_t byte = 0; byte < spread.size(); ++byte)
    for (unsigned bit = 0; bit < 8; ++bit) spread[byte] |= (byte >> bit & 1) << (8 * bit);
  return spread;
}();

// The bits that more than half of the members have. Counted eight at a time, as bytes, which hold so many.
Descriptor MajorityOf(std::span<const Descriptor> descriptors, const Members& members) {
  constexpr std::size_t kMostInByte = 255;
  std::array<std::uint32_t, 256> counts{};
  for (std::size_t begin = 0; begin < members.size(); begin += kMostInByte) {
    std::array<std::uint64_t, std::tuple_size_v<Descriptor>> sums{};
    for (std::size_t i = begin; i < std::min(begin + kMostInByte, members.size()); ++i)
      for (std::size_t byte = 0; byte < sums.size(); ++byte) sums[byte] += kSpread[descriptors[members[i]][byte]];
    for (std::size_t bit = 0; bit < counts.size(); ++bit)
      counts[bit] += static_cast<std::uint8_t>(sums[bit / 8] >> (8 * (bit % 8)));
  }
  Descriptor majority{};
  for (std::size_t bit = 0; bit < counts.size(); ++bit)
    if (2 * counts[bit] > members.size()) majority[bit / 8] |= static_cast<std::uint8_t>(1U << (bit % 8));
  return majority;
}

struct Cluster {
  Descriptor center{};
  Members members;
};

void Assign(std::span<const Descriptor> descriptors, const Members& members, std::vector<Cluster>& clusters) {
  for (Cluster& cluster : clusters) cluster.members.clear();
  for (const std::uint32_t row : members) {
    const auto distance = [&](const Cluster& cluster) { return HammingDistance(cluster.center, descriptors[row]); };
    std::ranges::min_element(clusters, {}, distance)->members.push_back(row);
  }
  std::erase_if(clusters, [](const Cluster& cluster) { return cluster.members.empty(); });
}

// Centres begin as members at equal steps of the list.
std::vector<Cluster> Divide(std::span<const Descriptor> descriptors, const Members& members, int branching) {
  std::vector<Cluster> clusters;
  for (std::size_t i = 0; i < static_cast<std::size_t>(branching); ++i) {
    const Descriptor& center = descriptors[members[i * members.size() / static_cast<std::size_t>(branching)]];
    if (std::ranges::find(clusters, center, &Cluster::center) == clusters.end()) clusters.push_back({center, {}});
  }
  Assign(descriptors, members, clusters);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (Cluster& cluster : clusters) cluster.center = MajorityOf(descriptors, cluster.members);
    Assign(descriptors, members, clusters);
  }
  return clusters;
}

}  // namespace

VocabularyTree TrainVocabulary(std::span<const Descriptor> descriptors, int branching, int depth) {
  VocabularyTree tree{.branching = branching, .depth = depth};
  std::vector<Cluster> level(1);  // the nodes of the level at hand, in order
  level[0].members.resize(descriptors.size());
  std::iota(level[0].members.begin(), level[0].members.end(), 0U);
  std::uint32_t next_node = 1;
  for (int at = 0; !level.empty(); ++at) {
    std::vector<Cluster> below;
    for (Cluster& node : level) {
      std::vector<Cluster> parts;
      if (at < depth && node.members.size() >= kSmallestCluster) parts = Divide(descriptors, node.members, branching);
      if (parts.size() == 1) parts.clear();
      tree.descriptors.push_back(node.center);
      tree.first_child.push_back(static_cast<std::uint32_t>(tree.children.size()));
      for (std::size_t i = 0; i < parts.size(); ++i) tree.children.push_back(next_node++);
      const bool leaf = parts.empty();
      tree.words.push_back(leaf ? tree.word_count++ : VocabularyTree::kNoWord);
      tree.weights.push_back(leaf ? 1 : 0);
      std::ranges::move(parts, std::back_inserter(below));
    }
    level = std::move(below);
  }
  tree.first_child.push_back(static_cast<std::uint32_t>(tree.children.size()));
  return tree;
}

}  // namespace slamdb::detail
