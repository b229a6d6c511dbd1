// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/find_across.h"

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "slamdb/align/detail/match_points.h"
#include "slamdb/align/detail/visibility.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

constexpr double kRadius = 4;         // pixels at octave 0
constexpr double kMostError = 5.991;  // squared, in standard deviations of the keypoint: 95 of 100 are within
constexpr double kLeastCosine = 0.5;  // 60 degrees from where a point was seen

// A point that a picture shows at a keypoint.
struct Shown {
  std::uint32_t view, keypoint, point;
  int bits;
};

class Searcher {
 public:
  Searcher(const MapViews& map, std::span<const std::uint32_t> sessions) : map_(map), sessions_(sessions) {
    for (const PointGroup& group : map.groups()) only_session_.push_back(OnlySessionOf(group));
  }

  std::vector<Shown> LookFrom(std::uint32_t view) const {
    std::vector<Shown> shown;
    for (std::size_t row = 0; row < only_session_.size(); ++row) {
      const PointGroup& group = map_.groups()[row];
      if (only_session_[row] == SessionOf(view) || IsOutOfSight(map_.views()[view], group, {})) continue;
      for (const std::uint32_t point : group.points) {
        if (!IsOfAnother(point, view)) continue;
        if (const auto found = Find(point, view)) shown.push_back({view, found->keypoint, point, found->bits});
      }
    }
    return shown;
  }

 private:
  std::uint32_t SessionOf(std::uint32_t view) const { return sessions_[map_.views()[view].keyframe]; }

  // The session that sees the points; kNoRow: several do.
  std::uint32_t OnlySessionOf(const PointGroup& group) const {
    const std::uint32_t first = SessionOf(map_.SightingsOf(group.points.front()).front().view);
    for (const std::uint32_t point : group.points)
      for (const Sighting& sighting : map_.SightingsOf(point))
        if (SessionOf(sighting.view) != first) return kNoRow;
    return first;
  }

  // Whether another session sees the point, and the keyframe of the view does not.
  bool IsOfAnother(std::uint32_t point, std::uint32_t view) const {
    const std::uint32_t keyframe = map_.views()[view].keyframe;
    bool other = false;
    for (const Sighting& sighting : map_.SightingsOf(point)) {
      const std::uint32_t observer = map_.views()[sighting.view].keyframe;
      if (observer == keyframe) return false;
      other |= sessions_[observer] != sessions_[keyframe];
    }
    return other;
  }

  std::optional<Found> Find(std::uint32_t point, std::uint32_t view) const {
    const auto expected = Expect(map_.views()[view], map_.points()[point], {}, kLeastCosine);
    if (!expected) return std::nullopt;
    std::optional<Found> best;
    for (const Sighting& sighting : map_.SightingsOf(point)) {
      const Descriptor& descriptor = map_.views()[sighting.view].descriptors[sighting.keypoint];
      const auto found = FindNear(map_.views()[view], *expected, descriptor, kRadius, kMostBits);
      if (found && (!best || found->bits < best->bits)) best = found;
    }
    if (best && !IsThere(*expected, map_.views()[view], best->keypoint)) best.reset();
    return best;
  }

  // What looks alike best, but farther off than a measurement may be, is something else beside it.
  static bool IsThere(const Expected& expected, const View& view, std::uint32_t row) {
    const Keypoint& keypoint = view.keypoints[row];
    const Eigen::Vector2d place = PixelOf(keypoint);
    const double sigma = view.ScaleOf(keypoint.octave);
    return (place - expected.pixel).squaredNorm() <= kMostError * sigma * sigma;
  }

  const MapViews& map_;
  const std::span<const std::uint32_t> sessions_;
  std::vector<std::uint32_t> only_session_;  // by group of points
};

std::vector<Shown> LookEverywhere(const MapViews& map, std::span<const std::uint32_t> sessions, int threads) {
  const Searcher searcher(map, sessions);
  std::vector<std::vector<Shown>> by_view(map.views().size());
  ParallelFor(by_view.size(), 4, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t view = begin; view < end; ++view)
      by_view[view] = searcher.LookFrom(static_cast<std::uint32_t>(view));
  });
  std::vector<Shown> all;
  for (const std::vector<Shown>& shown : by_view) all.insert(all.end(), shown.begin(), shown.end());
  std::ranges::stable_sort(all, {}, &Shown::bits);
  return all;
}

// How many pictures show two points as one, and how unlike they are at most.
struct Votes {
  int pictures = 0, bits = 0;
};

}  // namespace

Across FindAcross(const MapViews& map, std::span<const std::uint32_t> sessions, int threads) {
  Across across;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Votes> same;
  const auto id_of = [&](std::uint32_t point) { return map.map().points[map.points()[point].row].id; };
  for (const Shown& shown : LookEverywhere(map, sessions, threads)) {
    const View& view = map.views()[shown.view];
    const KeyFrame& keyframe = map.KeyFrameOf(view);
    const std::uint32_t there = map.PointAt({shown.view, shown.keypoint});
    if (there == kNoRow) {
      const auto left = static_cast<std::uint32_t>(view.right ? keyframe.features.left_count : 0);
      across.seen.push_back({id_of(shown.point), keyframe.id, left + shown.keypoint});
    } else {
      Votes& votes = same[std::minmax(shown.point, there)];
      ++votes.pictures;
      votes.bits = std::max(votes.bits, shown.bits);
    }
  }
  std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, Votes>> pairs(same.begin(), same.end());
  std::ranges::stable_sort(pairs, [](const auto& a, const auto& b) {
    return std::tuple(-a.second.pictures, a.second.bits) < std::tuple(-b.second.pictures, b.second.bits);
  });
  for (const auto& [points, votes] : pairs) across.same.emplace_back(id_of(points.first), id_of(points.second));
  return across;
}

}  // namespace slamdb::detail
