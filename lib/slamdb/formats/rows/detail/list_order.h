// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/base/file.h"

// The order of a map's list where it is not that of its rows: ORB-SLAM3 keeps its lists by address, so what a map gets
// comes to stand between what it had. Rows stay what they are, and their order stands beside them.
// Layout: schema/store.md, `map.keyframe_order`.
namespace slamdb::rows {

class ListOrder {
 public:
  ListOrder() = default;           // ascending
  explicit ListOrder(Bytes blob);  // throws Error (kDamaged)

  // Of rows in that order; nothing when they ascend.
  static std::string Encode(std::span<const std::int64_t> rows);

  bool is_ascending() const { return runs_.empty(); }

  // Brings lists whose entries belong to `rows`, which ascend, into the order. Throws Error (kDamaged) when one of them
  // has no place in it.
  template <class... List>
  void Sort(std::span<const std::int64_t> rows, List&... lists) const {
    if (is_ascending()) return;
    const std::vector<std::size_t> sorted = Sorted(rows);
    const auto sort = [&]<class Each>(Each& list) {
      Each in_order;
      in_order.reserve(list.size());
      for (const std::size_t i : sorted) in_order.push_back(std::move(list[i]));
      list = std::move(in_order);
    };
    (sort(lists), ...);
  }

 private:
  // Rows that follow each other.
  struct Run {
    std::uint32_t place = 0, count = 0;  // of the map's places, see plan.h
    std::size_t position = 0;            // of the first one in the list
  };
  // Which of `rows` is first in the list, second, ...
  std::vector<std::size_t> Sorted(std::span<const std::int64_t> rows) const;

  std::vector<Run> runs_;  // by place
};

}  // namespace slamdb::rows
