// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "slamdb/export.h"
#include "slamdb/model/similarity.h"

namespace slamdb {

// A transform as text. Numbers are separated by blanks, commas, semicolons or line feeds; `#` or `%` begins a comment.
// Commas are those of decimals where something else separates: `1,5;2;3;0;0;0;1`.
//   7 or 8    tx ty tz qx qy qz qw [scale]; the quaternion is within a tenth of length 1, and normalised. In any order
//             under a line of names, as tables of poses have them
//   12 or 16  the rows of a 3x4 or 4x4 matrix [s R | t], whose last row is 0 0 0 1
//
// Throws Error (kUsage) when the text is neither, or the transform singular, mirrored, sheared or not finite, or the 8
// numbers are a pose with its time; (kDamaged) with the line when a row under names is none.
[[nodiscard]] SLAMDB_EXPORT Similarity3d ParseSimilarity(std::string_view text);

// The same of the numbers themselves, or of a file that holds them.
//
// Throws Error as ParseSimilarity, of a file with its path and as kDamaged; kNotFound when it is neither.
[[nodiscard]] SLAMDB_EXPORT Similarity3d ReadSimilarity(const std::string& text_or_path);

// As 8 numbers that ParseSimilarity takes, with the digits that give the same doubles again.
[[nodiscard]] SLAMDB_EXPORT std::string ToText(const Similarity3d& transform);

}  // namespace slamdb
