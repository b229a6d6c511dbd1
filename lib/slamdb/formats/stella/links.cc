// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/stella/detail/links.h"

#include <algorithm>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/union_find.h"
#include "slamdb/model/index.h"

namespace slamdb::stella {
namespace {

KeyFrameId IdOf(const StoredKeyFrame& stored) { return stored.keyframe.id; }
MapPointId IdOf(const MapPoint& point) { return point.id; }

// Sorts by id, and takes out all but the first of one id. Returns how many that are.
template <class Items>
std::size_t SortDistinct(Items& items) {
  std::ranges::stable_sort(items, {}, [](const auto& item) { return IdOf(item); });
  const auto twins =
      std::unique(items.begin(), items.end(), [](const auto& a, const auto& b) { return IdOf(a) == IdOf(b); });
  const auto count = static_cast<std::size_t>(items.end() - twins);
  items.erase(twins, items.end());
  return count;
}

template <class Items>
IdTable TableOf(const Items& sorted) {
  if (sorted.empty()) return {};
  IdTable rows(IdOf(sorted.front()).value(), IdOf(sorted.back()).value(), sorted.size());
  for (std::size_t row = 0; row < sorted.size(); ++row)
    rows.Insert(IdOf(sorted[row]).value(), static_cast<std::uint32_t>(row));
  return rows;
}

class Cleaner {
 public:
  explicit Cleaner(StoredMap& map) : map_(map) {
    twins_ = SortDistinct(map.keyframes) + SortDistinct(map.points);
    keyframes_ = TableOf(map.keyframes);
    points_ = TableOf(map.points);
  }

  void Run() {
    for (StoredKeyFrame& stored : map_.keyframes) CleanGraph(stored.keyframe);
    std::vector<std::uint32_t> last_seen(map_.points.size(), kNoRow);
    for (std::uint32_t row = 0; row < map_.keyframes.size(); ++row) CleanSlots(row, last_seen);
    std::size_t row = 0;
    unseen_ = std::erase_if(map_.points, [&](const MapPoint&) { return last_seen[row++] == kNoRow; });
    for (MapPoint& point : map_.points)
      if (!Has(point.reference)) point.reference = {};
  }

  void Tell(Notices& notices) const {
    const auto lose = [&](std::uint64_t count, std::string_view noun, std::string_view what) {
      if (count > 0) notices.Lose(detail::Concat(detail::Counted(count, noun), what));
    };
    lose(twins_, "entry", " with the id of another one: left out");
    lose(slots_, "keypoint", " that see a landmark which is not there: they see none now");
    lose(repeated_, "keypoint", " that see a landmark which another keypoint of their picture sees: they see none now");
    lose(unseen_, "landmark", " that no keyframe sees: left out");
    lose(links_, "link", " to keyframes that are not there: left out");
  }

 private:
  bool Has(KeyFrameId id) const { return id && keyframes_.Find(id.value()) != kNoRow; }

  void CleanGraph(KeyFrame& keyframe) {
    if (keyframe.parent && (!Has(keyframe.parent) || keyframe.parent == keyframe.id)) {
      keyframe.parent = {};
      ++links_;
    }
    for (Column<KeyFrameId>* links : {&keyframe.children, &keyframe.loop_edges})
      links_ += std::erase_if(*links, [&](KeyFrameId id) { return !Has(id); });
  }

  void CleanSlots(std::uint32_t keyframe, std::vector<std::uint32_t>& last_seen) {
    for (MapPointId& id : map_.keyframes[keyframe].keyframe.features.map_points) {
      if (!id) continue;
      const std::uint32_t point = points_.Find(id.value());
      if (point != kNoRow && last_seen[point] != keyframe) {
        last_seen[point] = keyframe;
        continue;
      }
      ++(point == kNoRow ? slots_ : repeated_);
      id = {};
    }
  }

  StoredMap& map_;
  IdTable keyframes_, points_;
  std::uint64_t twins_ = 0, slots_ = 0, repeated_ = 0, unseen_ = 0, links_ = 0;
};

}  // namespace

void CleanLinks(StoredMap& map, Notices& notices) {
  Cleaner cleaner(map);
  cleaner.Run();
  cleaner.Tell(notices);
}

Parts PartsOf(const StoredMap& map) {
  const IdTable keyframes = TableOf(map.keyframes), points = TableOf(map.points);
  detail::UnionFind joined(map.keyframes.size());
  std::vector<std::uint32_t> seen_by(map.points.size(), kNoRow);
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
    const KeyFrame& keyframe = map.keyframes[row].keyframe;
    if (keyframe.parent) joined.Join(row, keyframes.Find(keyframe.parent.value()));
    for (const KeyFrameId other : keyframe.loop_edges) joined.Join(row, keyframes.Find(other.value()));
    for (const MapPointId id : keyframe.features.map_points) {
      if (!id) continue;
      std::uint32_t& first = seen_by[points.Find(id.value())];
      if (first == kNoRow)
        first = row;
      else
        joined.Join(row, first);
    }
  }
  Parts parts;
  std::vector<std::uint32_t> part_of_root(map.keyframes.size(), kNoRow);
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
    std::uint32_t& part = part_of_root[joined.Root(row)];
    if (part == kNoRow) part = parts.count++;
    parts.of_keyframe.push_back(part);
  }
  for (const std::uint32_t row : seen_by) parts.of_point.push_back(parts.of_keyframe[row]);
  return parts;
}

}  // namespace slamdb::stella
