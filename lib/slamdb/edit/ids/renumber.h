// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/base/report_files.h"
#include "slamdb/edit/ids/id_map.h"
#include "slamdb/export.h"

namespace slamdb {

// In which order dense ids are handed out.
enum class IdOrder {
  kId,    // of the ids as they are, so that every order by id stays
  kTime,  // keyframes and frames by timestamp, points and maps by the earliest keyframe that sees or holds them
  kAsIs,  // of the lists of the atlas
};

// Of several names; `all` is every kind. Throws Error (kUsage) for another one.
[[nodiscard]] SLAMDB_EXPORT std::vector<IdKind> IdKindsByName(const std::vector<std::string>& names);

struct RenumberOptions {
  std::vector<IdKind> kinds = {IdKind::kMap, IdKind::kKeyFrame, IdKind::kPoint, IdKind::kCamera};
  std::optional<std::int64_t> offset;  // added to every id; without it ids become dense
  std::uint64_t start = 0;             // the first of the dense ids
  IdOrder order = IdOrder::kId;
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty
};

// How the ids of an atlas would change.
// Ids are handed out to what is there first, then, ascending, to what is only named: entities long gone.
//
// Throws Error (kNotPossible) when an id of a kind to renumber is there twice, as no table can then tell which is
// meant, or when ids would become negative or larger than LargestId. Cost: linear, but for sorting.
[[nodiscard]] SLAMDB_EXPORT IdMap PlanRenumbering(const Atlas& atlas, const RenumberOptions& options = {});

// Plans and applies. Returns which id became which.
//
// Throws Error as PlanRenumbering does, before anything changes.
// Cost: linear, but for sorting.
SLAMDB_EXPORT IdMap Renumber(Atlas& atlas, const RenumberOptions& options = {});

// How the ids of one kind changed.
struct KindRenumbered {
  IdKind kind = IdKind::kMap;
  std::uint64_t ids = 0, changed = 0;
  std::uint64_t first = kNoId, last = 0;  // the smallest and the largest new id; kNoId, 0: none is in the result
};

struct RenumberReport {
  std::vector<KindRenumbered> kinds;  // those with ids in the map, in the order of IdKind
};

// What an id map comes to.
//
// Cost: linear.
[[nodiscard]] SLAMDB_EXPORT RenumberReport SummaryOf(const IdMap& ids);

// As schema/renumber.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const RenumberReport& report, const ReportFiles& files = {});

}  // namespace slamdb
