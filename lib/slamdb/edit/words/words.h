// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/vocabulary_tree.h"

namespace slamdb {

struct RecomputeWordsOptions {
  bool only_missing = false;  // leave keyframes alone that have both a bag of words and a feature vector
  int threads = 0;            // 0: every core
  Progress progress;          // may be empty
};

struct RecomputeWordsReport {
  std::uint64_t keyframes = 0;   // of the atlas
  std::uint64_t recomputed = 0;  // of those; the others were not missing, or have no descriptors
  std::uint64_t missing = 0;     // recomputed ones that lacked a bag of words or a feature vector
  std::uint64_t equal = 0;       // recomputed ones that had both, and got the same to the last bit
  std::uint64_t words = 0;       // entries of the recomputed bags
  Vocabulary before, after;      // that the atlas named, and names now
};

// Computes the bag of words and the feature vector of every keyframe anew from its descriptors, as ORB-SLAM3 does for a
// new keyframe (KeyFrame::ComputeBoW), and makes the atlas name `identity` as its vocabulary.
//
// Throws Error (kNotPossible), before it changes anything, when only the missing are asked for and others stay that
// were made with another vocabulary, and where descriptors are not ORB's. Cost: linear, in place; the result is the
// same for any number of threads.
SLAMDB_EXPORT RecomputeWordsReport RecomputeWords(Atlas& atlas, const VocabularyTree& tree, const Vocabulary& identity,
                                                  const RecomputeWordsOptions& options = {});

// As schema/vocabulary-recompute.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const RecomputeWordsReport& report, const ReportFiles& files = {});

}  // namespace slamdb
