// SPDX-License-Identifier: BSD-3-Clause
// 1. Every pair of maps is aligned.
// 2. Links are taken in the order of how sure they are (Kruskal): each joins two groups, or closes a cycle. Those whose
//    scale is known come first: one by way of a monocular map would leave two metric maps with different scales.
// 3. What cycles are off by is spread over their links.
#include "slamdb/align/align_all.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "slamdb/align/detail/align_pair.h"
#include "slamdb/align/detail/prepared_map.h"
#include "slamdb/align/detail/settle_places.h"
#include "slamdb/model/statistics.h"

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

// The same transform, of another scale: what is at `fixed` (in the frame that it goes to) stays there.
Similarity3d Scaled(const Similarity3d& transform, double factor, const Eigen::Vector3d& fixed) {
  Similarity3d scaled = transform;
  scaled.scale *= factor;
  scaled.translation = fixed + factor * (transform.translation - fixed);
  return scaled;
}

class Grouping {
 public:
  explicit Grouping(std::vector<bool> metric) : metric_(std::move(metric)) {
    for (std::size_t map = 0; map < metric_.size(); ++map) places_.push_back({map, {}});
  }

  void Take(MapLink& link, double depth) {
    if (link.alignment.verdict != AlignmentVerdict::kAligned) return;
    const MapPlace first = places_[link.first], second = places_[link.second];
    if (first.group == second.group) {
      const Similarity3d by_others = first.group_from_map.Inverse() * second.group_from_map;
      link.use = Closes(link.alignment, by_others, depth) ? LinkUse::kCloses : LinkUse::kContradicts;
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
      if (places_[map].group == group && metric_[map]) return places_[map].group_from_map.scale;
    return std::nullopt;
  }

  const std::vector<bool> metric_;
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
  std::vector<bool> metric;
  for (const MapRef& map : maps) metric.push_back(IsMetric(map.atlas->maps[map.map]));
  Grouping grouping(metric);
  AlignedMaps aligned{{}, grouping.places()};
  if (maps.size() < 2) return aligned;
  const detail::PreparedMaps prepared(maps, options);
  const double pairs = static_cast<double>(maps.size() * (maps.size() - 1)) / 2;
  AlignOptions of_pair = options;
  if (options.progress)
    of_pair.progress = [&](std::string_view stage, double fraction) {
      options.progress(stage, (static_cast<double>(aligned.links.size()) + fraction) / pairs);
    };
  for (std::size_t first = 0; first < maps.size(); ++first)
    for (std::size_t second = first + 1; second < maps.size(); ++second)
      aligned.links.push_back(
          {first, second, detail::AlignPair(prepared[first], prepared[second], prepared.trained_words(), of_pair)});
  const auto knows_scale = [&](const MapLink& link) { return metric[link.first] && metric[link.second]; };
  std::ranges::stable_sort(aligned.links, [&](const MapLink& a, const MapLink& b) {
    if (a.alignment.verdict != b.alignment.verdict) return a.alignment.verdict < b.alignment.verdict;
    if (knows_scale(a) != knows_scale(b)) return knows_scale(a);
    return a.alignment.evidence.points > b.alignment.evidence.points;
  });
  for (MapLink& link : aligned.links) grouping.Take(link, prepared[link.first].views.median_depth());
  aligned.places = grouping.places();
  detail::SettlePlaces(aligned.links, metric, aligned.places);
  return aligned;
}

}  // namespace slamdb
