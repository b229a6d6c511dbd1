// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/table.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"

namespace slamdb::detail {

Table::Table(std::string_view text, TableKind kind)
    : kind_(std::move(kind)), layout_(FindLayout(WithoutMark(text), kind_)) {
  if (const std::size_t zero = text.find('\0'); zero != text.npos)
    throw Error(ErrorKind::kDamaged, "", Concat("line ", 1 + LineEndsIn(text.substr(0, zero))),
                "holds a zero byte, which no text does; is it UTF-16, which has to be saved as UTF-8, or damaged?");
  rest_ = layout_.rows;
  next_line_ = layout_.line;
  comments_ = layout_.comments;
  const std::size_t line_of_names = next_line_ - !layout_.names.empty();
  if (!layout_.problem.empty()) throw Error(ErrorKind::kDamaged, "", Concat("line ", line_of_names), layout_.problem);
}

const ColumnName* Table::NameOf(std::size_t column) const {
  return Has(column) && !layout_.names.empty() ? &layout_.names[*layout_.places[column]] : nullptr;
}

bool Table::Next() {
  if (line_ > 0) comments_.clear();
  while (!SkipToRow(rest_, next_line_, comments_).empty()) {
    line_ = next_line_;
    std::string_view behind = rest_;
    row_ = TakeRow(behind, layout_.separator, cells_);
    if (cells_.size() < layout_.needed && (cells_.size() == 1 || layout_.separator == '\t')) {
      // Blanks may stand for the separator in this row, where that gives all cells.
      std::string_view again = rest_;
      std::vector<Cell> words;
      const std::string_view row = TakeRow(again, ' ', words);
      if (words.size() >= layout_.needed) {
        row_ = row;
        cells_ = std::move(words);
        behind = again;
      }
    }
    rest_ = behind;
    next_line_ += 1 + LineEndsIn(row_);
    if (std::ranges::all_of(cells_, [](const Cell& cell) { return cell.text.empty(); })) continue;
    CheckCells();
    CheckDecimals();
    return true;
  }
  return false;
}

void Table::CheckCells() const {
  const bool named = !layout_.names.empty();
  const std::size_t width = named ? layout_.names.size() : layout_.needed;
  const auto behind = std::span(cells_).subspan(std::min(width, cells_.size()));
  const bool too_many = std::ranges::any_of(behind, [](const Cell& cell) { return !cell.text.empty(); });
  if (cells_.size() >= layout_.needed && (!too_many || kind_.more_cells)) return;
  throw LineError(named ? Concat("expected ", width, " cells, found ", cells_.size())
                        : Concat("expected ", kind_.expected, ", found ", Excerpt(row_)));
}

// Decimal commas and decimal points in one table would make thousands of some numbers.
void Table::CheckDecimals() {
  const auto has_point = [](const Cell& cell) {
    return cell.text.find('.') != cell.text.npos && ParseNumber<double>(cell.text).has_value();
  };
  const bool commas = std::ranges::any_of(cells_, [](const Cell& cell) { return IsDecimalComma(cell.text); });
  decimal_commas_ |= commas;
  if (commas) decimal_points_ |= std::ranges::any_of(cells_, has_point);
  if (decimal_commas_ && decimal_points_)
    throw LineError(Concat("expected one decimal mark, found commas and points in ", Excerpt(row_)));
}

std::string_view Table::Raw(std::size_t column) const {
  const auto place = layout_.places[column];
  return place && *place < cells_.size() ? cells_[*place].text : std::string_view();
}

std::string Table::Digits(std::size_t column) const {
  const auto place = layout_.places[column];
  return place ? DigitsAt(*place) : std::string();
}

std::string Table::DigitsAt(std::size_t place) const {
  const std::string_view cell = place < cells_.size() ? cells_[place].text : std::string_view();
  std::string digits = IsDecimalComma(cell) ? WithPoint(cell) : std::string(cell);
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.erase(0, 1);
  return digits;
}

std::string Table::Text(std::size_t column) const {
  std::string text(Raw(column));
  const auto place = layout_.places[column];
  if (!place || *place >= cells_.size() || !cells_[*place].quoted) return text;
  for (std::size_t at = text.find("\"\""); at != text.npos; at = text.find("\"\"", at + 1)) text.erase(at, 1);
  return text;
}

Error Table::CellError(std::size_t column, std::string_view expected) const {
  constexpr std::size_t kLongest = 40;
  const std::string_view cell = Raw(column);
  const bool commas =
      layout_.separator == ',' && cell.find_first_of(kBlanks) != cell.npos && cell[0] >= '0' && cell[0] <= '9';
  return LineError(Concat(
      "expected ", expected, ", found '", cell.substr(0, kLongest), "' in column ", kind_.columns[column].title(),
      commas ? "; commas separate cells here: where they are decimal commas, separate cells by semicolons" : ""));
}

Error Table::LineError(const std::string& problem) const {
  return Error(ErrorKind::kDamaged, "", Concat("line ", line_), problem);
}

}  // namespace slamdb::detail
