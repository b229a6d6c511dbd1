// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/detail/chains.h"

#include <algorithm>
#include <compare>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace slamdb::detail {
namespace {

using Link = RevisionChain::Link;

// How many links of each chain are of one line.
struct Split {
  std::size_t first = 0, second = 0;
};

// Behind the last link that both have by number and hash.
Split SplitByNumber(const std::vector<Link>& first, const std::vector<Link>& second) {
  Split split;
  for (std::size_t i = 0, j = 0; i < first.size() && j < second.size();) {
    const auto order = first[i].number <=> second[j].number;
    if (order == 0 && first[i].hash == second[j].hash) split = {i + 1, j + 1};
    i += order <= 0 ? 1 : 0;
    j += order >= 0 ? 1 : 0;
  }
  return split;
}

// And behind the last of one hash that both have since: that with the most before it in both, as a hash comes again
// when a revision is restored.
Split SplitByHash(const std::vector<Link>& first, const std::vector<Link>& second, const Split& since) {
  std::unordered_map<std::uint64_t, std::size_t> last;  // in the second
  for (std::size_t j = since.second; j < second.size(); ++j) last[second[j].hash] = j;
  Split split = since;
  for (std::size_t i = since.first; i < first.size(); ++i) {
    const auto found = last.find(first[i].hash);
    if (found == last.end()) continue;
    const auto before = [&](const Split& at) { return std::min(at.first - since.first, at.second - since.second); };
    const Split here{i + 1, found->second + 1};
    if (before(here) >= before(split)) split = here;
  }
  return split;
}

// The first link from `begin` on that was made of the newest one of the other chain; the chain's size: none. What was
// made of a content that both had before, as a restored one has it, was not made of that.
std::size_t FirstMadeOf(const std::vector<Link>& other, const std::vector<Link>& in, std::size_t begin) {
  const std::uint64_t hash = other.back().hash;
  const auto common_end = in.begin() + static_cast<std::ptrdiff_t>(begin);
  if (hash == 0 || std::ranges::find(in.begin(), common_end, hash, &Link::hash) != common_end) return in.size();
  while (begin < in.size() && in[begin].from_hash != hash) ++begin;
  return begin;
}

}  // namespace

Compared Compare(const RevisionChain& first, const RevisionChain& second) {
  using enum Compared::State;
  const auto& [of_first, of_second] = std::tie(first.links, second.links);
  const Split split = SplitByHash(of_first, of_second, SplitByNumber(of_first, of_second));
  const bool first_went_on = split.first < of_first.size(), second_went_on = split.second < of_second.size();
  if (!first_went_on && !second_went_on) return {};
  if (!first_went_on) return {kFirstBehind, split.second};
  if (!second_went_on) return {kSecondBehind, split.first};
  if (const std::size_t made = FirstMadeOf(of_first, of_second, split.second); made < of_second.size())
    return {kFirstBehind, made};
  if (const std::size_t made = FirstMadeOf(of_second, of_first, split.first); made < of_first.size())
    return {kSecondBehind, made};
  return {kDiverged, split.first};
}

std::uint64_t NumberOf(const RevisionChain& chain, const RevisionChain::Link& link) {
  std::uint64_t number = 0;
  for (const Link& each : chain.links)
    if (each.hash == link.hash && number != link.number) number = each.number;
  return number;
}

std::uint64_t HashOf(const RevisionChain& chain, std::uint64_t number) {
  const auto found = std::ranges::find(chain.links, number, &Link::number);
  return found == chain.links.end() ? 0 : found->hash;
}

RevisionChain TakeChain(std::vector<RevisionChain>& chains, const std::string& name) {
  const auto found = std::ranges::lower_bound(chains, name, {}, &RevisionChain::name);
  if (found == chains.end() || found->name != name) return {.name = name};
  return std::exchange(*found, {.name = name});
}

}  // namespace slamdb::detail
