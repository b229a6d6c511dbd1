// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/edit/ids/detail/references.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

struct IdPair {
  std::uint64_t before = kNoId;
  std::uint64_t after = kNoId;  // none: it is not in the result
  friend bool operator==(const IdPair&, const IdPair&) = default;
};

// Which id became which, kind by kind; of a kind without pairs every id stayed. Ids of entities long gone that are
// still named somewhere (the keyframe that made a point, the map in which a keyframe was made) have pairs too, so that
// a map and its inverse give the original bytes.
struct IdMap {
  std::string input;                                // the file that the ids before are of; may be empty
  std::array<std::vector<IdPair>, kIdKinds> kinds;  // by IdKind; ascending `before`
  std::optional<Counters> counters_before, counters_after;

  std::vector<IdPair>& operator[](IdKind kind) { return kinds[static_cast<std::size_t>(kind)]; }
  const std::vector<IdPair>& operator[](IdKind kind) const { return kinds[static_cast<std::size_t>(kind)]; }
  friend bool operator==(const IdMap&, const IdMap&) = default;
};

// `map`, `keyframe`, `point`, `frame`, `camera`.
std::string_view NameOf(IdKind kind);
std::optional<IdKind> IdKindByName(std::string_view name);

// The counters of an atlas, each with the kind that it counts and its name in tables.
struct CounterField {
  IdKind kind;
  std::string_view name;
  std::uint64_t Counters::*field;
};
std::span<const CounterField> CounterFields();

// The counter of the next id of a kind.
std::uint64_t& NextId(Counters& counters, IdKind kind);
std::uint64_t NextId(const Counters& counters, IdKind kind);

// The pair of an id in a list that ascends by `before`; null when it has none.
const IdPair* FindPair(const std::vector<IdPair>& pairs, std::uint64_t before);

// The largest id that the fields of a kind hold and ORB-SLAM3 can work with.
std::uint64_t LargestId(IdKind kind);

// What takes the ids after back to those before. Throws Error when an entity is not in the result.
IdMap Inverse(const IdMap& ids);

// Gives every id of the atlas its new one, in every field; counters follow. Changes nothing when it throws Error: when
// the map names an id twice, before or after, or one too large; when the atlas has an entity of a mapped kind that the
// map does not name; or when it names something else by an id that would be taken. Linear.
void ApplyIdMap(Atlas& atlas, const IdMap& ids, int threads = 0);

// A CSV table `input,kind,old,new`, one row for each id, then rows of the counters: `next_keyframe` and so on. An empty
// `new` says that the entity is not in the result.
std::string IdMapsToCsv(std::span<const IdMap> maps);

// Reads such a table back, in any dialect of schema/tables.md: one map for each input, in order of appearance. The
// column `input` may be missing. Throws Error (kDamaged) with line and column.
std::vector<IdMap> ParseIdMapsCsv(std::string_view csv);

// A table in any dialect of schema/tables.md whose first line names the columns, with the ids in it replaced and all
// else as it was. Columns are told by name: `map`; `keyframe`, `parent`, `reference_keyframe`; `point`; `frame`,
// `frame_id`; `camera`; `id` is a keyframe when there is a column `timestamp`, else a point when there is a column `x`.
// Empty cells stay. Throws Error (kDamaged) when no column holds an id of a mapped kind, and with the line when an id
// is not in the map, or has none in the result.
std::string ApplyIdMapToCsv(std::string_view csv, const IdMap& ids);

}  // namespace slamdb
