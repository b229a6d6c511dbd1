// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/features.h"

namespace slamdb::detail {

// A descriptor as words, for counting.
using Bits = std::array<std::uint64_t, 4>;
SLAMDB_EXPORT Bits BitsOf(const Descriptor& descriptor);

// Descriptors as columns of words, so that one is compared with many at a time.
class SLAMDB_EXPORT BitColumns {
 public:
  explicit BitColumns(std::span<const Bits> descriptors);

  std::size_t size() const { return words_[0].size(); }
  // In how many bits each of `count` from row `first` on differs from `one`. `distances` has room for these.
  void DistancesTo(const Bits& one, std::size_t first, std::size_t count, std::uint16_t* distances) const;
  // Of all.
  void DistancesTo(const Bits& one, std::uint16_t* distances) const { DistancesTo(one, 0, size(), distances); }

 private:
  std::array<std::vector<std::uint64_t>, 4> words_;
};

}  // namespace slamdb::detail
