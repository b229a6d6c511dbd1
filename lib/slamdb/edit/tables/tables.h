// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/base/file.h"
#include "slamdb/base/notices.h"
#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/edit/repair/journal.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// Tables of an atlas's points and keyframes, as the formats csv and csv-keyframes write them and others change them.
// Their first line names the columns; which of them count, docs/edit.md lists.
struct TableEditOptions {
  std::optional<Source> points, keyframes;
  // What has no row is deleted: of the maps that the table has rows of, but for what is flagged bad, which those
  // formats leave out.
  bool delete_missing = false;
  bool journal = true;  // false saves the copy that it takes
  int threads = 0;      // 0: every core
};

// What a table did.
struct TableEditChanges {
  std::uint64_t rows = 0;
  std::uint64_t moved = 0;           // other positions, or poses
  std::uint64_t changed = 0;         // another value in any other column; those that moved may be among them
  std::uint64_t deleted = 0;         // whose column `bad` became 1, or that have no row
  std::vector<std::string> ignored;  // columns of another name
  bool has_open_end = false;         // the last line has no end: the table may be cut there
  friend bool operator==(const TableEditChanges&, const TableEditChanges&) = default;
};

struct TableEditReport {
  TableEditChanges points, keyframes;
  std::uint64_t refreshed = 0;  // points whose normals or distance ranges follow from what moved
  SubsetReport removed;         // with what followed from deleting
  Journal journal;              // empty when none was asked for
};

// Gives `atlas` what the rows of the tables say, and closes what deleting leaves open as KeepSubset does.
// A value that is written as the atlas has it changes nothing, not a bit; an empty cell, and a column that is not
// there, neither: x alone moves along x. What `bad` becomes 1 of is deleted, as nothing may refer to what is bad.
// Points that moved, and those that moved keyframes see, get normals and distance ranges anew, as ORB-SLAM3's
// UpdateNormalAndDepth, unless their row has others. The position of the body follows the camera. Points that deleted
// keyframes leave with too few observers go, as Border::kStrict says. UndoRepair(atlas, report.journal) takes all of it
// back bit by bit.
//
// Throws Error, with file and line, before anything changes:
//   kDamaged      no such table: the column `id` is missing; a cell is no such number; an id that the atlas, or its
//                 map, does not have, or that several maps have where no column `map` tells; two rows of one entity; a
//                 number that is not finite; a rotation or viewing direction without length; distances that are not
//                 above 0, or no range; a reference keyframe that does not observe the point
//   kNotFound and others as WholeFile
//   kUsage        neither table is given
// Cost: linear; holds a second copy of the atlas meanwhile.
SLAMDB_EXPORT TableEditReport EditByTables(Atlas& atlas, const TableEditOptions& options);

// Columns that mean nothing, and tables that may be cut.
SLAMDB_EXPORT void TellWarnings(const TableEditReport& report, const TableEditOptions& options, Notices& notices);

// As schema/edit.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const TableEditReport& report, const ReportFiles& files = {});

}  // namespace slamdb
