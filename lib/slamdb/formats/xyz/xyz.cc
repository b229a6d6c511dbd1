// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/xyz/detail/xyz.h"

#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/points.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/points/detail/point_set.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kRowsPerBlock = 8192, kAxes = 3;
constexpr std::string_view kSeparators = " \t,;";

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
  notices.Tell(points.Summary());
}

bool IsComment(std::string_view line) { return IsCommentMark(line.front()) || line.starts_with("//"); }

// The numbers of a line; what stands behind the third counts in `more`.
void ReadLine(const std::string& path, std::uint64_t number, std::string_view line,
              const std::vector<CloudColumn>& columns, PointSet& points, std::uint64_t& more) {
  points.BeginPoint();
  for (const CloudColumn& column : columns) {
    const std::string_view word = TakeWord(line, kSeparators);
    if (!points.Set(column, word))
      throw Error(ErrorKind::kDamaged, path, Concat("line ", number),
                  word.empty() ? "expected three numbers" : Concat("expected a number, found ", Excerpt(word)));
  }
  if (line.find_first_not_of(kSeparators) != line.npos) ++more;
  points.EndPoint();
}

Atlas ReadXyz(const Source& source, const ReadOptions& options, Notices& notices) {
  const WholeFile file(source);
  const std::vector<CloudColumn> columns = {{NumberType::kFloat, PointField::kX, "x"},
                                            {NumberType::kFloat, PointField::kY, "y"},
                                            {NumberType::kFloat, PointField::kZ, "z"}};
  PointSet points(file.path(), columns);
  std::uint64_t number = 0, more = 0;
  for (std::string_view text = WithoutMark(file.text()); !text.empty();) {
    const std::string_view line = Trimmed(TakeLine(text));
    ++number;
    if (!line.empty() && !IsComment(line)) ReadLine(file.path(), number, line, columns, points, more);
  }
  Atlas atlas = points.Finish(options.selection, notices);
  if (more > 0) notices.Lose(Concat("what stands behind x, y and z is left out, in ", Counted(more, "line")));
  return atlas;
}

// Three numbers between blanks, and nothing else.
bool SniffXyz(const Probe& probe) {
  std::string_view text = probe.head;
  while (!text.empty()) {
    std::string_view line = Trimmed(TakeLine(text));
    if (line.empty() || IsComment(line)) continue;
    for (std::size_t axis = 0; axis < kAxes; ++axis)
      if (!ParseNumber<double>(TakeWord(line, kBlanks))) return false;
    return Trimmed(line).empty();
  }
  return false;
}

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
