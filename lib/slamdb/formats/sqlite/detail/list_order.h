// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/formats/sqlite/detail/database.h"

// The order of a map's list where it is not that of its rows: ORB-SLAM3 keeps its lists by address, so what a map gets
// comes to stand between what it had. Rows stay what they are, and their order stands beside them.
// Layout: schema/store.md, `map.keyframe_order`.
namespace slamdb::sqlite {

class ListOrder {
 public:
  ListOrder() = default;           // ascending
  explicit ListOrder(Bytes blob);  // throws Error (kDamaged)

  // Of the `list` keyframe, point or landmark of a map. Stores before version 7 know no other than ascending rows.
  static ListOrder Of(Database& database, std::int64_t map, std::string_view list);

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

// The rows of a list, which are those of `table`, in its order.
std::vector<std::int64_t> RowsInOrder(Database& database, std::int64_t map, std::string_view list,
                                      std::string_view table);

// The step from version 7 back to 6, which knows no order: gives the entries of lists that have one new rows, which
// ascend. Throws Error (kNotPossible) where a map has no more rows.
void MakeListsAscend(Database& database);

}  // namespace slamdb::sqlite
