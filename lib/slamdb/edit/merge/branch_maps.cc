// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/detail/branch_maps.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/union_find.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/edit/merge/detail/branch_geometry.h"
#include "slamdb/edit/merge/detail/mixture.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kAtlases = 3;

std::array<const Atlas*, kAtlases> AtlasesOf(const Branches& branches) {
  return {&branches.base, &branches.ours, &branches.theirs};
}

// The maps of all three one behind the other.
class Maps {
 public:
  explicit Maps(const Branches& branches) {
    for (const Atlas* atlas : AtlasesOf(branches)) {
      begins_.push_back(maps_.size());
      for (const Map& map : atlas->maps) maps_.push_back(&map);
    }
    begins_.push_back(maps_.size());
  }

  std::size_t size() const { return maps_.size(); }
  const Map& operator[](std::size_t number) const { return *maps_[number]; }
  std::size_t AtlasOf(std::size_t number) const {
    std::size_t atlas = 0;
    while (number >= begins_[atlas + 1]) ++atlas;
    return atlas;
  }
  std::uint32_t RowOf(std::size_t number) const {
    return static_cast<std::uint32_t>(number - begins_[AtlasOf(number)]);
  }

 private:
  std::vector<const Map*> maps_;
  std::vector<std::size_t> begins_;
};

// Of an atlas: which of its maps has what is in a map of an earlier one.
using Partner = std::unordered_map<std::size_t, std::uint32_t>;  // number of the earlier one -> number

void RefuseSplit(const Maps& maps, std::size_t earlier, std::uint32_t first, std::uint32_t second,
                 const std::array<std::string, 3>& names) {
  throw Error(ErrorKind::kNotPossible,
              Concat(names[maps.AtlasOf(first)], ": ", ToString(maps[earlier].id), " of ", names[maps.AtlasOf(earlier)],
                     " is split there, into ", ToString(maps[first].id), " and ", ToString(maps[second].id),
                     "; join these two first (`JoinMaps`), or merge with an atlas from before the split"));
}

// What a map without keyframes holds, by which it is known.
template <class Visit>
void ForEachThing(const Map& map, const Visit& visit) {
  for (const MapPoint& point : map.points) visit(point.id.value());
  for (const Landmark& landmark : map.landmarks)
    if (landmark.is_numbered()) visit(landmark.id.value());
}

// What several maps of one atlas have tells nothing, as where each map counts its landmarks from 0.
std::unordered_set<std::uint64_t> ThingsOfSeveral(const Maps& maps) {
  std::unordered_set<std::uint64_t> several;
  std::unordered_map<std::uint64_t, std::array<std::uint32_t, kAtlases>> owners;  // the last map of each atlas, from 1
  for (std::uint32_t number = 0; number < maps.size(); ++number)
    if (maps[number].keyframes.empty())
      ForEachThing(maps[number], [&](std::uint64_t thing) {
        std::uint32_t& owner = owners[thing][maps.AtlasOf(number)];
        if (owner != 0 && owner != number + 1) several.insert(thing);
        owner = number + 1;
      });
  return several;
}

// Clouds and landmarks: those that share things, and of those of which these do not tell those of one id.
void JoinWithoutKeyframes(const Maps& maps, UnionFind& sets) {
  const std::unordered_set<std::uint64_t> several = ThingsOfSeveral(maps);
  // Numbers of the first maps that have a thing, or are called so.
  std::unordered_map<std::uint64_t, std::uint32_t> owner, by_id;
  std::vector<std::uint8_t> shares(maps.size(), 0), is_vague(maps.size(), 0);
  for (std::uint32_t number = 0; number < maps.size(); ++number)
    if (maps[number].keyframes.empty())
      ForEachThing(maps[number], [&](std::uint64_t thing) {
        if (several.contains(thing)) {
          is_vague[number] = 1;
          return;
        }
        const auto [first, is_new] = owner.emplace(thing, number);
        if (is_new) return;
        sets.Join(first->second, number);
        shares[first->second] = shares[number] = 1;
      });
  for (std::uint32_t number = 0; number < maps.size(); ++number)
    if (maps[number].keyframes.empty() && (shares[number] == 0 || is_vague[number] != 0))
      sets.Join(by_id.emplace(maps[number].id.value(), number).first->second, number);
}

std::vector<std::vector<std::uint32_t>> SetsOf(const Maps& maps, UnionFind& sets) {
  std::vector<std::vector<std::uint32_t>> members(maps.size());
  for (std::uint32_t number = 0; number < maps.size(); ++number) members[sets.Root(number)].push_back(number);
  return members;
}

template <class Entity>
void Append(std::vector<Entity>& from, std::vector<Entity>& to) {
  std::ranges::move(from, std::back_inserter(to));
}
template <class Entity>
void Append(Column<Entity>& from, Column<Entity>& to) {
  to.reserve(to.size() + from.size());
  std::ranges::move(from, std::back_inserter(to));
}

void Absorb(Map& from, Map& into) {
  Append(from.keyframes, into.keyframes);
  Append(from.points, into.points);
  Append(from.landmarks, into.landmarks);
  Append(from.origins, into.origins);
  into.max_keyframe_id = std::max(into.max_keyframe_id, from.max_keyframe_id);
  into.lowest_keyframe = std::min(into.lowest_keyframe, from.lowest_keyframe);
  into.big_change_index = std::max(into.big_change_index, from.big_change_index);
  for (const auto flag : {&Map::imu_initialized, &Map::inertial, &Map::imu_ba1, &Map::imu_ba2})
    into.*flag = into.*flag && from.*flag;
  from = {};
}

}  // namespace

std::vector<MapGroup> GroupMaps(const Branches& branches, const std::array<std::string, 3>& names) {
  const Maps maps(branches);
  UnionFind sets(maps.size());
  std::unordered_map<std::uint64_t, std::uint32_t> owner;  // of a keyframe: the number of the first map that has it
  std::array<Partner, kAtlases> partners;
  for (std::uint32_t number = 0; number < maps.size(); ++number)
    for (const KeyFrame& keyframe : maps[number].keyframes) {
      const auto [first, is_new] = owner.emplace(keyframe.id.value(), number);
      if (is_new) continue;
      sets.Join(first->second, number);
      if (maps.AtlasOf(first->second) != 0) continue;  // what both made may be joined by either
      const auto [partner, alone] = partners[maps.AtlasOf(number)].emplace(first->second, number);
      if (!alone && partner->second != number) RefuseSplit(maps, first->second, partner->second, number, names);
    }
  JoinWithoutKeyframes(maps, sets);
  std::vector<MapGroup> groups;
  for (const std::vector<std::uint32_t>& members : SetsOf(maps, sets)) {
    if (members.empty()) continue;
    MapGroup& group = groups.emplace_back();
    std::vector<std::uint32_t>* rows[] = {&group.base, &group.ours, &group.theirs};
    for (const std::uint32_t number : members) rows[maps.AtlasOf(number)]->push_back(maps.RowOf(number));
  }
  std::ranges::sort(groups, {}, [](const MapGroup& group) {
    const auto first = [](const std::vector<std::uint32_t>& rows) { return rows.empty() ? kNoRow : rows.front(); };
    return std::tuple(first(group.ours), first(group.theirs), first(group.base));
  });
  return groups;
}

namespace {

// Where maps lie in the frame of one of them, as far as keyframes that they share tell.
class Frames {
 public:
  Frames(std::vector<Map*> maps, std::size_t root) : maps_(std::move(maps)), frames_(maps_.size()) {
    frames_[root] = Similarity3d();
  }

  const std::optional<Similarity3d>& operator[](std::size_t map) const { return frames_[map]; }
  void Set(std::size_t map, const Similarity3d& frame) { frames_[map] = frame; }

  std::optional<Similarity3d> MotionBetween(std::size_t target, std::size_t source) const {
    const bool with_scale = HasArbitraryScale(*maps_[target]) || HasArbitraryScale(*maps_[source]);
    return MeanMotion(*maps_[target], *maps_[source], with_scale);
  }
  // Where a map lies by its neighbour.
  std::optional<Similarity3d> By(std::size_t neighbour, std::size_t map) const {
    const auto motion = frames_[neighbour] ? MotionBetween(neighbour, map) : std::nullopt;
    return motion ? std::optional(*frames_[neighbour] * *motion) : std::nullopt;
  }
  // Finds those that are not known yet, by neighbours that are.
  void FindAll() {
    for (bool found = true; found;) {
      found = false;
      for (std::size_t map = 0; map < maps_.size(); ++map)
        for (std::size_t by = 0; by < maps_.size() && !frames_[map]; ++by)
          if (const auto frame = By(by, map)) {
            frames_[map] = frame;
            found = true;
          }
    }
  }

 private:
  std::vector<Map*> maps_;
  std::vector<std::optional<Similarity3d>> frames_;
};

// Where both sides joined the maps of the base, each its own way. A map of the base that neither moved tells the frame
// of both; each other one lies between where ours has it and where theirs has it, so that both changed that.
void LayByBoth(Frames& frames, const std::vector<Map*>& maps, std::size_t ours, std::size_t theirs,
               std::size_t first_of_base) {
  const auto stays = [&](std::size_t side, std::size_t base) {
    const auto motion = frames.MotionBetween(side, base);
    return motion && !IsAnotherFrame(*motion, *maps[base]);
  };
  for (std::size_t base = first_of_base; base < maps.size(); ++base)
    if (stays(ours, base) && stays(theirs, base)) {
      frames.Set(base, Similarity3d());
      frames.Set(theirs, Similarity3d());
    }
  if (!frames[theirs]) frames.Set(theirs, frames.By(ours, theirs).value_or(Similarity3d()));
  for (std::size_t base = first_of_base; base < maps.size(); ++base) {
    const auto by_ours = frames.By(ours, base), by_theirs = frames.By(theirs, base);
    if (!frames[base] && by_ours && by_theirs) frames.Set(base, Halfway(*by_ours, *by_theirs, *maps[base]));
  }
}

}  // namespace

void LayTogether(Branches& branches, const MapGroup& group, int threads) {
  std::vector<Map*> maps;
  const std::pair<Atlas*, const std::vector<std::uint32_t>*> sides[] = {
      {&branches.ours, &group.ours}, {&branches.theirs, &group.theirs}, {&branches.base, &group.base}};
  for (const auto& [atlas, rows] : sides)
    for (const std::uint32_t row : *rows) maps.push_back(&atlas->maps[row]);
  // The frame is that of a side which is one map, ours before theirs.
  const std::size_t theirs = group.ours.size(), base = theirs + group.theirs.size();
  Frames frames(maps, group.ours.size() != 1 && group.theirs.size() == 1 ? theirs : 0);
  if (group.ours.size() == 1 && group.theirs.size() == 1) LayByBoth(frames, maps, 0, theirs, base);
  frames.FindAll();
  for (std::size_t i = 0; i < maps.size(); ++i)
    if (frames[i]) TransformMap(*maps[i], *frames[i], threads);
  for (const auto& [atlas, rows] : sides)
    for (std::size_t i = 1; i < rows->size(); ++i) Absorb(atlas->maps[(*rows)[i]], atlas->maps[rows->front()]);
}

}  // namespace slamdb::detail
