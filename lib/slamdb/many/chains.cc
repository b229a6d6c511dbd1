// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/detail/chains.h"

#include <algorithm>
#include <optional>
#include <unordered_set>
#include <utility>

namespace slamdb::detail {
namespace {

using Link = RevisionChain::Link;

// Where the newest revision of one chain is in another.
struct Found {
  bool is_exact = false;    // number and hash
  std::size_t missing = 0;  // the first link behind it
};

std::optional<Found> FindNewest(const std::vector<Link>& of, const std::vector<Link>& in) {
  if (of.empty()) return Found{.is_exact = true, .missing = 0};
  const Link& newest = of.back();
  std::optional<Found> by_hash, by_from;
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (in[i].hash == newest.hash && in[i].number == newest.number) return Found{.is_exact = true, .missing = i + 1};
    if (in[i].hash == newest.hash) by_hash = Found{.missing = i + 1};
    if (!by_from && in[i].from_hash != 0 && in[i].from_hash == newest.hash) by_from = Found{.missing = i};
  }
  return by_hash ? by_hash : by_from;
}

// The first link of a chain behind the last that another one has, too.
std::size_t FirstOfItsOwn(const std::vector<Link>& of, const std::vector<Link>& other) {
  std::unordered_set<std::uint64_t> hashes;
  for (const Link& link : other) hashes.insert(link.hash);
  std::size_t i = of.size();
  while (i > 0 && !hashes.contains(of[i - 1].hash)) --i;
  return i;
}

}  // namespace

Compared Compare(const RevisionChain& first, const RevisionChain& second) {
  using enum Compared::State;
  const std::optional<Found> first_in_second = FindNewest(first.links, second.links);
  const std::optional<Found> second_in_first = FindNewest(second.links, first.links);
  const auto leads = [](const std::optional<Found>& found, const std::optional<Found>& other) {
    return found && (found->is_exact || !other || !other->is_exact);
  };
  const bool behind_second = leads(first_in_second, second_in_first),
             behind_first = leads(second_in_first, first_in_second);
  const auto is_newest = [](const std::optional<Found>& found, const RevisionChain& in) {
    return found && found->missing == in.links.size();
  };
  if (behind_second && is_newest(first_in_second, second)) return {};
  if (behind_first && is_newest(second_in_first, first)) return {};
  if (behind_second != behind_first)
    return behind_second ? Compared{kFirstBehind, first_in_second->missing}
                         : Compared{kSecondBehind, second_in_first->missing};
  return {kDiverged, FirstOfItsOwn(first.links, second.links)};
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
