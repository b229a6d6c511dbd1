// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/candidates.h"

#include <algorithm>

#include "slamdb/base/detail/parallel.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kGroup = 10;  // covisible keyframes that vote with one
constexpr std::size_t kPlaces = 3;  // for each picture

}  // namespace

std::vector<std::vector<std::uint32_t>> CovisibilityGroups(const MapViews& map, int threads) {
  std::vector<std::vector<std::uint32_t>> groups(map.views().size());
  ParallelFor(groups.size(), 16, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t view = begin; view < end; ++view)
      if (!map.views()[view].right) groups[view] = map.BestCovisibles(static_cast<std::uint32_t>(view), kGroup);
  });
  return groups;
}

std::vector<Candidate> BestPlaces(const std::vector<float>& scores, std::span<const std::vector<std::uint32_t>> groups,
                                  std::uint32_t second, std::size_t count) {
  std::vector<Candidate> votes;
  for (std::uint32_t view = 0; view < groups.size(); ++view) {
    if (!(scores[view] > 0)) continue;
    Candidate vote{view, second, scores[view]};
    for (const std::uint32_t neighbour : groups[view]) {
      vote.score += scores[neighbour];
      if (scores[neighbour] > scores[vote.first]) vote.first = neighbour;
    }
    votes.push_back(vote);
  }
  std::ranges::stable_sort(votes, std::greater(), &Candidate::score);
  std::vector<Candidate> best;
  for (const Candidate& vote : votes) {
    if (best.size() == count) break;
    if (std::ranges::find(best, vote.first, &Candidate::first) == best.end()) best.push_back(vote);
  }
  return best;
}

std::vector<Candidate> FindCandidates(const PlaceIndex& index, std::span<const std::vector<std::uint32_t>> groups,
                                      std::span<const BagOfWords* const> asked, int threads, const Silence& silence) {
  std::vector<std::vector<Candidate>> found(asked.size());
  ParallelFor(asked.size(), 8, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t view = begin; view < end; ++view) {
      if (asked[view] == nullptr) continue;
      std::vector<float> scores = index.Query(*asked[view]);
      if (silence) silence(static_cast<std::uint32_t>(view), scores);
      found[view] = BestPlaces(scores, groups, static_cast<std::uint32_t>(view), kPlaces);
    }
  });
  std::vector<Candidate> candidates;
  for (const std::vector<Candidate>& best : found) candidates.insert(candidates.end(), best.begin(), best.end());
  std::ranges::stable_sort(candidates, std::greater(), &Candidate::score);
  return candidates;
}

}  // namespace slamdb::detail
