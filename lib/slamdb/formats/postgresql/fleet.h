// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/export.h"

// A store in PostgreSQL (formats/store/store.h) whose partitions are on several servers, by postgres_fdw.
// An atlas is in the partition that a hash of its row number tells; the store's own server has the list of atlases,
// their revisions, tags and the log.
// docs/servers.md explains it.
//
// `uri` is the store: `postgresql://user@host/database`. All throw Error: kNotFound no server answers or there is no
// store; kPermission; kLocked; kUnsupported built without PostgreSQL, or servers too old. Safe to call from any thread.
namespace slamdb {

struct FleetPartition {
  std::uint64_t number = 0;   // from 0
  std::string server;         // `host:5432/database`; empty: the store's own
  std::uint64_t atlases = 0;  // that are in it
  std::uint64_t bytes = 0;    // about what their newest revisions take
  std::string failure;        // why its server does not answer; empty: it does
};

struct Fleet {
  std::vector<FleetPartition> partitions;  // by number

  // All answer.
  bool ok() const { return std::ranges::all_of(partitions, &std::string::empty, &FleetPartition::failure); }
};

struct FleetOptions {
  double lock_timeout = 60;  // seconds to wait for saves that are under way
  // Called by one thread; ends by throwing, which leaves what there was. May be empty.
  Progress progress;
};

// Makes a store of `partitions` partitions, from 1 on, which are on `servers` in turn; all on its own server when there
// are none. A server's password, when its URI has one, is kept by the store's server (pg_user_mappings). Needs the
// right to CREATE EXTENSION postgres_fdw, or that it is there. Completes what was begun; nothing happens where it is
// there already.
//
// Throws Error: kAlreadyExists when the store has atlases, or other partitions; kUsage when a server holds a store of
// its own, or partitions of another, or there are more servers than partitions.
SLAMDB_EXPORT void InitFleet(const std::string& uri, std::uint32_t partitions, std::span<const std::string> servers,
                             const FleetOptions& options = {});

// What is where, and who answers.
[[nodiscard]] SLAMDB_EXPORT Fleet ReadFleet(const std::string& uri);

// Removes what interrupted writers left on other servers, which nobody reads. Returns how many rows. Saves to a
// partition wait meanwhile; partitions that do not answer are passed over.
SLAMDB_EXPORT std::uint64_t RepairFleet(const std::string& uri, const FleetOptions& options = {});

// Moves a partition to another server. Readers go on; saves to it wait. When it is interrupted, the same again does the
// rest.
//
// Throws Error: kUsage for a store that InitFleet did not make, or no such partition.
SLAMDB_EXPORT void MovePartition(const std::string& uri, std::uint32_t partition, const std::string& to,
                                 const FleetOptions& options = {});

}  // namespace slamdb
