// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slamdb/edit/part/detail/sights.h"
#include "slamdb/edit/part/subset.h"

namespace slamdb::detail {

// What a choice of keyframes must keep to.
struct KeyFrameBudget {
  std::optional<std::size_t> keyframes;  // at most so many
  std::optional<std::uint64_t> bytes;    // of the .osa file, at most so many
  bool lean = false;                     // features that see no point go, and IMU measurements
};

// What is left of an atlas while keyframes are taken away, at the strict border (SettleBorder): who stays, and the
// bytes of the .osa file, or a little more. Begins with all that is good.
class Remains {
 public:
  // `sights` must outlive it.
  Remains(const Sights& sights, const KeyFrameBudget& budget);

  const Sights& sights() const { return sights_; }
  const KeyFrameBudget& budget() const { return budget_; }
  bool Keeps(std::uint32_t keyframe) const { return kept_[keyframe] != 0; }
  bool Stays(std::uint32_t point) const { return !is_dropped_[point] && weights_[point] >= sights_.Need(point); }
  std::size_t keyframes() const { return keyframes_; }
  std::size_t points() const { return points_; }
  std::uint64_t bytes() const { return bytes_; }
  bool Fits() const {
    return keyframes_ <= budget_.keyframes.value_or(keyframes_) && bytes_ <= budget_.bytes.value_or(bytes_);
  }

  // The points that go with a keyframe that is kept.
  std::vector<std::uint32_t> GoingWith(std::uint32_t keyframe) const;
  // What the file is smaller by without them.
  std::uint64_t BytesOf(std::uint32_t keyframe, std::span<const std::uint32_t> going) const;
  void Remove(std::uint32_t keyframe, std::span<const std::uint32_t> going);
  // Points that stay till now.
  void Drop(std::span<const std::uint32_t> points);

  // With the landmarks of every map that stays; .osa files, whose size is the target, hold none.
  Subset ToSubset() const;

 private:
  std::uint64_t KeyFrameBytes(std::uint32_t keyframe, std::uint32_t views) const;
  void TakeOffBytes(std::uint32_t point);

  const Sights& sights_;
  const KeyFrameBudget budget_;
  std::vector<std::uint8_t> kept_;         // by keyframe
  std::vector<std::uint64_t> own_bytes_;   // by keyframe: beside features
  std::vector<std::uint64_t> all_bytes_;   // by keyframe: of all its features
  std::vector<std::uint64_t> view_bytes_;  // by keyframe: of the features that see one point
  std::vector<std::uint32_t> views_;       // by keyframe: points in view that stay
  std::vector<std::uint32_t> weights_;     // by point, of the observations by kept keyframes
  std::vector<std::uint8_t> is_dropped_;   // by point
  std::size_t keyframes_ = 0, points_ = 0;
  std::uint64_t bytes_ = 0;
};

}  // namespace slamdb::detail
