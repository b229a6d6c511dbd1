// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/vocabulary_tree.h"

namespace slamdb {

struct MendWordsOptions {
  // The vocabulary that the words are of, which computes those that cannot be; null: none is at hand.
  const VocabularyTree* tree = nullptr;
  Vocabulary identity;   // of `tree`
  bool damaged = false;  // the atlas was: what no vocabulary vouches for goes when it is in doubt
  int threads = 0;       // 0: every core
  Progress progress;     // may be empty
};

struct MendWordsReport {
  std::uint64_t keyframes = 0;         // of the atlas
  std::uint64_t words = 0;             // that the vocabulary has; 0: it is neither given nor known by its checksum
  std::vector<KeyFrameId> recomputed;  // whose words could not be of the vocabulary, or were missing
  std::vector<KeyFrameId> dropped;     // whose words are in doubt, without a vocabulary to compute them with
  bool restored_vocabulary = false;    // the atlas named none, or a damaged checksum

  bool changed() const { return !recomputed.empty() || !dropped.empty() || restored_vocabulary; }
};

// Holds the bags of words and feature vectors against the vocabulary: a word beyond it makes ORB-SLAM3 write beyond the
// end of its inverted index when it loads the atlas.
// With a vocabulary, words that it does not give for the descriptors are computed anew; more words than the descriptors
// give may be of features that were dropped on purpose, and stay. Without one, a bag is in doubt when its words or
// nodes do not ascend, its weights are no numbers above 0 or do not add up to 1 as those of the other bags do, its
// features are not there, or a word is beyond a vocabulary that is known by its checksum, or else far above those of
// all other bags. Such a bag and its feature vector are dropped; `RecomputeWords` makes them anew.
//
// Throws Error (kNotPossible), before it changes anything, when the atlas names another vocabulary and its words are of
// another one. Cost: linear, in place; the result is the same for any number of threads.
SLAMDB_EXPORT MendWordsReport MendWords(Atlas& atlas, const MendWordsOptions& options = {});

// Refuses a vocabulary that MendWords refuses. Where the atlas names no vocabulary or this one, nothing is computed.
//
// Throws Error (kNotPossible). `damaged` of the options is ignored. Cost: linear.
SLAMDB_EXPORT void RequireVocabulary(const Atlas& atlas, const MendWordsOptions& options);

// Whether MendWords with a vocabulary would change nothing.
//
// Throws Error (kNotPossible) as it does. Cost: linear; nothing is copied.
[[nodiscard]] SLAMDB_EXPORT bool HasWordsOf(const Atlas& atlas, const MendWordsOptions& options);

// What became of the words, one sentence each.
[[nodiscard]] SLAMDB_EXPORT std::vector<std::string> SentencesOf(const MendWordsReport& report);

}  // namespace slamdb
