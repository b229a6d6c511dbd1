// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "slamdb/edit/ids/id_map.h"

namespace slamdb {

// In which order dense ids are handed out.
enum class IdOrder {
  kId,    // of the ids as they are, so that every order by id stays
  kTime,  // keyframes and frames by timestamp, points and maps by the earliest keyframe that sees or holds them
  kAsIs,  // of the lists of the atlas
};

struct RenumberOptions {
  std::vector<IdKind> kinds = {IdKind::kMap, IdKind::kKeyFrame, IdKind::kPoint, IdKind::kCamera};
  std::optional<std::int64_t> offset;  // added to every id; without it ids become dense
  std::uint64_t start = 0;             // the first of the dense ids
  IdOrder order = IdOrder::kId;
  int threads = 0;
};

// How the ids of an atlas would change. Ids are handed out to what is there first, then, ascending, to what is only
// named: entities long gone. Throws Error when an id of a kind to renumber is there twice, as no table can then tell
// which is meant, or when ids would become negative or larger than LargestId.
IdMap PlanRenumbering(const Atlas& atlas, const RenumberOptions& options);

// Plans and applies. Linear.
IdMap Renumber(Atlas& atlas, const RenumberOptions& options);

}  // namespace slamdb
