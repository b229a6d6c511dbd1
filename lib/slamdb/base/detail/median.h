// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace slamdb::detail {

// The upper of the two in the middle where there are as many above as below; a value of nothing for an empty list.
template <class Value>
Value MedianOf(std::vector<Value> values) {
  if (values.empty()) return Value();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace slamdb::detail
