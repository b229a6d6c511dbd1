// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/pictures/detail/spread.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>

namespace slamdb::detail {
namespace {

struct Leaf {
  double left, top, width, height;
  std::vector<std::size_t> corners;  // rows
};

std::array<Leaf, 4> Divide(const Leaf& leaf, std::span<const Corner> corners) {
  const double width = leaf.width / 2, height = leaf.height / 2;
  std::array<Leaf, 4> parts;
  for (std::size_t part = 0; part < parts.size(); ++part)
    parts[part] = {leaf.left + (part % 2 == 1 ? width : 0), leaf.top + (part / 2 == 1 ? height : 0), width, height, {}};
  for (const std::size_t row : leaf.corners) {
    const std::size_t right = corners[row].x >= leaf.left + width ? 1 : 0;
    const std::size_t below = corners[row].y >= leaf.top + height ? 2 : 0;
    parts[right + below].corners.push_back(row);
  }
  return parts;
}

// Roots that are about square.
std::vector<Leaf> RootsOf(std::span<const Corner> corners, int width, int height) {
  const std::size_t count = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(double(width) / height)));
  const double each = static_cast<double>(width) / static_cast<double>(count);
  std::vector<Leaf> roots;
  for (std::size_t i = 0; i < count; ++i) roots.push_back({each * static_cast<double>(i), 0, each, double(height), {}});
  for (std::size_t row = 0; row < corners.size(); ++row)
    roots[std::min(count - 1, static_cast<std::size_t>(corners[row].x / each))].corners.push_back(row);
  return roots;
}

}  // namespace

std::vector<std::size_t> SpreadCorners(std::span<const Corner> corners, int width, int height, std::size_t count) {
  if (corners.empty() || count == 0) return {};
  std::vector<Leaf> leaves = RootsOf(corners, width, height);
  std::erase_if(leaves, [](const Leaf& leaf) { return leaf.corners.empty(); });
  using Full = std::pair<std::size_t, std::size_t>;  // corners, row of `leaves`
  std::priority_queue<Full> full;
  for (std::size_t row = 0; row < leaves.size(); ++row) full.emplace(leaves[row].corners.size(), row);
  while (!full.empty() && full.top().first > 1 && leaves.size() < count) {
    const std::size_t row = full.top().second;
    full.pop();
    if (leaves[row].width < 1 && leaves[row].height < 1) continue;  // its corners are in one pixel
    bool first = true;
    for (Leaf& part : Divide(leaves[row], corners)) {
      if (part.corners.empty()) continue;
      const std::size_t at = first ? row : leaves.size();
      full.emplace(part.corners.size(), at);
      if (first) leaves[row] = std::move(part);
      if (!first) leaves.push_back(std::move(part));
      first = false;
    }
  }
  std::vector<std::size_t> kept;
  for (const Leaf& leaf : leaves)
    kept.push_back(*std::ranges::max_element(leaf.corners, {}, [&](std::size_t row) { return corners[row].response; }));
  std::ranges::sort(kept);
  return kept;
}

}  // namespace slamdb::detail
