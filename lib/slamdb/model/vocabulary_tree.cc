// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/vocabulary_tree.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slamdb/model/derive.h"

namespace slamdb {
namespace {

struct Place {
  std::uint32_t leaf = 0, group = 0;  // nodes
};

Place FindPlace(const VocabularyTree& tree, const Descriptor& descriptor, int group_level) {
  Place place;
  for (int level = 1; tree.words[place.leaf] == VocabularyTree::kNoWord; ++level) {
    const std::uint32_t end = tree.first_child[place.leaf + 1];
    int least = std::numeric_limits<int>::max();
    for (std::uint32_t i = tree.first_child[place.leaf]; i < end; ++i) {
      const int distance = HammingDistance(descriptor, tree.descriptors[tree.children[i]]);
      if (distance >= least) continue;
      least = distance;
      place.leaf = tree.children[i];
    }
    if (level <= group_level) place.group = place.leaf;
  }
  return place;
}

// Two numbers in one, so that sorting sorts by the first and then the second.
std::uint64_t Pair(std::uint32_t first, std::uint32_t second) { return std::uint64_t{first} << 32 | second; }
std::uint32_t First(std::uint64_t pair) { return static_cast<std::uint32_t>(pair >> 32); }
std::uint32_t Second(std::uint64_t pair) { return static_cast<std::uint32_t>(pair); }

void Normalize(WordScoring scoring, WordWeighting weighting, Column<double>& weights) {
  double divisor = 0;
  if (scoring == WordScoring::kDotProduct) {
    const bool by_frequency = weighting == WordWeighting::kTfIdf || weighting == WordWeighting::kTf;
    divisor = by_frequency ? static_cast<double>(weights.size()) : 0;
  } else if (scoring == WordScoring::kL2) {
    for (const double weight : weights) divisor += weight * weight;
    divisor = std::sqrt(divisor);
  } else {
    for (const double weight : weights) divisor += weight;
  }
  if (divisor <= 0) return;
  for (double& weight : weights) weight /= divisor;
}

// `leaves`: a pair of word and leaf for each feature, ascending.
BagOfWords MakeBag(const VocabularyTree& tree, const std::vector<std::uint64_t>& leaves) {
  const bool counts = tree.weighting == WordWeighting::kTfIdf || tree.weighting == WordWeighting::kTf;
  BagOfWords bag;
  for (const std::uint64_t pair : leaves) {
    const double weight = tree.weights[Second(pair)];
    if (bag.words.empty() || bag.words.back() != First(pair)) {
      bag.words.push_back(First(pair));
      bag.weights.push_back(weight);
    } else if (counts) {
      bag.weights.back() += weight;  // a product would round otherwise
    }
  }
  Normalize(tree.scoring, tree.weighting, bag.weights);
  return bag;
}

// `groups`: a pair of node and row for each feature, ascending.
FeatureVector MakeFeatureVector(const std::vector<std::uint64_t>& groups) {
  FeatureVector vector;
  vector.features.reserve(groups.size());
  for (const std::uint64_t pair : groups) {
    if (vector.nodes.empty() || vector.nodes.back() != First(pair)) {
      vector.nodes.push_back(First(pair));
      vector.sizes.push_back(0);
    }
    ++vector.sizes.back();
    vector.features.push_back(Second(pair));
  }
  return vector;
}

}  // namespace

Words ComputeWords(const VocabularyTree& tree, const Column<Descriptor>& descriptors, int levels_up) {
  std::vector<std::uint64_t> leaves, groups;
  leaves.reserve(descriptors.size());
  groups.reserve(descriptors.size());
  for (std::uint32_t row = 0; row < descriptors.size(); ++row) {
    const Place place = FindPlace(tree, descriptors[row], tree.depth - levels_up);
    if (tree.weights[place.leaf] <= 0) continue;
    leaves.push_back(Pair(tree.words[place.leaf], place.leaf));
    groups.push_back(Pair(place.group, row));
  }
  std::sort(leaves.begin(), leaves.end());
  std::sort(groups.begin(), groups.end());
  return {MakeBag(tree, leaves), MakeFeatureVector(groups)};
}

}  // namespace slamdb
