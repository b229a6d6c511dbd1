// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "slamdb/model/atlas.h"
#include "slamdb/model/features.h"

// What keyframes look like, so that pictures are looked for in a store without reading its atlases: which of 4,096
// words each shows. The words are a part of the store's format, like its schema, so that rows of all stores mean the
// same. They follow from keyframe_features, and are in no hash.
namespace slamdb::rows {

// A bit for each word.
using PlaceWords = std::array<std::uint64_t, 64>;

// How many there are.
int CountOf(const PlaceWords& words);

// Of a picture's descriptors. Thread-safe.
PlaceWords PlaceWordsOf(std::span<const Descriptor> descriptors);
// Of some of a map's keyframes, by their indices.
std::vector<PlaceWords> PlaceWordsOf(const Map& map, std::span<const std::size_t> keyframes, int threads);
// Of pictures, each by its descriptors.
std::vector<PlaceWords> PlaceWordsOf(std::span<const std::span<const Descriptor>> pictures, int threads);

// Of keyframes that follow each other: what two of them show at least, or one that is alone. That is seen again from
// nearby far more often than what one shows.
PlaceWords SharedWords(std::span<const PlaceWords> keyframes);

// In what share of the keyframes of real maps each word is.
std::vector<double> PlaceWordFrequencies();

}  // namespace slamdb::rows
