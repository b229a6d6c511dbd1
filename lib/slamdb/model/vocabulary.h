// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// A vocabulary that is known by the MD5 of its file.
struct KnownVocabulary {
  std::string_view name, checksum;
  std::uint64_t words;
};

// ORB-SLAM's own, and those that slamdb's examples are made with.
[[nodiscard]] SLAMDB_EXPORT std::span<const KnownVocabulary> KnownVocabularies();

// How many words the vocabulary has, when its checksum is known.
[[nodiscard]] SLAMDB_EXPORT std::optional<std::uint64_t> KnownWords(const Vocabulary& vocabulary);

// Whether two checksums are one of which a few digits were damaged: those of different files differ in nearly all.
[[nodiscard]] SLAMDB_EXPORT bool IsDamagedCopy(std::string_view checksum, std::string_view original);

// From which word on a word is far above those of the other bags of the atlas, and more likely damaged than rare:
// `margin` times the median of the largest words of the bags. nullopt when too few keyframes have words to tell.
//
// Cost: linear in the keyframes.
[[nodiscard]] SLAMDB_EXPORT std::optional<std::uint64_t> WordsFarAbove(const Atlas& atlas, double margin = 2);

// Where the vocabulary of an atlas ends: as its checksum tells, or else where words are far above.
[[nodiscard]] SLAMDB_EXPORT std::optional<std::uint64_t> WordsEnd(const Atlas& atlas);

}  // namespace slamdb
