// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <chrono>
#include <thread>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/postgresql/detail/fleet_parts.h"
#include "slamdb/formats/postgresql/detail/foreign_server.h"
#include "slamdb/formats/postgresql/detail/partition.h"
#include "slamdb/formats/postgresql/detail/schema.h"

// Moving a partition:
//   1. the tables are made on the new server
//   2. in one transaction of the store's server, which keeps saves to the partition out: rows are copied, and the
//      partition is to be found there from now on. The new server commits first; if that is all that happens, its rows
//      are deleted by the next attempt
//   3. when all who may still read the tables that it was moved from are done, these are emptied
namespace slamdb {
namespace postgresql {
namespace {

using detail::Concat;
using namespace std::chrono_literals;

std::string NameOfNext(std::int64_t partition) { return Concat("slamdb_next_", partition); }
std::string NameOfOld(std::int64_t partition) { return Concat("slamdb_old_", partition); }

// `slamdb_old_3.map_3, ...`
std::string TablesBehind(const std::string& door, std::int64_t partition) {
  std::string tables;
  for (const std::string_view table : PartitionedTables())
    tables += Concat(tables.empty() ? "" : ", ", door, ".", table, "_", partition);
  return tables;
}

void CopyRows(Connection& store, std::int64_t partition, const FleetOptions& options) {
  const std::string next = NameOfNext(partition);
  store.Execute("TRUNCATE " + TablesBehind(next, partition));
  const std::vector<std::string_view> tables = PartitionedTables();
  for (std::size_t i = 0; i < tables.size(); ++i) {
    if (options.progress)
      options.progress(Concat("copying ", tables[i]), static_cast<double>(i) / static_cast<double>(tables.size()));
    const Result columns = store.Query(
        "SELECT string_agg(quote_ident(attname), ', ' ORDER BY attnum) FROM pg_attribute WHERE attrelid = "
        "to_regclass('slamdb.' || $1::text) AND attnum > 0 AND NOT attisdropped",
        {tables[i]});
    const std::string list(columns[0].Text(0));
    store.Query(Concat("INSERT INTO ", next, ".", tables[i], "_", partition, " (", list, ") SELECT ", list, " FROM ",
                       tables[i], "_", partition),
                {}, Concat("table ", tables[i]));
  }
}

// Takes tables away from all readers, who are never made to fail: a lock that does not come within the time after which
// the server looks for deadlocks (1 s) is given back, and tried again.
void LockTables(Connection& store, const FleetOptions& options) {
  std::string tables;
  for (const std::string_view table : PartitionedTables())
    tables += Concat(tables.empty() ? "ONLY " : ", ONLY ", table);
  const auto take = [&] {
    store.Execute("SAVEPOINT readers; SET LOCAL lock_timeout TO '300ms'");
    try {
      store.Execute(Concat("LOCK TABLE ", tables, " IN ACCESS EXCLUSIVE MODE"));
    } catch (const ServerError& error) {
      if (error.state() != "55P03") throw;
      store.Execute("ROLLBACK TO SAVEPOINT readers");
      return false;
    }
    store.Execute("SET LOCAL lock_timeout TO 0");
    return true;
  };
  WaitForLock(take, {options.lock_timeout, options.progress}, [&] {
    return Error(ErrorKind::kLocked, store.path(), "",
                 "readers leave no moment for the partition to be taken from the store's own server: try again");
  });
}

// From the store's own server.
void LeaveOwnServer(Connection& store, std::int64_t partition, const ForeignServer& server,
                    const FleetOptions& options) {
  const std::int64_t partitions = store.Integer("SELECT partitions FROM store");
  CreateForeignServer(store, NameOfServer(partition), server);
  LockTables(store, options);
  for (const std::string_view table : PartitionedTables()) {
    store.Execute(Concat("DROP TABLE ", table, "_", partition));
    CreateForeignPartition(store, table, partition, partitions);
  }
}

void Move(Connection& store, std::int64_t partition, const ForeignServer& to, const FleetOptions& options) {
  Transaction transaction(store, Transaction::Kind::kWrite);
  store.Execute("CREATE EXTENSION IF NOT EXISTS postgres_fdw");
  LockPartition(store, partition, {options.lock_timeout, options.progress});
  const std::optional<ForeignServer> from = ReadForeignServer(store, NameOfServer(partition));
  OpenDoor(store, NameOfNext(partition), to, partition);
  CopyRows(store, partition, options);
  CloseDoor(store, NameOfNext(partition));
  if (from) {
    OpenDoor(store, NameOfOld(partition), *from, partition);
    AlterForeignServer(store, NameOfServer(partition), *from, to);
  } else {
    LeaveOwnServer(store, partition, to, options);
  }
  transaction.Commit();
}

// All transactions that have read something of the store; as the server writes them.
std::vector<std::string> Readers(Connection& store) {
  return store
      .Query(
          "SELECT DISTINCT virtualtransaction FROM pg_locks WHERE locktype = 'relation' AND pid <> pg_backend_pid() "
          "AND "
          "database = (SELECT oid FROM pg_database WHERE datname = current_database()) AND relation IN (SELECT oid "
          "FROM "
          "pg_class WHERE relnamespace = to_regnamespace('slamdb'))")
      .Texts();
}

void WaitForReaders(Connection& store, const FleetOptions& options) {
  const std::vector<std::string> before = Readers(store);
  for (;;) {
    const std::vector<std::string> now = Readers(store);
    const bool is_done = std::ranges::none_of(
        before, [&](const std::string& reader) { return std::ranges::find(now, reader) != now.end(); });
    if (is_done) return;
    if (options.progress) options.progress("waiting for readers", 1);
    std::this_thread::sleep_for(20ms);
  }
}

}  // namespace

void FinishMove(Connection& store, std::int64_t partition, const FleetOptions& options) {
  const std::string old = NameOfOld(partition);
  if (!ReadForeignServer(store, old)) return;
  WaitForReaders(store, options);
  Transaction transaction(store, Transaction::Kind::kWrite);
  LockMaking(store);
  if (!ReadForeignServer(store, old)) return;  // somebody was faster
  store.Execute("TRUNCATE " + TablesBehind(old, partition));
  CloseDoor(store, old);
  transaction.Commit();
}

}  // namespace postgresql

using namespace postgresql;  // NOLINT(google-build-using-namespace): what follows is made of it

void MovePartition(const std::string& uri, std::uint32_t partition, const std::string& to,
                   const FleetOptions& options) {
  postgresql::Connection store(uri, {.progress = options.progress});
  CheckIsStore(store);
  if (!IsFleet(store))
    throw Error(ErrorKind::kUsage, store.path(), "",
                "is no fleet: 'slamdb fleet init' makes one, in a database without atlases");
  const std::int64_t partitions = store.Integer("SELECT partitions FROM slamdb.store");
  if (partition >= partitions)
    throw Error(ErrorKind::kUsage, store.path(), "",
                detail::Concat("has no partition ", partition, ", but 0 to ", partitions - 1));
  FinishMove(store, partition, options);
  postgresql::Connection target(to, {.progress = options.progress});
  const ForeignServer server = ForeignServerOf(target, to);
  const std::optional<ForeignServer> now = ReadForeignServer(store, NameOfServer(partition));
  if (now && now->Label() == server.Label()) return;
  const std::int64_t numbers[] = {partition};
  MakeParts(target, IdOfFleet(store), partitions, numbers);
  Move(store, partition, server, options);
  FinishMove(store, partition, options);
}

}  // namespace slamdb
