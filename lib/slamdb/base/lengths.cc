// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/lengths.h"

#include <cmath>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/time_units.h"

namespace slamdb::detail {

double MetresIn(const Table& table, std::size_t column) {
  static constexpr std::pair<std::string_view, double> kUnits[] = {
      {"", 1},        {"m", 1},          {"metre", 1},     {"metres", 1},      {"meter", 1},     {"meters", 1},
      {"cm", 0.01},   {"mm", 0.001},     {"km", 1000},     {"ft", 0.3048},     {"foot", 0.3048}, {"feet", 0.3048},
      {"yd", 0.9144}, {"yards", 0.9144}, {"inch", 0.0254}, {"inches", 0.0254}, {"mi", 1609.344}, {"miles", 1609.344}};
  const ColumnName* name = table.NameOf(column);
  if (name == nullptr) return 1;
  for (const auto& [unit, metres] : kUnits)
    if (name->unit == unit) return metres;
  throw Error(ErrorKind::kUnsupported, "", "column " + name->text,
              Concat("expected lengths in m, cm, mm, km, ft, yd, inch or mi, found the unit '", name->unit, "'"));
}

std::string MetresText(const Table& table, std::size_t column, double unit) {
  const std::string digits = table.Digits(column);
  const double power = std::log10(unit);
  if (std::round(power) == power)
    if (auto metres = ShiftedDecimal(digits, static_cast<int>(power))) return *std::move(metres);
  std::string text;
  AppendNumber(text, table.Get<double>(column) * unit);
  return text;
}

}  // namespace slamdb::detail
