// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/fleet.h"

#include <algorithm>
#include <map>
#include <set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/postgresql/detail/fleet_parts.h"
#include "slamdb/formats/postgresql/detail/foreign_server.h"
#include "slamdb/formats/postgresql/detail/names.h"
#include "slamdb/formats/postgresql/detail/partition.h"
#include "slamdb/formats/postgresql/detail/schema.h"

namespace slamdb {

using detail::Concat;

namespace postgresql {
namespace {

constexpr const char* kFleetTable =
    "CREATE TABLE IF NOT EXISTS slamdb.fleet (row integer PRIMARY KEY DEFAULT 1 CHECK (row = 1), id uuid NOT NULL "
    "DEFAULT gen_random_uuid(), ready boolean NOT NULL DEFAULT false)";

// A server that gets partitions, and which.
struct Holder {
  std::string uri;
  ForeignServer server;
  std::vector<std::int64_t> numbers;
};

std::int64_t PartitionsIn(Connection& store) { return store.Integer("SELECT partitions FROM slamdb.store"); }

bool IsReady(Connection& store) { return IsFleet(store) && store.Integer("SELECT ready FROM slamdb.fleet") != 0; }

// The servers of a fleet's partitions.
std::vector<std::string> LabelsOf(Connection& store) {
  std::vector<std::string> labels;
  for (const Partition& partition : PartitionsOf(store)) {
    const auto server = partition.is_remote ? ReadForeignServer(store, NameOfServer(partition.number)) : std::nullopt;
    labels.push_back(server ? server->Label() : std::string());
  }
  return labels;
}

// Throws unless the fleet that is there is what is asked for.
void CheckIsSame(Connection& store, std::int64_t partitions, const std::vector<Holder>& holders) {
  const std::vector<std::string> labels = LabelsOf(store);
  const auto has = [&](const Holder& holder) {
    return std::ranges::find(labels, holder.server.Label()) != labels.end();
  };
  if (std::ssize(labels) == partitions && std::ranges::all_of(holders, has)) return;
  throw Error(ErrorKind::kAlreadyExists, store.path(), "",
              Concat("is a fleet of ", labels.size(),
                     " partitions already, on other servers or another number of them: 'slamdb fleet status' tells "
                     "where they are, 'slamdb fleet move' moves one"));
}

// Names the primary keys of the partitioned tables, which are theirs no more: of a table with partitions on other
// servers each partition has its own.
std::map<std::string_view, std::string> TakePrimaryKeys(Connection& store) {
  std::map<std::string_view, std::string> keys;
  for (const std::string_view table : PartitionedTables()) {
    const Result found = store.Query(
        "SELECT conname, pg_get_constraintdef(oid) FROM pg_constraint WHERE contype = 'p' AND conrelid = "
        "to_regclass('slamdb.' || $1::text)",
        {table});
    if (found.rows() == 0)
      throw Error(ErrorKind::kDamaged, store.path(), Concat("table ", table), "has no primary key");
    keys[table] = found[0].Text(1);
    store.Execute(Concat("ALTER TABLE ", table, " DROP CONSTRAINT ", found[0].Text(0)));
  }
  return keys;
}

// Makes the partitions anew, of a store without atlases.
void MakePartitionsAnew(Connection& store, std::int64_t partitions, const std::vector<Holder>& holders) {
  const std::int64_t before = PartitionsIn(store);
  for (const std::string_view table : PartitionedTables())
    for (std::int64_t i = 0; i < before; ++i) store.Execute(Concat("DROP TABLE ", table, "_", i));
  const auto keys = TakePrimaryKeys(store);
  if (!holders.empty()) store.Execute("CREATE EXTENSION IF NOT EXISTS postgres_fdw");
  std::set<std::int64_t> remote;
  for (const Holder& holder : holders)
    for (const std::int64_t number : holder.numbers) {
      CreateForeignServer(store, NameOfServer(number), holder.server);
      for (const std::string_view table : PartitionedTables()) CreateForeignPartition(store, table, number, partitions);
      remote.insert(number);
    }
  for (std::int64_t i = 0; i < partitions; ++i)
    for (const std::string_view table : PartitionedTables())
      if (!remote.contains(i)) MakePartition(store, table, i, partitions, keys.at(table));
}

// Whether the server answers: as the store's own sees it.
void Ask(Connection& store, std::int64_t partition) {
  store.Query(Concat("SELECT count(*) FROM (SELECT 1 FROM slamdb.map_", partition, " LIMIT 1) AS one"));
}

void RequireNoAtlas(Connection& store) {
  const std::int64_t atlases = store.Integer("SELECT count(*) FROM slamdb.atlas");
  if (atlases == 0) return;
  throw Error(ErrorKind::kAlreadyExists, store.path(), "",
              Concat("holds ", atlases,
                     " atlases in one server's tables: make the fleet in another database, and copy them there, as by "
                     "'slamdb sync'"));
}

// The store gets the partitions of several servers, in one transaction.
void MakeFleet(Connection& store, std::int64_t partitions, const std::vector<Holder>& holders) {
  Transaction transaction(store, Transaction::Kind::kWrite);
  LockMaking(store);
  if (IsReady(store)) return CheckIsSame(store, partitions, holders);  // somebody was faster
  store.Execute("LOCK TABLE atlas IN SHARE ROW EXCLUSIVE MODE");
  RequireNoAtlas(store);
  MakePartitionsAnew(store, partitions, holders);
  for (const Holder& holder : holders) Ask(store, holder.numbers.front());
  store.Query("UPDATE store SET partitions = $1::integer", {partitions});
  store.Execute("UPDATE fleet SET ready = true");
  transaction.Commit();
}

std::vector<Holder> HoldersOf(std::span<const std::string> servers, std::int64_t partitions,
                              const FleetOptions& options) {
  if (partitions < 1) throw Error(ErrorKind::kUsage, "", "", "a store has at least one partition");
  if (std::ssize(servers) > partitions)
    throw Error(ErrorKind::kUsage, "", "",
                Concat(servers.size(), " servers cannot share ", partitions, " partitions: make more of these"));
  std::vector<Holder> holders;
  for (const std::string& uri : servers) {
    const Connection remote(uri, {.progress = options.progress});
    Holder& holder = holders.emplace_back(Holder{uri, ForeignServerOf(remote, uri), {}});
    for (std::int64_t i = std::ssize(holders) - 1; i < partitions; i += std::ssize(servers))
      holder.numbers.push_back(i);
  }
  return holders;
}

// ---- status

std::vector<FleetPartition> ReadPartitions(Connection& store) {
  std::vector<FleetPartition> partitions;
  const Result found = store.Query(
      Concat("SELECT count(atlas.row), coalesce(sum(bytes), 0)::bigint FROM generate_series(0, (SELECT partitions FROM "
             "store) - 1) AS number LEFT JOIN atlas ON ",
             IsInPartition("atlas.row", "number"), " GROUP BY number ORDER BY number"),
      {}, "table atlas");
  const std::vector<std::string> labels = LabelsOf(store);
  for (std::size_t i = 0; i < found.rows(); ++i)
    partitions.push_back({i, i < labels.size() ? labels[i] : "", static_cast<std::uint64_t>(found[i].Integer(0)),
                          static_cast<std::uint64_t>(found[i].Integer(1)), ""});
  return partitions;
}

// ---- repair

// Of atlases that the store does not have.
std::uint64_t DeleteStray(Connection& store, std::int64_t partition) {
  const std::vector<std::int64_t> atlases =
      store
          .Query(Concat("SELECT row FROM atlas WHERE ", IsInPartition("row", "$1::integer")),
                 {static_cast<std::int32_t>(partition)}, "table atlas")
          .Integers();
  std::int64_t rows = 0;
  for (const std::string_view table : PartitionedTables())
    rows += store
                .Query(Concat("DELETE FROM ", table, "_", partition, " WHERE atlas <> ALL ($1)"),
                       {std::span<const std::int64_t>(atlases)})
                .changed();
  return static_cast<std::uint64_t>(rows);
}

std::uint64_t RepairPartition(Connection& store, std::int64_t partition, const FleetOptions& options) {
  std::uint64_t rows = 0;
  std::vector<std::string> names;
  {
    Transaction transaction(store, Transaction::Kind::kWrite);
    LockPartition(store, partition, {options.lock_timeout, options.progress});
    rows = DeleteStray(store, partition);
    names = NamesIn(store, partition);
    transaction.Commit();
  }
  for (const std::string& name : names) {
    if (options.progress) options.progress("looking at " + name, 0);
    Transaction transaction(store, Transaction::Kind::kWrite);
    const GivenUpRows deleted = DeleteGivenUp(store, name, {options.lock_timeout, options.progress});
    rows += deleted.rows + deleted.pictures;
    transaction.Commit();
  }
  return rows;
}

}  // namespace

std::string IdOfFleet(Connection& store) {
  return std::string(store.Query("SELECT id::text FROM slamdb.fleet", {}, "table fleet")[0].Text(0));
}

void MakeParts(Connection& remote, const std::string& id, std::int64_t partitions,
               std::span<const std::int64_t> numbers) {
  Transaction transaction(remote, Transaction::Kind::kWrite);
  LockMaking(remote);
  if (const int version = VersionOf(remote); version == 0) {
    MakeTables(remote);
    remote.Execute(kFleetTable);
    remote.Query("INSERT INTO fleet (id) VALUES ($1::text::uuid)", {id});
    remote.Query("INSERT INTO store (version, partitions) VALUES ($1::integer, 0)", {NewestVersion()});
  } else if (version != NewestVersion() || PartitionsIn(remote) != 0 || !IsFleet(remote) || IdOfFleet(remote) != id) {
    throw Error(
        ErrorKind::kUsage, remote.path(), "",
        "holds a store, or partitions of another one: name an empty database; a partition does not come back to the "
        "store's own");
  }
  for (const std::string_view table : PartitionedTables())
    for (const std::int64_t i : numbers) MakePartition(remote, table, i, partitions);
  transaction.Commit();
}

}  // namespace postgresql

using namespace postgresql;  // NOLINT(google-build-using-namespace): what follows is made of it

void InitFleet(const std::string& uri, std::uint32_t partitions, std::span<const std::string> servers,
               const FleetOptions& options) {
  const std::vector<Holder> holders = HoldersOf(servers, partitions, options);
  postgresql::Connection store(uri, {.progress = options.progress});
  MakeStore(store);
  if (IsReady(store)) return CheckIsSame(store, partitions, holders);
  RequireNoAtlas(store);
  store.Execute(Concat(kFleetTable, "; INSERT INTO slamdb.fleet DEFAULT VALUES ON CONFLICT DO NOTHING"));
  const std::string id = IdOfFleet(store);
  for (const Holder& holder : holders) {
    postgresql::Connection remote(holder.uri, {.progress = options.progress});
    MakeParts(remote, id, partitions, holder.numbers);
  }
  MakeFleet(store, partitions, holders);
}

Fleet ReadFleet(const std::string& uri) {
  postgresql::Connection store(uri);
  CheckIsStore(store);
  Fleet fleet;
  {
    const Transaction transaction(store, Transaction::Kind::kRead);
    fleet.partitions = ReadPartitions(store);
  }
  std::map<std::string, std::string> failures;  // by server, so that one that is down is waited for once
  for (FleetPartition& partition : fleet.partitions) {
    if (const auto known = failures.find(partition.server); known != failures.end()) {
      partition.failure = known->second;
      continue;
    }
    try {
      Ask(store, static_cast<std::int64_t>(partition.number));
    } catch (const ServerError& error) {
      if (store.is_lost()) throw;
      partition.failure = failures[partition.server] = error.problem();
    }
  }
  return fleet;
}

std::uint64_t RepairFleet(const std::string& uri, const FleetOptions& options) {
  postgresql::Connection store(uri, {.progress = options.progress});
  CheckIsStore(store);
  std::uint64_t rows = 0;
  for (const Partition& partition : PartitionsOf(store)) {
    if (!partition.is_remote) continue;
    try {
      FinishMove(store, partition.number, options);
      rows += RepairPartition(store, partition.number, options);
    } catch (const Error& error) {
      if (store.is_lost() || !IsOfOtherServer(error)) throw;
    }
  }
  return rows;
}

}  // namespace slamdb
