// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "slamdb/base/detail/median.h"

namespace slamdb::detail {

// Poses that are more seconds apart than this have a gap between them, in plots and in the coverage of evaluations:
// five times their median distance in time, and a second at least. `times` ascend.
inline double GapBetween(const std::vector<double>& times) {
  constexpr double kMedians = 5, kLeast = 1;
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  return std::max(kLeast, kMedians * MedianOf(std::move(steps)));
}

}  // namespace slamdb::detail
