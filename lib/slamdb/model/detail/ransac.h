// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace slamdb::detail {

// How many samples of three find three inliers, with so much confidence, when so many are; `most` at most.
inline int SamplesNeeded(std::size_t inliers, std::size_t count, double confidence, int most) {
  const double share = static_cast<double>(inliers) / static_cast<double>(count);
  const double miss = std::log1p(-share * share * share);
  if (!(miss < 0)) return most;
  return std::max(1, static_cast<int>(std::min<double>(most, std::ceil(std::log(1 - confidence) / miss))));
}

}  // namespace slamdb::detail
