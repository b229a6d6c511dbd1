// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/xyz/detail/xyz.h"

#include <algorithm>
#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/lengths.h"
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/detail/table.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/points.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/points/detail/point_set.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kRowsPerBlock = 8192, kAxes = 3;

void WriteXyz(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, FileOptions(options));
  const PointRows points(atlas, target, options, Positions::kFinite);
  WarnOfSeveralFrames(points.maps(), "nothing tells them apart", notices);
  WriteRows(file, points.size(), kRowsPerBlock, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) {
      for (const float value : points[row].point->position) AppendNumber(out, value), out += ' ';
      out.back() = '\n';
    }
  });
  file.Commit();
  points.WarnOfNotFinite(notices);
  notices.Tell(points.Summary(), WrittenCounts{.points = points.size()});
}

// What a line above the points may name besides x, y and z.
const TableKind& XyzTable() {
  constexpr int kOptional = Column::kOptional;
  static const TableKind kind = {.columns = {{{"x"}, 0},
                                             {{"y"}, 0},
                                             {{"z"}, 0},
                                             {{"nx", "normal_x"}, kOptional},
                                             {{"ny", "normal_y"}, kOptional},
                                             {{"nz", "normal_z"}, kOptional},
                                             {{"map"}, kOptional},
                                             {{"id"}, kOptional}},
                                 .expected = "3 numbers or more: x y z",
                                 .more_cells = true};
  return kind;
}

// Columns of the kind that the table has, as those of a cloud.
std::vector<CloudColumn> ColumnsOf(const Table& table, std::vector<std::size_t>& places) {
  std::vector<CloudColumn> columns;
  for (std::size_t i = 0; i < XyzTable().columns.size(); ++i) {
    if (!table.Has(i)) continue;
    const std::string_view name = XyzTable().columns[i].title();
    columns.push_back({NumberType::kFloat, FieldByName(name), std::string(name)});
    places.push_back(i);
  }
  return columns;
}

// The names of those that it has besides, for PointSet to tell.
void AddOthers(const Table& table, std::vector<CloudColumn>& columns) {
  for (const ColumnName& name : table.names()) {
    const auto is_known = [&](const Column& column) {
      return std::ranges::find(column.names, name.name) != column.names.end();
    };
    if (std::ranges::none_of(XyzTable().columns, is_known)) columns.push_back({{}, FieldByName(name.name), name.text});
  }
}

Atlas ReadTable(std::string_view text, const std::string& path, const ReadOptions& options, Notices& notices) {
  Table table(text, XyzTable());
  for (std::size_t axis = 0; axis < kAxes; ++axis) RequireMetres(table, axis);
  std::vector<std::size_t> places;
  std::vector<CloudColumn> columns = ColumnsOf(table, places);
  AddOthers(table, columns);
  PointSet points(path, columns);
  std::uint64_t more = 0;
  while (table.Next()) {
    points.BeginPoint();
    for (std::size_t i = 0; i < places.size(); ++i)
      if (!points.Set(columns[i], table.Digits(places[i]))) throw table.CellError(places[i], "a number");
    more += table.names().empty() && table.cells().size() > kAxes ? 1 : 0;
    points.EndPoint();
  }
  Atlas atlas = points.Finish(options.selection, notices);
  if (more > 0)
    notices.Lose("no line names what stands behind x, y and z; it is left out, of " + Counted(more, "point"));
  return atlas;
}

// CloudCompare's comment, which names columns.
std::string_view WithoutSlashes(std::string_view text) { return text.substr(text.starts_with("//") ? 2 : 0); }

Atlas ReadXyz(const Source& source, const ReadOptions& options, Notices& notices) {
  Atlas atlas;
  ParseLines(source, "points", notices, [&](std::string_view text) {
    atlas = ReadTable(WithoutSlashes(WithoutMark(text)), source.path, options, notices);
  });
  return atlas;
}

// Three numbers a line and nothing else; with more it may be anything, and the suffix tells.
bool SniffXyz(const Probe& probe) { return GlanceAtTable(probe.head, XyzTable()).numbers == kAxes; }

constexpr std::array<std::string_view, 1> kSuffixes = {".xyz"};

}  // namespace

const Format kXyzFormat = {.id = "xyz",
                           .title = "XYZ point cloud",
                           .suffixes = kSuffixes,
                           .chooses_maps = true,
                           .is_export = true,
                           .reads = Content::kPoints,
                           .writes = Content::kPoints,
                           .sniff = SniffXyz,
                           .read = ReadXyz,
                           .write = WriteXyz};

}  // namespace slamdb::detail
