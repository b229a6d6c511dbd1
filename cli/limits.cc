// SPDX-License-Identifier: BSD-3-Clause
#include "cli/limits.h"

#include "slamdb/base/detail/concat.h"

namespace slamdb::cli {

std::string Limits::Text() const {
  const bool has_low = low > kFinite.low, has_high = high < kFinite.high;
  if (!has_low && !has_high) return "a finite number";
  if (has_high) return detail::Concat("a number from ", low, " to ", high);
  return above_low ? detail::Concat("a number above ", low) : detail::Concat(low, " or a number above it");
}

}  // namespace slamdb::cli
