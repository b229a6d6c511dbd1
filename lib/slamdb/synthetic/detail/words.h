// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/model/features.h"

// Bags of words as a DBoW2 tree of 10 branches and 6 levels would make them: words 0 to 999,999; the node four levels
// above word w is 11 + w / 10,000, level two being the nodes 11 to 110. `words` holds the word of each feature row.
namespace slamdb::synthetic {

inline constexpr std::uint32_t kSyntheticWords = 1'000'000;

BagOfWords CountWords(std::vector<std::uint32_t> words);
FeatureVector GroupByNode(const std::vector<std::uint32_t>& words);

}  // namespace slamdb::synthetic
