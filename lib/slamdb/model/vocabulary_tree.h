// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

#include "slamdb/export.h"
#include "slamdb/model/features.h"

namespace slamdb {

// How often and how rare a word is, in its weight. DBoW2: WeightingType, in the order of its numbers.
enum class WordWeighting : std::uint8_t { kTfIdf, kTf, kIdf, kBinary };

// How two bags are compared, which decides how a bag is normalised. DBoW2: ScoringType, in the order of its numbers.
enum class WordScoring : std::uint8_t { kL1, kL2, kChiSquare, kKullbackLeibler, kBhattacharyya, kDotProduct };

// A vocabulary tree of binary descriptors.
// Nodes are numbered as in its file, 0 being the root.
// The leaves are the words, numbered in the order of their nodes.
// Every node but a leaf has children, which come behind it, and no leaf is deeper than `depth`.
//
// Shapes: columns by node.
// After Nister and Stewenius, CVPR 2006; Galvez-Lopez and Tardos, DBoW2, TRO 2012.
struct VocabularyTree {
  static constexpr std::uint32_t kNoWord = std::numeric_limits<std::uint32_t>::max();

  int branching = 0;  // children of a node at most                     k
  int depth = 0;      // levels below the root                          L
  WordWeighting weighting = WordWeighting::kTfIdf;
  WordScoring scoring = WordScoring::kL1;
  std::uint32_t word_count = 0;

  Column<Descriptor> descriptors;     // centre of the node's cluster; the root's means nothing
  Column<double> weights;             // of words: inverse document frequency
  Column<std::uint32_t> words;        // kNoWord: not a leaf
  Column<std::uint32_t> first_child;  // children of node n: [first_child[n], first_child[n + 1]) of `children`
  Column<std::uint32_t> children;     // nodes, ascending for each parent

  std::size_t node_count() const { return words.size(); }
};

// What a keyframe's descriptors are in a vocabulary.
struct Words {
  BagOfWords bag_of_words;
  FeatureVector feature_vector;
  friend bool operator==(const Words&, const Words&) = default;
};

// The words of descriptors, to the last bit as DBoW2 computes them for ORB-SLAM3 (transform with `levels_up` 4).
// Each descriptor goes down to the child at the least Hamming distance, the first of equals.
// The weight of its word is added once for every feature, in double; the sum over ascending words divides them.
// Words of weight 0 are left out of both vectors.
// The feature vector groups rows by the node `levels_up` above the deepest level:
//   0, the root, when the tree is not that deep
//   the leaf itself where a branch ends earlier, for which DBoW2 has no defined value
//
// Requires: the tree is not empty.
// Cost: O(depth * branching) for each descriptor. Thread-safe.
SLAMDB_EXPORT Words ComputeWords(const VocabularyTree& tree, const Column<Descriptor>& descriptors, int levels_up = 4);

}  // namespace slamdb
