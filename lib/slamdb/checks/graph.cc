// SPDX-License-Identifier: BSD-3-Clause
// Graphs: the spanning tree, covisibility, loop and merge edges, and neighbours in time.
#include <algorithm>
#include <cstddef>
#include <unordered_set>

#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/observers.h"
#include "slamdb/checks/detail/visit.h"
#include "slamdb/model/detail/spanning_tree.h"

namespace slamdb::detail {
namespace {

bool Contains(const Column<KeyFrameId>& links, KeyFrameId id) { return std::ranges::find(links, id) != links.end(); }

// Files hold connections by id; in any other order they are found as well, only slower.
const Connection* FindConnection(const KeyFrame& keyframe, KeyFrameId id) {
  const auto& connections = keyframe.connections;
  const auto sorted = std::ranges::lower_bound(connections, id, {}, &Connection::keyframe);
  if (sorted != connections.end() && sorted->keyframe == id) return &*sorted;
  const auto found = std::ranges::find(connections, id, &Connection::keyframe);
  return found == connections.end() ? nullptr : &*found;
}

// Reports every edge whose other end does not have it too.
void CheckEdgesMutual(const Subject& subject, Column<KeyFrameId> KeyFrame::*edges, const char* kind,
                      Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    for (const KeyFrameId id : keyframe.*edges) {
      const KeyFrame* other = subject.index.FindKeyFrame(row, id);
      if (other != nullptr && !Contains(other->*edges, keyframe.id))
        findings.Add(PlaceOf(map, keyframe), "has a ", kind, " edge to ", id, ", which has none back");
    }
  });
}

std::size_t AddMissingEdges(Atlas& atlas, Column<KeyFrameId> KeyFrame::*edges) {
  const AtlasIndex index(atlas);
  std::size_t added = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (const KeyFrame& keyframe : atlas.maps[row].keyframes)
      for (const KeyFrameId id : keyframe.*edges) {
        const std::uint32_t other = index.KeyFrameRow(row, id);
        if (other == kNoRow || id == keyframe.id) continue;
        Column<KeyFrameId>& back = atlas.maps[row].keyframes[other].*edges;
        if (Contains(back, keyframe.id)) continue;
        back.push_back(keyframe.id);
        ++added;
      }
  return added;
}

// For each keyframe of a map, the row of its parent, or kNoRow.
std::vector<std::uint32_t> ParentRows(const AtlasIndex& index, std::size_t map) {
  std::vector<std::uint32_t> parents;
  parents.reserve(index.atlas().maps[map].keyframes.size());
  for (const KeyFrame& keyframe : index.atlas().maps[map].keyframes)
    parents.push_back(index.KeyFrameRow(map, keyframe.parent));
  return parents;
}

// The lowest row of every cycle that following `parents` runs into, ascending.
std::vector<std::uint32_t> FindCycles(const std::vector<std::uint32_t>& parents) {
  constexpr std::uint32_t kUnseen = 0;
  std::vector<std::uint32_t> walk_of(parents.size(), kUnseen);  // number of the walk that came by
  std::vector<std::uint32_t> cycles;
  for (std::uint32_t start = 0; start < parents.size(); ++start) {
    const std::uint32_t walk = start + 1;
    std::uint32_t row = start;
    for (; row != kNoRow && walk_of[row] == kUnseen; row = parents[row]) walk_of[row] = walk;
    if (row == kNoRow || walk_of[row] != walk) continue;
    std::uint32_t lowest = row;
    for (std::uint32_t next = parents[row]; next != row; next = parents[next]) lowest = std::min(lowest, next);
    cycles.push_back(lowest);
  }
  std::ranges::sort(cycles);
  return cycles;
}

// Adds to shared[other], all 0 before, the points that keyframe `row` and `other` both observe, and sets `others` to
// those that share any, ascending and without `row` itself.
void CountShared(const Observers& observers, std::uint32_t row, std::vector<std::int32_t>& shared,
                 std::vector<std::uint32_t>& others) {
  others.clear();
  for (const Observers::Sight& sight : observers.By(row))
    for (const std::uint32_t other : observers.Of(sight.point))
      if (shared[other]++ == 0) others.push_back(other);
  std::erase(others, row);
  shared[row] = 0;
  std::ranges::sort(others);
}

constexpr std::int32_t kSharedPointsOfEdge = 15;  // from here on UpdateConnections links both ways

}  // namespace

void CheckTreeAcyclic(const Subject& subject, Findings& findings) {
  for (std::size_t row = 0; row < subject.atlas.maps.size(); ++row) {
    const Map& map = subject.atlas.maps[row];
    const std::vector<std::uint32_t> parents = ParentRows(subject.index, row);
    for (const std::uint32_t start : FindCycles(parents)) {
      std::size_t length = 1;
      for (std::uint32_t next = parents[start]; next != start; next = parents[next]) ++length;
      findings.Add(PlaceOf(map, map.keyframes[start]), [&]() -> std::string {
        return length == 1 ? "is its own parent" : "is its own ancestor, " + std::to_string(length) + " parents up";
      });
    }
  }
}

void CheckTreeRoot(const Subject& subject, Findings& findings) {
  for (std::size_t row = 0; row < subject.atlas.maps.size(); ++row) {
    const Map& map = subject.atlas.maps[row];
    for (const KeyFrame& keyframe : map.keyframes)
      if (!keyframe.bad && !keyframe.parent && keyframe.id != map.first_keyframe)
        findings.Add(PlaceOf(map, keyframe), "has no parent, but the initial keyframe is ", map.first_keyframe);
    const KeyFrame* root = subject.index.FindKeyFrame(row, map.first_keyframe);
    if (root != nullptr && root->parent && root->parent != root->id)
      findings.Add(PlaceOf(map, *root), "is the initial keyframe, but has parent ", root->parent);
  }
}

// Only trees in which something hangs on no root or on another one than the initial keyframe.
std::size_t RegrowTrees(Atlas& atlas) {
  std::size_t changed = 0;
  const AtlasIndex index(atlas);
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    Map& map = atlas.maps[row];
    const std::uint32_t root = index.KeyFrameRow(row, map.first_keyframe);
    if (root == kNoRow) continue;
    const std::vector<std::uint32_t> parents = ParentRows(index, row);
    const auto roots = std::ranges::count(parents, kNoRow);
    const bool root_has_parent = map.keyframes[root].parent.has_value();
    if (roots == 1 && !root_has_parent && FindCycles(parents).empty()) continue;
    changed += AdoptOrphans(map) + (root_has_parent ? 1 : 0);
  }
  return changed;
}

namespace {

// Not so one without an id, or with that of another one before it.
bool IsFoundByItsId(const AtlasIndex& index, std::size_t row, const KeyFrame& keyframe) {
  return keyframe.id && index.FindKeyFrame(row, keyframe.id) == &keyframe;
}

}  // namespace

void CheckParentListsChild(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    const KeyFrame* parent = subject.index.FindKeyFrame(row, keyframe.parent);
    if (parent != nullptr && parent != &keyframe && IsFoundByItsId(subject.index, row, keyframe) &&
        !Contains(parent->children, keyframe.id))
      findings.Add(PlaceOf(map, keyframe), "parent ", keyframe.parent, " does not have it as child");
  });
}

std::size_t AddMissingChildren(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t added = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (const KeyFrame& keyframe : atlas.maps[row].keyframes) {
      const std::uint32_t parent = index.KeyFrameRow(row, keyframe.parent);
      if (keyframe.bad || parent == kNoRow || keyframe.parent == keyframe.id) continue;
      if (!IsFoundByItsId(index, row, keyframe)) continue;
      Column<KeyFrameId>& children = atlas.maps[row].keyframes[parent].children;
      if (Contains(children, keyframe.id)) continue;
      children.push_back(keyframe.id);
      ++added;
    }
  return added;
}

void CheckChildHasParent(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    for (const KeyFrameId id : keyframe.children) {
      const KeyFrame* child = subject.index.FindKeyFrame(row, id);
      if (child != nullptr && child != &keyframe && child->parent != keyframe.id)
        findings.Add(PlaceOf(map, keyframe), "has child ", id, ", whose parent is ", child->parent);
    }
  });
}

std::size_t EraseForeignChildren(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t erased = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (KeyFrame& keyframe : atlas.maps[row].keyframes)
      erased += std::erase_if(keyframe.children, [&](KeyFrameId id) {
        const KeyFrame* child = index.FindKeyFrame(row, id);
        return child != nullptr && child != &keyframe && child->parent != keyframe.id;
      });
  return erased;
}

void CheckFirstConnection(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    if (keyframe.first_connection && keyframe.parent)
      findings.Add(PlaceOf(map, keyframe), "has parent ", keyframe.parent, ", but still waits for one");
  });
}

std::size_t ClearFirstConnections(Atlas& atlas) {
  std::size_t cleared = 0;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) {
      if (!keyframe.first_connection || !keyframe.parent) continue;
      keyframe.first_connection = false;
      ++cleared;
    }
  return cleared;
}

void CheckConnectionMutual(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    for (const Connection& connection : keyframe.connections) {
      const KeyFrame* other = subject.index.FindKeyFrame(row, connection.keyframe);
      if (other == nullptr || other == &keyframe) continue;
      const Connection* back = FindConnection(*other, keyframe.id);
      if (back == nullptr)
        findings.Add(PlaceOf(map, keyframe), "is covisible with ", connection.keyframe, ", but not the other way");
      else if (back->weight != connection.weight)
        findings.Add(PlaceOf(map, keyframe), "shares ", connection.weight, " points with ", connection.keyframe,
                     ", which shares ", back->weight, " with it");
    }
  });
}

void CheckConnectionWeight(const Subject& subject, Findings& findings) {
  for (std::size_t map_row = 0; map_row < subject.atlas.maps.size(); ++map_row) {
    const Map& map = subject.atlas.maps[map_row];
    const Observers& observers = subject.observers[map_row];
    std::vector<std::int32_t> shared(map.keyframes.size(), 0);
    std::vector<std::uint32_t> others;
    for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
      const KeyFrame& keyframe = map.keyframes[row];
      if (keyframe.bad) continue;
      CountShared(observers, row, shared, others);
      for (const Connection& connection : keyframe.connections) {
        const std::uint32_t other = subject.index.KeyFrameRow(map_row, connection.keyframe);
        if (other == kNoRow || other == row) continue;
        if (shared[other] != connection.weight)
          findings.Add(PlaceOf(map, keyframe), "covisibility with ", connection.keyframe, " has weight ",
                       connection.weight, ", but they share ", shared[other], " points");
        shared[other] = 0;
      }
      for (const std::uint32_t other : others) {
        if (shared[other] >= kSharedPointsOfEdge)
          findings.Add(PlaceOf(map, keyframe), "shares ", shared[other], " points with ", map.keyframes[other].id,
                       ", but has no covisibility with it");
        shared[other] = 0;
      }
    }
  }
}

void CheckConnectionPositive(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    for (const Connection& connection : keyframe.connections)
      if (connection.weight <= 0)
        findings.Add(PlaceOf(map, keyframe), "is covisible with ", connection.keyframe, " by ", connection.weight,
                     " points");
  });
}

// The weight that UpdateConnections would give; without a shared point there is no edge.
std::size_t WeighConnections(Atlas& atlas) {
  std::size_t changed = 0;
  const AtlasIndex index(atlas);
  const auto has_no_weight = [](const Connection& connection) { return connection.weight <= 0; };
  for (std::size_t map_row = 0; map_row < atlas.maps.size(); ++map_row) {
    Map& map = atlas.maps[map_row];
    const auto is_broken = [&](const KeyFrame& keyframe) {
      return !keyframe.bad && std::ranges::any_of(keyframe.connections, has_no_weight);
    };
    if (std::ranges::none_of(map.keyframes, is_broken)) continue;
    const Observers observers(index, map_row);
    std::vector<std::int32_t> shared(map.keyframes.size(), 0);
    std::vector<std::uint32_t> others;
    for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
      KeyFrame& keyframe = map.keyframes[row];
      if (!is_broken(keyframe)) continue;
      CountShared(observers, row, shared, others);
      for (Connection& connection : keyframe.connections) {
        const std::uint32_t other = index.KeyFrameRow(map_row, connection.keyframe);
        if (!has_no_weight(connection)) continue;
        connection.weight = other == kNoRow ? 0 : shared[other];
        ++changed;
      }
      std::erase_if(keyframe.connections, has_no_weight);
      for (const std::uint32_t other : others) shared[other] = 0;
    }
  }
  return changed;
}

void CheckLoopEdgeMutual(const Subject& subject, Findings& findings) {
  CheckEdgesMutual(subject, &KeyFrame::loop_edges, "loop", findings);
}
std::size_t AddMissingLoopEdges(Atlas& atlas) { return AddMissingEdges(atlas, &KeyFrame::loop_edges); }

void CheckMergeEdgeMutual(const Subject& subject, Findings& findings) {
  CheckEdgesMutual(subject, &KeyFrame::merge_edges, "merge", findings);
}
std::size_t AddMissingMergeEdges(Atlas& atlas) { return AddMissingEdges(atlas, &KeyFrame::merge_edges); }

void CheckLoopEdgeKept(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    if (!keyframe.loop_edges.empty() && !keyframe.not_erase)
      findings.Add(PlaceOf(map, keyframe), "has loop edges, but may be culled");
  });
}

std::size_t KeepLoopKeyFrames(Atlas& atlas) {
  std::size_t kept = 0;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) {
      if (keyframe.bad || keyframe.loop_edges.empty() || keyframe.not_erase) continue;
      keyframe.not_erase = true;
      ++kept;
    }
  return kept;
}

void CheckLinksUnique(const Subject& subject, Findings& findings) {
  std::vector<KeyFrameId> ids;
  const auto report = [&](const Place& place, const char* list) {
    std::ranges::sort(ids);
    for (auto again = std::ranges::adjacent_find(ids); again != ids.end();
         again = std::adjacent_find(again + 1, ids.end()))
      findings.Add(place, list, " ", *again, " more than once");
  };
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const auto check = [&](const Column<KeyFrameId>& links, const char* list) {
      ids.assign(links.begin(), links.end());
      report(PlaceOf(map, keyframe), list);
    };
    ids.clear();
    for (const Connection& connection : keyframe.connections) ids.push_back(connection.keyframe);
    report(PlaceOf(map, keyframe), "is covisible with");
    check(keyframe.children, "has child");
    check(keyframe.loop_edges, "has a loop edge to");
    check(keyframe.merge_edges, "has a merge edge to");
  });
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    // Files hold them sorted, and then a look at the neighbours is enough.
    const auto rises = [](const Observation& a, const Observation& b) { return a.keyframe >= b.keyframe; };
    if (std::ranges::adjacent_find(point.observations, rises) == point.observations.end()) return;
    ids.clear();
    for (const Observation& observation : point.observations) ids.push_back(observation.keyframe);
    report(PlaceOf(map, point), "is observed by");
  });
}

// The first of each stays.
std::size_t EraseRepeatedLinks(Atlas& atlas) {
  std::unordered_set<KeyFrameId> seen;
  const auto erase = [&](auto& links, const auto& id_of) -> std::size_t {
    const auto rises = [&](const auto& a, const auto& b) { return id_of(a) >= id_of(b); };
    if (std::ranges::adjacent_find(links, rises) == links.end()) return 0;
    seen.clear();
    return std::erase_if(links, [&](const auto& link) { return !seen.insert(id_of(link)).second; });
  };
  const auto id = [](KeyFrameId link) { return link; };
  std::size_t erased = 0;
  for (Map& map : atlas.maps) {
    for (KeyFrame& keyframe : map.keyframes) {
      erased += erase(keyframe.connections, [](const Connection& link) { return link.keyframe; });
      for (auto* links : {&keyframe.children, &keyframe.loop_edges, &keyframe.merge_edges}) erased += erase(*links, id);
    }
    for (MapPoint& point : map.points)
      erased += erase(point.observations, [](const Observation& link) { return link.keyframe; });
  }
  return erased;
}

}  // namespace slamdb::detail
