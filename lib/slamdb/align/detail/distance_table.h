// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "slamdb/model/detail/bit_columns.h"

namespace slamdb::detail {

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
