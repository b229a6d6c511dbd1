// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/table.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/time_unit.h"

namespace slamdb::detail {
namespace {

std::string_view BlanksOf(char separator) { return separator == '\t' ? " " : " \t"; }

// Lines end with `\n`, `\r\n`, or, where old programs wrote them, with `\r`.
bool IsLineEnd(char letter) { return letter == '\n' || letter == '\r'; }

void SkipLineEnd(std::string_view& text) { text.remove_prefix(text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1); }

std::string_view TakeTableLine(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  text.remove_prefix(line.size());
  SkipLineEnd(text);
  return line;
}

std::size_t LineEndsIn(std::string_view text) {
  std::size_t ends = 0;
  for (std::size_t at = text.find_first_of("\r\n"); at != text.npos; at = text.find_first_of("\r\n")) {
    text.remove_prefix(at);
    SkipLineEnd(text);
    ++ends;
  }
  return ends;
}

void SkipBlanks(std::string_view& text, char separator) {
  text.remove_prefix(std::min(text.find_first_not_of(BlanksOf(separator)), text.size()));
}

bool AtLineEnd(std::string_view text) { return text.empty() || IsLineEnd(text.front()); }

// Where the quote that begins the text is closed; npos when it is not.
std::size_t ClosingQuote(std::string_view text) {
  std::size_t end = text.find('"', 1);
  while (end != std::string_view::npos && end + 1 < text.size() && text[end + 1] == '"') end = text.find('"', end + 2);
  return end;
}

// Takes a quoted cell and the blanks behind it off the text. What begins with a quote but has more than a separator
// behind the closing one is not quoted: `5" pipe`.
std::optional<Cell> TakeQuoted(std::string_view& text, char separator) {
  if (!text.starts_with('"')) return std::nullopt;
  const std::size_t close = ClosingQuote(text);
  if (close == std::string_view::npos) return std::nullopt;
  std::string_view behind = text.substr(close + 1);
  const std::size_t length = behind.size();
  SkipBlanks(behind, separator);
  const bool ends = separator == ' ' ? behind.size() < length : behind.starts_with(separator);
  if (!ends && !AtLineEnd(behind)) return std::nullopt;
  const Cell cell{text.substr(1, close - 1), true};
  text = behind;
  return cell;
}

Cell TakeCell(std::string_view& text, char separator) {
  if (const auto quoted = TakeQuoted(text, separator)) return *quoted;
  const auto ends = [separator](char letter) {
    return IsLineEnd(letter) || letter == separator || (separator == ' ' && letter == '\t');
  };
  std::string_view cell(text.data(), static_cast<std::size_t>(std::ranges::find_if(text, ends) - text.begin()));
  text.remove_prefix(cell.size());
  cell = cell.substr(0, cell.find_last_not_of(BlanksOf(separator)) + 1);
  return {cell};
}

// Takes a row with its line end off the text and returns it without.
std::string_view TakeRow(std::string_view& text, char separator, std::vector<Cell>& cells) {
  const std::string_view all = text;
  cells.clear();
  SkipBlanks(text, separator);
  while (separator != ' ' || !AtLineEnd(text)) {
    cells.push_back(TakeCell(text, separator));
    if (AtLineEnd(text)) break;
    if (separator != ' ') text.remove_prefix(1);
    SkipBlanks(text, separator);
  }
  const std::string_view row = all.substr(0, all.size() - text.size());
  SkipLineEnd(text);
  return row;
}

std::vector<Cell> CellsOf(std::string_view line, char separator) {
  std::vector<Cell> cells;
  TakeRow(line, separator, cells);
  return cells;
}

// `sep=;`, by which Excel tells itself.
bool IsSeparatorLine(std::string_view line) { return line.size() == 5 && line.starts_with("sep="); }

// Goes to the first line that is neither blank nor a comment, and returns it; empty when there is none.
std::string_view SkipToRow(std::string_view& text, std::size_t& line_number, std::vector<std::string_view>& comments) {
  for (std::string_view behind = text; !text.empty(); text = behind, ++line_number) {
    const std::string_view line = TakeTableLine(behind);
    const std::size_t first = line.find_first_not_of(kBlanks);
    if (first == std::string_view::npos || IsSeparatorLine(line)) continue;
    if (!IsCommentMark(line[first])) return line;
    comments.push_back(line);
  }
  return {};
}

bool IsNumber(std::string_view text) {
  return ParseNumber<double>(IsDecimalComma(text) ? WithPoint(text) : std::string(text)).has_value();
}

bool AreNumbers(std::span<const Cell> cells) {
  return std::ranges::all_of(cells, [](const Cell& cell) { return IsNumber(cell.text); });
}

bool HasUnquoted(std::string_view line, char separator) {
  bool quoted = false;
  for (const char letter : line) {
    if (letter == '"') quoted = !quoted;
    if (letter == separator && !quoted) return true;
  }
  return false;
}

// Tabs may separate cells, or be mere blanks: the latter where numbers stand between more of one than of the other.
char SeparatorOf(std::string_view line) {
  if (HasUnquoted(line, ';')) return ';';
  const std::vector<Cell> words = CellsOf(line, ' ');
  const bool numbers = AreNumbers(words);
  // Commas that stand in numbers between blanks are those of decimals.
  if (HasUnquoted(line, ',') && !(numbers && words.size() > 1)) return ',';
  if (!HasUnquoted(line, '\t')) return ' ';
  return numbers && words.size() != CellsOf(line, '\t').size() ? ' ' : '\t';
}

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& letter : lower)
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  return lower;
}

bool IsUnit(std::string_view word) {
  static constexpr std::string_view kUnits[] = {
      "min",    "minutes", "h",    "hours", "days",   "m",       "metre", "metres", "meter", "meters", "cm",  "mm",
      "km",     "ft",      "foot", "feet",  "yd",     "yards",   "inch",  "inches", "mi",    "miles",  "deg", "degs",
      "degree", "degrees", "rad",  "rads",  "radian", "radians", "e6",    "dege6",  "e7",    "dege7"};
  return TimeUnitByName(word) || std::ranges::find(kUnits, word) != std::end(kUnits);
}

// `us` for `\u00b5s` and `\u03bcs`, the two letters that people write.
std::string WithoutMicro(std::string_view unit) {
  for (const std::string_view micro : {"\xc2\xb5", "\xce\xbc", "\xce\x9c"})
    if (unit.starts_with(micro)) return Concat('u', unit.substr(micro.size()));
  return std::string(unit);
}

// Where the unit begins in `UnixTimeMillis`, `latitudeE7` and `TimeUS`; npos: nowhere.
std::size_t CamelUnit(std::string_view shown) {
  const auto is_lower = [](char letter) { return letter >= 'a' && letter <= 'z'; };
  const auto is_upper = [](char letter) { return letter >= 'A' && letter <= 'Z'; };
  for (std::size_t at = shown.size(); at-- > 1;)
    if (is_lower(shown[at - 1]) && is_upper(shown[at])) return IsUnit(Lower(shown.substr(at))) ? at : shown.npos;
  return shown.npos;
}

std::vector<ColumnName> NamesIn(std::string_view line, char separator) {
  const std::vector<Cell> cells = CellsOf(line, separator);
  std::vector<ColumnName> names;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::string_view text = cells[i].text;
    // Between blanks a unit in brackets looks like a column of its own.
    while (separator == ' ' && i + 1 < cells.size() &&
           (cells[i + 1].text.starts_with('[') || cells[i + 1].text.starts_with('('))) {
      ++i;
      text = {text.data(), static_cast<std::size_t>(cells[i].text.data() + cells[i].text.size() - text.data())};
    }
    names.emplace_back(text);
  }
  return names;
}

// Whether a name stands for a column. `.position.x` is wanted at the end of a path too: `field.pose.position.x`.
bool Stands(std::string_view name, std::string_view wanted) {
  if (!wanted.starts_with('.')) return name == wanted;
  return name == wanted.substr(1) || (name.size() > wanted.size() && name.ends_with(wanted));
}

// What may stand behind a name without making it another thing, as `lat_std` and `time_since_start` are.
bool IsDatum(std::string_view behind) {
  static constexpr std::string_view kData[] = {"wgs84", "gps", "gnss", "ellipsoid", "ellipsoidal", "hae"};
  return !behind.empty() && (behind.front() == '_' || behind.front() == ' ') &&
         std::ranges::find(kData, behind.substr(1)) != std::end(kData);
}

// Which names stand for a column: the better ones first, each exactly, or without its unit, or at the end of a path;
// or else by its beginning.
std::vector<std::size_t> Matches(const std::vector<ColumnName>& names, const Column& column, bool beginnings) {
  const auto matching = [&](const auto& matches) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < names.size(); ++i)
      if (matches(names[i])) found.push_back(i);
    return found;
  };
  for (const std::string_view wanted : column.names) {
    auto found = matching([&](const ColumnName& name) { return Stands(Comparable(name.text), wanted); });
    if (found.empty()) found = matching([&](const ColumnName& name) { return Stands(Comparable(name.name), wanted); });
    if (!found.empty()) return found;
  }
  for (std::string_view wanted : beginnings ? column.names : std::vector<std::string_view>()) {
    if (wanted.starts_with('.')) wanted.remove_prefix(1);
    if (auto found = matching([&](const ColumnName& name) {
          return name.name.starts_with(wanted) && IsDatum(std::string_view(name.name).substr(wanted.size()));
        });
        !found.empty())
      return found;
  }
  return {};
}

// Of `time_s` and `time_ns` the first.
void PreferSeconds(const std::vector<ColumnName>& names, std::vector<std::size_t>& matches) {
  const auto in_seconds = [&](std::size_t i) { return TimeUnitByName(names[i].unit) == TimeUnit::kSeconds; };
  if (std::ranges::count_if(matches, in_seconds) == 1) matches = {*std::ranges::find_if(matches, in_seconds)};
}

using Places = std::vector<std::optional<std::size_t>>;

// Leaves out the columns of groups that are not whole; false when no group is.
bool KeepWholeGroups(const std::vector<Column>& columns, Places& places) {
  bool groups = false, whole_group = false;
  for (const Column& column : columns) {
    if (column.group == Column::kOptional) continue;
    groups = true;
    bool whole = true;
    for (std::size_t i = 0; i < columns.size(); ++i) whole &= columns[i].group != column.group || places[i];
    for (std::size_t i = 0; i < columns.size() && !whole; ++i)
      if (columns[i].group == column.group) places[i].reset();
    whole_group |= whole;
  }
  return whole_group || !groups;
}

std::size_t CellsNeeded(const std::vector<Column>& columns, const Places& places) {
  std::size_t needed = 0;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].group != Column::kOptional && places[i]) needed = std::max(needed, *places[i] + 1);
  return needed;
}

// Finds the columns by the names in a line. False when the line does not name them; two columns of one name are a
// problem of the layout.
bool TakeNames(std::string_view line, const TableKind& kind, TableLayout& layout) {
  const char separator = SeparatorOf(line);
  std::vector<ColumnName> names = NamesIn(line, separator);
  Places places(kind.columns.size());
  std::string problem;
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::vector<std::size_t> matches = Matches(names, kind.columns[i], kind.name_beginnings);
    if (kind.columns[i].seconds) PreferSeconds(names, matches);
    if (matches.size() > 1)
      problem =
          Concat("columns ", matches[0] + 1, " and ", matches[1] + 1, " are both named ", kind.columns[i].title());
    if (!matches.empty()) places[i] = matches[0];
  }
  if (!KeepWholeGroups(kind.columns, places)) return false;
  layout.needed = CellsNeeded(kind.columns, places);
  layout.names = std::move(names);
  layout.places = std::move(places);
  layout.separator = separator;
  layout.problem = std::move(problem);
  return true;
}

// The separator of rows, the first of which begins `text`, under names with a separator.
char SeparatorOfRows(std::string_view text, char of_names) {
  return of_names != ' ' && CellsOf(text, of_names).size() > 1 ? of_names : SeparatorOf(TakeTableLine(text));
}

// Finds the columns in the comments above the first row.
bool FindNamesInComments(const TableKind& kind, TableLayout& layout) {
  if (kind.columns.empty()) return false;
  for (std::string_view comment : layout.comments) {
    TableLayout named;
    comment.remove_prefix(std::min(comment.find_first_not_of("#% \t"), comment.size()));
    // In prose the words that are names do not stand where the cells are.
    if (!TakeNames(comment, kind, named) || !named.problem.empty()) continue;
    const char separator = SeparatorOfRows(layout.rows, named.separator);
    if (!layout.first.empty() && named.needed > CellsOf(layout.first, separator).size()) continue;
    layout.names = std::move(named.names);
    layout.places = std::move(named.places);
    layout.needed = named.needed;
    layout.separator = separator;
    return true;
  }
  return false;
}

// Gives the columns of the first group that a row of so many cells has their places.
bool TakePositions(std::span<const Cell> row, const TableKind& kind, TableLayout& layout) {
  // The first is a number, or a date.
  if (!kind.by_position || row.empty()) return false;
  if (!IsNumber(row[0].text) && (row[0].text.empty() || row[0].text[0] < '0' || row[0].text[0] > '9')) return false;
  const auto filled = [&] { return row.back().text.empty() ? row.size() - 1 : row.size(); }();
  for (const Column& column : kind.columns) {
    std::size_t size = 0;
    for (const Column& other : kind.columns) size += other.group == column.group;
    if (column.group == Column::kOptional || !(filled == size || (kind.more_cells && filled > size))) continue;
    for (std::size_t i = 0, place = 0; i < kind.columns.size(); ++i)
      if (kind.columns[i].group == column.group) layout.places[i] = place++;
    layout.needed = size;
    return true;
  }
  return false;
}

// Notes which columns a line lacks that names some of a group, so that they are not searched for by eye.
void NoteMissing(const std::vector<Cell>& row, const TableKind& kind, TableLayout& layout) {
  if (std::ranges::any_of(row, [](const Cell& cell) { return IsNumber(cell.text); })) return;
  std::vector<ColumnName> names;
  for (const Cell& cell : row) names.emplace_back(cell.text);
  std::string missing;
  for (const Column& column : kind.columns) {
    if (column.group != 0 || column.names.empty()) continue;
    if (!Matches(names, column, kind.name_beginnings).empty())
      ++layout.named;
    else
      missing += Concat(missing.empty() ? "" : ", ", column.title());
  }
  if (layout.named > 0) layout.missing = std::move(missing);
}

}  // namespace

std::string Comparable(std::string_view name) {
  std::string text(name);
  for (char& letter : text) letter = letter == ' ' || letter == '-' ? '_' : letter == '/' ? '.' : letter;
  return text.starts_with('.') ? text.substr(1) : text;
}

bool IsDecimalComma(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == text.npos || comma + 1 == text.size()) return false;
  const std::size_t first = text.front() == '+' || text.front() == '-' ? 1 : 0;
  const auto digits = [](std::string_view part) { return part.find_first_not_of("0123456789") == part.npos; };
  return comma > first && digits(text.substr(first, comma - first)) && digits(text.substr(comma + 1));
}

std::string WithPoint(std::string_view text) {
  std::string number(text);
  std::ranges::replace(number, ',', '.');
  return number;
}

std::string_view Column::title() const {
  const std::string_view name = called.empty() ? names[0] : called;
  return name.substr(name.starts_with('.') ? 1 : 0);
}

ColumnName::ColumnName(std::string_view shown) : text(Lower(shown)), name(text) {
  const std::size_t bracket = text.find_last_of("[(");
  if (bracket != text.npos && bracket > 0 && (text.back() == ']' || text.back() == ')')) {
    unit = WithoutMicro(Trimmed(std::string_view(text).substr(bracket + 1, text.size() - bracket - 2)));
    name = Trimmed(std::string_view(text).substr(0, bracket));
    if (name.ends_with('_')) name.pop_back();
    return;
  }
  if (IsUnit(text) && text.size() > 2) unit = text;  // `seconds`, `nanoseconds`
  if (const std::size_t at = CamelUnit(shown); at != shown.npos) {
    name = text.substr(0, at);
    unit = text.substr(at);
    return;
  }
  const std::size_t end = text.find_last_of("_ -");
  if (end == text.npos || end == 0 || !IsUnit(WithoutMicro(std::string_view(text).substr(end + 1)))) return;
  unit = WithoutMicro(std::string_view(text).substr(end + 1));
  name = Trimmed(std::string_view(text).substr(0, end));
}

TableLayout FindLayout(std::string_view text, const TableKind& kind) {
  TableLayout layout{.places = Places(kind.columns.size())};
  layout.first = SkipToRow(text, layout.line, layout.comments);
  layout.rows = text;
  if (layout.first.empty()) {
    FindNamesInComments(kind, layout);
    return layout;
  }
  if (TakeNames(layout.first, kind, layout)) {
    TakeTableLine(layout.rows);
    ++layout.line;
    std::vector<std::string_view> comments;
    std::size_t line = layout.line;
    text = layout.rows;
    SkipToRow(text, line, comments);
    layout.separator = SeparatorOfRows(text, layout.separator);
    return layout;
  }
  const std::vector<Cell> row = CellsOf(layout.first, layout.separator = SeparatorOf(layout.first));
  if (FindNamesInComments(kind, layout) || TakePositions(row, kind, layout)) return layout;
  NoteMissing(row, kind, layout);
  layout.problem = "expected " + kind.expected + ", found " + Excerpt(layout.first);
  if (!layout.missing.empty()) layout.problem += ", in which no column is named " + layout.missing;
  return layout;
}

TableGlance GlanceAtTable(std::string_view head, const TableKind& kind) {
  if (IsUtf16(head)) return {};
  const TableLayout layout = FindLayout(WithoutMark(head), kind);
  if (!layout.names.empty()) return {.named = true, .separator = layout.separator};
  std::vector<Cell> row = CellsOf(layout.first, layout.separator);
  if (row.size() > 1 && row.back().text.empty()) row.pop_back();  // a separator behind the last cell
  if (row.empty() || !AreNumbers(row)) return {.separator = layout.separator};
  const auto first = ParseNumber<double>(WithPoint(row[0].text));
  return {.numbers = row.size(), .first = first.value_or(0), .separator = layout.separator};
}

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
