// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "slamdb/export.h"

namespace slamdb {

// Of a set of errors, as evo and numpy define them. All but the count are NaN when it is empty.
struct ErrorStatistics {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::uint64_t count = 0;
  double rmse = kNone, mean = kNone, median = kNone;  // the median of an even number is the mean of the two middle ones
  double std = kNone;                                 // standard deviation, of a population: over n, not n - 1
  double min = kNone, max = kNone;
  double sse = kNone;                                                      // sum of squared errors
  double p25 = kNone, p75 = kNone, p90 = kNone, p95 = kNone, p99 = kNone;  // percentiles, see PercentileOf
};

// Cost: O(n log n).
[[nodiscard]] SLAMDB_EXPORT ErrorStatistics ErrorStatisticsOf(std::vector<double> errors);

// The value that `percent` of a sorted list are at most, interpolated between the two nearest ones.
[[nodiscard]] SLAMDB_EXPORT double PercentileOf(std::span<const double> sorted, double percent);

}  // namespace slamdb
