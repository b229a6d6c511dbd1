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

// As schema/gc.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const GiveUpReport& report, const std::string& input = {});

// As schema/stats.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const StoreStats& stats, const std::string& input = {});

// As schema/fleet.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const Fleet& fleet, const std::string& input = {});

}  // namespace slamdb
