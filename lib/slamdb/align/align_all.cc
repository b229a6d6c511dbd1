// SPDX-License-Identifier: BSD-3-Clause
// 1. Every pair of maps is aligned.
// 2. Links are taken in the order of how sure they are (Kruskal): each joins two groups, or closes a cycle.
#include "slamdb/align/align_all.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slamdb/align/detail/align_pair.h"
#include "slamdb/align/detail/prepared_map.h"

namespace slamdb {
namespace {

// By which a link may miss what the others say of the same two maps.
constexpr double kMostTurn = 3 * std::numbers::pi / 180;
constexpr double kMostLogScale = 0.06;
constexpr double kMostShift = 0.1;  // of the distance to what both maps see

bool Closes(const Alignment& alignment, const Similarity3d& by_others, double depth) {
  const Similarity3d& own = *alignment.first_from_second;
  if (own.rotation.angularDistance(by_others.rotation) > kMostTurn) return false;
  if (std::abs(std::log(own.scale / by_others.scale)) > kMostLogScale) return false;
  const Eigen::Vector3d in_second = own.Inverse() * alignment.center;
  return (by_others * in_second - alignment.center).norm() <= kMostShift * depth;
}

class Grouping {
 public:
  explicit Grouping(std::size_t maps) {
    for (std::size_t map = 0; map < maps; ++map) places_.push_back({map, {}});
  }

  void Take(MapLink& link, double depth) {
    if (link.alignment.verdict != AlignmentVerdict::kAligned) return;
    const MapPlace first = places_[link.first], second = places_[link.second];
    if (first.group == second.group) {
      const Similarity3d by_others = first.group_from_map.Inverse() * second.group_from_map;
      link.use = Closes(link.alignment, by_others, depth) ? LinkUse::kCloses : LinkUse::kContradicts;
      return;
    }
    link.use = LinkUse::kJoins;
    const Similarity3d one_from_other =
        first.group_from_map * *link.alignment.first_from_second * second.group_from_map.Inverse();
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

  std::vector<MapPlace> places_;
};

}  // namespace

std::string_view NameOf(LinkUse use) {
  switch (use) {
    case LinkUse::kJoins:
      return "joins";
    case LinkUse::kCloses:
      return "closes";
    case LinkUse::kContradicts:
      return "contradicts";
    case LinkUse::kUnused:
      return "unused";
  }
  return {};
}

AlignedMaps AlignAllMaps(std::span<const MapRef> maps, const AlignOptions& options) {
  return AlignWithOthers(maps, maps.size(), options);
}

AlignedMaps AlignWithOthers(std::span<const MapRef> maps, std::size_t asked, const AlignOptions& options) {
  Grouping grouping(maps.size());
  AlignedMaps aligned{{}, grouping.places()};
  if (maps.size() < 2) return aligned;
  const detail::PreparedMaps prepared(maps, options);
  for (std::size_t first = 0; first < std::min(asked, maps.size()); ++first)
    for (std::size_t second = first + 1; second < maps.size(); ++second)
      aligned.links.push_back(
          {first, second, detail::AlignPair(prepared[first], prepared[second], prepared.trained_words(), options)});
  std::ranges::stable_sort(aligned.links, [](const MapLink& a, const MapLink& b) {
    if (a.alignment.verdict != b.alignment.verdict) return a.alignment.verdict < b.alignment.verdict;
    return a.alignment.evidence.points > b.alignment.evidence.points;
  });
  for (MapLink& link : aligned.links) grouping.Take(link, prepared[link.first].views.median_depth());
  aligned.places = grouping.places();
  return aligned;
}

}  // namespace slamdb
