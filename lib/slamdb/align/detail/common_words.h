// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "slamdb/align/detail/map_views.h"
#include "slamdb/model/vocabulary_tree.h"

namespace slamdb::detail {

// The words of the left views of some maps in one vocabulary.
// As recorded where the atlases name the same vocabulary and every view has its bag; else of a vocabulary that is
// trained on the maps themselves.
class CommonWords {
 public:
  // Refers to the maps. `same_vocabulary`: what their atlases name is one.
  CommonWords(std::span<const MapViews* const> maps, bool same_vocabulary, int threads = 0);
  // No view has words.
  explicit CommonWords(std::span<const MapViews* const> maps);

  bool trained() const { return !own_.empty(); }
  // The vocabulary that was trained, its words weighed by how rare they are in the maps; without nodes where none was.
  const VocabularyTree& trained_tree() const { return tree_; }

  // Of a left view; of a right one, which has none of its own, null.
  const BagOfWords* Bag(std::size_t map, std::uint32_t view) const { return bags_[map][view]; }
  std::span<const BagOfWords* const> Bags(std::size_t map) const { return bags_[map]; }
  const FeatureVector* Nodes(std::size_t map, std::uint32_t view) const { return nodes_[map][view]; }

 private:
  void Train(std::span<const MapViews* const> maps, int threads);

  std::vector<std::vector<const BagOfWords*>> bags_;  // by map and view
  std::vector<std::vector<const FeatureVector*>> nodes_;
  std::vector<std::vector<Words>> own_;
  VocabularyTree tree_;
};

}  // namespace slamdb::detail
