// SPDX-License-Identifier: BSD-3-Clause
// 1. Places of the second map are recognised in the first, the most alike first.
// 2. Each is matched and verified by itself, until enough of them agree.
// 3. All their matches together give the transform, which then finds more matches all over the maps.
// 4. The pictures of each map are held against the points of the other, and the verdict is given.
// What is not sure after an early stop is looked at once more with every candidate and every pair of points.
#include "slamdb/align/align.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <unordered_map>

#include "slamdb/align/detail/candidates.h"
#include "slamdb/align/detail/common_words.h"
#include "slamdb/align/detail/consensus.h"
#include "slamdb/align/detail/decide.h"
#include "slamdb/align/detail/hypothesis.h"
#include "slamdb/align/detail/map_views.h"
#include "slamdb/align/detail/verify.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace detail {
namespace {

constexpr std::size_t kBatch = 8;            // candidates between two looks at whether enough agree
constexpr std::size_t kEnoughKeyframes = 8;  // of the second map, that agree: the rest is not tried at first
constexpr std::size_t kConsensusesTried = 3;
constexpr std::size_t kNearestViews = 3;
constexpr double kGlobalRadius = 4;  // pixels at octave 0
constexpr int kGlobalRounds = 2;
constexpr double kNearView = 0.3;      // of the median depth: keyframes that near, and
constexpr double kNearCosine = 0.866;  // turned by 30 degrees at most, look at the same

class Aligner {
 public:
  Aligner(const Atlas& first, std::size_t first_map, const Atlas& second, std::size_t second_map,
          const AlignOptions& options)
      : options_(options),
        first_(first, first_map, options.threads),
        second_(second, second_map, options.threads),
        words_(std::array{&first_, &second_}, SameVocabulary(first, second), options.threads),
        first_nodes_(first_, words_, 0),
        second_nodes_(second_, words_, 1),
        pair_{first_, second_, first_nodes_, second_nodes_, PairGeometry(first_, second_)} {}

  Alignment Run() {
    const std::vector<Candidate> candidates = FindCandidates(
        PlaceIndex(words_.Bags(0)), CovisibilityGroups(first_, options_.threads), words_.Bags(1), options_.threads);
    Alignment quick = Decide(Try(candidates, Search::kNodes, /*stop_early=*/true));
    if (quick.verdict == AlignmentVerdict::kAligned) return quick;
    return Decide(Try(candidates, Search::kAll, /*stop_early=*/false));
  }

 private:
  static bool SameVocabulary(const Atlas& first, const Atlas& second) {
    return !first.vocabulary.checksum.empty() && first.vocabulary.checksum == second.vocabulary.checksum;
  }

  struct Tried {
    std::vector<Hypothesis> hypotheses;
    std::size_t candidates = 0;
  };

  Tried Try(const std::vector<Candidate>& candidates, Search search, bool stop_early) const {
    Tried tried;
    while (tried.candidates < candidates.size()) {
      const std::size_t begin = tried.candidates, count = std::min(kBatch, candidates.size() - begin);
      std::array<std::optional<Hypothesis>, kBatch> batch;
      ParallelFor(count, 1, options_.threads, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) batch[i] = TryCandidate(pair_, candidates[begin + i], search);
      });
      for (std::optional<Hypothesis>& hypothesis : batch)
        if (hypothesis) tried.hypotheses.push_back(*std::move(hypothesis));
      tried.candidates += count;
      if (options_.progress)
        options_.progress("comparing places",
                          static_cast<double>(tried.candidates) / static_cast<double>(candidates.size()));
      if (!stop_early || tried.hypotheses.size() < kEnoughKeyframes) continue;
      const auto consensus = FindConsensus(pair_, tried.hypotheses);
      if (consensus.front().second_keyframes >= kEnoughKeyframes) break;
    }
    return tried;
  }

  // The verdict over the best consensus, or over the next ones where it is refused.
  Alignment Decide(const Tried& tried) const {
    const std::vector<Consensus> found = FindConsensus(pair_, tried.hypotheses);
    Alignment best = NothingAgrees(tried.candidates, words_.trained());
    for (std::size_t i = 0; i < std::min(found.size(), kConsensusesTried); ++i) {
      Alignment alignment = Judge(tried, found, i);
      if (i == 0 || alignment.verdict < best.verdict) best = std::move(alignment);
      if (best.verdict != AlignmentVerdict::kNoOverlap) break;
    }
    return best;
  }

  Alignment Judge(const Tried& tried, const std::vector<Consensus>& found, std::size_t chosen) const {
    const Consensus& consensus = found[chosen];
    std::vector<PointMatch> matches = MatchesOf(tried.hypotheses, consensus);
    Fit fit = pair_.geometry.Refine(matches, tried.hypotheses[consensus.members.front()].first_from_second, 20);
    for (int round = 0; round < kGlobalRounds; ++round) {
      std::vector<PointMatch> more = SearchEverywhere(fit.first_from_second);
      if (more.size() < 3) break;
      matches = std::move(more);
      fit = pair_.geometry.Refine(matches, fit.first_from_second, 20);
    }
    matches = pair_.geometry.InliersOf(matches, fit.first_from_second);
    if (matches.size() >= 3) fit = pair_.geometry.Refine(matches, fit.first_from_second, 20);

    Alignment alignment{.first_from_second = fit.first_from_second,
                        .scale_is_free = pair_.geometry.freedom() == Freedom::kSimilarity,
                        .covariance = fit.covariance,
                        .center = fit.center};
    AlignmentEvidence& evidence = alignment.evidence;
    evidence.own_vocabulary = words_.trained();
    evidence.candidates = tried.candidates;
    evidence.agreeing = consensus.members.size();
    evidence.keyframes = consensus.second_keyframes;
    for (std::size_t other = 0; other < found.size(); ++other)
      if (other != chosen) evidence.contradicting = std::max(evidence.contradicting, found[other].members.size());
    evidence.points = matches.size();
    evidence.extent = ExtentOf(matches);
    evidence.rms = fit.residuals == 0 ? 0 : std::sqrt(2 * fit.cost / static_cast<double>(fit.residuals));
    evidence.overlap = OverlapOf(fit.first_from_second);
    LookBothWays(fit.first_from_second, evidence);
    alignment.pairs = PairsOf(tried.hypotheses, consensus);
    GiveVerdict(first_, second_, alignment);
    return alignment;
  }

  std::vector<PointMatch> MatchesOf(const std::vector<Hypothesis>& hypotheses, const Consensus& consensus) const {
    std::vector<PointMatch> matches;
    std::set<std::pair<std::uint32_t, std::uint32_t>> taken;
    for (const std::uint32_t member : consensus.members)
      for (const PointMatch& match : hypotheses[member].inliers)
        if (taken.emplace(match.first.point, match.second.point).second) matches.push_back(match);
    return matches;
  }

  // Matches of every keyframe of either map with what the nearest keyframes of the other see.
  std::vector<PointMatch> SearchEverywhere(const Similarity3d& first_from_second) const {
    std::vector<std::vector<PointMatch>> found(second_.views().size());
    ParallelFor(found.size(), 4, options_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t view = begin; view < end; ++view) {
        if (second_.views()[view].right) continue;
        const auto number = static_cast<std::uint32_t>(view);
        const LocalMap own = MakeLocalMap(second_, second_nodes_, number, 0);
        for (const std::uint32_t near : NearestViews(first_from_second, number)) {
          const LocalMap other = MakeLocalMap(first_, first_nodes_, near, 0);
          const auto matches = SearchByTransform(pair_, other, std::array{near}, own, std::array{number},
                                                 first_from_second, kGlobalRadius);
          for (const PointMatch& match : matches)
            if (pair_.geometry.IsInlier(match, first_from_second)) found[view].push_back(match);
        }
      }
    });
    std::vector<PointMatch> matches;
    std::set<std::pair<std::uint32_t, std::uint32_t>> taken;
    for (const std::vector<PointMatch>& of_view : found)
      for (const PointMatch& match : of_view)
        if (taken.emplace(match.first.point, match.second.point).second) matches.push_back(match);
    return matches;
  }

  // Left views of the first map nearest to one of the second, that look the same way.
  std::vector<std::uint32_t> NearestViews(const Similarity3d& first_from_second, std::uint32_t second) const {
    const View& view = second_.views()[second];
    const Eigen::Vector3d center = first_from_second * view.center;
    const Eigen::Vector3d axis = first_from_second.rotation * view.rotation.row(2).transpose();
    std::vector<std::pair<double, std::uint32_t>> near;
    for (std::uint32_t row = 0; row < first_.views().size(); ++row) {
      const View& other = first_.views()[row];
      if (!other.right && other.rotation.row(2).dot(axis) > 0.5)
        near.emplace_back((other.center - center).squaredNorm(), row);
    }
    const std::size_t count = std::min(kNearestViews, near.size());
    std::ranges::partial_sort(near, near.begin() + static_cast<std::ptrdiff_t>(count));
    std::vector<std::uint32_t> views;
    for (std::size_t i = 0; i < count; ++i) views.push_back(near[i].second);
    return views;
  }

  double OverlapOf(const Similarity3d& first_from_second) const {
    std::size_t near = 0, all = 0;
    for (std::uint32_t row = 0; row < second_.views().size(); ++row) {
      const View& view = second_.views()[row];
      if (view.right) continue;
      ++all;
      const Eigen::Vector3d center = first_from_second * view.center;
      const Eigen::Vector3d axis = first_from_second.rotation * view.rotation.row(2).transpose();
      near += std::ranges::any_of(first_.views(), [&](const View& other) {
        return !other.right && other.rotation.row(2).dot(axis) > kNearCosine &&
               (other.center - center).norm() < kNearView * first_.median_depth();
      });
    }
    return all == 0 ? 0 : static_cast<double>(near) / static_cast<double>(all);
  }

  // The second axis of the ellipsoid of the matched points, in median depths.
  double ExtentOf(const std::vector<PointMatch>& matches) const {
    if (matches.size() < 3 || !(first_.median_depth() > 0)) return 0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const PointMatch& match : matches) mean += first_.points()[match.first.point].position;
    mean /= static_cast<double>(matches.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const PointMatch& match : matches) {
      const Eigen::Vector3d offset = first_.points()[match.first.point].position - mean;
      spread += offset * offset.transpose();
    }
    spread /= static_cast<double>(matches.size());
    return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues()[1])) /
           first_.median_depth();
  }

  // A map with few features in its pictures explains little of a rich one, so the better direction counts.
  void LookBothWays(const Similarity3d& first_from_second, AlignmentEvidence& evidence) const {
    const SeenShare in_first = LookFor(second_, first_, first_from_second, options_.threads);
    const SeenShare in_second = LookFor(first_, second_, first_from_second.Inverse(), options_.threads);
    evidence.found_share = std::max(in_first.found_share(), in_second.found_share());
    evidence.cell_share = std::max(in_first.cell_share(), in_second.cell_share());
    evidence.front_share = std::max(in_first.front_share(), in_second.front_share());
    evidence.views = in_first.views + in_second.views;
    evidence.agreeing_views = in_first.agreeing_views + in_second.agreeing_views;
  }

  std::vector<AlignedPair> PairsOf(const std::vector<Hypothesis>& hypotheses, const Consensus& consensus) const {
    std::vector<AlignedPair> pairs;
    for (const std::uint32_t member : consensus.members) {
      const Hypothesis& hypothesis = hypotheses[member];
      pairs.push_back({first_.KeyFrameOf(first_.views()[hypothesis.candidate.first]).id,
                       second_.KeyFrameOf(second_.views()[hypothesis.candidate.second]).id, hypothesis.inliers.size()});
    }
    std::ranges::stable_sort(pairs, std::greater(), &AlignedPair::inliers);
    return pairs;
  }

  const AlignOptions& options_;
  const MapViews first_, second_;
  const CommonWords words_;
  const NodeTable first_nodes_, second_nodes_;
  const MapPair pair_;
};

}  // namespace
}  // namespace detail

Alignment AlignMaps(const Atlas& first, std::size_t first_map, const Atlas& second, std::size_t second_map,
                    const AlignOptions& options) {
  return detail::Aligner(first, first_map, second, second_map, options).Run();
}

}  // namespace slamdb
