// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/dialects.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace slamdb {

void PrintTo(const NamedTable& table, std::ostream* out) { *out << table.name; }

std::string InSomeDialect(const NamedTable& table, std::mt19937_64& random) {
  const auto chance = [&] { return random() % 2 == 0; };
  const std::string end = std::array{"\n", "\r\n", "\r"}[random() % 3];
  const std::string separator = std::array{",", ";", "\t", ", ", " ; "}[random() % 5];
  const bool quotes = chance(), plus = chance() && table.plus_signs, upper = chance();
  const bool commas = separator.find(',') == std::string::npos && chance();
  std::string text = chance() ? "\xef\xbb\xbf" : "";
  if (chance()) text += "sep=" + separator.substr(0, 1) + end;
  if (chance()) text += "# made by hand" + end;
  std::string header;
  for (const std::string& name : table.names) header += (header.empty() ? "" : separator) + name;
  if (upper) std::ranges::transform(header, header.begin(), [](unsigned char c) { return std::toupper(c); });
  text += header + end;
  for (const auto& row : table.rows) {
    std::string line;
    for (std::string cell : row) {
      const bool number = cell.find_first_not_of("-0123456789.") == std::string::npos;
      if (number && commas) std::ranges::replace(cell, '.', ',');
      if (number && plus && cell[0] != '-') cell.insert(0, 1, '+');
      if (quotes) cell = '"' + cell + '"';
      line += (line.empty() ? "" : separator) + cell;
    }
    text += line + end + (chance() ? end : "");
  }
  while (chance() && text.ends_with(end)) text.erase(text.size() - end.size());
  return text;
}

}  // namespace slamdb
