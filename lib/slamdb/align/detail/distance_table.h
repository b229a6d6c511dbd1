// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "slamdb/model/features.h"

namespace slamdb::detail {

// A descriptor as words, for counting.
using Bits = std::array<std::uint64_t, 4>;
Bits BitsOf(const Descriptor& descriptor);

// Descriptors as columns of words, so that one is compared with many at a time.
class BitColumns {
 public:
  explicit BitColumns(std::span<const Bits> descriptors);

  std::size_t size() const { return words_[0].size(); }
  // In how many bits each differs from `one`: `distances` has room for size().
  void DistancesTo(const Bits& one, std::uint16_t* distances) const;

 private:
  std::array<std::vector<std::uint64_t>, 4> words_;
};

// In how many bits each of some descriptors differs from each of others.
class DistanceTable {
 public:
  DistanceTable(const std::vector<Bits>& rows, const std::vector<Bits>& columns);

  std::size_t columns() const { return columns_; }
  const std::uint16_t* Row(std::size_t row) const { return &distances_[row * columns_]; }
  std::uint16_t operator()(std::size_t row, std::size_t column) const { return distances_[row * columns_ + column]; }

 private:
  std::size_t columns_;
  std::vector<std::uint16_t> distances_;  // row after row
};

}  // namespace slamdb::detail
