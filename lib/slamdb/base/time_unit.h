// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

#include "slamdb/export.h"

namespace slamdb {

// What the times of a table count.
enum class TimeUnit { kSeconds, kMilliseconds, kMicroseconds, kNanoseconds };

// `s`, `ms`, `us`, `ns`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(TimeUnit unit);

// The unit of that name, in any of its spellings: `ms`, `msec`, `milliseconds`.
[[nodiscard]] SLAMDB_EXPORT std::optional<TimeUnit> TimeUnitByName(std::string_view name);

}  // namespace slamdb
