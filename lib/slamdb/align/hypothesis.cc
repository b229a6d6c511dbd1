// SPDX-License-Identifier: BSD-3-Clause
// 1. Descriptors of the two local maps are matched, and a transform sought on which many matches agree (RANSAC).
// 2. It is refined, and more matches are sought where it says that they are; twice, with a smaller radius.
// 3. What is left must be enough.
#include "slamdb/align/detail/hypothesis.h"

#include <algorithm>
#include <array>
#include <unordered_set>

#include "slamdb/align/detail/visibility.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kFewestToSolve = 8, kFewestToKeep = 15;
constexpr std::array kRadii = {8.0, 4.0};  // pixels at octave 0
constexpr double kLeastCosine = 0.5;       // of the angle to where a point was seen from: 60 degrees

// Best match of each point of both maps: the one with the fewest different bits.
class OneEach {
 public:
  void Offer(const PointMatch& match, int bits) { offers_.push_back({bits, match}); }

  std::vector<PointMatch> Take() {
    std::ranges::stable_sort(offers_, {}, &Offered::bits);
    std::unordered_set<std::uint32_t> first, second;
    std::vector<PointMatch> matches;
    for (const auto& [bits, match] : offers_) {
      if (first.contains(match.first.point) || second.contains(match.second.point)) continue;
      first.insert(match.first.point);
      second.insert(match.second.point);
      matches.push_back(match);
    }
    return matches;
  }

 private:
  struct Offered {
    int bits;
    PointMatch match;
  };
  std::vector<Offered> offers_;
};

// Points of `local` found in the picture, or the pictures of a fisheye pair, that `there` is about, at keypoints that
// are points of the other map.
template <class Visit>
void VisitFound(const MapViews& from, const LocalMap& local, const MapViews& to, const LocalMap& there,
                const Similarity3d& to_from_from, double radius, const Visit& visit) {
  for (std::uint32_t view = there.view; view <= to.LastViewOf(there.view); ++view)
    for (const LocalPoint& point : local.points) {
      const ViewedPoint& viewed = from.points()[point.point];
      const auto expected = Expect(to.views()[view], viewed, to_from_from, kLeastCosine);
      if (!expected) continue;
      const auto found = FindNear(to.views()[view], *expected, *viewed.descriptor, radius, kMostBits);
      if (!found) continue;
      const Sighting sighting{view, found->keypoint};
      if (const std::uint32_t other = to.PointAt(sighting); other != kNoRow)
        visit(point, LocalPoint{other, sighting}, found->bits);
    }
}

}  // namespace

std::vector<PointMatch> SearchByTransform(const MapPair& pair, const LocalMap& first, const LocalMap& second,
                                          const Similarity3d& first_from_second, double radius) {
  OneEach matches;
  VisitFound(pair.first.views, first, pair.second.views, second, first_from_second.Inverse(), radius,
             [&](const LocalPoint& own, const LocalPoint& other, int bits) {
               matches.Offer({own, other}, bits);
             });
  VisitFound(pair.second.views, second, pair.first.views, first, first_from_second, radius,
             [&](const LocalPoint& own, const LocalPoint& other, int bits) {
               matches.Offer({other, own}, bits);
             });
  return matches.Take();
}

std::optional<Hypothesis> TryCandidate(const MapPair& pair, const Candidate& candidate, Search search) {
  const LocalMap first = MakeLocalMap(pair.first, candidate.first);
  const LocalMap second = MakeLocalMap(pair.second, candidate.second);
  const std::vector<PointMatch> matches = MatchPoints(pair.first.views, first, pair.second.views, second, search);
  const std::uint64_t seed = (std::uint64_t{candidate.first} << 32) | candidate.second;
  const auto found = pair.geometry.FindTransform(matches, kFewestToSolve, seed);
  if (!found) return std::nullopt;
  Hypothesis hypothesis{candidate, *found, pair.geometry.InliersOf(matches, *found)};
  const auto refine = [&] {
    hypothesis.first_from_second =
        pair.geometry.Refine(hypothesis.inliers, hypothesis.first_from_second).first_from_second;
  };
  for (const double radius : kRadii) {
    refine();
    const auto more = SearchByTransform(pair, first, second, hypothesis.first_from_second, radius);
    hypothesis.inliers = pair.geometry.InliersOf(more, hypothesis.first_from_second);
    if (hypothesis.inliers.size() < kFewestToKeep) return std::nullopt;
  }
  refine();
  return hypothesis;
}

}  // namespace slamdb::detail
