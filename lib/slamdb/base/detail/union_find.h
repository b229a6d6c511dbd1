// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace slamdb::detail {

// Rows that belong together, however far the links between them lead.
class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), std::uint32_t{0});
  }
  // One row of each set stands for all of it: the lowest.
  std::uint32_t Root(std::uint32_t row) {
    while (parents_[row] != row) row = parents_[row] = parents_[parents_[row]];
    return row;
  }
  void Join(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax({Root(a), Root(b)});
    parents_[high] = low;
  }

 private:
  std::vector<std::uint32_t> parents_;
};

}  // namespace slamdb::detail
