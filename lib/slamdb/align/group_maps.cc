// SPDX-License-Identifier: BSD-3-Clause
// Each link joins two groups, or closes a cycle (Kruskal). Maps at which cycles do not close are set apart, and it is
// done again without them.
#include "slamdb/align/detail/group_maps.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace slamdb::detail {
namespace {

// By which a link may miss what the others say of the same two maps.
constexpr double kMostTurn = 2 * std::numbers::pi / 180;
constexpr double kMostLogScale = 0.04;
constexpr double kMostShift = 0.05;  // of the distance to what both maps see

bool Closes(const Alignment& alignment, const Similarity3d& by_others, double depth) {
  const Similarity3d& own = *alignment.first_from_second;
  if (own.rotation.angularDistance(by_others.rotation) > kMostTurn) return false;
  if (std::abs(std::log(own.scale / by_others.scale)) > kMostLogScale) return false;
  const Eigen::Vector3d in_second = own.Inverse() * alignment.center;
  return (by_others * in_second - alignment.center).norm() <= kMostShift * depth;
}

// The same transform, of another scale: what is at `fixed` (in the frame that it goes to) stays there.
Similarity3d Scaled(const Similarity3d& transform, double factor, const Eigen::Vector3d& fixed) {
  Similarity3d scaled = transform;
  scaled.scale *= factor;
  scaled.translation = fixed + factor * (transform.translation - fixed);
  return scaled;
}

class Grouping {
 public:
  explicit Grouping(const std::vector<MapTraits>& maps) : maps_(maps) {
    for (std::size_t map = 0; map < maps_.size(); ++map) places_.push_back({map, {}});
  }

  // Of a link that is aligned.
  void Take(MapLink& link) {
    const MapPlace first = places_[link.first], second = places_[link.second];
    if (first.group == second.group) {
      const Similarity3d by_others = first.group_from_map.Inverse() * second.group_from_map;
      link.use =
          Closes(link.alignment, by_others, maps_[link.first].median_depth) ? LinkUse::kCloses : LinkUse::kContradicts;
      return;
    }
    Similarity3d one_from_other =
        first.group_from_map * *link.alignment.first_from_second * second.group_from_map.Inverse();
    const auto one_metric = MetricScaleOf(first.group), other_metric = MetricScaleOf(second.group);
    if (one_metric && other_metric) {
      const double factor = *one_metric / (one_from_other.scale * *other_metric);
      if (std::abs(std::log(factor)) > kMostLogScale) {
        link.use = LinkUse::kContradicts;
        return;
      }
      one_from_other = Scaled(one_from_other, factor, first.group_from_map * link.alignment.center);
    }
    link.use = LinkUse::kJoins;
    if (first.group < second.group)
      Move(second.group, first.group, one_from_other);
    else
      Move(first.group, second.group, one_from_other.Inverse());
  }

  const std::vector<MapPlace>& places() const { return places_; }

 private:
  void Move(std::size_t from, std::size_t to, const Similarity3d& to_from_from) {
    for (MapPlace& place : places_)
      if (place.group == from) place = {to, to_from_from * place.group_from_map};
  }

  // Of a metric map to its group's frame; all of a group have the same.
  std::optional<double> MetricScaleOf(std::size_t group) const {
    for (std::size_t map = 0; map < places_.size(); ++map)
      if (places_[map].group == group && maps_[map].metric) return places_[map].group_from_map.scale;
    return std::nullopt;
  }

  const std::vector<MapTraits>& maps_;
  std::vector<MapPlace> places_;
};

std::vector<MapPlace> Group(std::vector<MapLink>& links, const std::vector<MapTraits>& maps,
                            const std::vector<bool>& apart) {
  Grouping grouping(maps);
  for (MapLink& link : links) {
    if (link.alignment.verdict != AlignmentVerdict::kAligned) continue;
    if (apart[link.first] || apart[link.second])
      link.use = LinkUse::kContradicts;
    else
      grouping.Take(link);
  }
  return grouping.places();
}

// From one map to another along joining links, both of them included; empty: there is no way.
std::vector<std::size_t> PathBetween(const std::vector<MapLink>& links, std::size_t from, std::size_t to,
                                     std::size_t maps) {
  std::vector<std::size_t> before(maps, maps), reached{from};
  before[from] = from;
  for (std::size_t i = 0; i < reached.size() && before[to] == maps; ++i)
    for (const MapLink& link : links) {
      if (link.use != LinkUse::kJoins || (link.first != reached[i] && link.second != reached[i])) continue;
      const std::size_t next = link.first == reached[i] ? link.second : link.first;
      if (before[next] != maps) continue;
      before[next] = reached[i];
      reached.push_back(next);
    }
  std::vector<std::size_t> path;
  if (before[to] == maps) return path;
  for (std::size_t map = to; map != from; map = before[map]) path.push_back(map);
  path.push_back(from);
  return path;
}

// Those in most cycles that do not close; of these the ones in fewest that do. Empty: all close.
std::vector<std::size_t> WhereCyclesDoNotClose(const std::vector<MapLink>& links, const std::vector<bool>& apart) {
  struct Cycles {
    std::int64_t open = 0, closed = 0;
    auto operator<=>(const Cycles&) const = default;
  };
  std::vector<Cycles> cycles(apart.size());
  for (const MapLink& link : links) {
    if (apart[link.first] || apart[link.second]) continue;
    if (link.use != LinkUse::kCloses && link.use != LinkUse::kContradicts) continue;
    for (const std::size_t map : PathBetween(links, link.first, link.second, apart.size()))
      link.use == LinkUse::kContradicts ? ++cycles[map].open : --cycles[map].closed;
  }
  const Cycles most = *std::ranges::max_element(cycles);
  std::vector<std::size_t> worst;
  for (std::size_t map = 0; map < cycles.size(); ++map)
    if (most.open > 0 && cycles[map] == most) worst.push_back(map);
  return worst;
}

}  // namespace

std::vector<MapPlace> GroupMaps(std::vector<MapLink>& links, const std::vector<MapTraits>& maps) {
  std::vector<bool> apart(maps.size(), false);
  for (;;) {
    std::vector<MapPlace> places = Group(links, maps, apart);
    const std::vector<std::size_t> worst = WhereCyclesDoNotClose(links, apart);
    if (worst.empty()) return places;
    for (const std::size_t map : worst) apart[map] = true;
  }
}

}  // namespace slamdb::detail
