// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/words/mend.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/model/vocabulary.h"

namespace slamdb {
namespace {

constexpr std::size_t kGrain = 4;        // keyframes
constexpr double kNormTolerance = 1e-6;  // of the sum of weights

template <class SomeAtlas>
auto AllKeyFrames(SomeAtlas& atlas) {
  std::vector<decltype(&atlas.maps[0].keyframes[0])> keyframes;
  for (auto& map : atlas.maps)
    for (auto& keyframe : map.keyframes) keyframes.push_back(&keyframe);
  return keyframes;
}

bool Rises(const Column<std::uint32_t>& keys) {
  return std::ranges::adjacent_find(keys, std::greater_equal<>()) == keys.end();
}

bool HasNoWords(const Features& features) {
  return features.bag_of_words.words.empty() && features.feature_vector.nodes.empty();
}

bool AddsUpToOne(const BagOfWords& bag) {
  return std::abs(std::accumulate(bag.weights.begin(), bag.weights.end(), 0.0) - 1) <= kNormTolerance;
}

// Whether a std::map could have held them: words and nodes ascend, weights are numbers above 0, each feature is there
// and in one node.
bool IsInOrder(const Features& features) {
  const auto& [words, weights] = features.bag_of_words;
  const FeatureVector& vector = features.feature_vector;
  const auto is_weight = [](double weight) { return std::isfinite(weight) && weight > 0; };
  if (words.empty() != vector.nodes.empty() || words.size() != weights.size() || !Rises(words) ||
      !std::ranges::all_of(weights, is_weight))
    return false;
  if (vector.nodes.size() != vector.sizes.size() || !Rises(vector.nodes) ||
      std::accumulate(vector.sizes.begin(), vector.sizes.end(), std::uint64_t{0}) != vector.features.size())
    return false;
  std::vector<bool> seen(features.descriptors.size(), false);
  for (const std::uint32_t row : vector.features) {
    if (row >= seen.size() || seen[row]) return false;
    seen[row] = true;
  }
  return true;
}

// Whether the vocabulary gives these words for the descriptors that are left.
bool IsOf(const Features& features, const Words& computed, std::uint64_t word_count) {
  const Column<std::uint32_t>& words = features.bag_of_words.words;
  return IsInOrder(features) && (words.empty() || words.back() < word_count) &&
         AddsUpToOne(features.bag_of_words) == AddsUpToOne(computed.bag_of_words) &&
         std::ranges::includes(words, computed.bag_of_words.words) &&
         features.feature_vector == computed.feature_vector;
}

// ---- With a vocabulary

std::string NamesAnother(const Vocabulary& atlas, const Vocabulary& given) {
  return detail::Concat("its words are of another vocabulary, '", atlas.name, "' (", atlas.checksum, "), not of '",
                        given.name, "' (", given.checksum, "); `RecomputeWords` computes all anew");
}

// Whether the atlas says that it is of the vocabulary, or says nothing.
bool NamesVocabulary(const Atlas& atlas, const Vocabulary& given) {
  return atlas.vocabulary.checksum == given.checksum || atlas.vocabulary.checksum.empty() ||
         IsDamagedCopy(atlas.vocabulary.checksum, given.checksum);
}

// What the vocabulary gives for each keyframe's descriptors, where the keyframe's words are others.
struct Held {
  std::vector<Words> computed;
  std::vector<std::uint8_t> fits;
};

// Throws when the atlas neither names the vocabulary nor has mostly words of it.
Held Hold(const Atlas& atlas, const MendWordsOptions& options) {
  const auto keyframes = AllKeyFrames(atlas);
  std::vector<Words> computed(keyframes.size());
  std::vector<std::uint8_t> fits(keyframes.size());
  detail::ParallelFor(keyframes.size(), kGrain, options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Features& features = keyframes[i]->features;
      computed[i] = ComputeWords(*options.tree, features.descriptors);
      fits[i] = IsOf(features, computed[i], options.tree->word_count);
      if (fits[i]) computed[i] = {};
    }
  });
  std::size_t with_words = 0, fitting = 0;
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const bool has_words = !HasNoWords(keyframes[i]->features);
    with_words += has_words;
    fitting += has_words && fits[i];
  }
  if (!NamesVocabulary(atlas, options.identity) && 2 * fitting <= with_words)
    throw Error(ErrorKind::kNotPossible, NamesAnother(atlas.vocabulary, options.identity));
  return {std::move(computed), std::move(fits)};
}

void HoldAgainst(Atlas& atlas, const MendWordsOptions& options, MendWordsReport& report) {
  auto [computed, fits] = Hold(atlas, options);
  const auto keyframes = AllKeyFrames(atlas);
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    if (fits[i]) continue;
    keyframes[i]->features.bag_of_words = std::move(computed[i].bag_of_words);
    keyframes[i]->features.feature_vector = std::move(computed[i].feature_vector);
    report.recomputed.push_back(keyframes[i]->id);
  }
  report.words = options.tree->word_count;
}

// ---- Without one

// A word is beyond the vocabulary from here on.
std::optional<std::uint64_t> EndOf(const Atlas& atlas, bool damaged) {
  if (!damaged || KnownWords(atlas.vocabulary)) return WordsEnd(atlas);
  // The largest words of bags lie close together, the closer the more words the bags have.
  std::uint64_t bags = 0, words = 0;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) {
      bags += !keyframe.features.bag_of_words.words.empty();
      words += keyframe.features.bag_of_words.words.size();
    }
  return words == 0
             ? std::nullopt
             : WordsFarAbove(atlas, 1 + std::min(1.0, 8.0 * static_cast<double>(bags) / static_cast<double>(words)));
}

void DropDoubtful(Atlas& atlas, const MendWordsOptions& options, MendWordsReport& report) {
  const auto keyframes = AllKeyFrames(atlas);
  std::size_t with_words = 0, adding_up = 0;
  for (const KeyFrame* keyframe : keyframes) {
    if (HasNoWords(keyframe->features)) continue;
    ++with_words;
    adding_up += AddsUpToOne(keyframe->features.bag_of_words);
  }
  const bool must_add_up = options.damaged && 2 * adding_up > with_words;  // other scorings norm otherwise
  const std::optional<std::uint64_t> end = EndOf(atlas, options.damaged);
  for (KeyFrame* keyframe : keyframes) {
    Features& features = keyframe->features;
    const Column<std::uint32_t>& words = features.bag_of_words.words;
    if (HasNoWords(features)) continue;
    if (IsInOrder(features) && (!end || words.empty() || words.back() < *end) &&
        (!must_add_up || AddsUpToOne(features.bag_of_words)))
      continue;
    features.bag_of_words = {};
    features.feature_vector = {};
    report.dropped.push_back(keyframe->id);
  }
  report.words = KnownWords(atlas.vocabulary).value_or(0);
}

// A checksum of which some digits were damaged is that of the vocabulary that it is nearly the checksum of.
bool RestoreVocabulary(const MendWordsOptions& options, Vocabulary& vocabulary) {
  if (options.tree != nullptr) {
    const bool nearly = options.damaged && (vocabulary.checksum.size() != options.identity.checksum.size() ||
                                            IsDamagedCopy(vocabulary.checksum, options.identity.checksum));
    if (!vocabulary.checksum.empty() && !nearly) return false;
    vocabulary = options.identity;
    return true;
  }
  if (!options.damaged) return false;
  for (const KnownVocabulary& known : KnownVocabularies()) {
    if (!IsDamagedCopy(vocabulary.checksum, known.checksum)) continue;
    vocabulary = {std::string(known.name), std::string(known.checksum)};
    return true;
  }
  return false;
}

std::string Listed(const std::vector<KeyFrameId>& ids) {
  constexpr std::size_t kShown = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(kShown, ids.size()); ++i) text += (text.empty() ? "" : ", ") + ToString(ids[i]);
  return ids.size() > kShown ? text + ", .." : text;
}

}  // namespace

MendWordsReport MendWords(Atlas& atlas, const MendWordsOptions& options) {
  MendWordsReport report;
  for (const Map& map : atlas.maps) report.keyframes += map.keyframes.size();
  if (report.keyframes == 0) return report;
  detail::Steps steps(options.progress, "holding words against their vocabulary", 1);
  if (options.tree != nullptr) HoldAgainst(atlas, options, report);
  report.restored_vocabulary = RestoreVocabulary(options, atlas.vocabulary);
  if (options.tree == nullptr) DropDoubtful(atlas, options, report);
  steps.Next();
  return report;
}

void RequireVocabulary(const Atlas& atlas, const MendWordsOptions& options) {
  if (!NamesVocabulary(atlas, options.identity)) Hold(atlas, options);
}

bool HasWordsOf(const Atlas& atlas, const MendWordsOptions& options) {
  if (AllKeyFrames(atlas).empty()) return true;
  const Held held = Hold(atlas, options);
  Vocabulary vocabulary = atlas.vocabulary;
  return std::ranges::find(held.fits, 0) == held.fits.end() && !RestoreVocabulary(options, vocabulary);
}

std::vector<std::string> SentencesOf(const MendWordsReport& report) {
  std::vector<std::string> sentences;
  const auto tell = [&](const std::vector<KeyFrameId>& ids, std::string_view what) {
    if (!ids.empty())
      sentences.push_back(
          detail::Concat("the words of ", detail::Counted(ids.size(), "keyframe"), " (", Listed(ids), ") ", what));
  };
  if (report.restored_vocabulary)
    sentences.emplace_back("the vocabulary's checksum was damaged, and is that of the vocabulary again");
  tell(report.recomputed, "computed anew with the vocabulary");
  tell(report.dropped, "dropped, since they are in doubt; `RecomputeWords` makes them anew");
  return sentences;
}

}  // namespace slamdb
