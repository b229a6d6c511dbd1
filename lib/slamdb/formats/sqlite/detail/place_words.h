// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "slamdb/formats/rows/detail/place_words.h"
#include "slamdb/formats/sqlite/detail/save.h"

// The table `keyframe_words`.
namespace slamdb::sqlite {

using rows::PlaceWords;
using rows::PlaceWordsOf;

// Whether each keyframe of a map has its row, as far as the hashes of what the rows were made of tell. Reads no
// keyframe.
bool HasAllPlaceWords(Database& database, std::int64_t map_row, std::span<const std::int64_t> features_hashes);

// Brings the rows of a map's keyframes up to date, and deletes those of others. `rows`: of map.keyframes, ascending.
void SavePlaceWords(SaveContext& context, std::int64_t map_row, const Map& map, std::span<const std::int64_t> rows,
                    std::span<const std::int64_t> features_hashes);

// Makes the rows of the whole store anew. Keyframes whose features are damaged stay without. In the caller's
// transaction.
void RebuildPlaceWords(Database& database);

}  // namespace slamdb::sqlite
