// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "slamdb/base/time_unit.h"

namespace slamdb::detail {

inline constexpr std::array kTimeUnits = {TimeUnit::kSeconds, TimeUnit::kMilliseconds, TimeUnit::kMicroseconds,
                                          TimeUnit::kNanoseconds};

// `seconds`, `milliseconds`, ...
std::string_view LongNameOf(TimeUnit unit);

// The power of ten that makes seconds of the unit.
int PowerOf(TimeUnit unit);

inline constexpr double kEpochBegin = 946684800, kEpochEnd = 4102444800;  // 2000 and 2100, seconds since 1970

// Whether seconds lie in this century, as times of day since 1970 do.
bool IsEpoch(double seconds);

// The number times 10^power, as text with all its digits and without an exponent: `1700000000250000000` and -9 give
// `1700000000.25`. Nothing when the text is no finite number, or one of absurd length.
std::optional<std::string> ShiftedDecimal(std::string_view number, int power);

}  // namespace slamdb::detail
