// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "slamdb/export.h"
#include "slamdb/model/ids.h"

// The colours of pictures of maps, told apart with every kind of colour vision.
namespace slamdb {

// Red, green and blue, as sRGB.
using Color = std::array<std::uint8_t, 3>;

// Of what has no value.
inline constexpr Color kNoColor = {128, 128, 128};

// Of the edges of a map's graph.
inline constexpr Color kCovisibilityColor = {148, 164, 162}, kSpanningTreeColor = {146, 218, 221},
                       kLoopColor = {189, 31, 1}, kMergeColor = {131, 45, 182};

// One of ten colours, by map id.
// M. A. Petroff, "Accessible color sequences for data visualization", 2021.
SLAMDB_EXPORT Color ColorOfMap(MapId id);

// From dark violet at 0 by green to yellow at 1, as light as the value is large; kNoColor for NaN.
// Values beyond are those at the ends.
// "Viridis" of S. van der Walt and N. Smith, in 15 straight pieces.
SLAMDB_EXPORT Color ColorOfShare(double share);

}  // namespace slamdb
