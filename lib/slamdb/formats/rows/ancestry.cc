// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/ancestry.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <unordered_map>

namespace slamdb::rows {
namespace {

using Row = std::size_t;  // of the list of all revisions

// The revisions that others were made of, and how many lie behind each.
class Ancestry {
 public:
  explicit Ancestry(const std::vector<RevisionOf>& all) : all_(all), parents_(all.size()), depths_(all.size()) {
    for (Row row = 0; row < all.size(); ++row) {
      rows_.emplace(std::pair(all[row].atlas, all[row].number), row);
      by_content_[all[row].hash].push_back(row);
    }
    for (Row row = 0; row < all.size(); ++row) Link(row);
    std::vector<Row> restored;
    for (Row row = 0; row < all.size(); ++row)
      if (IsRestored(row)) restored.push_back(row);
    for (const Row row : restored) std::erase(parents_[row], row - 1);
    depths_.assign(all.size(), 0);
  }

  std::optional<Row> Find(const Named& named) const {
    const auto found = rows_.find({named.name, named.number});
    return found == rows_.end() ? std::nullopt : std::optional(found->second);
  }

  // A revision and all that it was made of, parents before what was made of them.
  std::vector<Row> Of(Row self) {
    std::vector<Row> order;
    std::vector<std::pair<Row, std::size_t>> open = {{self, 0}};  // and its next parent
    std::set<Row> seen = {self};
    while (!open.empty()) {
      auto& [row, next] = open.back();
      if (next < parents_[row].size()) {
        const Row parent = parents_[row][next++];
        if (seen.insert(parent).second) open.emplace_back(parent, 0);
        continue;
      }
      for (const Row parent : parents_[row]) depths_[row] = std::max(depths_[row], depths_[parent] + 1);
      order.push_back(row);
      open.pop_back();
    }
    return order;
  }

  // The longest way to a revision that was made of none. Known of what Of has walked.
  std::size_t DepthOf(Row row) const { return depths_[row]; }

 private:
  bool HasOneBefore(Row row) const { return row > 0 && all_[row - 1].atlas == all_[row].atlas; }

  void Link(Row row) {
    if (HasOneBefore(row)) parents_[row].push_back(row - 1);
    const std::optional<Row> source = all_[row].from ? SourceOf(row) : std::nullopt;
    if (source && std::ranges::find(parents_[row], *source) == parents_[row].end()) parents_[row].push_back(*source);
  }

  // Whether it is again what the one before was made of, and so not made of that one.
  bool IsRestored(Row row) {
    const RevisionOf& of = all_[row];
    if (!of.from || !HasOneBefore(row) || of.hash != static_cast<std::int64_t>(of.from->hash)) return false;
    if (of.from->atlas == of.atlas) return true;  // of an earlier one, which may be given up
    const std::vector<Row> behind = Of(row - 1);
    const auto is_source = [&](Row other) { return other != row && all_[other].hash == of.hash; };
    return std::ranges::any_of(behind, is_source);
  }

  // That of the name and number, or, where it has got another one since, of its content.
  std::optional<Row> SourceOf(Row row) const {
    const RevisionName& from = *all_[row].from;
    const auto hash = static_cast<std::int64_t>(from.hash);
    const auto named = rows_.find({from.atlas, static_cast<std::int64_t>(from.number)});
    if (named != rows_.end() && all_[named->second].hash == hash && named->second != row) return named->second;
    const auto alike = by_content_.find(hash);
    if (alike == by_content_.end()) return std::nullopt;
    const auto is_it = [&](Row other) {
      return other != row && all_[other].atlas == from.atlas && IsBefore(other, row);
    };
    const auto found = std::ranges::find_if(alike->second, is_it);
    return found == alike->second.end() ? std::nullopt : std::optional(*found);
  }

  // In an atlas of its own a revision was made of earlier ones only.
  bool IsBefore(Row other, Row row) const {
    return all_[other].atlas != all_[row].atlas || all_[other].number < all_[row].number;
  }

  const std::vector<RevisionOf>& all_;
  std::map<std::pair<std::string, std::int64_t>, Row> rows_;
  std::unordered_map<std::int64_t, std::vector<Row>> by_content_;
  std::vector<std::vector<Row>> parents_;
  std::vector<std::size_t> depths_;
};

std::set<std::string> AtlasesOf(const std::vector<RevisionOf>& all, const std::vector<Row>& rows) {
  std::set<std::string> atlases;
  for (const Row row : rows) atlases.insert(all[row].atlas);
  return atlases;
}

bool HaveCommon(const std::set<std::string>& first, const std::set<std::string>& second) {
  return std::ranges::any_of(first, [&](const std::string& name) { return second.contains(name); });
}

}  // namespace

std::optional<RevisionName> CommonBase(const std::vector<RevisionOf>& all, const Named& first, const Named& second) {
  Ancestry ancestry(all);
  const std::optional<Row> from_first = ancestry.Find(first), from_second = ancestry.Find(second);
  if (!from_first || !from_second) return std::nullopt;
  const std::vector<Row> of_first = ancestry.Of(*from_first), of_second = ancestry.Of(*from_second);
  if (!HaveCommon(AtlasesOf(all, of_first), AtlasesOf(all, of_second))) return std::nullopt;
  const std::set<Row> in_first(of_first.begin(), of_first.end());
  std::unordered_map<std::int64_t, Row> alike;  // the deepest of each content that the first comes from
  for (const Row row : of_first) {
    const auto [deepest, is_new] = alike.emplace(all[row].hash, row);
    if (!is_new && ancestry.DepthOf(row) > ancestry.DepthOf(deepest->second)) deepest->second = row;
  }
  // The pair that lies deepest on both sides, so that no other one was made of both; a revision itself before copies.
  using Rank = std::tuple<std::size_t, bool, std::size_t>;
  Rank highest;
  std::optional<Row> best;
  const auto weigh = [&](Row a, Row b) {
    const auto [low, high] = std::minmax({ancestry.DepthOf(a), ancestry.DepthOf(b)});
    const Rank rank = {low, a == b, high};
    if (best && (rank < highest || (rank == highest && all[a].history >= all[*best].history))) return;
    highest = rank;
    best = a;
  };
  for (const Row row : of_second) {
    if (in_first.contains(row)) weigh(row, row);
    if (const auto found = alike.find(all[row].hash); found != alike.end()) weigh(found->second, row);
  }
  if (!best) return std::nullopt;
  // Of that content the one that was there first.
  for (const std::vector<Row>* rows : {&of_first, &of_second})
    for (const Row row : *rows)
      if (all[row].hash == all[*best].hash && all[row].history < all[*best].history) best = row;
  const RevisionOf& base = all[*best];
  return RevisionName{base.atlas, static_cast<std::uint64_t>(base.number), static_cast<std::uint64_t>(base.hash)};
}

}  // namespace slamdb::rows
