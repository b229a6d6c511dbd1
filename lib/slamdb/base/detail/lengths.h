// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "slamdb/base/detail/table.h"

namespace slamdb::detail {

// How many metres a unit of that name is, in any of its spellings: `ft`, `feet`.
std::optional<double> MetresByName(std::string_view unit);

// How many metres the lengths in a column of a table count, as its name says: `altitude_ft`, `tx [mm]`; 1 when it says
// nothing. Throws Error (kUnsupported) when the unit is none that is known.
double MetresIn(const Table& table, std::size_t column);

// Throws Error (kUnsupported) when the column says that it counts anything but metres.
void RequireMetres(const Table& table, std::size_t column);

// A length of the row in metres, with all its digits where the unit is a power of ten.
std::string MetresText(const Table& table, std::size_t column, double unit);

}  // namespace slamdb::detail
