// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/detail/branch_landmarks.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "slamdb/edit/merge/detail/fused_landmarks.h"
#include "slamdb/edit/merge/detail/three_ways.h"
#include "slamdb/model/detail/row_hash.h"

namespace slamdb::detail {
namespace {

// What tells a landmark of a map: its id, or else its content, and how many of that are before it.
using Key = std::tuple<std::uint64_t, std::int64_t, std::size_t>;

struct Entry {
  std::uint32_t row = 0;
  std::int64_t content = 0;
};

using Entries = std::map<Key, Entry>;

Entries EntriesOf(const LandmarkLists& lists, bool with_places) {
  Entries entries;
  std::uint32_t row = 0;
  std::unordered_map<std::int64_t, std::size_t> alike;
  std::unordered_map<std::uint64_t, std::size_t> of_one_id;
  for (const std::span<const Landmark> list : lists)
    for (const Landmark& landmark : list) {
      const std::int64_t content = ContentOf(landmark, with_places);
      const std::uint64_t id = landmark.id.value();
      const Key key = landmark.is_numbered() ? Key(id, 0, of_one_id[id]++) : Key(kNoId, content, alike[content]++);
      entries.emplace(key, Entry{row++, content});
    }
  return entries;
}

const Entry* Find(const Entries& entries, const Key& key) {
  const auto found = entries.find(key);
  return found == entries.end() ? nullptr : &found->second;
}

std::size_t SizeOf(const LandmarkLists& lists) {
  std::size_t size = 0;
  for (const std::span<const Landmark> list : lists) size += list.size();
  return size;
}

// Ids of landmarks by content, of those that are in no pair yet; kNoId where several have it.
std::unordered_map<std::int64_t, std::uint64_t> ByContent(const Atlas& atlas,
                                                          const std::unordered_set<std::uint64_t>& taken) {
  std::unordered_map<std::int64_t, std::uint64_t> ids;
  for (const Map& map : atlas.maps)
    for (const Landmark& landmark : map.landmarks) {
      if (!landmark.is_numbered() || taken.contains(landmark.id.value())) continue;
      const auto [found, is_new] = ids.emplace(ContentOf(landmark), landmark.id.value());
      if (!is_new) found->second = kNoId;
    }
  return ids;
}

std::unordered_set<std::uint64_t> IdsOf(const Atlas& atlas) {
  std::unordered_set<std::uint64_t> ids;
  for (const Map& map : atlas.maps)
    for (const Landmark& landmark : map.landmarks)
      if (landmark.is_numbered()) ids.insert(landmark.id.value());
  return ids;
}

void Move(Landmark& landmark, const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
  const Eigen::Vector3d moved = (to - from).cast<double>();
  if (from != to && moved.allFinite()) landmark.mean += moved;
}

}  // namespace

std::int64_t ContentOf(const Landmark& landmark, bool with_place) {
  Landmark content = landmark;
  content.id = {};
  if (!with_place) {
    content.mean = content.normal = Eigen::Vector3d::Zero();
    content.set_pose({content.mean, Eigen::Matrix3d::Zero()});
  }
  return HashOf(content);
}

std::vector<IdPair> MatchLandmarks(const Atlas& from, const Atlas& to, const std::vector<IdPair>& known,
                                   bool ids_say_something) {
  std::unordered_set<std::uint64_t> from_taken, to_taken;
  for (const IdPair& pair : known) {
    from_taken.insert(pair.before);
    to_taken.insert(pair.after);
  }
  std::vector<IdPair> pairs;
  const std::unordered_set<std::uint64_t> there = ids_say_something ? IdsOf(to) : std::unordered_set<std::uint64_t>();
  for (const std::uint64_t id : IdsOf(from))
    if (there.contains(id) && !from_taken.contains(id) && to_taken.insert(id).second) {
      from_taken.insert(id);
      pairs.push_back({id, id});
    }
  const auto alike = ByContent(to, to_taken);
  for (const auto& [content, id] : ByContent(from, from_taken))
    if (const auto found = alike.find(content); id != kNoId && found != alike.end() && found->second != kNoId)
      pairs.push_back({id, found->second});
  std::ranges::sort(pairs, {}, &IdPair::before);
  return pairs;
}

LandmarkPlan PlanLandmarks(const LandmarkLists& base, const LandmarkLists& ours, const LandmarkLists& theirs,
                           BranchSide prefer, bool with_places) {
  const Entries before = EntriesOf(base, with_places), mine = EntriesOf(ours, with_places),
                other = EntriesOf(theirs, with_places);
  LandmarkPlan plan{.ours_stays = std::vector<std::uint8_t>(SizeOf(ours), 1),
                    .theirs_is_new = std::vector<std::uint8_t>(SizeOf(theirs), 0),
                    .replacement = std::vector<std::optional<std::uint32_t>>(SizeOf(ours)),
                    .conflicts = {}};
  const auto conflict = [&](const Key& key, std::string_view what, BranchSide taken) {
    plan.conflicts.push_back({{.landmark = LandmarkId(std::get<0>(key))}, what, taken});
  };
  for (const auto& [key, our] : mine) {
    const Entry *was = Find(before, key), *their = Find(other, key);
    if (their == nullptr) {
      if (was == nullptr) continue;
      plan.ours_stays[our.row] = was->content != our.content;
      if (was->content != our.content) conflict(key, "deletion", BranchSide::kOurs);
      continue;
    }
    const Pick pick = PickOf(was == nullptr ? nullptr : &was->content, our.content, their->content);
    if (pick == Pick::kConflict) conflict(key, "landmark", prefer);
    if (pick == Pick::kTheirs || (pick == Pick::kConflict && prefer == BranchSide::kTheirs))
      plan.replacement[our.row] = their->row;
  }
  for (const auto& [key, their] : other) {
    const Entry* was = Find(before, key);
    if (Find(mine, key) != nullptr || (was != nullptr && was->content == their.content)) continue;
    if (was != nullptr) conflict(key, "deletion", BranchSide::kTheirs);
    plan.theirs_is_new[their.row] = 1;
  }
  return plan;
}

bool LandmarkPlan::Apply(std::vector<Landmark>& ours, const std::vector<Landmark>& theirs) const {
  bool took_any = false;
  std::vector<Landmark> result;
  result.reserve(ours.size() + theirs.size());
  for (std::size_t row = 0; row < ours.size(); ++row) {
    if (!ours_stays[row]) continue;
    took_any |= replacement[row].has_value();
    result.push_back(replacement[row] ? theirs[*replacement[row]] : std::move(ours[row]));
  }
  for (std::size_t row = 0; row < theirs.size(); ++row) {
    if (!theirs_is_new[row]) continue;
    took_any = true;
    result.push_back(theirs[row]);
  }
  ours = std::move(result);
  return took_any;
}

PlacesOfPoints PlacesOf(const Map& map, const PointClasses& classes) {
  PlacesOfPoints places;
  places.reserve(map.points.size());
  for (const MapPoint& point : map.points) {
    const MapPointId name = classes.Of(point.id);
    Eigen::Vector3f& place = places.emplace(name.value(), point.position).first->second;
    if (name == point.id) place = point.position;
  }
  return places;
}

PlacesOfPoints PlacesBeforeMerging(const LandmarkPlan& plan, const Map& ours, const Map& theirs,
                                   const PointClasses& classes) {
  PlacesOfPoints all;
  const auto add = [&](const Map& side, const auto& is_taken) {
    if (side.landmarks.empty()) return;
    const PlacesOfPoints places = PlacesOf(side, classes);
    for (std::size_t row = 0; row < side.landmarks.size(); ++row) {
      const Landmark& landmark = side.landmarks[row];
      const auto place = landmark.is_numbered() ? places.find(landmark.id.value()) : places.end();
      if (place != places.end() && is_taken(row)) all.insert_or_assign(place->first, place->second);
    }
  };
  std::vector<std::uint8_t> taken = plan.theirs_is_new;
  for (const std::optional<std::uint32_t>& row : plan.replacement)
    if (row) taken[*row] = 1;
  add(ours, [&](std::size_t row) { return plan.ours_stays[row] != 0; });
  add(theirs, [&](std::size_t row) { return taken[row] != 0; });
  return all;
}

void FollowPoints(const PlacesOfPoints& before, const PointClasses& classes, Map& map) {
  if (before.empty()) return;
  const PlacesOfPoints now = PlacesOf(map, classes);
  for (Landmark& landmark : map.landmarks) {
    const auto was = landmark.is_numbered() ? before.find(landmark.id.value()) : before.end();
    const auto is = was == before.end() ? now.end() : now.find(was->first);
    if (is != now.end()) Move(landmark, was->second, is->second);
  }
}

void FollowFusing(const PlacesOfPoints& before, const FuseReport& fused, Map& map) {
  if (map.landmarks.empty()) return;
  const IdTable points = PointTable(map);
  for (Landmark& landmark : map.landmarks) {
    const MapPointId id(landmark.id.value());
    const auto was = before.find(id.value());
    if (was == before.end()) continue;
    const auto gone = std::ranges::lower_bound(fused.replaced, id, {}, &std::pair<MapPointId, MapPointId>::first);
    const MapPointId name = gone != fused.replaced.end() && gone->first == id ? gone->second : id;
    if (const std::uint32_t is = points.Find(name.value()); is != kNoRow)
      Move(landmark, was->second, map.points[is].position);
  }
  FollowFusedPoints(fused, map);
}

void UniteLandmarks(const PointClasses& classes, Map& map) {
  if (map.landmarks.empty()) return;
  const FuseReport fused{.replaced = classes.Gone()};
  if (fused.replaced.empty()) return;
  const PlacesOfPoints places = PlacesOf(map, classes);
  const IdTable points = PointTable(map);
  for (Landmark& landmark : map.landmarks) {
    const std::uint32_t point = landmark.is_numbered() ? points.Find(landmark.id.value()) : kNoRow;
    if (point == kNoRow) continue;
    const MapPoint& own = map.points[point];
    Move(landmark, own.position, places.at(classes.Of(own.id).value()));
  }
  FollowFusedPoints(fused, map);
}

bool HasOtherLandmarks(const LandmarkLists& base, std::span<const Landmark> list) {
  const Entries before = EntriesOf(base, true);
  return std::ranges::any_of(EntriesOf({list}, true), [&](const auto& each) {
    const Entry* was = Find(before, each.first);
    return was == nullptr || was->content != each.second.content;
  });
}

}  // namespace slamdb::detail
