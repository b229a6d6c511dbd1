// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/features.h"
#include "slamdb/model/index.h"

namespace slamdb {

// Which of many pictures look like one: an inverted file of bags of words, from each word to the pictures that have it.
// Pictures are numbered by their place in the list that the index is made of.
// Refers to nothing after it is made.
//
// Cost: to make, linear in the words of all bags; a query, in the entries of the lists of its own words: far fewer than
// the pictures have words.
// Constant after construction: safe to use from many threads.
// After Sivic and Zisserman, ICCV 2003, and DBoW2 (Galvez-Lopez and Tardos, TRO 2012).
class SLAMDB_EXPORT PlaceIndex {
 public:
  // Bags of one vocabulary. A null has no words.
  explicit PlaceIndex(std::span<const BagOfWords* const> bags);

  std::size_t size() const { return size_; }

  // By picture, how alike it is: DBoW2's L1 score, 0 nothing in common to 1 equal.
  std::vector<float> Query(const BagOfWords& bag) const;

 private:
  struct Entry {
    std::uint32_t picture;
    float weight;
  };

  std::size_t size_;
  IdTable rows_;                     // word -> row of begins_
  std::vector<std::size_t> begins_;  // of row r: [begins_[r], begins_[r + 1]) of entries_
  std::vector<Entry> entries_;       // ascending by picture inside a word
};

}  // namespace slamdb
