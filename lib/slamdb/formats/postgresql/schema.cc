// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/schema.h"

#include <algorithm>
#include <iterator>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/formats/postgresql/detail/migrations_sql.h"
#include "slamdb/formats/postgresql/detail/writer_lock.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;

constexpr std::int64_t kMakingLock = 0x534C4442;  // `SLDB`: held while the store is made

constexpr Versioned kVersioned[] = {{"camera", "position"}, {"map", "row"},       {"repeated_entry", "map"},
                                    {"keyframe", "row"},    {"map_point", "row"}, {"keyframe_features", "keyframe"},
                                    {"landmark", "row"}};
constexpr std::string_view kUnversioned[] = {"picture", "keyframe_words", "place"};

std::vector<Type> Types(std::initializer_list<std::pair<Type, int>> runs) {
  std::vector<Type> types;
  for (const auto& [type, count] : runs) types.insert(types.end(), static_cast<std::size_t>(count), type);
  return types;
}

// A keyframe's row fits into a page: its arrays are left in it, where PostgreSQL would compress them otherwise.
std::string_view StorageOf(std::string_view table) {
  return table == "keyframe" ? " WITH (toast_tuple_target = 8160)" : "";
}

// What a database says of its store; version 0: it has none.
struct StoreHead {
  int version = 0;
  std::int64_t partitions = 0;
};

StoreHead HeadOf(Connection& connection) {
  if (connection.Integer("SELECT to_regclass('slamdb.store') IS NOT NULL") == 0) return {};
  const Result found = connection.Query("SELECT version, partitions FROM slamdb.store", {}, "table store");
  const std::int64_t version = found.rows() == 0 ? 0 : found[0].Integer(0);
  if (version < 1)
    throw Error(ErrorKind::kDamaged, connection.path(), "table store",
                Concat("says version ", version,
                       ", which no slamdb has made: somebody edited it; write back what it was (a slamdb makes ",
                       NewestVersion(), ")"));
  return {static_cast<int>(version), found[0].Integer(1)};
}

void CheckIsStore(const StoreHead& head, const std::string& path) {
  const auto& [version, partitions] = head;
  if (version != 0 && partitions == 0)
    throw Error(ErrorKind::kUsage, path, "", "holds partitions of a store that is on another server: name that one");
  if (version == NewestVersion()) return;
  if (version == 0)
    throw Error(ErrorKind::kNotFound, path, "",
                "the database holds no store yet: save an atlas there, which makes one");
  throw Error(
      ErrorKind::kUnsupported, path, "",
      Concat("store version ", version, ", this program knows ", NewestVersion(),
             version > NewestVersion() ? ": use the slamdb that wrote it, or a newer one" : ": migrate it first"));
}

}  // namespace

std::string InRevision(std::int64_t atlas, std::int64_t revision) {
  return Concat("atlas = ", atlas, " AND since <= ", revision, " AND until > ", revision);
}

std::string InNewest(std::int64_t atlas) { return Concat("atlas = ", atlas, " AND until = ", kNewest); }

std::string ListOf(const std::set<std::int64_t>& numbers) {
  std::string list;
  for (const std::int64_t number : numbers) list += Concat(list.empty() ? "" : ", ", number);
  return list;
}

const Table& KeyframeTable() {
  static const Table table{
      "keyframe (row, map, atlas, id, unique_id, hash, links_hash, frame_id, timestamp, qw, qx, qy, qz, tx, ty, tz, "
      "vx, "
      "vy, vz, bias_ax, bias_ay, bias_az, bias_wx, bias_wy, bias_wz, camera, right_camera, parent, previous, next, "
      "origin_map, features, left_features, right_features, first_connection, not_erase, to_be_erased, bad, "
      "imu_initialized, has_velocity, details, exact, children, connections, weights, loop_edges, merge_edges, "
      "carried, "
      "since)",
      Types({{Type::kInt8, 8},
             {Type::kFloat8, 1},
             {Type::kFloat4, 16},
             {Type::kInt8, 6},
             {Type::kInt4, 3},
             {Type::kInt2, 6},
             {Type::kBytea, 2},
             {Type::kInt8Array, 2},
             {Type::kInt4Array, 1},
             {Type::kInt8Array, 2},
             {Type::kBytea, 1},
             {Type::kInt4, 1}})};
  return table;
}

const Table& FeaturesTable() {
  static const Table table{"keyframe_features (atlas, keyframe, hash, source_hash, points, picture, since)",
                           Types({{Type::kInt8, 4}, {Type::kBytea, 1}, {Type::kUuid, 1}, {Type::kInt4, 1}})};
  return table;
}

const Table& PictureTable() {
  static const Table table{"picture (atlas, hash, columns)",
                           Types({{Type::kInt8, 1}, {Type::kUuid, 1}, {Type::kBytea, 1}})};
  return table;
}

const Table& WordsTable() {
  static const Table table{"keyframe_words (atlas, keyframe, hash, words)",
                           Types({{Type::kInt8, 3}, {Type::kBytea, 1}})};
  return table;
}

const Table& PlaceTable() {
  static const Table table{"place (atlas, map, number, shown, words)",
                           Types({{Type::kInt8, 2}, {Type::kInt4, 2}, {Type::kBits, 1}})};
  return table;
}

const Table& PointTable() {
  static const Table table{
      "map_point (row, map, id, unique_id, hash, observations_hash, x, y, z, nx, ny, nz, min_distance, max_distance, "
      "reference, replaced_by, first_keyframe, first_frame, observation_count, bad, descriptor, descriptor_form, "
      "exact, "
      "origin_map, visible_count, found_count, seen_by, left_keypoints, right_keypoints, carried, atlas, since)",
      Types({{Type::kInt8, 6},
             {Type::kFloat4, 8},
             {Type::kInt8, 4},
             {Type::kInt4, 1},
             {Type::kInt2, 1},
             {Type::kBytea, 1},
             {Type::kInt2, 1},
             {Type::kBytea, 1},
             {Type::kInt8, 3},
             {Type::kInt8Array, 1},
             {Type::kInt4Array, 2},
             {Type::kBytea, 1},
             {Type::kInt8, 1},
             {Type::kInt4, 1}})};
  return table;
}

const Table& LandmarkTable() {
  static const Table table{
      "landmark (row, map, id, unique_id, hash, x, y, z, nx, ny, nz, cov_11, cov_22, cov_33, cov_12, cov_13, cov_23, "
      "last_seen, seen_count, features, exact, atlas, since)",
      Types({{Type::kInt8, 5},
             {Type::kFloat8, 12},
             {Type::kInt8, 2},
             {Type::kBytea, 2},
             {Type::kInt8, 1},
             {Type::kInt4, 1}})};
  return table;
}

std::span<const Versioned> VersionedTables() { return kVersioned; }

std::vector<std::string_view> PartitionedTables() {
  std::vector<std::string_view> tables;
  for (const Versioned& each : VersionedTables()) tables.push_back(each.table);
  tables.insert(tables.end(), std::begin(kUnversioned), std::end(kUnversioned));
  return tables;
}

std::int64_t DeleteRows(Connection& connection, std::int64_t atlas) {
  std::int64_t deleted = 0;
  for (const std::string_view table : PartitionedTables())
    deleted += connection.Query(Concat("DELETE FROM ", table, " WHERE atlas = $1"), {atlas}, Concat("table ", table))
                   .changed();
  return deleted;
}

std::int64_t CountRows(Connection& connection, std::int64_t atlas) {
  std::int64_t rows = 0;
  for (const std::string_view table : PartitionedTables())
    rows += connection.Integer(Concat("SELECT count(*) FROM ", table, " WHERE atlas = $1"), {atlas});
  return rows;
}

int NewestVersion() { return Migrations().back().number; }

int VersionOf(Connection& connection) { return HeadOf(connection).version; }

void CheckIsStore(Connection& connection) { CheckIsStore(HeadOf(connection), connection.path()); }

void LockMaking(Connection& connection) { connection.Query("SELECT pg_advisory_xact_lock($1)", {kMakingLock}); }

namespace {

// For the rest of the transaction; neither this lock nor those of tables are waited for longer.
void LockMigrating(Connection& connection, double timeout) {
  WaitForLock([&] { return connection.Integer("SELECT pg_try_advisory_xact_lock($1)", {kMakingLock}) != 0; },
              {timeout, {}},
              [&] {
                return Error(ErrorKind::kLocked, connection.path(), "",
                             "another slamdb makes or migrates this store right now");
              });
  const auto milliseconds = static_cast<std::int64_t>(std::clamp(1e3 * timeout, 1.0, 2e9));  // 0 would be for ever
  connection.Execute(Concat("SET LOCAL lock_timeout TO ", milliseconds));
}

}  // namespace

void MakeTables(Connection& connection) {
  connection.Execute("CREATE SCHEMA IF NOT EXISTS slamdb");
  for (const Migration& migration : Migrations()) connection.Execute(std::string(migration.sql));
}

void MakePartition(Connection& connection, std::string_view table, std::int64_t number, std::int64_t partitions,
                   std::string_view constraint) {
  connection.Execute(Concat("CREATE TABLE IF NOT EXISTS ", table, "_", number, " PARTITION OF ", table,
                            constraint.empty() ? "" : Concat(" (", constraint, ")"), " FOR VALUES WITH (MODULUS ",
                            partitions, ", REMAINDER ", number, ")", StorageOf(table)));
}

void MakeStore(Connection& connection, int partitions) {
  if (const StoreHead head = HeadOf(connection); head.version != 0) return CheckIsStore(head, connection.path());
  const Result encoding = connection.Query("SHOW server_encoding");
  if (encoding[0].Text(0) != "UTF8")
    throw Error(ErrorKind::kUnsupported, connection.path(), "",
                Concat("the database is in ", encoding[0].Text(0),
                       ", and names of atlases are UTF-8: make one with "
                       "createdb --encoding=UTF8 --template=template0"));
  Transaction transaction(connection, Transaction::Kind::kWrite);
  LockMaking(connection);
  if (VersionOf(connection) != 0) return CheckIsStore(connection);  // somebody was faster
  MakeTables(connection);
  for (const std::string_view table : PartitionedTables())
    for (int i = 0; i < partitions; ++i) MakePartition(connection, table, i, partitions);
  connection.Query("INSERT INTO store (version, partitions) VALUES ($1, $2)", {NewestVersion(), partitions});
  transaction.Commit();
}

MigrateReport Migrate(const std::string& uri, const MigrateOptions& options) {
  if (options.back)
    throw Error(ErrorKind::kNotPossible, detail::WithoutPassword(uri), "",
                "a store on a server does not go back: restore the dump that was made before it was migrated");
  Connection connection(uri);
  Transaction transaction(connection, Transaction::Kind::kWrite);
  LockMigrating(connection, options.lock_timeout);
  MigrateReport report;
  report.from = VersionOf(connection);
  report.to = NewestVersion();
  if (report.from == 0 || report.from > report.to) CheckIsStore(connection);
  for (const Migration& migration : Migrations()) {
    if (migration.number <= report.from) continue;
    report.steps.emplace_back(migration.name);
    if (!options.dry_run) connection.Execute(std::string(migration.sql));
  }
  if (options.dry_run || report.steps.empty()) return report;
  connection.Query("UPDATE store SET version = $1", {report.to});
  transaction.Commit();
  return report;
}

}  // namespace slamdb::postgresql
