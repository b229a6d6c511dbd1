// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/common_words.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "slamdb/align/detail/train_vocabulary.h"
#include "slamdb/base/detail/parallel.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kMostTrainedOn = 100'000;  // descriptors
constexpr int kLevelsUp = 2;                     // of nodes that group features for matching

bool IsSound(const BagOfWords& bag) {
  return !bag.words.empty() && bag.words.size() == bag.weights.size() && std::ranges::is_sorted(bag.words) &&
         std::ranges::all_of(bag.weights, [](double weight) { return weight >= 0 && weight <= 1; });
}

bool HasWords(const MapViews& map) {
  return std::ranges::all_of(map.views(), [&](const View& view) {
    return view.right || view.keypoints.empty() || IsSound(map.KeyFrameOf(view).features.bag_of_words);
  });
}

// Descriptors of all left views, one in so many that there are not too many.
std::vector<Descriptor> SampleOf(std::span<const MapViews* const> maps) {
  std::size_t total = 0;
  for (const MapViews* map : maps)
    for (const View& view : map->views()) total += view.descriptors.size();
  const std::size_t step = total / kMostTrainedOn + 1;
  std::vector<Descriptor> sample;
  std::size_t at = 0;
  for (const MapViews* map : maps)
    for (const View& view : map->views())
      for (const Descriptor& descriptor : view.descriptors)
        if (at++ % step == 0) sample.push_back(descriptor);
  return sample;
}

// Weighs words by how rare they are among the pictures, as TF-IDF does, in the tree and in each bag, whose sum is 1.
void WeighByRarity(std::vector<std::vector<Words>>& maps, VocabularyTree& tree) {
  std::vector<double> rarity(tree.word_count, 0);  // at first: in how many pictures
  double count = 0;
  for (const std::vector<Words>& views : maps)
    for (const Words& view : views) {
      count += view.bag_of_words.words.empty() ? 0 : 1;
      for (const std::uint32_t word : view.bag_of_words.words) ++rarity[word];
    }
  for (double& word : rarity) word = std::log((count + 1) / std::max(word, 1.0));
  for (std::size_t node = 0; node < tree.words.size(); ++node)
    if (tree.words[node] != VocabularyTree::kNoWord) tree.weights[node] = rarity[tree.words[node]];
  for (std::vector<Words>& views : maps)
    for (Words& view : views) {
      BagOfWords& bag = view.bag_of_words;
      for (std::size_t i = 0; i < bag.words.size(); ++i) bag.weights[i] *= rarity[bag.words[i]];
      const double sum = std::reduce(bag.weights.begin(), bag.weights.end());
      for (double& weight : bag.weights) weight = sum > 0 ? weight / sum : 0;
    }
}

}  // namespace

CommonWords::CommonWords(std::span<const MapViews* const> maps, bool same_vocabulary, int threads)
    : bags_(maps.size()), nodes_(maps.size()) {
  const bool recorded =
      same_vocabulary && std::ranges::all_of(maps, [](const MapViews* map) { return HasWords(*map); });
  if (!recorded) Train(maps, threads);
  for (std::size_t map = 0; map < maps.size(); ++map)
    for (std::size_t row = 0; row < maps[map]->views().size(); ++row) {
      const View& view = maps[map]->views()[row];
      const Features& features = maps[map]->KeyFrameOf(view).features;
      bags_[map].push_back(view.right ? nullptr : recorded ? &features.bag_of_words : &own_[map][row].bag_of_words);
      nodes_[map].push_back(view.right ? nullptr
                            : recorded ? &features.feature_vector
                                       : &own_[map][row].feature_vector);
    }
}

CommonWords::CommonWords(std::span<const MapViews* const> maps) {
  for (const MapViews* map : maps) {
    bags_.emplace_back(map->views().size(), nullptr);
    nodes_.emplace_back(map->views().size(), nullptr);
  }
}

void CommonWords::Train(std::span<const MapViews* const> maps, int threads) {
  tree_ = TrainVocabulary(SampleOf(maps));
  own_.resize(maps.size());
  for (std::size_t map = 0; map < maps.size(); ++map) {
    const std::span<const View> views = maps[map]->views();
    own_[map].resize(views.size());
    ParallelFor(views.size(), 8, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row)
        if (!views[row].right)
          own_[map][row] =
              ComputeWords(tree_, {views[row].descriptors.begin(), views[row].descriptors.end()}, kLevelsUp);
    });
  }
  WeighByRarity(own_, tree_);
}

}  // namespace slamdb::detail
