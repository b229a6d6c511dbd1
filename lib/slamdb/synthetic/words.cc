// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/synthetic/detail/words.h"

#include <algorithm>
#include <array>

#include "slamdb/synthetic/detail/random.h"

namespace slamdb::synthetic {
namespace {

constexpr std::uint32_t kWordsPerNode = 10'000, kFirstNode = 11, kNodes = kSyntheticWords / kWordsPerNode;

}  // namespace

BagOfWords CountWords(std::vector<std::uint32_t> words) {
  std::sort(words.begin(), words.end());
  BagOfWords bag;
  double sum = 0;
  for (auto word = words.begin(); word != words.end();) {
    const auto next = std::upper_bound(word, words.end(), *word);
    const double rarity = Random({kWordWeight, *word}).Uniform(4, 10);  // the idf of a word
    bag.words.push_back(*word);
    bag.weights.push_back(rarity * static_cast<double>(next - word));
    sum += bag.weights.back();
    word = next;
  }
  for (double& weight : bag.weights) weight /= sum;
  return bag;
}

FeatureVector GroupByNode(const std::vector<std::uint32_t>& words) {
  std::array<std::uint32_t, kNodes> sizes{}, next{};
  for (const std::uint32_t word : words) ++sizes[word / kWordsPerNode];
  FeatureVector vector;
  std::uint32_t begin = 0;
  for (std::uint32_t node = 0; node < kNodes; ++node) {
    next[node] = begin;
    begin += sizes[node];
    if (sizes[node] == 0) continue;
    vector.nodes.push_back(kFirstNode + node);
    vector.sizes.push_back(sizes[node]);
  }
  vector.features.resize(words.size());
  for (std::uint32_t row = 0; row < words.size(); ++row) vector.features[next[words[row] / kWordsPerNode]++] = row;
  return vector;
}

}  // namespace slamdb::synthetic
