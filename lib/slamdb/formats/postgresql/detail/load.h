// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"
#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/names.h"
#include "slamdb/model/atlas.h"

namespace slamdb::postgresql {

// Loads a revision, or what of it is selected, in the caller's transaction: each table comes as one COPY, rows are
// compared with their hashes, features are unpacked on all threads while the server sends the next.
// Throws Error (kDamaged) naming the first row that differs from its hash.
Atlas LoadAtlas(Connection& connection, const Named& named, const ReadOptions& options);

// Loads all of a revision, as LoadAtlas does, by what an atlas that is at hand has of it: hashes of rows come first,
// 24 bytes for each, and then the rows, features and pictures that `base` has not, some thousands in one statement.
Atlas LoadOnto(Connection& connection, const Named& named, const Atlas& base, const ReadOptions& options);

}  // namespace slamdb::postgresql
