// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/evaluate/error_statistics.h"

#include <algorithm>
#include <cmath>

#include "slamdb/base/detail/median.h"

namespace slamdb {

double PercentileOf(std::span<const double> sorted, double percent) {
  if (sorted.empty()) return ErrorStatistics::kNone;
  return detail::InterpolatedQuantileOf(sorted, percent / 100);
}

ErrorStatistics ErrorStatisticsOf(std::vector<double> errors) {
  ErrorStatistics statistics;
  if (errors.empty()) return statistics;
  std::ranges::sort(errors);
  const auto count = static_cast<double>(errors.size());
  double sum = 0, squares = 0, deviations = 0;
  for (const double error : errors) sum += error, squares += error * error;
  statistics.mean = sum / count;
  for (const double error : errors) deviations += (error - statistics.mean) * (error - statistics.mean);
  statistics.count = errors.size();
  statistics.rmse = std::sqrt(squares / count);
  statistics.std = std::sqrt(deviations / count);
  statistics.sse = squares;
  statistics.min = errors.front();
  statistics.max = errors.back();
  statistics.p25 = PercentileOf(errors, 25);
  statistics.median = PercentileOf(errors, 50);
  statistics.p75 = PercentileOf(errors, 75);
  statistics.p90 = PercentileOf(errors, 90);
  statistics.p95 = PercentileOf(errors, 95);
  statistics.p99 = PercentileOf(errors, 99);
  return statistics;
}

}  // namespace slamdb
