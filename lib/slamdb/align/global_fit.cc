// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/global_fit.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "slamdb/base/detail/parallel.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kNearestViews = 3;
constexpr double kLeastCosine = 0.5;  // between the axes of two cameras that may see the same: 60 degrees
constexpr double kRadius = 4;         // pixels at octave 0
constexpr int kRounds = 2, kIterations = 20;

// Each pair of points once.
class DistinctMatches {
 public:
  void Add(std::span<const PointMatch> matches) {
    for (const PointMatch& match : matches)
      if (taken_.emplace(match.first.point, match.second.point).second) matches_.push_back(match);
  }
  std::vector<PointMatch> Take() { return std::move(matches_); }

 private:
  std::set<std::pair<std::uint32_t, std::uint32_t>> taken_;
  std::vector<PointMatch> matches_;
};

// Left views of the first map nearest to one of the second, among those that look about the same way.
std::vector<std::uint32_t> NearestViews(const MapPair& pair, const Similarity3d& first_from_second,
                                        const View& second) {
  const std::span<const View> views = pair.first.views.views();
  const Eigen::Vector3d center = first_from_second * second.center;
  const Eigen::Vector3d axis = first_from_second.rotation * second.axis();
  std::vector<std::pair<double, std::uint32_t>> near;
  for (std::uint32_t row = 0; row < views.size(); ++row)
    if (!views[row].right && views[row].axis().dot(axis) > kLeastCosine)
      near.emplace_back((views[row].center - center).squaredNorm(), row);
  const std::size_t count = std::min(kNearestViews, near.size());
  std::ranges::partial_sort(near, near.begin() + static_cast<std::ptrdiff_t>(count));
  std::vector<std::uint32_t> nearest;
  for (std::size_t i = 0; i < count; ++i) nearest.push_back(near[i].second);
  return nearest;
}

// Matches of every keyframe of the second map with what the nearest ones of the first see.
std::vector<PointMatch> SearchEverywhere(const MapPair& pair, const Similarity3d& first_from_second, int threads) {
  const std::span<const View> views = pair.second.views.views();
  std::vector<std::vector<PointMatch>> found(views.size());
  ParallelFor(found.size(), 4, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t view = begin; view < end; ++view) {
      if (views[view].right) continue;
      const auto number = static_cast<std::uint32_t>(view);
      const LocalMap own = MakeLocalMap(pair.second, number, 0);
      for (const std::uint32_t near : NearestViews(pair, first_from_second, views[view])) {
        const LocalMap other = MakeLocalMap(pair.first, near, 0);
        const auto matches = SearchByTransform(pair, other, own, first_from_second, kRadius);
        std::ranges::copy(pair.geometry.InliersOf(matches, first_from_second), std::back_inserter(found[view]));
      }
    }
  });
  DistinctMatches matches;
  for (const std::vector<PointMatch>& of_view : found) matches.Add(of_view);
  return matches.Take();
}

}  // namespace

GlobalFit FitEverywhere(const MapPair& pair, std::span<const Hypothesis> hypotheses, const Consensus& consensus,
                        int threads) {
  DistinctMatches distinct;
  for (const std::uint32_t member : consensus.members) distinct.Add(hypotheses[member].inliers);
  GlobalFit global{.matches = distinct.Take()};
  const auto refine = [&](const Similarity3d& start) {
    global.fit = pair.geometry.Refine(global.matches, start, kIterations);
  };
  refine(hypotheses[consensus.members.front()].first_from_second);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<PointMatch> more = SearchEverywhere(pair, global.fit.first_from_second, threads);
    if (more.size() < 3) return global;
    global.matches = std::move(more);
    refine(global.fit.first_from_second);
  }
  std::vector<PointMatch> inliers = pair.geometry.InliersOf(global.matches, global.fit.first_from_second);
  if (inliers.size() < 3) return global;
  global.matches = std::move(inliers);
  refine(global.fit.first_from_second);
  return global;
}

}  // namespace slamdb::detail
