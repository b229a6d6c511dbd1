// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/detail/chains.h"

#include <algorithm>
#include <compare>
#include <iterator>
#include <set>
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

Split SplitOf(const std::vector<Link>& first, const std::vector<Link>& second) {
  return SplitByHash(first, second, SplitByNumber(first, second));
}

// All links that a store ever had, as far as is known.
std::vector<Link> Whole(const RevisionChain& chain) {
  std::vector<Link> whole;
  std::ranges::merge(chain.links, chain.given_up, std::back_inserter(whole), {}, &Link::number, &Link::number);
  return whole;
}

// The first that can be read of a whole chain's links from that one on: its newest can always.
std::size_t FirstFrom(const RevisionChain& chain, const Link& link) {
  return static_cast<std::size_t>(std::ranges::lower_bound(chain.links, link.number, {}, &Link::number) -
                                  chain.links.begin());
}

// Behind the last link of the first before `of_first` that can be read in both, the other's being before `of_second`.
std::size_t BehindReadable(const RevisionChain& first, const Link& of_first, const RevisionChain& second,
                           const Link& of_second) {
  const auto before = [](const RevisionChain& chain, const Link& link) {
    return std::vector(chain.links.begin(), chain.links.begin() + static_cast<std::ptrdiff_t>(FirstFrom(chain, link)));
  };
  return SplitOf(before(first, of_first), before(second, of_second)).first;
}

}  // namespace

Compared Compare(const RevisionChain& first, const RevisionChain& second) {
  using enum Compared::State;
  const std::vector<Link> of_first = Whole(first), of_second = Whole(second);
  const Split split = SplitOf(of_first, of_second);
  const bool first_went_on = split.first < of_first.size(), second_went_on = split.second < of_second.size();
  if (!first_went_on && !second_went_on) return {};
  if (!first_went_on) return {kFirstBehind, FirstFrom(second, of_second[split.second])};
  if (!second_went_on) return {kSecondBehind, FirstFrom(first, of_first[split.first])};
  if (const std::size_t made = FirstMadeOf(of_first, of_second, split.second); made < of_second.size())
    return {kFirstBehind, FirstFrom(second, of_second[made])};
  if (const std::size_t made = FirstMadeOf(of_second, of_first, split.first); made < of_first.size())
    return {kSecondBehind, FirstFrom(first, of_first[made])};
  return {kDiverged, BehindReadable(first, of_first[split.first], second, of_second[split.second])};
}

bool DependsOnGivenUp(const RevisionChain& first, const RevisionChain& second) {
  const auto is_same = [](const Link& a, const Link& b) { return a.number == b.number && a.hash == b.hash; };
  const auto [of_first, of_second] = std::ranges::mismatch(first.links, second.links, is_same);
  return of_first != first.links.end() && of_second != second.links.end();
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

std::vector<RevisionChain::Link> LinksAlone(const RevisionChain& chain, const RevisionChain& other) {
  const auto hashes_of = [](const RevisionChain& each) {
    std::set<std::uint64_t> hashes;
    for (const Link& link : Whole(each)) hashes.insert(link.hash);
    return hashes;
  };
  const std::set<std::uint64_t> own = hashes_of(chain), others = hashes_of(other);
  std::vector<Link> alone;
  bool is_merged = false;  // into what both have
  for (auto link = chain.links.rbegin(); link != chain.links.rend(); ++link) {
    const bool is_restored = link->from_hash == link->hash;  // which takes back what is before it
    if (others.contains(link->hash))
      is_merged = !is_restored && (own.contains(link->from_hash) || others.contains(link->from_hash));
    else if (!is_merged)
      alone.push_back(*link);
  }
  std::ranges::reverse(alone);
  return alone;
}

RevisionChain* FindChain(std::vector<RevisionChain>& chains, const std::string& name) {
  const auto found = std::ranges::lower_bound(chains, name, {}, &RevisionChain::name);
  return found == chains.end() || found->name != name ? nullptr : &*found;
}

RevisionChain TakeChain(std::vector<RevisionChain>& chains, const std::string& name) {
  RevisionChain* const found = FindChain(chains, name);
  return found == nullptr ? RevisionChain{.name = name} : std::exchange(*found, {.name = name});
}

}  // namespace slamdb::detail
