// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/ids/origin.h"

#include <string>

#include "slamdb/base/error.h"
#include "slamdb/edit/ids/id_map.h"

namespace slamdb {
namespace {

using Replacements = std::map<std::uint32_t, std::uint32_t>;
using Histogram = std::map<std::uint32_t, std::uint64_t>;

std::string ListOf(const Histogram& origins) {
  std::string list;
  for (const auto& [origin, count] : origins) list += (list.empty() ? "" : ", ") + std::to_string(origin);
  return list.empty() ? "none" : list;
}

template <class Visit>
void ForEachOrigin(Atlas& atlas, const Visit& visit) {
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) visit(map, keyframe.origin_map);
}

Histogram Count(const Atlas& atlas) {
  Histogram counts;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) ++counts[keyframe.origin_map];
  return counts;
}

// Follows the replacements from each source: who comes back to it swaps origins, which nobody means.
void RefuseCircles(const Replacements& replacements) {
  for (const auto& [from, to] : replacements) {
    std::uint32_t at = to;
    for (std::size_t steps = 0; steps < replacements.size() && at != from; ++steps) {
      const auto next = replacements.find(at);
      if (next == replacements.end() || next->second == at) break;
      at = next->second;
    }
    if (at == from && to != from)
      throw Error(ErrorKind::kUsage, "the replacements lead from origin " + std::to_string(from) +
                  " back to it; to swap origins, move one of them out of the way first");
  }
}

Replacements Gather(const OriginOptions& options, const Histogram& origins) {
  Replacements replacements;
  for (const auto& [from, to] : options.replace) {
    if (!origins.contains(from))
      throw Error(ErrorKind::kNotPossible, "no keyframe has origin map " + std::to_string(from) + "; origins are " + ListOf(origins));
    if (!replacements.emplace(from, to).second)
      throw Error(ErrorKind::kUsage, "origin map " + std::to_string(from) + " is replaced twice");
  }
  RefuseCircles(replacements);
  return replacements;
}

// What each origin becomes by `replace`, `shift` and `compact`.
Replacements Plan(const OriginOptions& options, const Histogram& origins) {
  const Replacements replacements = Gather(options, origins);
  Replacements plan;
  Replacements compact;
  for (const auto& [origin, count] : origins) {
    const auto replaced = replacements.find(origin);
    const std::int64_t moved = std::int64_t{replaced == replacements.end() ? origin : replaced->second} + options.shift;
    if (moved < 0 || moved > static_cast<std::int64_t>(LargestId(IdKind::kMap)))
      throw Error(ErrorKind::kNotPossible, "origin map " + std::to_string(origin) + " would become " + std::to_string(moved) +
                  ", expected 0 to " + std::to_string(LargestId(IdKind::kMap)));
    plan[origin] = static_cast<std::uint32_t>(moved);
    compact[plan[origin]];
  }
  if (!options.compact) return plan;
  std::uint32_t next = 0;
  for (auto& [origin, dense] : compact) dense = next++;
  for (auto& [origin, after] : plan) after = compact[after];
  return plan;
}

// Origins after `from_map` and `set`, which do not depend on what they were.
Histogram CountAfterSetting(const Atlas& atlas, const OriginOptions& options) {
  if (!options.from_map && !options.set) return Count(atlas);
  Histogram counts;
  for (const Map& map : atlas.maps) {
    if (map.keyframes.empty()) continue;
    const std::uint64_t origin = options.set ? *options.set : map.id.value();
    if (origin > LargestId(IdKind::kMap))
      throw Error(ErrorKind::kNotPossible, ToString(map.id) + " cannot be an origin, expected an id up to " +
                  std::to_string(LargestId(IdKind::kMap)));
    counts[static_cast<std::uint32_t>(origin)] += map.keyframes.size();
  }
  return counts;
}

}  // namespace

OriginReport ReassignOrigins(Atlas& atlas, const OriginOptions& options) {
  OriginReport report{.before = Count(atlas)};
  report.next_map_before = atlas.next_ids.map;
  const Replacements plan = Plan(options, CountAfterSetting(atlas, options));
  ForEachOrigin(atlas, [&](const Map& map, std::uint32_t& origin) {
    std::uint32_t start = origin;
    if (options.from_map) start = static_cast<std::uint32_t>(map.id.value());
    if (options.set) start = *options.set;
    const std::uint32_t after = plan.at(start);
    report.changed += after != origin;
    origin = after;
  });
  report.after = Count(atlas);
  if (!report.after.empty())
    atlas.next_ids.map = std::max(atlas.next_ids.map, std::uint64_t{report.after.rbegin()->first} + 1);
  report.next_map_after = atlas.next_ids.map;
  return report;
}

}  // namespace slamdb
