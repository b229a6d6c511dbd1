// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

enum class EntityKind : std::uint8_t { kAtlas, kCamera, kMap, kKeyFrame, kPoint, kLandmark };

// `before` in place of `after` in a field, from element `at` on.
// Values are the bits of scalars, element after element.
// `kinds` says of the scalars of one element what they are, as Python's struct module does:
//   B    byte
//   i I  32 bits, signed and unsigned
//   q Q  64 bits, signed and unsigned
//   f d  floating point
//   r    a reference (an id; all bits set: none)
// A field that is no list is one element, a matrix one for each coefficient, column by column.
// A transform is the quaternion x y z w and the translation.
struct FieldEdit {
  std::string field;  // as the model's headers name it: `features.map_points`
  std::string kinds;
  std::uint64_t at = 0;
  std::vector<std::uint64_t> before, after;
};

// What one fix did to one entity.
struct EntityEdit {
  std::string rule;  // whose fix
  EntityKind kind = EntityKind::kAtlas;
  std::uint32_t map = 0;  // keyframes, points and landmarks: row of Atlas::maps at that moment
  std::uint64_t row = 0;  // of its list at that moment
  std::uint64_t id = 0;   // for the reader; before the edit, or of what was added. Of an atlas 0
  bool removed = false;   // taken out of its list; `fields` then say how it differed from an entity just made
  bool added = false;     // put into its list; `fields` then say how it differs from an entity just made
  std::vector<FieldEdit> fields;
};

// Changes of an atlas, in the order in which they were made; enough to take all of them back.
struct Journal {
  std::uint64_t original = 0, repaired = 0;  // HashWithoutEncoding (model/digest.h) of the atlas before and after
  ArchiveEncoding encoding;                  // how the original was written
  std::vector<EntityEdit> edits;
};

// Appends what makes `after` of `before` under the name of `rule`.
// Entities may have been changed, removed, added and moved; those moved are taken for removed and added. Of lists of
// equal length the rows are compared. Encodings do not count.
//
// Cost: linear; n log n for lists that something was added to.
SLAMDB_EXPORT void AppendChanges(const Atlas& before, const Atlas& after, std::string_view rule, Journal& journal);

// Takes the edits back, the last one first: bit by bit what it was, uninitialised values and the order of lists
// included. Hashes and encoding do not count here; UndoRepair holds the atlas against them.
//
// Throws Error (kNotPossible), and leaves `atlas` in between, where it does not hold what an edit made.
// Cost: linear in the edits, and in each list of which something was removed or added.
SLAMDB_EXPORT void TakeBack(const Journal& journal, Atlas& atlas);

struct UndoOptions {
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty
};

struct UndoReport {
  std::uint64_t edits = 0;  // taken back
};

// Makes of a repaired atlas the original again, its encoding included.
//
// Throws Error:
//   kNotPossible  the atlas is not the one that the journal was kept of; it stays as it is
//   kDamaged      the edits do not lead back to the original; the atlas is then of no use
// Cost: linear.
SLAMDB_EXPORT UndoReport UndoRepair(Atlas& atlas, const Journal& journal, const UndoOptions& options = {});

// As schema/undo.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const UndoReport& report, const ReportFiles& files = {});

// ---- Journals as files: docs/repair.md and schema/journal.schema.json

// JSON, one line for each entity. Equal journals give equal text.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const Journal& journal);

// Throws Error: kDamaged when the text is no journal, kUnsupported when it is one of a newer version.
[[nodiscard]] SLAMDB_EXPORT Journal ParseJournal(std::string_view json);

// Writes a file, which appears whole or not at all.
//
// Throws Error as AtomicFile does.
SLAMDB_EXPORT void WriteJournal(const Journal& journal, const std::string& path, const AtomicFileOptions& options = {});

// Throws Error with the path: kNotFound, kPermission, and as ParseJournal does.
[[nodiscard]] SLAMDB_EXPORT Journal ReadJournal(const std::string& path);

}  // namespace slamdb
