// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/fragments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

Fragment Describe(const Map& map) {
  Fragment fragment{.id = map.id, .keyframes = map.keyframes.size(), .points = map.points.size()};
  double begin = std::numeric_limits<double>::infinity(), end = -begin;
  for (const KeyFrame& keyframe : map.keyframes) {
    if (!std::isfinite(keyframe.timestamp)) continue;
    begin = std::min(begin, keyframe.timestamp);
    end = std::max(end, keyframe.timestamp);
  }
  if (begin <= end) {
    fragment.begin_time = begin;
    fragment.end_time = end;
  }
  return fragment;
}

// Decides which stay. Of maps of the same size, the earlier in the list.
void Choose(std::vector<Fragment>& maps, const FragmentOptions& options) {
  std::vector<std::size_t> by_size(maps.size());
  std::iota(by_size.begin(), by_size.end(), std::size_t{0});
  std::ranges::stable_sort(by_size, std::ranges::greater(), [&](std::size_t row) { return maps[row].keyframes; });
  const std::size_t most = options.largest.value_or(maps.size());
  for (std::size_t rank = 0; rank < std::min(most, by_size.size()); ++rank) {
    Fragment& map = maps[by_size[rank]];
    map.kept = map.keyframes >= std::max<std::size_t>(options.min_keyframes, 1);
  }
}

void Sort(Atlas& atlas, MapOrder order) {
  const auto comes_before = [order](const Map& a, const Map& b) {
    if (order == MapOrder::kSize) return a.keyframes.size() > b.keyframes.size();
    if (order == MapOrder::kTime) return Describe(a).begin_time < Describe(b).begin_time;
    return a.id < b.id;
  };
  if (order == MapOrder::kAsIs || std::ranges::is_sorted(atlas.maps, comes_before)) return;
  std::ranges::stable_sort(atlas.maps, comes_before);
  // Entries that stand for maps by their row would now stand for others.
  atlas.repeated_maps.clear();
  for (Map& map : atlas.maps)
    for (auto* entries : {&map.repeated_keyframes, &map.repeated_points}) entries->clear();
}

}  // namespace

FragmentReport DropFragments(Atlas& atlas, const FragmentOptions& options) {
  FragmentReport report;
  for (const Map& map : atlas.maps) report.maps.push_back(Describe(map));
  Choose(report.maps, options);
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)  // maps of landmarks alone are no fragments
    if (atlas.maps[row].keyframes.empty() && !atlas.maps[row].landmarks.empty()) report.maps[row].kept = true;
  if (std::ranges::none_of(report.maps, &Fragment::kept)) {
    std::uint64_t largest = 0;
    for (const Fragment& map : report.maps) largest = std::max(largest, map.keyframes);
    throw Error(ErrorKind::kNotPossible,
                detail::Concat("no map has ", options.min_keyframes, " keyframes; the largest has ", largest));
  }
  Subset kept = Subset::Everything(atlas);
  for (std::size_t row = 0; row < report.maps.size(); ++row) {
    if (report.maps[row].kept) continue;
    std::ranges::fill(kept.maps[row].keyframes, std::uint8_t{0});
    std::ranges::fill(kept.maps[row].points, std::uint8_t{0});
    std::ranges::fill(kept.maps[row].landmarks, std::uint8_t{0});
  }
  detail::Steps steps(options.progress, "dropping fragments", 2);
  steps.Next();
  report.removed = KeepSubset(atlas, kept, options.threads);
  Sort(atlas, options.order);
  for (const Map& map : atlas.maps) report.order.push_back(map.id);
  steps.Next();
  return report;
}

}  // namespace slamdb
