// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/partition.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/postgresql/detail/schema.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;

constexpr std::int64_t kPartitionLocks = 0x534C4450;  // `SLDP`: the class of their advisory locks

void Lock(Connection& connection, std::int64_t number, std::string_view function, const LockOptions& options) {
  WaitForLock(
      [&] {
        return connection.Integer(Concat("SELECT ", function, "(", kPartitionLocks, ", $1::integer)"), {number}) != 0;
      },
      options,
      [&] {
        return Error(ErrorKind::kLocked, connection.path(), Concat("partition ", number),
                     "is being moved to another server, or used by others meanwhile: try again later");
      });
}

Partition FindPartition(Connection& connection, std::int64_t atlas) {
  const Result found = connection.Query(
      Concat(
          "SELECT number, (SELECT relkind = 'f' FROM pg_class WHERE oid = to_regclass('slamdb.map_' || number)) FROM "
          "generate_series(0, (SELECT partitions FROM store) - 1) AS number WHERE ",
          IsInPartition("$1::bigint", "number")),
      {atlas}, "table map");
  if (found.rows() == 0) throw Error(ErrorKind::kDamaged, connection.path(), "table map", "lacks a partition");
  return {found[0].Integer(0), found[0].Integer(1) != 0};
}

// Whether there are rows beyond the newest revision, which those of `map`, `camera` and `repeated_entry` tell of: a
// save that changes anything of an atlas that has maps writes its rows of `map` anew, all in one transaction.
bool IsUnfinished(Connection& connection, const Partition& partition, std::int64_t atlas, std::int64_t newest) {
  std::string any;
  for (const char* table : {"map", "camera", "repeated_entry"})
    any += Concat(any.empty() ? "SELECT " : " OR ", "EXISTS (SELECT 1 FROM ", partition.Table(table),
                  " WHERE atlas = $1 AND (since > $2::integer OR (until > $2::integer AND until < 2147483647)))");
  return connection.Integer(any, {atlas, newest}) != 0;
}

// Of an atlas that never was, whose row number the next one gets.
std::int64_t DeletePictures(Connection& connection, std::int64_t atlas) {
  return connection.Query("DELETE FROM picture WHERE atlas = $1", {atlas}, "table picture").changed();
}

// What the keyframes look like goes with the revision that was to come: the next save finds out again.
std::uint64_t ForgetWords(Connection& connection, const Partition& partition, std::int64_t atlas) {
  return static_cast<std::uint64_t>(
      connection
          .Query(Concat("DELETE FROM keyframe_words WHERE atlas = $1 AND NOT EXISTS (SELECT 1 FROM ",
                        partition.Table("keyframe_features"),
                        " WHERE keyframe_features.atlas = $1 AND keyframe_features.until = 2147483647 AND "
                        "keyframe_features.keyframe = keyframe_words.keyframe AND keyframe_features.hash = "
                        "keyframe_words.hash)"),
                 {atlas}, "table keyframe_words")
          .changed());
}

// Those of maps that never were.
std::uint64_t ForgetPlaces(Connection& connection, const Partition& partition, std::int64_t atlas) {
  return static_cast<std::uint64_t>(
      connection
          .Query(Concat("DELETE FROM place WHERE atlas = $1 AND NOT EXISTS (SELECT 1 FROM ", partition.Table("map"),
                        " WHERE map.atlas = $1 AND map.row = place.map AND map.until = 2147483647)"),
                 {atlas}, "table place")
          .changed());
}

}  // namespace

std::string Partition::Table(std::string_view table) const {
  return is_remote ? Concat(table, "_", number, " AS ", table) : std::string(table);
}

std::string IsInPartition(std::string_view row, std::string_view number) {
  return Concat("satisfies_hash_partition('slamdb.map'::regclass, (SELECT partitions FROM slamdb.store), ", number,
                ", ", row, ")");
}

bool IsFleet(Connection& connection) {
  return connection.Integer("SELECT to_regclass('slamdb.fleet') IS NOT NULL") != 0;
}

Partition PartitionOf(Connection& connection, std::int64_t atlas) {
  return IsFleet(connection) ? FindPartition(connection, atlas) : Partition();
}

std::vector<Partition> PartitionsOf(Connection& connection) {
  const Result found = connection.Query(
      "SELECT number, (SELECT relkind = 'f' FROM pg_class WHERE oid = to_regclass('slamdb.map_' || number)) FROM "
      "generate_series(0, (SELECT partitions FROM slamdb.store) - 1) AS number ORDER BY number",
      {}, "table store");
  std::vector<Partition> partitions;
  for (std::size_t i = 0; i < found.rows(); ++i) partitions.push_back({found[i].Integer(0), found[i].Integer(1) != 0});
  return partitions;
}

Partition HoldPartition(Connection& connection, std::int64_t atlas, const LockOptions& options) {
  if (!IsFleet(connection)) return {};
  Lock(connection, FindPartition(connection, atlas).number, "pg_try_advisory_xact_lock_shared", options);
  return FindPartition(connection, atlas);  // it may have been moved while we waited
}

void LockPartition(Connection& connection, std::int64_t number, const LockOptions& options) {
  Lock(connection, number, "pg_try_advisory_xact_lock", options);
}

std::uint64_t UndoUnfinished(Connection& connection, const Partition& partition, std::int64_t atlas,
                             std::int64_t newest, bool is_edited) {
  if (!is_edited && (!partition.is_remote || !IsUnfinished(connection, partition, atlas, newest))) return 0;
  std::int64_t rows = 0;
  for (const Versioned& each : VersionedTables()) {
    const std::string place = Concat("table ", each.table);
    rows += connection
                .Query(Concat("DELETE FROM ", each.table, " WHERE atlas = $1 AND since > $2::integer"), {atlas, newest},
                       place)
                .changed();
    rows +=
        connection
            .Query(Concat("UPDATE ", each.table,
                          " SET until = 2147483647 WHERE atlas = $1 AND until > $2::integer AND until < 2147483647"),
                   {atlas, newest}, place)
            .changed();
  }
  if (newest == 0) rows += DeletePictures(connection, atlas);
  const LocalSetting loops(connection, "enable_nestloop", "off");
  return static_cast<std::uint64_t>(rows) + ForgetWords(connection, partition, atlas) +
         ForgetPlaces(connection, partition, atlas);
}

bool IsOfOtherServer(const Error& error) {
  const auto* server = dynamic_cast<const ServerError*>(&error);
  if (server == nullptr) return false;
  constexpr std::string_view kStates[] = {"08", "HV", "28", "57P", "53300"};
  return std::ranges::any_of(kStates, [&](std::string_view state) { return server->state().starts_with(state); });
}

}  // namespace slamdb::postgresql
