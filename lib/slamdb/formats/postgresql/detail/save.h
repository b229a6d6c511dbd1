// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/copy_in.h"
#include "slamdb/formats/postgresql/detail/names.h"
#include "slamdb/formats/postgresql/detail/partition.h"
#include "slamdb/formats/postgresql/detail/schema.h"
#include "slamdb/formats/rows/detail/change_counter.h"
#include "slamdb/formats/rows/detail/match_maps.h"
#include "slamdb/formats/rows/detail/plan.h"
#include "slamdb/formats/rows/detail/row_changes.h"
#include "slamdb/formats/rows/stored.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/detail/record.h"
#include "slamdb/model/detail/row_hash.h"

// Saving an atlas, in the caller's transaction, under the lock of its name. Steps:
//   1. hash every row of the atlas (in memory, on all threads) - before the lock
//   2. ask for the hashes of the rows of the newest revision, and match entities with them by id (rows/plan.h)
//   3. end the rows that differ (`until`), all of a table in one statement, and COPY the new ones
namespace slamdb::postgresql {

using detail::AtlasHashes;

// What the parts of a save share.
struct SaveContext {
  Connection& connection;
  const SaveOptions& options;
  rows::ChangeCounter changes;
  MapChanges map;             // what changed in the map
  std::int64_t atlas = 0;     // its row
  std::int64_t revision = 0;  // that the save makes
  bool is_new = false;        // the store has no atlas of that name
  Partition partition;        // where its rows are
  bool rewrites = false;      // what the store has may not be what its hashes tell
  std::size_t entities = 0, entities_done = 0;

  void Report(std::size_t done);  // progress; throws what the callback throws
  CopyIn::Way way() const { return partition.is_remote ? CopyIn::Way::kInBatches : CopyIn::Way::kStraight; }
};

// Saves everything under `name`, where the store has `stored`. `hashes` is detail::HashesOf(atlas); `rewrite`: whatever
// hashes the rows have.
SaveReport SaveAtlas(Connection& connection, const std::string& name, const std::optional<StoredHead>& stored,
                     const Atlas& atlas, const AtlasHashes& hashes, const SaveOptions& options, const LockOptions& lock,
                     bool rewrite);

// ---- the lists (save_lists.cc)

// A keyframe as the newest revision has it, beside its StoredRow.
struct StoredFeatures {
  std::int64_t hash = 0, source_hash = 0;
  double timestamp = 0;  // NaN: none
};

// The rows of a map's lists, ascending.
struct StoredLists {
  std::vector<rows::StoredRow> keyframes, points, landmarks;
  std::vector<StoredFeatures> features;  // of each keyframe
};
// Of each map of the atlas, by `maps`, their rows.
std::vector<StoredLists> ReadStoredLists(SaveContext& context, const std::vector<std::int64_t>& maps);

// Ends rows: `table` is one of VersionedTables(). Gives of each what `returning` names, columns of the table; nothing
// where there are none to end.
std::optional<Result> EndRows(SaveContext& context, std::string_view table, const std::vector<std::int64_t>& rows,
                              std::string_view returning = {});

// A map to be saved.
struct MapToSave {
  std::int64_t row;
  const Map& map;
  const AtlasHashes::OfMap& hashes;
  const StoredLists& stored;
};
// The plan of each list (rows/plan.h).
struct ListPlans {
  rows::ListPlan keyframes, points, landmarks;
};
// Saves the lists of all maps, one table after the other. Returns their plans.
std::vector<ListPlans> SaveLists(SaveContext& context, const std::vector<MapToSave>& maps);
// What the keyframes look like, of the newest revision alone: it is in no hash, and other programs may delete it.
// (save_places.cc)
void SaveWords(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
               bool all_places = false);
bool HasAllWords(SaveContext& context, const Atlas& atlas);
// That alone, of an atlas that is there as it is. (save_lists.cc)
void SaveWords(SaveContext& context, const std::vector<MapToSave>& maps);

// Each of them, which SaveLists calls (save_keyframes.cc, save_features.cc, save_points.cc).
void SaveKeyframes(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans);
void SavePoints(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans);

// Which entries of a list a save writes: (index of the map, index in the list).
using ListPlaces = std::vector<std::pair<std::size_t, std::size_t>>;
void WriteFeatures(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                   const ListPlaces& changed);
// What of the features' packed columns follows from elsewhere (rows/features_blob.h): image bounds, the kind of camera.
std::int64_t SourceHashOf(const KeyFrame& keyframe);

// ---- maps, cameras and irregular entries (save_maps.cc)

// The maps of the newest revision that are those of the atlas, and which rows their lists have; row 0: a new map. Ends
// the others.
struct MatchedMaps {
  std::vector<rows::StoredMap> maps;
  std::vector<StoredLists> lists;
};
MatchedMaps MatchMaps(SaveContext& context, const Atlas& atlas);
std::vector<rows::StoredMap> ReadStoredMaps(SaveContext& context);  // in the order of the atlas, without keys
// The rows of the maps, by `matched` or new.
std::vector<std::int64_t> NumbersOfMaps(SaveContext& context, const std::vector<rows::StoredMap>& matched);
void SaveMapRows(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes,
                 const std::vector<rows::StoredMap>& matched, const std::vector<std::int64_t>& numbers,
                 const std::vector<ListPlans>& plans);
// Whether there are as many cameras, repeated entries and landmarks as the atlas has: of the other tables the history
// tells how many rows they had.
bool HasAllOfThese(const SaveContext& context, const Atlas& atlas);
// All of them or none.
void SaveCamerasAndRepeated(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes,
                            const std::vector<std::int64_t>& maps);

// ---- what all do

// Throws Error when a table has not taken all rows that it was given, as where a trigger keeps some out.
void RequireTaken(Connection& connection, std::string_view table, std::int64_t taken, std::int64_t wanted);

Parameter ParameterOf(const rows::Value& value);

// A row of few, by INSERT. `columns`: `map (row, atlas)`.
void InsertRow(Connection& connection, std::string_view columns, std::span<const rows::Value> values);

// What a fork's file has of an entity, as a column.
class CarriedColumn {
 public:
  rows::Value Of(const Boxed<Carried>& carried) {
    if (!carried) return {};
    bytes_.Clear();
    detail::EncodeCarried(carried, bytes_);
    return bytes_.bytes();
  }

 private:
  detail::ByteWriter bytes_;
};

// Columns of a row that is copied. A NaN is NULL in a column, as in every store; `exact` of the row has it.
template <class Columns>
void PutColumns(CopyIn& copy, const Columns& columns) {
  for (const rows::Value& value : columns) {
    const auto* real = std::get_if<double>(&value);
    real != nullptr&& std::isnan(*real) ? copy.PutNull() : copy.Put(value);
  }
}

}  // namespace slamdb::postgresql
