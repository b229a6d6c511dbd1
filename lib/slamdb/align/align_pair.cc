// SPDX-License-Identifier: BSD-3-Clause
// 1. Places of the second map are recognised in the first, the most alike first.
// 2. Each is matched and verified by itself, until enough of them agree.
// 3. All their matches together give the transform, which then finds more matches all over the maps.
// 4. The pictures of each map are held against the points of the other, and the verdict is given.
// What is not sure after an early stop is looked at once more with every candidate and every pair of points.
#include "slamdb/align/detail/align_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "slamdb/align/detail/candidates.h"
#include "slamdb/align/detail/consensus.h"
#include "slamdb/align/detail/decide.h"
#include "slamdb/align/detail/evidence.h"
#include "slamdb/align/detail/global_fit.h"
#include "slamdb/align/detail/hypothesis.h"
#include "slamdb/base/detail/parallel.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kBatch = 8;            // candidates between two looks at whether enough agree
constexpr std::size_t kEnoughKeyframes = 8;  // of the second map, that agree: the rest is not tried at first
constexpr std::size_t kConsensusesTried = 3;
constexpr std::size_t kFewestOfRival = 2;  // pairs of keyframes that agree on another transform
constexpr double kElsewhereTurn = 15 * std::numbers::pi / 180;
constexpr double kElsewhereShift = 0.5;  // of the first map's median depth

struct Tried {
  std::vector<Hypothesis> hypotheses;
  std::size_t candidates = 0;
};

class Aligner {
 public:
  Aligner(const PreparedMap& first, const PreparedMap& second, bool own_vocabulary, const AlignOptions& options)
      : options_(options),
        own_vocabulary_(own_vocabulary),
        pair_{first, second, PairGeometry(first.views, second.views)},
        candidates_(FindCandidates(first.index, first.groups, second.bags, options.threads)) {}

  Alignment Run() const {
    Alignment quick = Decide(Try(Search::kNodes, /*stop_early=*/true));
    if (quick.verdict == AlignmentVerdict::kAligned) return quick;
    return Decide(Try(Search::kAll, /*stop_early=*/false));
  }

 private:
  Tried Try(Search search, bool stop_early) const {
    Tried tried;
    while (tried.candidates < candidates_.size()) {
      const std::size_t begin = tried.candidates, count = std::min(kBatch, candidates_.size() - begin);
      std::array<std::optional<Hypothesis>, kBatch> batch;
      ParallelFor(count, 1, options_.threads, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) batch[i] = TryCandidate(pair_, candidates_[begin + i], search);
      });
      for (std::optional<Hypothesis>& hypothesis : batch)
        if (hypothesis) tried.hypotheses.push_back(*std::move(hypothesis));
      tried.candidates += count;
      Tell(tried.candidates);
      if (!stop_early || tried.hypotheses.size() < kEnoughKeyframes) continue;
      if (FindConsensus(pair_, tried.hypotheses).front().second_keyframes >= kEnoughKeyframes) break;
    }
    return tried;
  }

  void Tell(std::size_t done) const {
    if (options_.progress)
      options_.progress("comparing places", static_cast<double>(done) / static_cast<double>(candidates_.size()));
  }

  static bool HasFeatures(const MapViews& map) {
    return std::ranges::any_of(map.views(), [](const View& view) { return !view.descriptors.empty(); });
  }

  // The verdict over the best consensus, or over the next ones where it is refused.
  Alignment Decide(const Tried& tried) const {
    const std::vector<Consensus> found = FindConsensus(pair_, tried.hypotheses);
    Alignment best = NothingAgrees();
    if (!HasFeatures(pair_.first.views) || !HasFeatures(pair_.second.views))
      best.reason =
          "one of the maps has no keypoints with ORB descriptors, as trajectories have none, and maps of SIFT or "
          "SuperPoint";
    std::size_t judged = 0;
    while (judged < std::min(found.size(), kConsensusesTried)) {
      Alignment alignment = Judge(tried, found, judged);
      if (judged++ == 0 || alignment.verdict < best.verdict) best = std::move(alignment);
      if (best.verdict != AlignmentVerdict::kNoOverlap) break;
    }
    if (best.verdict == AlignmentVerdict::kAligned) HoldAgainstRivals(tried, found, judged, best);
    best.evidence.own_vocabulary = own_vocabulary_;
    best.evidence.candidates = tried.candidates;
    return best;
  }

  // Where walls repeat, pictures confirm more than one transform, whichever more pairs of keyframes happen to agree on.
  // Those before `judged` are the best one, or refused.
  void HoldAgainstRivals(const Tried& tried, const std::vector<Consensus>& found, std::size_t judged,
                         Alignment& best) const {
    for (std::size_t i = judged; i < std::min(found.size(), kConsensusesTried); ++i) {
      if (found[i].members.size() < kFewestOfRival) continue;
      const Alignment rival = Judge(tried, found, i);
      if (!IsElsewhere(*rival.first_from_second, best) || !PicturesConfirm(rival.evidence)) continue;
      best.verdict = AlignmentVerdict::kDoubtful;
      best.reason = "the pictures confirm another transform as well: the place may repeat itself";
      return;
    }
  }

  // By more than what maps are bent by.
  bool IsElsewhere(const Similarity3d& rival, const Alignment& best) const {
    const Similarity3d& own = *best.first_from_second;
    const Eigen::Vector3d in_second = own.Inverse() * best.center;
    return own.rotation.angularDistance(rival.rotation) > kElsewhereTurn ||
           (rival * in_second - best.center).norm() > kElsewhereShift * pair_.first.views.median_depth();
  }

  Alignment Judge(const Tried& tried, const std::vector<Consensus>& found, std::size_t chosen) const {
    const Consensus& consensus = found[chosen];
    const GlobalFit global = FitEverywhere(pair_, tried.hypotheses, consensus, options_.threads);
    Alignment alignment{.first_from_second = global.fit.first_from_second,
                        .scale_is_free = pair_.geometry.freedom() == Freedom::kSimilarity,
                        .covariance = global.fit.covariance,
                        .center = global.fit.center,
                        .evidence = EvidenceFor(pair_, global, options_.threads),
                        .pairs = PairsOf(tried.hypotheses, consensus),
                        .matches = MatchesOf(global)};
    alignment.evidence.agreeing = consensus.members.size();
    alignment.evidence.keyframes = consensus.second_keyframes;
    for (std::size_t other = 0; other < found.size(); ++other)
      if (other != chosen)
        alignment.evidence.contradicting =
            std::max<std::uint64_t>(alignment.evidence.contradicting, found[other].members.size());
    GiveVerdict(alignment);
    return alignment;
  }

  std::vector<AlignedPair> PairsOf(const std::vector<Hypothesis>& hypotheses, const Consensus& consensus) const {
    std::vector<AlignedPair> pairs;
    for (const std::uint32_t member : consensus.members) {
      const auto& [candidate, transform, inliers] = hypotheses[member];
      const View &first = pair_.first.views.views()[candidate.first],
                 &second = pair_.second.views.views()[candidate.second];
      pairs.push_back({pair_.first.views.KeyFrameOf(first).id, pair_.second.views.KeyFrameOf(second).id, inliers.size(),
                       BetweenCameras(first, second, transform)});
    }
    std::ranges::stable_sort(pairs, std::greater(), &AlignedPair::inliers);
    return pairs;
  }

  std::vector<MatchedPoints> MatchesOf(const GlobalFit& global) const {
    std::vector<MatchedPoints> matches;
    const auto id = [](const MapViews& map, std::uint32_t point) {
      return map.map().points[map.points()[point].row].id;
    };
    for (const PointMatch& match : global.matches) {
      const MatchErrors errors = pair_.geometry.ErrorsOf(match, global.fit.first_from_second);
      matches.push_back({id(pair_.first.views, match.first.point), id(pair_.second.views, match.second.point),
                         static_cast<float>(std::sqrt(std::max(errors.in_first, errors.in_second)))});
    }
    return matches;
  }

  const AlignOptions& options_;
  const bool own_vocabulary_;
  const MapPair pair_;
  const std::vector<Candidate> candidates_;
};

}  // namespace

Alignment AlignPair(const PreparedMap& first, const PreparedMap& second, bool own_vocabulary,
                    const AlignOptions& options) {
  return Aligner(first, second, own_vocabulary, options).Run();
}

}  // namespace slamdb::detail
