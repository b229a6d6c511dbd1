// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "slamdb/edit/part/detail/sights.h"
#include "slamdb/edit/part/subset.h"

namespace slamdb::detail {

// How good a choice of keyframes is: by the places that it covers, then by its points.
struct Quality {
  std::uint64_t covered = 0, points = 0;
  friend auto operator<=>(const Quality&, const Quality&) = default;
};

// What is left of an atlas of which some keyframes are kept: the points that stay, the places that they cover, and the
// bytes of the .osa file. Keyframes come and go one by one; each is as much work as its points have observers.
class KeptViews {
 public:
  // `keyframe_bytes` by number, without observations; `bytes` is what the file needs beside keyframes and points.
  KeptViews(const Sights& sights, std::size_t min_points, std::uint64_t bytes,
            const std::vector<std::uint64_t>& keyframe_bytes);

  // What a listener to Add may hear: before a point stays and before a place gets a point more.
  struct Deaf {
    void BeginsToStay(std::uint32_t /*point*/) const {}
    void Covers(std::uint32_t /*place*/) const {}
    void Weighs(std::uint32_t /*point*/) const {}
  };

  // A keyframe that is not kept. Listener::Weighs is called for points that weigh more now and do not stay yet.
  template <class Listener = Deaf>
  void Add(std::uint32_t keyframe, Listener&& listener = {});
  // A keyframe that is kept.
  void Remove(std::uint32_t keyframe);
  // What `bytes` would be.
  std::uint64_t BytesWith(std::uint32_t keyframe) const;

  bool Keeps(std::uint32_t keyframe) const { return kept_[keyframe] != 0; }
  bool Stays(std::uint32_t point) const { return weights_[point] >= sights_.Need(point); }
  std::uint32_t Weight(std::uint32_t point) const { return weights_[point]; }
  std::size_t keyframes() const { return keyframes_; }
  std::uint64_t bytes() const { return bytes_; }
  const Quality& quality() const { return quality_; }

  // With the landmarks of every map that stays; .osa files, whose size is the target, hold none.
  Subset ToSubset() const;

 private:
  const Sights& sights_;
  const std::size_t min_points_;
  const std::vector<std::uint64_t>& keyframe_bytes_;
  std::vector<std::uint8_t> kept_;        // by keyframe
  std::vector<std::uint32_t> views_;      // by keyframe: points in view that stay
  std::vector<std::uint32_t> weights_;    // by point, of the observations by kept keyframes
  std::vector<std::uint32_t> observers_;  // by point: kept ones
  std::size_t keyframes_ = 0;
  std::uint64_t bytes_;
  Quality quality_;
};

// What a point takes with `observers` observations.
std::uint64_t PointBytes(std::uint64_t observers);

template <class Listener>
void KeptViews::Add(std::uint32_t keyframe, Listener&& listener) {
  bytes_ = BytesWith(keyframe);
  kept_[keyframe] = 1;
  ++keyframes_;
  for (const auto& [point, weight] : sights_.PointsOf(keyframe)) {
    ++observers_[point];
    if (weight == 0) continue;
    const bool stayed = Stays(point), stays = weights_[point] + weight >= sights_.Need(point);
    if (stays && !stayed) {
      listener.BeginsToStay(point);
      ++quality_.points;
      for (const Sights::Sight& place : sights_.ObserversOf(point)) {
        if (views_[place.number] + 1 == min_points_) {
          listener.Covers(place.number);
          ++quality_.covered;
        }
        ++views_[place.number];
      }
    }
    weights_[point] += weight;
    if (!stays) listener.Weighs(point);
  }
}

}  // namespace slamdb::detail
