// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/csv_cells.h"

#include <algorithm>
#include <string>

namespace slamdb {

std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

void SplitCells(std::string_view line, std::vector<std::string_view>& cells) {
  cells.clear();
  bool quoted = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') quoted = !quoted;
    if (line[i] != ',' || quoted) continue;
    cells.push_back(line.substr(begin, i - begin));
    begin = i + 1;
  }
  cells.push_back(line.substr(begin));
}

Error LineError(std::size_t line, const std::string& problem) {
  return Error(ErrorKind::kDamaged, "", "line " + std::to_string(line), problem);
}

}  // namespace slamdb
