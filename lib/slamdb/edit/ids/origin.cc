// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/ids/origin.h"

#include <algorithm>
#include <string>
#include <type_traits>

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

// visit(map, entity) for each keyframe, and for each point whose origin is recorded.
template <class AnAtlas, class Visit>
void ForEachMade(AnAtlas& atlas, const Visit& visit) {
  for (auto& map : atlas.maps) {
    for (auto& keyframe : map.keyframes) visit(map, keyframe);
    for (auto& point : map.points)
      if (point.origin_map != MapPoint::kNoOrigin) visit(map, point);
  }
}

// How many keyframes and how many points have each origin.
struct Origins {
  Histogram keyframes, points;
  Histogram& Of(const KeyFrame&) { return keyframes; }
  Histogram& Of(const MapPoint&) { return points; }
};

Origins Count(const Atlas& atlas) {
  Origins origins;
  ForEachMade(atlas, [&](const Map&, const auto& made) { ++origins.Of(made)[made.origin_map]; });
  return origins;
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
      throw Error(ErrorKind::kNotPossible,
                  "no keyframe or point has origin map " + std::to_string(from) + "; origins are " + ListOf(origins));
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
      throw Error(ErrorKind::kNotPossible, "origin map " + std::to_string(origin) + " would become " +
                                               std::to_string(moved) + ", expected 0 to " +
                                               std::to_string(LargestId(IdKind::kMap)));
    plan[origin] = static_cast<std::uint32_t>(moved);
    compact[plan[origin]];
  }
  if (!options.compact) return plan;
  std::uint32_t next = 0;
  for (auto& [origin, dense] : compact) dense = next++;
  for (auto& [origin, after] : plan) after = compact[after];
  return plan;
}

// What the origin of something in `map` is after `from_map` and `set`.
std::uint32_t Start(const OriginOptions& options, const Map& map, std::uint32_t origin) {
  if (options.set) return *options.set;
  return options.from_map ? static_cast<std::uint32_t>(map.id.value()) : origin;
}

// All origins after `from_map` and `set`.
Histogram StartingOrigins(const Atlas& atlas, const OriginOptions& options) {
  Histogram origins;
  ForEachMade(atlas, [&](const Map& map, const auto& made) {
    const std::uint64_t given = options.set ? *options.set : options.from_map ? map.id.value() : 0;
    if (given > LargestId(IdKind::kMap))
      throw Error(ErrorKind::kNotPossible, ToString(map.id) + " cannot be an origin, expected an id up to " +
                                               std::to_string(LargestId(IdKind::kMap)));
    ++origins[Start(options, map, made.origin_map)];
  });
  return origins;
}

}  // namespace

OriginReport ReassignOrigins(Atlas& atlas, const OriginOptions& options) {
  Origins before = Count(atlas);
  OriginReport report{.before = std::move(before.keyframes), .points_before = std::move(before.points)};
  report.next_map_before = atlas.next_ids.map;
  const Replacements plan = Plan(options, StartingOrigins(atlas, options));
  ForEachMade(atlas, [&](const Map& map, auto& made) {
    const std::uint32_t after = plan.at(Start(options, map, made.origin_map));
    constexpr bool kIsPoint = std::is_same_v<std::remove_cvref_t<decltype(made)>, MapPoint>;
    (kIsPoint ? report.points_changed : report.changed) += after != made.origin_map;
    made.origin_map = after;
  });
  Origins after = Count(atlas);
  report.after = std::move(after.keyframes);
  report.points_after = std::move(after.points);
  for (const Histogram* origins : {&report.after, &report.points_after})
    if (!origins->empty())
      atlas.next_ids.map = std::max(atlas.next_ids.map, std::uint64_t{origins->rbegin()->first} + 1);
  report.next_map_after = atlas.next_ids.map;
  return report;
}

}  // namespace slamdb
