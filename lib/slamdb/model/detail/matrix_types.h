// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstring>
#include <span>

#include "slamdb/model/matrix.h"

// OpenCV's type codes of matrices: what a number is in the lower three bits, channels less one above them.
namespace slamdb::detail {

// Of one channel, as OpenCV calls them.
inline constexpr std::int32_t kCv8U = 0, kCv32S = 4, kCv32F = 5, kCv64F = 6;

constexpr bool IsMatrixType(std::int64_t type) { return type >= 0 && type < 4096; }

// Requires: IsMatrixType(type).
constexpr std::uint64_t ElementBytes(std::int32_t type) {
  constexpr std::array<std::uint8_t, 8> kBytes = {1, 1, 2, 2, 4, 4, 8, 2};  // CV_8U to CV_16F
  return kBytes[static_cast<std::size_t>(type & 7)] * (static_cast<std::uint64_t>(type >> 3) + 1);
}

// Numbers as a column of 32-bit floats.
inline Matrix FloatColumn(std::span<const double> numbers) {
  Matrix matrix{.rows = static_cast<std::int32_t>(numbers.size()), .columns = 1, .type = kCv32F, .continuous = true};
  matrix.data.resize(numbers.size() * sizeof(float));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto number = static_cast<float>(numbers[i]);
    std::memcpy(matrix.data.data() + i * sizeof number, &number, sizeof number);
  }
  return matrix;
}

}  // namespace slamdb::detail
