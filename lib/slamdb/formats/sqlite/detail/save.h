// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <deque>
#include <string>

#include "slamdb/formats/sqlite/detail/database.h"
#include "slamdb/formats/sqlite/detail/past.h"
#include "slamdb/formats/sqlite/detail/plan.h"
#include "slamdb/formats/sqlite/store.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/detail/row_hash.h"

// Saving an atlas, in the caller's transaction. Steps:
//   1. hash every row of the atlas (in memory, on all threads) - before the store is locked
//   2. match its entities with the rows in the store by id, so that they keep their rows (plan.h)
//   3. keep (past.h), delete, insert and update what differs, table by table
namespace slamdb::sqlite {

using detail::AtlasHashes;

// Counts what happens to the rows of each table.
class ChangeCounter {
 public:
  TableChanges& operator[](const std::string& table);
  std::vector<TableChanges> Take() const { return {tables_.begin(), tables_.end()}; }

 private:
  std::deque<TableChanges> tables_;  // so that references stay valid
};

// What the parts of a save share.
struct SaveContext {
  Database& database;
  const SaveOptions& options;
  ChangeCounter& changes;
  PastWriter& past;        // asked to keep all that changes, before it does
  MapChanges& map;         // what changed in the map
  std::int64_t atlas = 0;  // its row
  std::size_t entities = 0, entities_done = 0;

  void Report(std::size_t done);  // progress; throws what the callback throws
};

// Which rows a save writes.
enum class Rewrite {
  kWhatDiffers,  // from what the stored hashes tell
  kAll,          // that are in the store may hold something else than their hashes tell
};

// Saves everything. `hashes` is detail::HashesOf(atlas).
void SaveAtlas(Database& database, const std::string& name, const Atlas& atlas, const AtlasHashes& hashes,
               const SaveOptions& options, Rewrite rewrite, SaveReport& report);

// The order of a list (list_order.h), where it is another than before.
void SaveOrder(SaveContext& context, std::int64_t map, std::string_view list, const ListPlan& plan);

// Deletes the atlas of row `atlas` and all that belongs to it.
void DeleteAtlas(Database& database, std::int64_t atlas, ChangeCounter& changes);

// The parts, for one map of row `row`. The keyframes' rows are returned.
std::vector<std::int64_t> SaveKeyframes(SaveContext& context, std::int64_t row, const Map& map,
                                        const AtlasHashes::OfMap& hashes);
void SavePoints(SaveContext& context, std::int64_t row, const Map& map, const AtlasHashes::OfMap& hashes);
void SaveLandmarks(SaveContext& context, std::int64_t row, const Map& map, const AtlasHashes::OfMap& hashes);

// The rows of a map's list as the store has them. `table` is keyframe or map_point, `details_hash` its second hash;
// `expected` is about how many there will be.
std::vector<StoredRow> ReadStoredRows(Database& database, const std::string& table, const std::string& details_hash,
                                      std::int64_t map, std::size_t expected);

// How many rows of keyframe_link a keyframe has.
inline std::size_t CountLinks(const KeyFrame& keyframe) {
  return keyframe.children.size() + keyframe.connections.size() + keyframe.loop_edges.size() +
         keyframe.merge_edges.size();
}

// ---- values as columns

inline std::int64_t ToColumn(std::uint64_t value) { return static_cast<std::int64_t>(value); }
template <class Entity>
std::int64_t ToColumn(Id<Entity> id) {
  return static_cast<std::int64_t>(id.value());
}
// As a reference: NULL for none.
template <class Entity>
std::optional<std::int64_t> ToReference(Id<Entity> id) {
  return id.has_value() ? std::optional(static_cast<std::int64_t>(id.value())) : std::nullopt;
}
// False for NaN and -0.0, which a REAL column does not keep.
inline bool FitsReal(double value) { return value == value && !(value == 0 && std::signbit(value)); }

}  // namespace slamdb::sqlite
