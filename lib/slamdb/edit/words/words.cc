// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/words/words.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

constexpr std::size_t kGrain = 4;  // keyframes

// ORB-SLAM3 computes both when either is empty.
bool IsMissing(const Features& features) {
  return features.bag_of_words.words.empty() || features.feature_vector.nodes.empty();
}

void RefuseMixing(const Atlas& atlas, const Vocabulary& identity) {
  if (atlas.vocabulary.checksum == identity.checksum) return;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes)
      if (!IsMissing(keyframe.features))
        throw Error(ErrorKind::kNotPossible,
                    "the words of " + ToString(keyframe.id) + " were made with another vocabulary, '" +
                        atlas.vocabulary.name + "' (" + atlas.vocabulary.checksum + "), not with '" + identity.name +
                        "' (" + identity.checksum + "); recompute all keyframes, or give that vocabulary");
}

std::vector<KeyFrame*> Wanted(Atlas& atlas, bool only_missing, RecomputeWordsReport& report) {
  std::vector<KeyFrame*> wanted;
  for (Map& map : atlas.maps) {
    report.keyframes += map.keyframes.size();
    for (KeyFrame& keyframe : map.keyframes) {
      const bool missing = IsMissing(keyframe.features);
      if (keyframe.features.descriptors.empty() || (only_missing && !missing)) continue;
      report.missing += missing;
      wanted.push_back(&keyframe);
    }
  }
  report.recomputed = wanted.size();
  return wanted;
}

// Words are of ORB's descriptors alone.
void RefuseOtherDescriptors(const Atlas& atlas) {
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) {
      if (!keyframe.carried || keyframe.carried->descriptors.columns == 0) continue;
      const Matrix& matrix = keyframe.carried->descriptors;
      throw Error(ErrorKind::kNotPossible, "", ToString(map.id) + ", " + ToString(keyframe.id),
                  detail::Concat("its descriptors have ", matrix.columns, " numbers of OpenCV's type ", matrix.type,
                                 ", as those of SIFT and SuperPoint; words are of ORB's 32 bytes"));
    }
}

// An atlas without any would name a vocabulary of which it has no word.
void RefuseNoDescriptors(const Atlas& atlas) {
  bool any_keyframe = false;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) {
      if (!keyframe.features.descriptors.empty()) return;
      any_keyframe = true;
    }
  if (any_keyframe)
    throw Error(ErrorKind::kNotPossible,
                "no keyframe has a descriptor, so there are no words to compute; reconstructions get theirs from the "
                "database that ColmapReadOptions::database names, when they are read");
}

}  // namespace

RecomputeWordsReport RecomputeWords(Atlas& atlas, const VocabularyTree& tree, const Vocabulary& identity,
                                    const RecomputeWordsOptions& options) {
  RefuseOtherDescriptors(atlas);
  RefuseNoDescriptors(atlas);
  if (options.only_missing) RefuseMixing(atlas, identity);
  RecomputeWordsReport report{.before = atlas.vocabulary, .after = identity};
  const std::vector<KeyFrame*> wanted = Wanted(atlas, options.only_missing, report);
  std::atomic<std::uint64_t> equal{0}, words{0}, done{0};
  const std::thread::id caller = std::this_thread::get_id();
  detail::ParallelFor(wanted.size(), kGrain, options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Features& features = wanted[i]->features;
      Words computed = ComputeWords(tree, features.descriptors);
      words += computed.bag_of_words.words.size();
      equal += !IsMissing(features) && computed.bag_of_words == features.bag_of_words &&
               computed.feature_vector == features.feature_vector;
      features.bag_of_words = std::move(computed.bag_of_words);
      features.feature_vector = std::move(computed.feature_vector);
    }
    done += end - begin;
    if (options.progress && std::this_thread::get_id() == caller)
      options.progress("computing words", static_cast<double>(done) / static_cast<double>(wanted.size()));
  });
  report.equal = equal;
  report.words = words;
  atlas.vocabulary = identity;
  return report;
}

}  // namespace slamdb
