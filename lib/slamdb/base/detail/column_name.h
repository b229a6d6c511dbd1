// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace slamdb::detail {

// What a table calls a column: `Latitude [deg]`, `altitude_ft`, `#timestamp`.
struct ColumnName {
  explicit ColumnName(std::string_view text);

  std::string text;  // in lower case, without blanks and quotes around: `latitude [deg]`, `altitude_ft`
  std::string name;  // without the unit: `latitude`, `altitude`
  std::string unit;  // in lower case: `deg`, `ft`; empty when the name states none
};

// A name as it is compared: blanks and dashes in it are as good as `_`, and the slashes of a path as `.`.
std::string Comparable(std::string_view name);

}  // namespace slamdb::detail
