// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "slamdb/formats/rows/detail/value.h"
#include "slamdb/model/ids.h"

// Values of the model as columns of rows, and back. What reads them takes any Columns that have
//   bool IsNull(int column); std::int64_t Integer(int column) (0 for NULL); double Real(int column) (NaN for NULL);
//   Bytes Blob(int column) (empty for NULL)
namespace slamdb::rows {

inline std::int64_t ToColumn(std::uint64_t value) { return static_cast<std::int64_t>(value); }
template <class Entity>
std::int64_t ToColumn(Id<Entity> id) {
  return static_cast<std::int64_t>(id.value());
}
// As a reference: NULL for none.
template <class Entity>
std::optional<std::int64_t> ToReference(Id<Entity> id) {
  return id.has_value() ? std::optional(static_cast<std::int64_t>(id.value())) : std::nullopt;
}
// The entity that a column names, none where it is NULL.
template <class Entity, class Columns>
Entity FromReference(const Columns& columns, int column) {
  const std::int64_t id = columns.Integer(column);  // 0 for NULL, too: rare enough to look twice
  return id == 0 && columns.IsNull(column) ? Entity() : Entity(static_cast<std::uint64_t>(id));
}

// False for NaN and -0.0, which a REAL column does not keep.
inline bool FitsReal(double value) { return value == value && !(value == 0 && std::signbit(value)); }

// Real numbers of a row, exact in `values`, and as far as columns can hold them in those from `first` on, where NULL
// stands for NaN. What somebody edited is the columns: false when they differ, and `values` are then those.
template <class Columns, class Number, std::size_t size>
bool TakeColumns(const Columns& columns, int first, std::array<Number, size>& values) {
  bool same = true;
  for (std::size_t i = 0; i < size; ++i) {
    const int column = first + static_cast<int>(i);
    const bool is_null = columns.IsNull(column);
    if (values[i] == values[i] ? !is_null && columns.Real(column) == static_cast<double>(values[i]) : is_null) continue;
    values[i] = is_null ? std::numeric_limits<Number>::quiet_NaN() : static_cast<Number>(columns.Real(column));
    same = false;
  }
  return same;
}

}  // namespace slamdb::rows
