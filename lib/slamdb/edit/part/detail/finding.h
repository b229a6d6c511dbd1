// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "slamdb/edit/part/detail/remains.h"
#include "slamdb/edit/part/detail/sights.h"

namespace slamdb::detail {

// How well a camera at the keyframes of an atlas is found in what remains of it. As ORB-SLAM3's relocalisation goes
// about it: a camera is found by one keyframe, of whose points the picture must show enough, and only keyframes that
// share nearly as many words with the picture as any does are tried. So keyframes with very many words stand in the way
// of all others, as the first two of a monocular map do, which have five times as many features.
class Finding {
 public:
  // `shown`: by keyframe, points that a picture taken there shows beside those that it has recorded. `min_points`: with
  // which a camera is found.
  // Cost: that of the words which keyframes have in common.
  Finding(const Remains& remains, std::span<const std::vector<std::uint32_t>> shown, std::size_t min_points,
          int threads);

  // How much less is found without a keyframe and the points that go with it (Remains::GoingWith), in places; below 0
  // where it stands in the way.
  double Loss(std::uint32_t keyframe, std::span<const std::uint32_t> going);
  // Before the keyframe goes from `remains`.
  void Remove(std::uint32_t keyframe, std::span<const std::uint32_t> going);

  // Points that a single place shows, where they stand beside enough others.
  std::vector<std::uint32_t> ShownOnce() const;
  // Before they go from `remains`.
  void Drop(std::span<const std::uint32_t> points);

 private:
  // A keyframe as a place is found by it.
  struct Seer {
    std::uint32_t keyframe;
    std::uint32_t points = 0;  // of it, that remain and that the place shows
    std::uint32_t words = 0;   // in common
  };
  struct Place {
    std::vector<Seer> seers;                                    // the most words first, then by keyframe
    std::vector<std::pair<std::uint32_t, std::uint32_t>> rows;  // keyframe -> row of seers, ascending
    std::size_t gone = 0;                                       // of the seers
    double value = 0;                                           // 0 to 1: how sure a camera is found there
  };

  void CountPoints(std::span<const std::vector<std::uint32_t>> shown);
  // Points that stay, ascending: those a keyframe sees, and those a picture from there shows beside them.
  std::vector<std::uint32_t> ShownFrom(std::uint32_t place, std::span<const std::uint32_t> beside) const;
  void CountWords(int threads);
  void SetWords(std::uint32_t place, std::span<const std::uint32_t> sharing, std::span<const std::uint32_t> common);
  static void ListRows(Place& place);
  std::span<const std::uint32_t> PlacesThatShow(std::uint32_t point) const {
    return {shown_at_.data() + shown_begins_[point], shown_at_.data() + shown_begins_[point + 1]};
  }
  // Takes points away, or brings them back.
  void Change(std::span<const std::uint32_t> points, std::uint32_t by);
  double ValueOf(const Place& place, std::uint32_t without) const;

  const Remains& remains_;
  const double sure_;                                  // points with which every second camera is found
  std::vector<Place> places_;                          // by keyframe
  std::vector<std::size_t> shown_begins_;              // by point: of its places
  std::vector<std::uint32_t> shown_at_;                // places, point by point
  std::vector<std::vector<std::uint32_t>> places_of_;  // by keyframe: places that it is a seer of
};

}  // namespace slamdb::detail
