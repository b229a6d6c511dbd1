// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "slamdb/model/index.h"

// Which entity of one atlas is which of another: the first half of DiffAtlases.
namespace slamdb::detail {

// An atlas whose keyframes and points are numbered through all its maps, in the order of their lists.
class NumberedAtlas {
 public:
  explicit NumberedAtlas(const Atlas& atlas);

  const Atlas& atlas() const { return index_.atlas(); }
  const AtlasIndex& index() const { return index_; }

  // By number.
  std::vector<const KeyFrame*> keyframes;
  std::vector<const MapPoint*> points;
  std::vector<std::uint32_t> map_of_keyframe, map_of_point;  // rows of Atlas::maps

  // The keyframes of a map are the numbers from here to the first of the next map, which may be the end; so the points.
  std::uint32_t FirstKeyFrame(std::uint32_t map) const { return first_keyframe_[map]; }
  std::uint32_t FirstPoint(std::uint32_t map) const { return first_point_[map]; }

  // The number of an id inside a map, or kNoRow.
  std::uint32_t FindKeyFrame(std::uint32_t map, KeyFrameId id) const {
    const std::uint32_t row = index_.KeyFrameRow(map, id);
    return row == kNoRow ? kNoRow : first_keyframe_[map] + row;
  }
  std::uint32_t FindPoint(std::uint32_t map, MapPointId id) const {
    const std::uint32_t row = index_.PointRow(map, id);
    return row == kNoRow ? kNoRow : first_point_[map] + row;
  }

 private:
  AtlasIndex index_;
  std::vector<std::uint32_t> first_keyframe_, first_point_;  // by map, and the end of the last one
};

// Pairs of numbers, each in at most one pair.
class Pairing {
 public:
  static constexpr std::uint64_t kNoKey = ~std::uint64_t{0};
  using Key = std::function<std::uint64_t(std::uint32_t)>;
  using Accept = std::function<bool(std::uint32_t before, std::uint32_t after)>;

  Pairing(std::size_t before, std::size_t after) : after_of_(before, kNoRow), before_of_(after, kNoRow) {}

  // Pairs those not paired yet that have the same key, the first with the first, if it is accepted. kNoKey pairs with
  // nothing. O(n).
  void Join(const Key& before_key, const Key& after_key, const Accept& accept = {});
  void Add(std::uint32_t before, std::uint32_t after);

  // The partner, or kNoRow.
  std::uint32_t AfterOf(std::uint32_t before) const { return after_of_[before]; }
  std::uint32_t BeforeOf(std::uint32_t after) const { return before_of_[after]; }
  std::size_t before_size() const { return after_of_.size(); }
  std::size_t after_size() const { return before_of_.size(); }

 private:
  std::vector<std::uint32_t> after_of_, before_of_;
};

// Which row of a keyframe's features became which, in pairs of keyframes that do not have as many.
class FeatureRows {
 public:
  FeatureRows(const NumberedAtlas& before, const NumberedAtlas& after, const Pairing& keyframes, int threads);

  // The row after, or one that no keyframe has when the feature is gone. What is no row stays as it is.
  std::int32_t AfterOf(std::uint32_t keyframe_before, std::int32_t row) const {
    const std::vector<std::int32_t>& rows = rows_[keyframe_before];
    return row < 0 || rows.empty() ? row : static_cast<std::size_t>(row) < rows.size() ? rows[row] : kGone;
  }

  static constexpr std::int32_t kGone = std::numeric_limits<std::int32_t>::max();

 private:
  std::vector<std::vector<std::int32_t>> rows_;  // by keyframe before; empty: the same
};

struct AtlasPairing {
  Pairing maps, cameras, keyframes;
  FeatureRows rows;
  Pairing points;
};
AtlasPairing PairEntities(const NumberedAtlas& before, const NumberedAtlas& after, int threads);

}  // namespace slamdb::detail
