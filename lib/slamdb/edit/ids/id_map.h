// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/notices.h"
#include "slamdb/edit/ids/id_kind.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

struct IdPair {
  std::uint64_t before = kNoId;
  std::uint64_t after = kNoId;  // none: it is not in the result
  friend bool operator==(const IdPair&, const IdPair&) = default;
};

// Which id became which, kind by kind; of a kind without pairs every id stayed.
// Ids of entities long gone that are still named somewhere (the keyframe that made a point, the map in which a keyframe
// was made) have pairs too, so that a map and its inverse give the original bytes.
struct IdMap {
  std::string input;                                // the file that the ids before are of; may be empty
  std::array<std::vector<IdPair>, kIdKinds> kinds;  // by IdKind; ascending `before`
  std::optional<Counters> counters_before, counters_after;

  std::vector<IdPair>& operator[](IdKind kind) { return kinds[static_cast<std::size_t>(kind)]; }
  const std::vector<IdPair>& operator[](IdKind kind) const { return kinds[static_cast<std::size_t>(kind)]; }
  friend bool operator==(const IdMap&, const IdMap&) = default;
};

// `map`, `keyframe`, `point`, `frame`, `camera`.
SLAMDB_EXPORT std::string_view NameOf(IdKind kind);
SLAMDB_EXPORT std::optional<IdKind> IdKindByName(std::string_view name);

// The counters of an atlas, each with the kind that it counts and its name in tables.
struct CounterField {
  IdKind kind;
  std::string_view name;
  std::uint64_t Counters::*field;
};
SLAMDB_EXPORT std::span<const CounterField> CounterFields();

// The counter of the next id of a kind.
SLAMDB_EXPORT std::uint64_t& NextId(Counters& counters, IdKind kind);
SLAMDB_EXPORT std::uint64_t NextId(const Counters& counters, IdKind kind);

// The pair of an id in a list that ascends by `before`; null when it has none.
SLAMDB_EXPORT const IdPair* FindPair(const std::vector<IdPair>& pairs, std::uint64_t before);

// The largest id that the fields of a kind hold and ORB-SLAM3 can work with.
SLAMDB_EXPORT std::uint64_t LargestId(IdKind kind);

// What takes the ids after back to those before.
//
// Throws Error (kNotPossible) when an entity is not in the result.
[[nodiscard]] SLAMDB_EXPORT IdMap Inverse(const IdMap& ids);

// Gives every id of the atlas its new one, in every field; counters follow.
//
// Throws Error, and then changes nothing:
//   kUsage        the map names an id twice, before or after, or one too large
//   kNotPossible  the atlas has an entity of a mapped kind that the map does not name, names something else by an id
//                 that would be taken, or the map has no new id for an entity
// Cost: linear. `threads` 0: every core.
SLAMDB_EXPORT void ApplyIdMap(Atlas& atlas, const IdMap& ids, int threads = 0);

// ---- Id maps as files: a table, or JSON (schema/id_map.schema.json)

// A CSV table `input,kind,old,new`, one row for each id, then rows of the counters: `next_keyframe` and so on.
// An empty `new` says that the entity is not in the result.
[[nodiscard]] SLAMDB_EXPORT std::string IdMapsToCsv(std::span<const IdMap> maps);

// Reads such a table back, in any dialect of schema/tables.md: one map for each input, in order of appearance.
// The column `input` may be missing.
//
// Throws Error (kDamaged) with line and column, and where an input has some counters and not all.
[[nodiscard]] SLAMDB_EXPORT std::vector<IdMap> ParseIdMapsCsv(std::string_view csv);

// The same as JSON, on one line. Equal maps give equal text.
[[nodiscard]] SLAMDB_EXPORT std::string IdMapsToJson(std::span<const IdMap> maps);

// Throws Error (kDamaged) when the text is no JSON, or not of id maps.
[[nodiscard]] SLAMDB_EXPORT std::vector<IdMap> ParseIdMapsJson(std::string_view json);

// What WriteIdMaps writes to a file of this name: JSON when it ends with .json, CSV otherwise.
[[nodiscard]] SLAMDB_EXPORT std::string IdMapsToText(std::span<const IdMap> maps, std::string_view path);

// Writes a file, which appears whole or not at all.
//
// Throws Error as AtomicFile does.
SLAMDB_EXPORT void WriteIdMaps(std::span<const IdMap> maps, const std::string& path,
                               const AtomicFileOptions& options = {});

// Reads a file of either kind, by its name.
//
// Throws Error with the path: kNotFound, kPermission, kDamaged.
[[nodiscard]] SLAMDB_EXPORT std::vector<IdMap> ReadIdMaps(const std::string& path, Notices* notices = nullptr);

// The id map of one input in such a file.
//
// Throws Error as ReadIdMaps does, and with the inputs that there are:
//   kNotFound  no input of the file is `input`
//   kUsage     `input` is empty and the file has several
[[nodiscard]] SLAMDB_EXPORT IdMap ReadIdMap(const std::string& path, const std::string& input = {},
                                            Notices* notices = nullptr);

// A table in any dialect of schema/tables.md whose first line names the columns, with the ids in it replaced and all
// else as it was. Empty cells stay.
// Columns are told by name:
//   `map`, `point`, `camera`
//   `frame`, `frame_id`
//   `keyframe`, `keyframe_id`, `parent`, `reference_keyframe`
//   `id`: a keyframe when there is a column `timestamp`, else a point when there is a column `x`
//
// Throws Error (kDamaged) when no column holds an id of a mapped kind.
// Throws Error (kDamaged) with the line when an id is not in the map, or has none in the result.
[[nodiscard]] SLAMDB_EXPORT std::string ApplyIdMapToCsv(std::string_view csv, const IdMap& ids);

}  // namespace slamdb
