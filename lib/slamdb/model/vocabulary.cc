// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/vocabulary.h"

#include <algorithm>
#include <array>
#include <vector>

#include "slamdb/base/detail/median.h"

namespace slamdb {
namespace {

constexpr std::array kKnown = {
    KnownVocabulary{"ORBvoc.txt", "5420bad0713bc97034dd2a9b2f0cc387", 971'815},  // as ORB-SLAM2 and 3 come with it
    KnownVocabulary{"labvoc.txt", "6cfd24abfaccea29d49a8d99d874d41d", 405'448},
    KnownVocabulary{"synthetic.txt", "5e1f00d5e1f00d5e1f00d5e1f00d5e1f", 1'000'000},  // of `SynthesizeAtlas`
    KnownVocabulary{"small.txt", "d1794015a5038cf90ae5d6308e2d81af", 27},
    KnownVocabulary{"small.bin", "3c9a7c0ca5fcfe0f47d39fbf01877eaa", 27},
};

constexpr std::size_t kFewestBags = 3;            // that tell what is usual
constexpr std::uint64_t kSmallVocabulary = 4096;  // words; below this a few bags tell little

}  // namespace

std::span<const KnownVocabulary> KnownVocabularies() { return kKnown; }

std::optional<std::uint64_t> KnownWords(const Vocabulary& vocabulary) {
  const auto found = std::ranges::find(kKnown, std::string_view(vocabulary.checksum), &KnownVocabulary::checksum);
  return found == kKnown.end() ? std::nullopt : std::optional(found->words);
}

bool IsDamagedCopy(std::string_view checksum, std::string_view original) {
  constexpr std::size_t kMostDamaged = 8;
  if (checksum.size() != original.size() || checksum == original) return false;
  std::size_t differ = 0;
  for (std::size_t i = 0; i < checksum.size(); ++i) differ += checksum[i] != original[i];
  return differ <= kMostDamaged;
}

std::optional<std::uint64_t> WordsFarAbove(const Atlas& atlas, double margin) {
  std::vector<std::uint32_t> largest;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) {
      const Column<std::uint32_t>& words = keyframe.features.bag_of_words.words;
      if (!words.empty()) largest.push_back(*std::ranges::max_element(words));
    }
  if (largest.size() < kFewestBags) return std::nullopt;
  const double median = detail::MedianOf(std::move(largest));
  return std::max(kSmallVocabulary, static_cast<std::uint64_t>(median * margin) + 1);
}

std::optional<std::uint64_t> WordsEnd(const Atlas& atlas) {
  const std::optional<std::uint64_t> known = KnownWords(atlas.vocabulary);
  return known ? known : WordsFarAbove(atlas);
}

}  // namespace slamdb
