// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "slamdb/formats/sqlite/detail/save.h"
#include "slamdb/model/features.h"

// What keyframes look like, so that pictures are looked for in a store without reading its atlases: which of 4,096
// words each shows. The words are a part of the store's format, like its schema, so that rows of all stores mean the
// same. They follow from keyframe_features, and are in no hash.
namespace slamdb::sqlite {

// A bit for each word.
using PlaceWords = std::array<std::uint64_t, 64>;

// Of a picture's descriptors. Thread-safe.
PlaceWords PlaceWordsOf(std::span<const Descriptor> descriptors);

// In what share of the keyframes of real maps each word is.
std::vector<double> PlaceWordFrequencies();

// Brings the rows of a map's keyframes up to date, and deletes those of others. `rows`: of map.keyframes, ascending.
void SavePlaceWords(SaveContext& context, std::int64_t map_row, const Map& map, std::span<const std::int64_t> rows,
                    std::span<const std::int64_t> features_hashes);

// Makes the rows of the whole store anew. Keyframes whose features are damaged stay without. In the caller's
// transaction.
void RebuildPlaceWords(Database& database);

}  // namespace slamdb::sqlite
