// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

// Where a list is cut: the value that a share of it lies at or below. Two definitions, as who asks needs: an element of
// the list, found in linear time, for pictures and limits; or numpy's, between two elements, for figures that are
// compared with those of other programs.
namespace slamdb::detail {

// The element that would stand in that row were the list sorted; reorders the list, which has such a row.
template <class List>
auto ElementInOrder(List&& list, std::size_t row) {
  const auto place = std::begin(list) + static_cast<std::ptrdiff_t>(row);
  std::nth_element(std::begin(list), place, std::end(list));
  return *place;
}

// The upper of the two in the middle where there are as many above as below; a value of nothing for an empty list.
template <class List>
auto MedianOf(List list) {
  using Value = typename List::value_type;
  return list.empty() ? Value() : ElementInOrder(list, list.size() / 2);
}

// The element at `share`, from 0 (the least) to 1 (the largest), of the way through the list were it sorted; where that
// is between two elements, the lower. A value of nothing for an empty list. Reorders the list.
template <class List>
auto QuantileOf(List& list, double share) {
  using Value = typename List::value_type;
  if (list.empty()) return Value();
  return ElementInOrder(list, static_cast<std::size_t>(share * static_cast<double>(list.size() - 1)));
}

// The value there, interpolated between the two elements, as numpy has it; of a list that is sorted and not empty.
inline double InterpolatedQuantileOf(std::span<const double> sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - std::floor(place));
}

}  // namespace slamdb::detail
