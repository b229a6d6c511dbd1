// SPDX-License-Identifier: BSD-3-Clause
// Map by map: each goes to the mean of where its links say that it is, in fifty sweeps.
#include "slamdb/align/detail/settle_places.h"

#include <algorithm>
#include <cmath>

namespace slamdb::detail {
namespace {

constexpr int kSweeps = 50;

// What the links of a map say about its place.
class MeanPlace {
 public:
  explicit MeanPlace(const Similarity3d& now) : now_(now) {}

  // `center`: of what both maps see, in this one.
  void Add(const Similarity3d& place, const Eigen::Vector3d& center, double weight) {
    const double sign = place.rotation.dot(now_.rotation) < 0 ? -1 : 1;
    rotation_ += sign * weight * place.rotation.coeffs();
    log_scale_ += weight * std::log(place.scale);
    center_ += weight * center;
    target_ += weight * (place * center);
    weight_ += weight;
  }

  Similarity3d Place(bool keeps_scale) const {
    Similarity3d place;
    place.rotation = Eigen::Quaterniond(rotation_).normalized();
    place.scale = keeps_scale ? now_.scale : std::exp(log_scale_ / weight_);
    place.translation = (target_ - place.scale * (place.rotation * center_)) / weight_;
    return place;
  }

 private:
  const Similarity3d& now_;
  Eigen::Vector4d rotation_ = Eigen::Vector4d::Zero();
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero(), target_ = Eigen::Vector3d::Zero();
  double log_scale_ = 0, weight_ = 0;
};

Similarity3d MeanPlaceOf(std::size_t map, const std::vector<MapLink>& links, bool keeps_scale,
                         const std::vector<MapPlace>& places) {
  MeanPlace mean(places[map].group_from_map);
  for (const MapLink& link : links) {
    if (!link.is_used() || (link.first != map && link.second != map)) continue;
    const Similarity3d& first_from_second = *link.alignment.first_from_second;
    const Eigen::Vector3d& center = link.alignment.center;
    const auto weight = static_cast<double>(link.alignment.evidence.points);
    if (link.first == map)
      mean.Add(places[link.second].group_from_map * first_from_second.Inverse(), center, weight);
    else
      mean.Add(places[link.first].group_from_map * first_from_second, first_from_second.Inverse() * center, weight);
  }
  return mean.Place(keeps_scale);
}

}  // namespace

void SettlePlaces(const std::vector<MapLink>& links, const std::vector<MapTraits>& maps,
                  std::vector<MapPlace>& places) {
  if (std::ranges::none_of(links, [](const MapLink& link) { return link.use == LinkUse::kCloses; })) return;
  const auto anchor_of = [&](std::size_t group) {  // it stays
    for (std::size_t map = 0; map < places.size(); ++map)
      if (places[map].group == group && maps[map].metric) return map;
    return group;
  };
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t map = 0; map < places.size(); ++map) {
      const bool alone = std::ranges::none_of(
          links, [&](const MapLink& link) { return link.is_used() && (link.first == map || link.second == map); });
      if (alone || anchor_of(places[map].group) == map) continue;
      places[map].group_from_map = MeanPlaceOf(map, links, maps[map].metric, places);
    }
  std::vector<Similarity3d> settled;
  for (const MapPlace& place : places)
    settled.push_back(places[place.group].group_from_map.Inverse() * place.group_from_map);
  for (std::size_t map = 0; map < places.size(); ++map) places[map].group_from_map = settled[map];
}

}  // namespace slamdb::detail
