// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/spanning_tree.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <vector>

#include "slamdb/model/index.h"

namespace slamdb {
namespace {

void EraseChild(KeyFrame& keyframe, KeyFrameId child) { std::erase(keyframe.children, child); }

void AddChild(KeyFrame& keyframe, KeyFrameId child) {
  if (std::ranges::find(keyframe.children, child) == keyframe.children.end()) keyframe.children.push_back(child);
}

// Which keyframes hang on the root, by row: each chain of parents is followed until it meets what is known.
std::vector<std::uint8_t> RowsInTree(const Map& map, const IdTable& rows, std::uint32_t root) {
  enum : std::uint8_t { kUnknown, kOnChain, kOutside, kInside };
  std::vector<std::uint8_t> state(map.keyframes.size(), kUnknown);
  state[root] = kInside;
  std::vector<std::uint32_t> chain;
  for (std::uint32_t start = 0; start < map.keyframes.size(); ++start) {
    chain.clear();
    std::uint32_t row = start;
    while (row != kNoRow && state[row] == kUnknown) {
      state[row] = kOnChain;
      chain.push_back(row);
      row = rows.Find(map.keyframes[row].parent.value());
    }
    const std::uint8_t end = row != kNoRow && state[row] == kInside ? kInside : kOutside;
    for (const std::uint32_t member : chain) state[member] = end;
  }
  for (std::uint8_t& each : state) each = each == kInside;
  return state;
}

// Grows the tree by one orphan at a time, the strongest covisibility first; equal ones by row, so that the outcome does
// not depend on anything else.
class Adoption {
 public:
  Adoption(Map& map, const IdTable& rows, std::uint32_t root)
      : map_(map), rows_(rows), root_(root), inside_(RowsInTree(map, rows, root)) {}

  std::size_t Run() {
    for (std::uint32_t row = 0; row < inside_.size(); ++row)
      if (!inside_[row]) Offer(row);
    const std::size_t orphans = static_cast<std::size_t>(std::ranges::count(inside_, 0));
    for (std::size_t left = orphans; left > 0; --left) {
      if (!AdoptStrongest()) AdoptByTime();
    }
    return orphans;
  }

 private:
  // Pairs (weight, orphan, parent); the greatest weight, then the lowest rows, comes out first.
  using Pair = std::tuple<std::int32_t, std::int64_t, std::int64_t>;

  // Everything in the tree that is covisible with an orphan, from either side.
  void Offer(std::uint32_t orphan) {
    for (const Connection& connection : map_.keyframes[orphan].connections) {
      const std::uint32_t other = rows_.Find(connection.keyframe.value());
      if (other == kNoRow || other == orphan) continue;
      neighbours_[orphan].push_back({other, connection.weight});
      neighbours_[other].push_back({orphan, connection.weight});
      if (inside_[other]) pairs_.emplace(connection.weight, -std::int64_t{orphan}, -std::int64_t{other});
    }
  }

  bool AdoptStrongest() {
    while (!pairs_.empty()) {
      const auto [weight, orphan, parent] = pairs_.top();
      pairs_.pop();
      if (inside_[static_cast<std::size_t>(-orphan)]) continue;
      Adopt(static_cast<std::uint32_t>(-orphan), static_cast<std::uint32_t>(-parent));
      return true;
    }
    return false;
  }

  // The earliest orphan, on the keyframe of the tree that was made last before it, or on the root.
  void AdoptByTime() {
    std::uint32_t orphan = kNoRow, parent = kNoRow;
    for (std::uint32_t row = 0; row < inside_.size(); ++row)
      if (!inside_[row] && (orphan == kNoRow || map_.keyframes[row].id < map_.keyframes[orphan].id)) orphan = row;
    for (std::uint32_t row = 0; row < inside_.size(); ++row) {
      if (!inside_[row] || !(map_.keyframes[row].id < map_.keyframes[orphan].id)) continue;
      if (parent == kNoRow || map_.keyframes[parent].id < map_.keyframes[row].id) parent = row;
    }
    Adopt(orphan, parent == kNoRow ? root_ : parent);
  }

  void Adopt(std::uint32_t row, std::uint32_t parent) {
    KeyFrame& child = map_.keyframes[row];
    if (const std::uint32_t old = rows_.Find(child.parent.value()); old != kNoRow)
      EraseChild(map_.keyframes[old], child.id);
    child.parent = map_.keyframes[parent].id;
    child.first_connection = false;
    AddChild(map_.keyframes[parent], child.id);
    inside_[row] = 1;
    for (const auto& [other, weight] : neighbours_[row])
      if (!inside_[other]) pairs_.emplace(weight, -std::int64_t{other}, -std::int64_t{row});
  }

  struct Neighbour {
    std::uint32_t row;
    std::int32_t weight;
  };

  Map& map_;
  const IdTable& rows_;
  const std::uint32_t root_;
  std::vector<std::uint8_t> inside_;
  std::vector<std::vector<Neighbour>> neighbours_ = std::vector<std::vector<Neighbour>>(inside_.size());
  std::priority_queue<Pair> pairs_;
};

// Lists of children hold exactly those who say so, in the order they had; missing ones at the end.
void MakeChildrenAgree(Map& map, const IdTable& rows) {
  for (KeyFrame& keyframe : map.keyframes)
    std::erase_if(keyframe.children, [&](KeyFrameId child) {
      const std::uint32_t row = rows.Find(child.value());
      return row == kNoRow || map.keyframes[row].parent != keyframe.id;
    });
  for (const KeyFrame& keyframe : map.keyframes)
    if (const std::uint32_t parent = rows.Find(keyframe.parent.value()); parent != kNoRow)
      AddChild(map.keyframes[parent], keyframe.id);
}

}  // namespace

void RerootTree(Map& map, KeyFrameId root) {
  const IdTable rows = KeyFrameTable(map);
  std::uint32_t row = rows.Find(root.value());
  KeyFrameId new_parent;  // none for the root itself
  for (std::size_t steps = 0; row != kNoRow && steps < map.keyframes.size(); ++steps) {
    KeyFrame& keyframe = map.keyframes[row];
    const KeyFrameId old_parent = keyframe.parent;
    keyframe.parent = new_parent;
    if (const std::uint32_t parent = rows.Find(new_parent.value()); parent != kNoRow)
      AddChild(map.keyframes[parent], keyframe.id);
    row = rows.Find(old_parent.value());
    if (row != kNoRow) EraseChild(map.keyframes[row], keyframe.id);
    new_parent = keyframe.id;
  }
}

std::size_t AdoptOrphans(Map& map) {
  const IdTable rows = KeyFrameTable(map);
  const std::uint32_t root = rows.Find(map.first_keyframe.value());
  if (root == kNoRow) return 0;
  KeyFrame& first = map.keyframes[root];
  if (const std::uint32_t parent = rows.Find(first.parent.value()); parent != kNoRow)
    EraseChild(map.keyframes[parent], first.id);
  first.parent = {};
  const std::size_t adopted = Adoption(map, rows, root).Run();
  MakeChildrenAgree(map, rows);
  return adopted;
}

}  // namespace slamdb
