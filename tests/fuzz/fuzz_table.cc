// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <functional>

#include "slamdb/base/detail/table.h"
#include "slamdb/edit/frame/georeference.h"
#include "slamdb/edit/frame/similarity_text.h"
#include "slamdb/edit/ids/id_map.h"
#include "slamdb/edit/merge/anchors.h"
#include "tests/fuzz/fuzz.h"

namespace slamdb {
namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

void RequireErrorOrNone(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error&) {
  }
}

// Rows go forward, and every cell is a part of its row.
void ReadTable(std::string_view text) {
  const detail::TableKind kind = {
      .columns = {{{"time"}}, {{"x"}}, {{"old", "y"}, 1}, {{"new"}, 1}, {{"kind"}, detail::Column::kOptional}},
      .expected = "numbers",
      .more_cells = true,
      .name_beginnings = true};
  detail::GlanceAtTable(text, kind);
  detail::Table table(text, kind);
  std::size_t line = 0;
  const char* end = text.data();
  while (table.Next()) {
    Require(table.line() > line && table.row().data() >= end);
    line = table.line();
    end = table.row().data() + table.row().size();
    for (const detail::Cell& cell : table.cells())
      Require(cell.text.data() >= table.row().data() && cell.text.data() + cell.text.size() <= end);
    for (std::size_t column = 0; column < kind.columns.size(); ++column)
      Require(table.Text(column).size() <= table.Raw(column).size());
  }
  Require(line <= 1 + text.size());
}

// What can be read as ids is read again from what is written of it.
void ReadIdMaps(std::string_view text) {
  const std::vector<IdMap> maps = ParseIdMapsCsv(text);
  Require(ParseIdMapsCsv(IdMapsToCsv(maps)) == maps);
}

// Ids that change to themselves leave a table as it is.
void ApplyIdMap(std::string_view text) {
  IdMap ids;
  for (std::uint64_t id = 0; id < 10; ++id) ids[IdKind::kKeyFrame].push_back({id, id});
  Require(ApplyIdMapToCsv(text, ids) == text);
}

}  // namespace
}  // namespace slamdb

// Any bytes as each kind of table and as a transform. They are read or fail with an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  RequireErrorOrNone([&] { ReadTable(text); });
  RequireErrorOrNone([&] { return ReadIdMaps(text); });
  RequireErrorOrNone([&] { ApplyIdMap(text); });
  RequireErrorOrNone([&] { return ParseFixes(text); });
  RequireErrorOrNone([&] { return ParseAnchorsCsv(text); });
  RequireErrorOrNone([&] { return ParseAnchors(text); });
  RequireErrorOrNone([&] { return ParseSimilarity(text); });
  return 0;
}
