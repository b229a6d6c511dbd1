// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/lengths.h"

#include <cmath>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/time_units.h"

namespace slamdb::detail {

std::optional<double> MetresByName(std::string_view unit) {
  static constexpr std::pair<std::string_view, double> kUnits[] = {
      {"m", 1},          {"metre", 1},     {"metres", 1},      {"meter", 1},     {"meters", 1},      {"cm", 0.01},
      {"mm", 0.001},     {"km", 1000},     {"ft", 0.3048},     {"foot", 0.3048}, {"feet", 0.3048},   {"yd", 0.9144},
      {"yards", 0.9144}, {"inch", 0.0254}, {"inches", 0.0254}, {"mi", 1609.344}, {"miles", 1609.344}};
  for (const auto& [name, metres] : kUnits)
    if (unit == name) return metres;
  return std::nullopt;
}

double MetresIn(const Table& table, std::size_t column) {
  const ColumnName* name = table.NameOf(column);
  if (name == nullptr || name->unit.empty()) return 1;
  if (const auto metres = MetresByName(name->unit)) return *metres;
  throw Error(ErrorKind::kUnsupported, "", "column " + name->text,
              Concat("expected lengths in m, cm, mm, km, ft, yd, inch or mi, found the unit '", name->unit, "'"));
}

void RequireMetres(const Table& table, std::size_t column) {
  if (MetresIn(table, column) == 1) return;
  const ColumnName& name = *table.NameOf(column);
  throw Error(ErrorKind::kUnsupported, "", "column " + name.text,
              Concat("expected metres, or the unit of the map, and no unit in the name, found '", name.unit, "'"));
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
