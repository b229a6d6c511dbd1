// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/place_index.h"

#include <algorithm>

namespace slamdb {
namespace {

// Rows that both columns have: in a damaged file they may differ in length.
std::size_t SizeOf(const BagOfWords& bag) { return std::min(bag.words.size(), bag.weights.size()); }

std::vector<std::uint32_t> DistinctWords(std::span<const BagOfWords* const> bags) {
  std::vector<std::uint32_t> words;
  for (const BagOfWords* bag : bags)
    if (bag != nullptr) words.insert(words.end(), bag->words.begin(), bag->words.end());
  std::ranges::sort(words);
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

}  // namespace

PlaceIndex::PlaceIndex(std::span<const BagOfWords* const> bags) : size_(bags.size()) {
  const std::vector<std::uint32_t> words = DistinctWords(bags);
  if (!words.empty()) rows_ = IdTable(words.front(), words.back(), words.size());
  for (std::uint32_t row = 0; row < words.size(); ++row) rows_.Insert(words[row], row);
  begins_.assign(words.size() + 1, 0);
  for (const BagOfWords* bag : bags)
    for (std::size_t i = 0; bag != nullptr && i < SizeOf(*bag); ++i) ++begins_[rows_.Find(bag->words[i]) + 1];
  for (std::size_t row = 1; row < begins_.size(); ++row) begins_[row] += begins_[row - 1];
  entries_.resize(begins_.back());
  std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
  for (std::uint32_t picture = 0; picture < bags.size(); ++picture)
    for (std::size_t i = 0; bags[picture] != nullptr && i < SizeOf(*bags[picture]); ++i)
      entries_[next[rows_.Find(bags[picture]->words[i])]++] = {picture, static_cast<float>(bags[picture]->weights[i])};
}

std::vector<float> PlaceIndex::Query(const BagOfWords& bag) const {
  std::vector<float> scores(size_, 0);
  if (entries_.empty()) return scores;
  for (std::size_t i = 0; i < SizeOf(bag); ++i) {
    const std::uint32_t row = rows_.Find(bag.words[i]);
    if (row == kNoRow) continue;
    const auto weight = static_cast<float>(bag.weights[i]);
    for (std::size_t at = begins_[row]; at < begins_[row + 1]; ++at)
      scores[entries_[at].picture] += std::min(weight, entries_[at].weight);
  }
  return scores;
}

}  // namespace slamdb
