// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/formats/rows/detail/change_counter.h"
#include "slamdb/formats/rows/detail/columns.h"
#include "slamdb/formats/rows/detail/keyframe_row.h"
#include "slamdb/formats/rows/detail/plan.h"
#include "slamdb/formats/rows/stored.h"
#include "slamdb/formats/sqlite/detail/database.h"
#include "slamdb/formats/sqlite/detail/past.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/detail/row_hash.h"

// Saving an atlas, in the caller's transaction. Steps:
//   1. hash every row of the atlas (in memory, on all threads) - before the store is locked
//   2. match its entities with the rows in the store by id, so that they keep their rows (plan.h)
//   3. keep (past.h), delete, insert and update what differs, table by table
namespace slamdb::sqlite {

using detail::AtlasHashes;
using rows::ChangeCounter;
using rows::CountLinks;
using rows::FirstRowOfMap;
using rows::LastRowOfMap;
using rows::ListPlan;
using rows::PlanList;
using rows::StoredRow;
using rows::ToColumn;
using rows::ToReference;

// What the parts of a save share.
struct SaveContext {
  Database& database;
  const SaveOptions& options;
  ChangeCounter& changes;
  PastWriter& past;        // asked to keep all that changes, before it does
  MapChanges& map;         // what changed in the map
  const std::string& at;   // when it is saved
  std::int64_t atlas = 0;  // its row
  std::size_t entities = 0, entities_done = 0;

  void Report(std::size_t done);  // progress; throws what the callback throws
};

// Which rows a save writes.
enum class Rewrite {
  kWhatDiffers,  // from what the stored hashes tell
  kAll,          // that are in the store may hold something else than their hashes tell
};

// Saves everything. `hashes` is detail::HashesOf(atlas); `at`: when it is saved, as the history has it.
void SaveAtlas(Database& database, const std::string& name, const Atlas& atlas, const AtlasHashes& hashes,
               const std::string& at, const SaveOptions& options, Rewrite rewrite, SaveReport& report);

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

}  // namespace slamdb::sqlite
