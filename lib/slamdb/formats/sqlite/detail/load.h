// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/format.h"
#include "slamdb/formats/rows/detail/columns.h"
#include "slamdb/formats/rows/detail/plan.h"
#include "slamdb/formats/sqlite/detail/database.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/detail/row_hash.h"

// Loading an atlas. Steps:
//   1. read the atlas' own rows, and which rows of keyframes and points are wanted (by indexes and the R*Tree)
//   2. cut those into slices; each thread takes slices in turn, reads them over a connection of its own and decodes
//      them into their places
//   3. compare the hash of every row, and of the whole when all was read, with those stored
namespace slamdb::sqlite {

using detail::AtlasHashes;
using rows::FirstRowOfMap;
using rows::FromReference;
using rows::LastRowOfMap;
using rows::MapOfRow;

// Thrown when a connection sees another state of the atlas than the first one did: load again.
struct SnapshotChanged {};

// Read connections that all see the same revision of an atlas. Thread-safe.
class ConnectionPool {
 public:
  ConnectionPool(std::string path, double lock_timeout, std::int64_t atlas, std::int64_t revision)
      : path_(std::move(path)), lock_timeout_(lock_timeout), atlas_(atlas), revision_(revision) {}

  // A connection inside a read transaction, until the lease ends.
  class Lease {
   public:
    explicit Lease(ConnectionPool& pool) : pool_(pool), database_(pool.Take()) {}
    ~Lease() { pool_.Give(std::move(database_)); }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    Database& operator*() { return *database_; }

   private:
    ConnectionPool& pool_;
    std::unique_ptr<Database> database_;
  };

 private:
  std::unique_ptr<Database> Take();
  void Give(std::unique_ptr<Database> database);

  std::string path_;
  double lock_timeout_;
  std::int64_t atlas_, revision_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Database>> idle_;
};

// Loads the atlas of row `atlas` through `database`, on which a read transaction is open, and further connections.
// Throws Error, and SnapshotChanged when another program saved the atlas meanwhile.
Atlas LoadAtlas(Database& database, std::int64_t atlas, const ReadOptions& options);

// An earlier revision of it, of which `past` (past.h) knows what it does not share with the newest.
struct PastRows;
Atlas LoadPast(Database& database, std::int64_t atlas, PastRows& past, const ReadOptions& options);

// The atlas' own row and cameras, into `atlas`.
void LoadHeader(Database& database, std::int64_t row, Atlas& atlas);
void LoadCameras(Database& database, std::int64_t row, Atlas& atlas);

// The rows of an atlas' maps, in their order, and one of them without its lists.
std::vector<std::int64_t> RowsOfMaps(Database& database, std::int64_t atlas);
Map LoadMapHeader(Database& database, std::int64_t atlas, std::int64_t row);

// The rows of a map's list, ascending. `table` is keyframe, map_point or landmark.
std::vector<std::int64_t> RowsOfList(Database& database, std::string_view table, std::int64_t map);

// ` AND ...` on unsigned ids, both included, in the column `id` of signed integers, with parameters ?3 and ?4; empty
// when all ids are meant.
std::string IdCondition(std::uint64_t first, std::uint64_t last);

// The rows of a map's keyframes and points that the selection wants, ascending.
std::vector<std::int64_t> KeyframeRows(Database& database, std::int64_t map, const Selection& selection);
std::vector<std::int64_t> PointRows(Database& database, std::int64_t map, const Selection& selection);

// Of the list `maps`, `cameras`, `keyframes` or `points`; `map` 0: of the atlas.
std::vector<RepeatedEntry> LoadRepeated(Database& database, std::int64_t atlas, const char* list, std::int64_t map);

// What of keyframes is read; the rest stays empty.
struct KeyframeParts {
  bool links = true, features = true;
};
// Reads the keyframes of `rows` into `keyframes`, which is as long, and their hashes.
void LoadKeyframes(Database& database, std::span<const std::int64_t> rows, KeyframeParts parts,
                   std::span<KeyFrame> keyframes, std::span<std::int64_t> hashes, std::span<std::int64_t> links_hashes,
                   std::span<std::int64_t> features_hashes);
void LoadPoints(Database& database, std::span<const std::int64_t> rows, std::span<MapPoint> points,
                std::span<std::int64_t> hashes, std::span<std::int64_t> observations_hashes);

// Reads the landmarks of the map that the selection wants, and their hashes.
void LoadLandmarks(Database& database, std::int64_t map, const Selection& selection, std::vector<Landmark>& landmarks,
                   std::vector<std::int64_t>& hashes);

// Reads the landmarks of `rows`, ascending, into `landmarks`, which is as long.
void LoadLandmarkRows(Database& database, std::span<const std::int64_t> rows, std::span<Landmark> landmarks);

// Calls visit(first, count) for each run of consecutive row numbers in `rows`.
template <class Visit>
void ForEachRun(std::span<const std::int64_t> rows, Visit visit) {
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t end = first + 1;
    while (end < rows.size() && rows[end] == rows[end - 1] + 1) ++end;
    visit(first, end - first);
    first = end;
  }
}

// `table keyframe, row 12`, for errors.
inline std::string PlaceOf(const char* table, std::int64_t row) {
  return std::string("table ") + table + ", row " + std::to_string(row);
}
Error DamagedRow(Database& database, const char* table, std::int64_t row);

// Throws DamagedRow unless the row of the entity `id` is as it was saved, or the connection accepts edits.
void RequireSame(Database& database, const char* table, std::int64_t row, std::uint64_t id, bool same);

}  // namespace slamdb::sqlite
