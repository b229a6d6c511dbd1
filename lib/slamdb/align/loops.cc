// SPDX-License-Identifier: BSD-3-Clause
// 1. For each keyframe the earlier places that look like it, but for those that it is linked to by few steps.
// 2. Each is matched and verified by itself, as between two maps: the map has two copies, which differ by the drift.
// 3. Hypotheses about the same two ends are one loop; the largest part of them that agrees says how the ends lie.
// 4. The pictures of each end are held against the points of the other, and the verdict is given.
#include "slamdb/align/loops.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include "slamdb/align/detail/candidates.h"
#include "slamdb/align/detail/consensus.h"
#include "slamdb/align/detail/decide.h"
#include "slamdb/align/detail/evidence.h"
#include "slamdb/align/detail/hypothesis.h"
#include "slamdb/align/detail/verify.h"
#include "slamdb/base/detail/parallel.h"

namespace slamdb {
namespace detail {
namespace {

constexpr std::uint32_t kFewestShared = 15;  // points that link two keyframes, as in ORB-SLAM3
constexpr int kLinked = 3;                   // links: so near, local maps have points in common
constexpr std::size_t kFewestInliers = 15;   // of a hypothesis
constexpr double kDriftWithin = 4;           // by which a map may drift between hypotheses about the same ends
constexpr std::size_t kBatch = 32;           // candidates between two reports of progress

// Which left views share points.
class Links {
 public:
  Links(const MapViews& map, int threads) : neighbours_(map.views().size()) {
    ParallelFor(neighbours_.size(), 16, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t view = begin; view < end; ++view)
        if (!map.views()[view].right)
          for (const auto& [other, shared] : map.Covisibles(static_cast<std::uint32_t>(view)))
            if (shared >= kFewestShared) neighbours_[view].push_back(other);
    });
  }

  // Those within so many links, itself among them.
  std::vector<std::uint32_t> Within(std::uint32_t view, int links) const {
    std::vector<std::uint32_t> reached{view};
    std::vector<bool> known(neighbours_.size(), false);
    known[view] = true;
    std::size_t begin = 0;
    for (int link = 0; link < links; ++link)
      for (const std::size_t end = reached.size(); begin < end; ++begin)
        for (const std::uint32_t next : neighbours_[reached[begin]]) {
          if (!known[next]) reached.push_back(next);
          known[next] = true;
        }
    return reached;
  }

 private:
  std::vector<std::vector<std::uint32_t>> neighbours_;
};

class LoopFinder {
 public:
  LoopFinder(const PreparedMap& map, const AlignOptions& options)
      : map_(map), options_(options), pair_{map, map, PairGeometry(map.views, map.views)}, along_(Along()) {}

  LoopSearch Run() const {
    const std::vector<Candidate> candidates = Candidates();
    LoopSearch search{candidates.size(), {}};
    std::vector<Hypothesis> left = Try(candidates);
    while (!left.empty()) search.loops.push_back(Judge(TakeRegion(left)));
    std::ranges::stable_sort(search.loops, [](const Loop& a, const Loop& b) {
      return std::pair(a.verdict, b.evidence.points) < std::pair(b.verdict, a.evidence.points);
    });
    return search;
  }

 private:
  std::pair<double, KeyFrameId> OrderOf(std::uint32_t view) const {
    const KeyFrame& keyframe = map_.views.KeyFrameOf(map_.views.views()[view]);
    return {std::isfinite(keyframe.timestamp) ? keyframe.timestamp : 0, keyframe.id};
  }
  bool IsEarlier(std::uint32_t one, std::uint32_t other) const { return OrderOf(one) < OrderOf(other); }

  // By view, how far the camera had gone by then.
  std::vector<double> Along() const {
    const std::span<const View> views = map_.views.views();
    std::vector<std::uint32_t> order(views.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, {}, [&](std::uint32_t view) { return std::pair(OrderOf(view), view); });
    std::vector<double> along(views.size(), 0);
    for (std::size_t i = 1; i < order.size(); ++i)
      along[order[i]] = along[order[i - 1]] + (views[order[i]].center - views[order[i - 1]].center).norm();
    return along;
  }

  std::vector<Candidate> Candidates() const {
    const Links links(map_.views, options_.threads);
    return FindCandidates(map_.index, map_.groups, map_.bags, options_.threads,
                          [&](std::uint32_t asked, std::span<float> scores) {
                            for (std::uint32_t view = 0; view < scores.size(); ++view)
                              if (scores[view] > 0 && !IsEarlier(view, asked)) scores[view] = 0;
                            for (const std::uint32_t near : links.Within(asked, kLinked)) scores[near] = 0;
                          });
  }

  std::vector<Hypothesis> Try(const std::vector<Candidate>& candidates) const {
    std::vector<Hypothesis> hypotheses;
    for (std::size_t begin = 0; begin < candidates.size(); begin += kBatch) {
      std::array<std::optional<Hypothesis>, kBatch> batch;
      const std::size_t count = std::min(kBatch, candidates.size() - begin);
      ParallelFor(count, 1, options_.threads, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) batch[i] = TryCandidate(pair_, candidates[begin + i], Search::kNodes);
      });
      for (std::optional<Hypothesis>& hypothesis : batch) {
        if (!hypothesis) continue;
        // What both ends see in common says nothing: it is where it is.
        std::erase_if(hypothesis->inliers,
                      [](const PointMatch& match) { return match.first.point == match.second.point; });
        if (hypothesis->inliers.size() >= kFewestInliers) hypotheses.push_back(*std::move(hypothesis));
      }
      if (options_.progress)
        options_.progress("comparing places",
                          static_cast<double>(begin + count) / static_cast<double>(candidates.size()));
    }
    return hypotheses;
  }

  bool IsNear(std::uint32_t one, std::uint32_t other) const {
    const auto in_group = [&](std::uint32_t a, std::uint32_t b) {
      return std::ranges::find(map_.groups[a], b) != map_.groups[a].end();
    };
    return one == other || in_group(one, other) || in_group(other, one);
  }

  // The strongest hypothesis that is left, and all about its two ends.
  std::vector<Hypothesis> TakeRegion(std::vector<Hypothesis>& left) const {
    const Candidate leader =
        std::ranges::max_element(left, {}, [](const Hypothesis& each) { return each.inliers.size(); })->candidate;
    const auto begin = std::stable_partition(left.begin(), left.end(), [&](const Hypothesis& each) {
      return !IsNear(each.candidate.first, leader.first) || !IsNear(each.candidate.second, leader.second);
    });
    std::vector<Hypothesis> region(std::make_move_iterator(begin), std::make_move_iterator(left.end()));
    left.erase(begin, left.end());
    return region;
  }

  // Of all about one end: the views, and the points that they see.
  struct End {
    std::vector<std::uint32_t> views, points;
  };
  End EndOf(const std::set<std::uint32_t>& keyframes) const {
    std::set<std::uint32_t> views, points;
    const auto add = [&](std::uint32_t left) {
      for (std::uint32_t view = left; view <= map_.views.LastViewOf(left); ++view) views.insert(view);
    };
    for (const std::uint32_t left : keyframes) {
      add(left);
      for (const std::uint32_t neighbour : map_.groups[left]) add(neighbour);
    }
    for (const std::uint32_t view : views)
      for (const Seen& seen : map_.views.SeenBy(view)) points.insert(seen.point);
    return {{views.begin(), views.end()}, {points.begin(), points.end()}};
  }

  Loop Judge(const std::vector<Hypothesis>& region) const {
    const std::vector<Consensus> found = FindConsensus(pair_, region);
    const Consensus& best = found.front();
    Loop loop;
    loop.evidence.agreeing = best.members.size();
    for (const Consensus& other : found)
      if (!Agree(pair_, region[other.members.front()], region[best.members.front()], kDriftWithin))
        loop.evidence.contradicting = std::max<std::uint64_t>(loop.evidence.contradicting, other.members.size());
    std::set<std::uint32_t> first, second;
    for (const std::uint32_t member : best.members) {
      first.insert(region[member].candidate.first);
      second.insert(region[member].candidate.second);
      loop.pairs.push_back(PairOf(region[member]));
    }
    loop.evidence.first_keyframes = first.size();
    loop.evidence.second_keyframes = second.size();
    std::ranges::stable_sort(loop.pairs, std::greater(), &AlignedPair::inliers);
    const auto [transform, matches] = FitOf(region, best);
    AddMatches(matches, transform, loop);
    loop.gap = GapOf(transform, region[best.members.front()].candidate);
    Look(transform, EndOf(first), EndOf(second), loop.evidence);
    GiveVerdict(loop, map_.views.median_depth());
    return loop;
  }

  // All matches of a consensus together.
  std::pair<Similarity3d, std::vector<PointMatch>> FitOf(const std::vector<Hypothesis>& region,
                                                         const Consensus& consensus) const {
    std::vector<PointMatch> matches;
    std::set<std::pair<std::uint32_t, std::uint32_t>> known;
    for (const std::uint32_t member : consensus.members)
      for (const PointMatch& match : region[member].inliers)
        if (known.insert({match.first.point, match.second.point}).second) matches.push_back(match);
    Similarity3d transform = region[consensus.members.front()].first_from_second;
    transform = pair_.geometry.Refine(matches, transform).first_from_second;
    const std::vector<PointMatch> inliers = pair_.geometry.InliersOf(matches, transform);
    return {pair_.geometry.Refine(inliers, transform).first_from_second, inliers};
  }

  void AddMatches(const std::vector<PointMatch>& matches, const Similarity3d& first_from_second, Loop& loop) const {
    const auto id = [&](const LocalPoint& point) {
      return map_.views.map().points[map_.views.points()[point.point].row].id;
    };
    for (const PointMatch& match : matches) {
      const MatchErrors errors = pair_.geometry.ErrorsOf(match, first_from_second);
      loop.matches.push_back({id(match.first), id(match.second),
                              static_cast<float>(std::sqrt(std::max(errors.in_first, errors.in_second)))});
    }
    loop.evidence.points = matches.size();
    loop.evidence.extent = ExtentOf(map_.views, matches);
  }

  LoopGap GapOf(const Similarity3d& transform, const Candidate& ends) const {
    const Eigen::Vector3d& center = map_.views.views()[ends.second].center;
    return {.translation = (transform * center - center).norm(),
            .path = std::abs(along_[ends.second] - along_[ends.first]),
            .degrees = transform.rotation.angularDistance(Eigen::Quaterniond::Identity()) * 180 / std::numbers::pi,
            .scale = transform.scale};
  }

  AlignedPair PairOf(const Hypothesis& hypothesis) const {
    const View &first = map_.views.views()[hypothesis.candidate.first],
               &second = map_.views.views()[hypothesis.candidate.second];
    return {map_.views.KeyFrameOf(first).id, map_.views.KeyFrameOf(second).id, hypothesis.inliers.size(),
            BetweenCameras(first, second, hypothesis.first_from_second)};
  }

  void Look(const Similarity3d& first_from_second, const End& first, const End& second, LoopEvidence& evidence) const {
    const MapViews& map = map_.views;
    const SeenShare there = LookFor(map, second.points, map, first.views, first_from_second, options_.threads);
    const SeenShare here = LookFor(map, first.points, map, second.views, first_from_second.Inverse(), options_.threads);
    evidence.found_share = std::max(there.found_share(), here.found_share());
    evidence.cell_share = std::max(there.cell_share(), here.cell_share());
    evidence.front_share = std::max(there.front_share(), here.front_share());
    evidence.views = there.views + here.views;
    evidence.agreeing_views = there.agreeing_views + here.agreeing_views;
  }

  const PreparedMap& map_;
  const AlignOptions& options_;
  const MapPair pair_;
  const std::vector<double> along_;
};

}  // namespace
}  // namespace detail

LoopSearch FindLoops(MapRef map, const AlignOptions& options) {
  const detail::PreparedMaps prepared(std::span(&map, 1), options);
  return detail::LoopFinder(prepared[0], options).Run();
}

}  // namespace slamdb
