// SPDX-License-Identifier: BSD-3-Clause
// 1. Points of both maps that may match: all, or by node of the vocabulary.
// 2. The distances between all of them.
// 3. Pairs that are the least of their row and of their column, without rivals in either.
#include "slamdb/align/detail/match_points.h"

#include <algorithm>
#include <span>

#include "slamdb/align/detail/distance_table.h"

namespace slamdb::detail {
namespace {

constexpr int kRivalPercent = 85;    // a second one is a rival if the best is not below so much of its distance
constexpr double kSamePlace = 0.02;  // of the median depth: nearer ones are one thing

using Rows = std::vector<std::uint32_t>;
std::vector<Bits> BitsOfRows(const LocalMap& local, const Rows& rows) {
  std::vector<Bits> bits;
  for (const std::uint32_t row : rows) bits.push_back(BitsOf(local.descriptors[row]));
  return bits;
}

class GroupMatcher {
 public:
  GroupMatcher(const MapViews& first, const LocalMap& first_local, const MapViews& second, const LocalMap& second_local)
      : first_(first), second_(second), first_local_(first_local), second_local_(second_local) {}

  void Match(const Rows& rows, const Rows& columns, std::vector<PointMatch>& matches) const {
    if (rows.empty() || columns.empty()) return;
    const DistanceTable table(BitsOfRows(first_local_, rows), BitsOfRows(second_local_, columns));
    std::vector<std::uint32_t> best_row(columns.size(), 0);
    for (std::uint32_t row = 1; row < rows.size(); ++row)
      for (std::size_t column = 0; column < columns.size(); ++column)
        if (table(row, column) < table(best_row[column], column)) best_row[column] = row;
    for (std::uint32_t row = 0; row < rows.size(); ++row) {
      const std::uint16_t* begin = table.Row(row);
      const auto column = static_cast<std::size_t>(std::min_element(begin, begin + columns.size()) - begin);
      if (begin[column] > kMostBits || best_row[column] != row) continue;
      const auto along_row = [&](std::size_t i) { return table(row, i); };
      const auto along_column = [&](std::size_t i) { return table(i, column); };
      if (HasRival(second_, second_local_, columns, column, along_row)) continue;
      if (HasRival(first_, first_local_, rows, row, along_column)) continue;
      matches.push_back({first_local_.points[rows[row]], second_local_.points[columns[column]]});
    }
  }

 private:
  template <class Distance>
  static bool HasRival(const MapViews& map, const LocalMap& local, const Rows& rows, std::size_t best,
                       const Distance& distance_of) {
    const auto position = [&](std::size_t i) -> const Eigen::Vector3d& {
      return map.points()[local.points[rows[i]].point].position;
    };
    const double near = kSamePlace * map.median_depth();
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (i != best && distance_of(i) * kRivalPercent <= distance_of(best) * 100 &&
          (position(i) - position(best)).squaredNorm() > near * near)
        return true;
    return false;
  }

  const MapViews &first_, &second_;
  const LocalMap &first_local_, &second_local_;
};

Rows AllRows(const LocalMap& local) {
  Rows rows(local.points.size());
  for (std::uint32_t i = 0; i < rows.size(); ++i) rows[i] = i;
  return rows;
}

// Rows by node, those without one left out.
Rows ByNode(const LocalMap& local) {
  Rows rows = AllRows(local);
  std::erase_if(rows, [&](std::uint32_t row) { return local.nodes[row] == LocalMap::kNoNode; });
  std::ranges::stable_sort(rows, {}, [&](std::uint32_t row) { return local.nodes[row]; });
  return rows;
}

}  // namespace

std::vector<PointMatch> MatchPoints(const MapViews& first, const LocalMap& first_local, const MapViews& second,
                                    const LocalMap& second_local, Search search) {
  std::vector<PointMatch> matches;
  const GroupMatcher matcher(first, first_local, second, second_local);
  if (search == Search::kAll) {
    matcher.Match(AllRows(first_local), AllRows(second_local), matches);
    return matches;
  }
  const Rows rows = ByNode(first_local), columns = ByNode(second_local);
  const auto node_of_row = [&](std::uint32_t row) { return first_local.nodes[row]; };
  const auto node_of_column = [&](std::uint32_t row) { return second_local.nodes[row]; };
  for (auto at = rows.begin(); at != rows.end();) {
    const std::uint32_t node = node_of_row(*at);
    const auto end = std::ranges::upper_bound(at, rows.end(), node, {}, node_of_row);
    const auto begin = std::ranges::lower_bound(columns, node, {}, node_of_column),
               finish = std::ranges::upper_bound(columns, node, {}, node_of_column);
    matcher.Match(Rows(at, end), Rows(begin, finish), matches);
    at = end;
  }
  return matches;
}

}  // namespace slamdb::detail
