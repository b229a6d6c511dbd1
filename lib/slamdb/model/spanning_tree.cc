// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/spanning_tree.h"

#include <algorithm>
#include <map>
#include <queue>
#include <tuple>
#include <vector>

#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

void EraseChild(KeyFrame& keyframe, KeyFrameId child) { std::erase(keyframe.children, child); }

void AddChild(KeyFrame& keyframe, KeyFrameId child) {
  if (std::ranges::find(keyframe.children, child) == keyframe.children.end()) keyframe.children.push_back(child);
}

// The rows of the parents; kNoRow for the root and for what has no parent in the map but itself. Every cycle is cut
// above its keyframe of the lowest id.
std::vector<std::uint32_t> ParentRows(const Map& map, const IdTable& rows, std::uint32_t root) {
  std::vector<std::uint32_t> parents(map.keyframes.size());
  for (std::uint32_t row = 0; row < parents.size(); ++row) {
    parents[row] = rows.Find(map.keyframes[row].parent.value());
    if (row == root || parents[row] == row) parents[row] = kNoRow;
  }
  std::vector<std::uint32_t> walk_of(parents.size(), kNoRow);  // which walk came by
  for (std::uint32_t start = 0; start < parents.size(); ++start) {
    std::uint32_t row = start;
    for (; row != kNoRow && walk_of[row] == kNoRow; row = parents[row]) walk_of[row] = start;
    if (row == kNoRow || walk_of[row] != start) continue;
    std::uint32_t lowest = row;
    for (std::uint32_t next = parents[row]; next != row; next = parents[next])
      if (map.keyframes[next].id < map.keyframes[lowest].id) lowest = next;
    parents[lowest] = kNoRow;
  }
  return parents;
}

// Grows the tree by one orphan at a time, with all that hangs on it, the strongest covisibility first; equal ones by
// row, so that the outcome does not depend on anything else.
class Adoption {
 public:
  Adoption(Map& map, const IdTable& rows, std::uint32_t root)
      : map_(map), rows_(rows), root_(root), inside_(map.keyframes.size(), 0), children_(map.keyframes.size()) {
    const std::vector<std::uint32_t> parents = ParentRows(map, rows, root);
    for (std::uint32_t row = 0; row < parents.size(); ++row) {
      if (parents[row] != kNoRow)
        children_[parents[row]].push_back(row);
      else if (row != root)
        orphans_.push_back(row);
    }
  }

  std::size_t Run() {
    if (orphans_.empty()) return 0;
    for (const std::uint32_t orphan : orphans_) ListNeighbours(orphan);
    BringIn(root_);
    std::ranges::sort(orphans_, {}, [&](std::uint32_t row) { return map_.keyframes[row].id; });
    auto next_by_id = orphans_.begin();
    for (std::size_t left = orphans_.size(); left > 0; --left) {
      if (AdoptStrongest()) continue;
      next_by_id = std::find_if(next_by_id, orphans_.end(), [&](std::uint32_t row) { return inside_[row] == 0; });
      Adopt(*next_by_id, MadeBefore(*next_by_id));
    }
    return orphans_.size();
  }

 private:
  struct Neighbour {
    std::uint32_t orphan;
    std::int32_t weight;
  };
  // Weight, orphan, parent: the greatest weight, then the lowest rows, comes out first.
  using Pair = std::tuple<std::int32_t, std::int64_t, std::int64_t>;

  void ListNeighbours(std::uint32_t orphan) {
    for (const Connection& connection : map_.keyframes[orphan].connections) {
      const std::uint32_t other = rows_.Find(connection.keyframe.value());
      if (other != kNoRow && other != orphan) neighbours_[other].push_back({orphan, connection.weight});
    }
  }

  // The keyframe and all that hangs on it are part of the tree, and may become parents.
  void BringIn(std::uint32_t top) {
    std::vector<std::uint32_t> open = {top};
    while (!open.empty()) {
      const std::uint32_t row = open.back();
      open.pop_back();
      inside_[row] = 1;
      by_id_.emplace(map_.keyframes[row].id, row);
      for (const Neighbour& neighbour : neighbours_[row])
        pairs_.emplace(neighbour.weight, -std::int64_t{neighbour.orphan}, -std::int64_t{row});
      open.insert(open.end(), children_[row].begin(), children_[row].end());
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

  // The keyframe of the tree that was made last before this one, or the root.
  std::uint32_t MadeBefore(std::uint32_t orphan) const {
    const auto after = by_id_.lower_bound(map_.keyframes[orphan].id);
    return after == by_id_.begin() ? root_ : std::prev(after)->second;
  }

  void Adopt(std::uint32_t row, std::uint32_t parent) {
    KeyFrame& child = map_.keyframes[row];
    if (const std::uint32_t old = rows_.Find(child.parent.value()); old != kNoRow)
      EraseChild(map_.keyframes[old], child.id);
    child.parent = map_.keyframes[parent].id;
    child.first_connection = false;
    AddChild(map_.keyframes[parent], child.id);
    BringIn(row);
  }

  Map& map_;
  const IdTable& rows_;
  const std::uint32_t root_;
  std::vector<std::uint8_t> inside_;
  std::vector<std::vector<std::uint32_t>> children_;  // by row, as the parents say
  std::vector<std::uint32_t> orphans_;                // tops of what hangs on no root
  std::vector<std::vector<Neighbour>> neighbours_ = std::vector<std::vector<Neighbour>>(inside_.size());
  std::map<KeyFrameId, std::uint32_t> by_id_;  // rows in the tree
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

// The keyframe and its ancestors, up to the root or to where a cycle closes.
std::vector<std::uint32_t> Ancestors(const Map& map, const IdTable& rows, KeyFrameId id) {
  std::vector<std::uint8_t> seen(map.keyframes.size(), 0);
  std::vector<std::uint32_t> chain;
  for (std::uint32_t row = rows.Find(id.value()); row != kNoRow && !seen[row];
       row = rows.Find(map.keyframes[row].parent.value())) {
    seen[row] = 1;
    chain.push_back(row);
  }
  return chain;
}

}  // namespace

void RerootTree(Map& map, KeyFrameId root) {
  const IdTable rows = KeyFrameTable(map);
  KeyFrameId new_parent;  // none for the root itself
  for (const std::uint32_t row : Ancestors(map, rows, root)) {
    KeyFrame& keyframe = map.keyframes[row];
    if (const std::uint32_t old = rows.Find(keyframe.parent.value()); old != kNoRow)
      EraseChild(map.keyframes[old], keyframe.id);
    keyframe.parent = new_parent;
    if (const std::uint32_t parent = rows.Find(new_parent.value()); parent != kNoRow) {
      AddChild(map.keyframes[parent], keyframe.id);
      keyframe.first_connection = false;
    }
    new_parent = keyframe.id;
  }
}

std::size_t AdoptOrphans(Map& map) {
  const IdTable rows = KeyFrameTable(map);
  const std::uint32_t root = rows.Find(map.first_keyframe.value());
  if (root == kNoRow) return 0;
  map.keyframes[root].parent = {};
  const std::size_t adopted = Adoption(map, rows, root).Run();
  MakeChildrenAgree(map, rows);
  return adopted;
}

}  // namespace slamdb::detail
