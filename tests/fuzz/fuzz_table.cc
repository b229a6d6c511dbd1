// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/table.h"
#include "slamdb/edit/frame/georeference.h"
#include "slamdb/edit/frame/similarity_text.h"
#include "slamdb/edit/ids/id_map.h"
#include "slamdb/edit/merge/anchors.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

namespace slamdb {
namespace {

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
    fuzz::Require(table.line() > line && table.row().data() >= end, "rows go forward");
    line = table.line();
    end = table.row().data() + table.row().size();
    for (const detail::Cell& cell : table.cells())
      fuzz::Require(
          cell.text.empty() || (cell.text.data() >= table.row().data() && cell.text.data() + cell.text.size() <= end),
          "a cell is a part of its row");
    for (std::size_t column = 0; column < kind.columns.size(); ++column)
      fuzz::Require(table.Text(column).size() <= table.Raw(column).size(), "quotes written once are no more");
  }
  fuzz::Require(line <= 1 + text.size(), "a line has its end");
}

// What can be read as ids is read again from what is written of it.
void ReadIdMaps(std::string_view text) {
  const std::vector<IdMap> maps = ParseIdMapsCsv(text);
  fuzz::Require(ParseIdMapsCsv(IdMapsToCsv(maps)) == maps, "ids that were written are read again");
}

// Ids that change to themselves leave a table as it is.
void ApplyIdMap(std::string_view text) {
  IdMap ids;
  for (std::uint64_t id = 0; id < 10; ++id) ids[IdKind::kKeyFrame].push_back({id, id});
  fuzz::Require(ApplyIdMapToCsv(text, ids) == text, "ids that stay leave a table as it is");
}

}  // namespace
}  // namespace slamdb

// Any bytes as each kind of table and as a transform. They are read or fail with an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  fuzz::MayRefuse([&] { ReadTable(text); });
  fuzz::MayRefuse([&] { return ReadIdMaps(text); });
  fuzz::MayRefuse([&] { ApplyIdMap(text); });
  fuzz::MayRefuse([&] { return ParseFixes(text); });
  fuzz::MayRefuse([&] { return ParseAnchorsCsv(text); });
  fuzz::MayRefuse([&] { return ParseAnchors(text); });
  fuzz::MayRefuse([&] { return ParseSimilarity(text); });
  return 0;
}
