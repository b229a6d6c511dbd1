// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/detail/point_classes.h"

#include <algorithm>
#include <vector>

#include "slamdb/base/detail/union_find.h"
#include "slamdb/edit/merge/detail/branch_points.h"

namespace slamdb::detail {
namespace {

// Points by number, in the order in which they were met.
class Numbers {
 public:
  std::uint32_t Of(MapPointId id) {
    const auto [found, is_new] = numbers_.emplace(id.value(), static_cast<std::uint32_t>(ids_.size()));
    if (is_new) ids_.push_back(id);
    return found->second;
  }
  const std::vector<MapPointId>& ids() const { return ids_; }

 private:
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
  std::vector<MapPointId> ids_;
};

using Pairs = std::vector<std::pair<MapPointId, MapPointId>>;

template <class Visit>
void ForEachPoint(const AtlasIndex& index, const Visit& visit) {
  for (const Map& map : index.atlas().maps)
    for (const MapPoint& point : map.points) visit(point);
}

// Points that one side has no more, though most of the keypoints that saw them see another one there. Those that both
// sides replaced are none of these: they may have become two.
void AddReplaced(const AtlasIndex& base, const AtlasIndex& side, const AtlasIndex& other, Pairs& pairs) {
  ForEachPoint(base, [&](const MapPoint& point) {
    if (side.LocatePoint(point.id) || !other.LocatePoint(point.id)) return;
    const PointVote vote = VoteOn(point, side);
    if (vote.Carried() && side.LocatePoint(vote.most)) pairs.emplace_back(point.id, vote.most);
  });
}

// New points of one side that the other, which has their keyframes, has fused with others.
void AddNewOnes(const AtlasIndex& base, const AtlasIndex& of, const AtlasIndex& side, Pairs& pairs) {
  ForEachPoint(of, [&](const MapPoint& point) {
    if (base.LocatePoint(point.id) || side.LocatePoint(point.id)) return;
    const PointVote vote = VoteOn(point, side);
    if (2 * vote.votes > vote.all && side.LocatePoint(vote.most)) pairs.emplace_back(point.id, vote.most);
  });
}

}  // namespace

PointClasses::PointClasses(const AtlasIndex& base, const AtlasIndex& ours, const AtlasIndex& theirs) {
  Pairs pairs;
  AddReplaced(base, ours, theirs, pairs);
  AddReplaced(base, theirs, ours, pairs);
  AddNewOnes(base, theirs, ours, pairs);
  AddNewOnes(base, ours, theirs, pairs);
  Numbers numbers;
  for (const auto& [gone, survivor] : pairs) {
    numbers.Of(gone);
    numbers.Of(survivor);
  }
  UnionFind sets(numbers.ids().size());
  for (const auto& [gone, survivor] : pairs) sets.Join(numbers.Of(gone), numbers.Of(survivor));
  const auto rank = [&](MapPointId id) {
    return std::pair(ours.LocatePoint(id) ? 0 : theirs.LocatePoint(id) ? 1 : 2, id);
  };
  std::vector<MapPointId> names = numbers.ids();
  for (std::uint32_t number = 0; number < names.size(); ++number) {
    MapPointId& name = names[sets.Root(number)];
    if (rank(numbers.ids()[number]) < rank(name)) name = numbers.ids()[number];
  }
  for (std::uint32_t number = 0; number < names.size(); ++number)
    classes_[numbers.ids()[number].value()] = names[sets.Root(number)].value();
}

std::vector<std::pair<MapPointId, MapPointId>> PointClasses::Gone() const {
  std::vector<std::pair<MapPointId, MapPointId>> gone;
  for (const auto& [id, name] : classes_)
    if (id != name) gone.emplace_back(MapPointId(id), MapPointId(name));
  std::ranges::sort(gone);
  return gone;
}

}  // namespace slamdb::detail
