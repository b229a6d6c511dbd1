// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "slamdb/model/vocabulary_tree.h"

namespace slamdb::detail {

// A small vocabulary of the descriptors of the pictures that are to be compared, for maps that share none.
// Hierarchical k-means over bits: the centre of a cluster has the bits that most of its descriptors have.
// All words weigh 1. Deterministic: no random numbers.
// Cost: linear in the descriptors, O(branching * depth) distances for each.
// After Nister and Stewenius, CVPR 2006.
VocabularyTree TrainVocabulary(std::span<const Descriptor> descriptors, int branching = 10, int depth = 4);

}  // namespace slamdb::detail
