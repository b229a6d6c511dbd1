// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/writer_lock.h"
#include "slamdb/formats/postgresql/fleet.h"

namespace slamdb::postgresql {

// The id that a fleet's store and its other servers have in common.
std::string IdOfFleet(Connection& store);

// Makes the tables of some of the partitions on a server that has no store of its own.
void MakeParts(Connection& remote, const std::string& id, std::int64_t partitions,
               std::span<const std::int64_t> numbers);

// Empties the tables that a partition was moved from, when all who may read them are done. Nothing where that is done.
void FinishMove(Connection& store, std::int64_t partition, const FleetOptions& options);

}  // namespace slamdb::postgresql
