// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "slamdb/base/time_unit.h"

namespace slamdb::detail {

// The power of ten that makes seconds of the unit.
int PowerOf(TimeUnit unit);

// Whether seconds lie in this century, as times of day since 1970 do.
bool IsEpoch(double seconds);

// The number times 10^power, as text with all its digits and without an exponent: `1700000000250000000` and -9 give
// `1700000000.25`. Nothing when the text is no finite number, or one of absurd length.
std::optional<std::string> ShiftedDecimal(std::string_view number, int power);

}  // namespace slamdb::detail
