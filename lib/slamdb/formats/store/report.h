// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "slamdb/export.h"
#include "slamdb/formats/postgresql/fleet.h"
#include "slamdb/formats/store/store.h"

// What a store tells of itself, as JSON.
// `input` is the store's path.
//
// They throw nothing but std::bad_alloc.
namespace slamdb {

// As schema/log.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(std::span<const HistoryEntry> entries, const std::string& input = {});

// Of the tags in a history: as schema/tag.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string TagsAsJson(std::span<const HistoryEntry> entries,
                                                   const std::string& input = {});

// As schema/branch.schema.json describes it: `output` begins as `from`.
[[nodiscard]] SLAMDB_EXPORT std::string BranchAsJson(const RevisionName& from, const std::string& input,
                                                     const std::string& output);

// As schema/restore.schema.json describes it: `restored` is the newest again.
[[nodiscard]] SLAMDB_EXPORT std::string RestoreAsJson(const SaveReport& report, const RevisionName& restored,
                                                      const std::string& input);

// As schema/remove.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string RemovedAsJson(std::span<const std::string> inputs);

// As schema/migrate.schema.json describes it. `output` empty: nothing was done.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const MigrateReport& report, const std::string& input,
                                               const std::string& output);

// As schema/gc.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const GiveUpReport& report, const std::string& input = {});

// As schema/stats.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const StoreStats& stats, const std::string& input = {});

// As schema/fleet.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const Fleet& fleet, const std::string& input = {});

}  // namespace slamdb
