// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/writer_lock.h"

// Where the rows of an atlas are, when partitions of its store are on other servers (postgresql/fleet.h).
//
// Such a server commits before the store's own does, and by itself. What it has then and the store does not know, when
// that is killed in between, belongs to a revision that nobody reads: rows of `since` or `until` beyond the newest.
// Whoever writes an atlas undoes that first.
namespace slamdb::postgresql {

struct Partition {
  std::int64_t number = 0;
  bool is_remote = false;  // on another server

  // How to name a table that this partition is wanted of, where a FROM is: `map`, or of one on another server
  // `map_3 AS map`, which lets that server join and sum up.
  std::string Table(std::string_view table) const;
};

// Of which partition a row is, as SQL: `row` is an expression, the atlas' row; `number` the partition's.
std::string IsInPartition(std::string_view row, std::string_view number);

// Whether it was made by InitFleet; else all is in the one partition 0.
bool IsFleet(Connection& connection);

Partition PartitionOf(Connection& connection, std::int64_t atlas);
std::vector<Partition> PartitionsOf(Connection& connection);  // of a fleet: by number

// The same, which stays where it is until the transaction ends: to be called before rows of the atlas are read or
// written in a transaction that writes.
// Throws Error (kLocked) when it is being moved for longer than options.timeout.
Partition HoldPartition(Connection& connection, std::int64_t atlas, const LockOptions& options);
// Keeps all others who hold it out, until the transaction ends. Throws Error (kLocked) likewise.
void LockPartition(Connection& connection, std::int64_t number, const LockOptions& options);

// Undoes what an earlier writer had committed on another server alone, or where rows are edited, whatever is beyond the
// newest revision. `newest`: of the atlas, 0 when it has none yet. To be called under the lock of the atlas, with the
// partition held. Returns how many rows that changed.
std::uint64_t UndoUnfinished(Connection& connection, const Partition& partition, std::int64_t atlas,
                             std::int64_t newest, bool is_edited = false);

// Whether it says that another server than the one we are connected to does not answer.
bool IsOfOtherServer(const Error& error);

}  // namespace slamdb::postgresql
