// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/place_words.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/rows/detail/place_tree.h"
#include "slamdb/model/detail/bit_columns.h"
#include "slamdb/model/picture_features.h"

namespace slamdb::rows {
namespace {

constexpr std::size_t kWords = 8 * sizeof(PlaceWords);

// The tree of schema/0005_places.words: how many children each node has, breadth first, then the centres of all but the
// root, then how frequent each word is.
class PlaceTree {
 public:
  PlaceTree() : centres_(CentresOf(PlaceTreeBytes())) {
    std::uint32_t next = 1, words = 0;
    for (const unsigned char children : PlaceTreeBytes().first(centres_.size())) {
      nodes_.push_back({next, children, children == 0 ? words++ : 0});
      next += children;
    }
  }

  // Calls visit(word) for the word of each descriptor: down to the child at the least distance, the first of equals.
  // All go down one level before any goes down the next, so that the processor need not wait for one to end.
  template <class Visit>
  void ForEachWord(std::span<const Descriptor> descriptors, Visit visit) const {
    struct Walker {
      detail::Bits bits;
      Node node;
    };
    std::vector<Walker> walkers;
    walkers.reserve(descriptors.size());
    for (const Descriptor& descriptor : descriptors) walkers.push_back({detail::BitsOf(descriptor), nodes_[0]});
    while (!walkers.empty()) {
      std::size_t left = 0;
      for (Walker& walker : walkers) {
        walker.node = Nearest(walker.node, walker.bits);
        if (walker.node.children == 0)
          visit(walker.node.word);
        else
          walkers[left++] = walker;
      }
      walkers.resize(left);
    }
  }

 private:
  struct Node {
    std::uint32_t first;  // of its children
    std::uint8_t children;
    std::uint32_t word;  // of a leaf
  };

  // Of its children.
  Node Nearest(const Node& node, const detail::Bits& bits) const {
    std::array<std::uint16_t, 256> distances;
    centres_.DistancesTo(bits, node.first, node.children, distances.data());
    std::uint32_t least = ~std::uint32_t{0};  // a distance, and in its lowest byte whose it is
    for (std::uint32_t i = 0; i < node.children; ++i) least = std::min(least, std::uint32_t{distances[i]} << 8 | i);
    return nodes_[node.first + (least & 0xff)];
  }

  static detail::BitColumns CentresOf(std::span<const unsigned char> bytes) {
    const std::size_t size = bytes.size() - kWords * sizeof(std::uint16_t);
    std::vector<detail::Bits> centres((size + sizeof(Descriptor)) / (1 + sizeof(Descriptor)));
    std::memcpy(&centres[1], &bytes[centres.size()], (centres.size() - 1) * sizeof(Descriptor));
    return detail::BitColumns(centres);
  }

  detail::BitColumns centres_;  // by node
  std::vector<Node> nodes_;
};

}  // namespace

int CountOf(const PlaceWords& words) {
  int count = 0;
  for (const std::uint64_t part : words) count += std::popcount(part);
  return count;
}

PlaceWords PlaceWordsOf(std::span<const Descriptor> descriptors) {
  static const PlaceTree tree;
  PlaceWords words{};
  tree.ForEachWord(descriptors, [&](std::uint32_t word) { words[word / 64] |= std::uint64_t{1} << (word % 64); });
  return words;
}

std::vector<double> PlaceWordFrequencies() {
  std::array<std::uint16_t, kWords> recorded{};
  std::memcpy(recorded.data(), PlaceTreeBytes().last(sizeof recorded).data(), sizeof recorded);
  std::vector<double> frequencies;
  for (const std::uint16_t each : recorded) frequencies.push_back(each / 65535.0);
  return frequencies;
}

std::vector<PlaceWords> PlaceWordsOf(const Map& map, std::span<const std::size_t> keyframes, int threads) {
  std::vector<PlaceWords> words(keyframes.size());
  detail::ParallelFor(keyframes.size(), 8, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      words[i] = PlaceWordsOf(LeftDescriptors(map.keyframes[keyframes[i]].features));
  });
  return words;
}

std::vector<PlaceWords> PlaceWordsOf(std::span<const std::span<const Descriptor>> pictures, int threads) {
  std::vector<PlaceWords> words(pictures.size());
  detail::ParallelFor(pictures.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) words[i] = PlaceWordsOf(pictures[i]);
  });
  return words;
}

PlaceWords SharedWords(std::span<const PlaceWords> keyframes) {
  if (keyframes.size() == 1) return keyframes[0];
  PlaceWords once{}, twice{};
  for (const PlaceWords& keyframe : keyframes) {
    for (std::size_t part = 0; part < once.size(); ++part) {
      twice[part] |= once[part] & keyframe[part];
      once[part] |= keyframe[part];
    }
  }
  return twice;
}

}  // namespace slamdb::rows
