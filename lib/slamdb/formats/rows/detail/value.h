// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "slamdb/base/file.h"

namespace slamdb::rows {

// What a column of a row holds: NULL, an integer, a real number, a text or a blob.
using Value = std::variant<std::monostate, std::int64_t, double, std::string_view, Bytes>;

inline Value ValueOrNull(std::optional<std::int64_t> value) { return value ? Value(*value) : Value(); }

}  // namespace slamdb::rows
