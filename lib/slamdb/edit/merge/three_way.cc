// SPDX-License-Identifier: BSD-3-Clause
// 1. A side that is the base, or the other side, leaves nothing to do.
// 2. What is one thing gets one id, and what is in each atlas is written down.
// 3. What the format of a side has no place for is in it as in the base.
// 4. Maps are grouped by what they share. Of each group the sides are bent onto each other, their structures merged,
// and
//    new points at one place fused.
// 5. What is around the maps is merged, and the result held against what was written down.
#include "slamdb/edit/merge/three_way.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <unordered_map>
#include <unordered_set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/edit/merge/detail/branch_geometry.h"
#include "slamdb/edit/merge/detail/branch_ids.h"
#include "slamdb/edit/merge/detail/branch_maps.h"
#include "slamdb/edit/merge/detail/branch_proof.h"
#include "slamdb/edit/merge/detail/branch_structure.h"
#include "slamdb/edit/merge/detail/branch_unrecorded.h"
#include "slamdb/edit/merge/detail/three_ways.h"
#include "slamdb/model/counters.h"
#include "slamdb/model/detail/carried_members.h"
#include "slamdb/model/detail/irregular_entries.h"
#include "slamdb/model/digest.h"

namespace slamdb {
namespace {

using detail::MapGroup;

constexpr std::array<std::string_view, 2> kSides = {"ours", "theirs"};
constexpr std::array<std::string_view, 4> kGeometries = {"ours", "theirs", "align", "optimize"};

// By row: whether a point is elsewhere than in the base, or not in it.
std::vector<std::uint8_t> MovedPoints(const Map* base, const Map& side) {
  std::vector<std::uint8_t> moved(side.points.size(), 1);
  if (base == nullptr) return moved;
  const IdTable rows = PointTable(*base);
  for (std::size_t row = 0; row < moved.size(); ++row)
    if (const std::uint32_t before = rows.Find(side.points[row].id.value()); before != kNoRow)
      moved[row] = base->points[before].position != side.points[row].position;
  return moved;
}

class ThreeWayMerger {
 public:
  ThreeWayMerger(detail::Branches branches, const ThreeWayOptions& options)
      : branches_(std::move(branches)), options_(options) {
    report().names = options.names;
    report().geometry = options.geometry;
  }

  ThreeWayResult Run() {
    Count();
    if (IsTrivial()) return std::move(result_);
    detail::Steps steps(options_.progress, "merging", 4);
    Prepare();
    CompareVocabularies();
    AgreeOnLayout();
    base_maps_ = IdsOfMaps(branches_.base);
    their_maps_ = IdsOfMaps(branches_.theirs);
    const detail::UnifiedIds ids = detail::UnifyIds(branches_, options_.names, options_.threads);
    report().shift = ids.shift;
    report().other_images = ids.other_images;
    steps.Next();
    const detail::Inventory base(branches_.base), ours(branches_.ours), theirs(branches_.theirs);
    base_index_.emplace(branches_.base);
    classes_ = detail::PointClasses(*base_index_, AtlasIndex(branches_.ours), AtlasIndex(branches_.theirs));
    report().fused = classes_.Gone();
    UniteLandmarks();
    maps_of_ours_ = branches_.ours.maps.size();
    for (const std::size_t side : {0, 1}) TakeOver(side);
    our_maps_ = IdsOfMaps(branches_.ours);
    for (std::size_t row = their_maps_.size(); row < branches_.theirs.maps.size(); ++row)
      their_maps_.push_back(branches_.theirs.maps[row].id);
    for (const MapGroup& group : detail::GroupMaps(branches_, options_.names)) MergeGroup(group);
    steps.Next();
    Assemble();
    steps.Next();
    const detail::Inventory result(result_.atlas);
    detail::Prove(base, ours, theirs, result, cleared_, report());
    if (options_.id_maps) RecordIds(ids, ours, result);
    report().result = CountContent(result_.atlas, options_.threads);
    steps.Next();
    return std::move(result_);
  }

 private:
  struct Part {  // a map of the result
    std::uint64_t order = 0;
    Map map;
  };

  ThreeWayReport& report() { return result_.report; }

  // ---- before

  void Count() {
    const Atlas* atlases[] = {&branches_.base, &branches_.ours, &branches_.theirs};
    for (std::size_t i = 0; i < 3; ++i) report().counts[i] = CountContent(*atlases[i], options_.threads);
  }

  // Whether the result is one side as it is, but for what its format has no place for.
  bool IsTrivial() {
    unrecorded_ = {detail::UnrecordedIn(branches_.ours, branches_.base),
                   detail::UnrecordedIn(branches_.theirs, branches_.base)};
    const std::uint64_t base = HashWithoutEncoding(branches_.base, options_.threads),
                        ours = HashWithoutEncoding(branches_.ours, options_.threads),
                        theirs = HashWithoutEncoding(branches_.theirs, options_.threads);
    const auto is_base = [&](const Atlas& side, std::uint64_t hash, const detail::Unrecorded& what) {
      if (!what.Any()) return hash == base;
      return hash == HashWithoutEncoding(detail::Without(what, branches_.base, side), options_.threads);
    };
    report().same = ours == theirs;
    if (!report().same && is_base(branches_.theirs, theirs, unrecorded_[1]))
      report().unchanged = BranchSide::kTheirs;
    else if (!report().same && is_base(branches_.ours, ours, unrecorded_[0]))
      report().unchanged = BranchSide::kOurs;
    if (!report().same && !report().unchanged && options_.take_containing)
      report().contains = detail::FindContaining(branches_, options_.threads);
    if (!report().same && !report().unchanged && !report().contains) return false;
    const bool is_theirs = report().unchanged == BranchSide::kOurs || report().contains == BranchSide::kTheirs;
    const bool is_complete = !unrecorded_[is_theirs ? 1 : 0].Any();
    if (is_complete) result_.atlas = is_theirs ? branches_.theirs : branches_.ours;
    if (!is_complete || options_.id_maps) FollowTrivial(is_theirs);
    if (!is_complete) result_.atlas = std::move(branches_.ours);
    report().result = CountContent(result_.atlas, options_.threads);
    return true;
  }

  // Where everything of the two sides is in the one that is the result, which then is ours, and complete.
  void FollowTrivial(bool is_theirs) {
    const auto swap_sides = [&] {
      std::swap(report().names[1], report().names[2]);
      std::swap(report().dropped_members[0], report().dropped_members[1]);
      std::swap(unrecorded_[0], unrecorded_[1]);
    };
    if (is_theirs) {
      std::swap(branches_.ours, branches_.theirs);
      swap_sides();
    }
    Prepare();
    if (unrecorded_[0].members) AgreeOnLayout();
    const detail::UnifiedIds ids = detail::UnifyIds(branches_, report().names, options_.threads);
    base_index_.emplace(branches_.base);
    classes_ = detail::PointClasses(*base_index_, AtlasIndex(branches_.ours), AtlasIndex(branches_.theirs));
    report().fused = classes_.Gone();
    maps_of_ours_ = branches_.ours.maps.size();
    if (unrecorded_[0].Any()) {
      for (Map& map : branches_.base.maps) detail::UniteLandmarks(classes_, map);
      TakeOver(0);
      for (std::uint32_t row = 0; row < branches_.ours.maps.size(); ++row) SettleLandmarks(0, row);
    }
    our_maps_ = IdsOfMaps(branches_.ours);
    for (const MapGroup& group : detail::GroupMaps(branches_, report().names)) {
      for (const std::uint32_t row : group.ours) map_of_ours_.emplace(our_maps_[row].value(), our_maps_[row]);
      for (const std::uint32_t row : group.theirs)
        if (!group.ours.empty())
          map_of_theirs_.emplace(branches_.theirs.maps[row].id.value(), our_maps_[group.ours.front()]);
    }
    const detail::Inventory ours(branches_.ours);
    if (options_.id_maps) RecordIds(ids, ours, ours);
    report().fused.clear();
    if (!is_theirs) return;
    swap_sides();
    if (options_.id_maps) std::swap(report().id_maps[0], report().id_maps[1]);
  }

  void Prepare() {
    Atlas* atlases[] = {&branches_.base, &branches_.ours, &branches_.theirs};
    for (std::size_t i = 0; i < 3; ++i) {
      report().dropped_list_entries += detail::DropIrregularEntries(*atlases[i]);
      RefuseAmbiguous(*atlases[i], options_.names[i]);
      RaiseCounters(*atlases[i]);
    }
    if (std::ranges::all_of(branches_.base.maps, [](const Map& map) { return map.keyframes.empty(); }))
      throw Error(ErrorKind::kNotPossible, options_.names[0] +
                                               ": has no keyframes, so nothing tells what both sides "
                                               "have in common; `MergeAtlases` brings them together");
  }

  static void RefuseAmbiguous(const Atlas& atlas, const std::string& name) {
    const AtlasIndex index(atlas);
    const auto refuse = [&](std::string_view what) {
      throw Error(ErrorKind::kNotPossible, name + ": " + std::string(what) +
                                               ", so it cannot be told which is meant; `CheckAtlas` lists them, "
                                               "`RepairAtlas` gives them others");
    };
    if (!index.duplicate_keyframes().empty() || !index.duplicate_points().empty() || !index.duplicate_maps().empty() ||
        !index.duplicate_cameras().empty())
      refuse("ids are there more than once");
    for (const Map& map : atlas.maps)
      if (!map.id || std::ranges::any_of(map.keyframes, [](const KeyFrame& each) { return !each.id; }) ||
          std::ranges::any_of(map.points, [](const MapPoint& each) { return !each.id; }))
        refuse("something has no id");
  }

  void CompareVocabularies() {
    const Vocabulary &base = branches_.base.vocabulary, &ours = branches_.ours.vocabulary,
                     &theirs = branches_.theirs.vocabulary;
    if (ours.checksum == theirs.checksum) return;
    if (!options_.ignore_vocabulary)
      throw Error(ErrorKind::kNotPossible,
                  options_.names[2] + ": its bags of words are of vocabulary '" + theirs.name + "' (MD5 " +
                      theirs.checksum + "), those of " + options_.names[1] + " of '" + ours.name + "' (" +
                      ours.checksum + "); recompute the bags of words of one; MergeOptions::force merges all the same");
    const bool is_ours = base.checksum != ours.checksum || base.checksum == theirs.checksum;
    if (!is_ours) branches_.ours.vocabulary = theirs;
    report().warnings.push_back(options_.names[is_ours ? 2 : 1] +
                                ": its bags of words are of another vocabulary; compute them anew before place "
                                "recognition");
  }

  // Members of a fork mean something in their own layout only: that of the base, if it has any, or else of a side.
  void AgreeOnLayout() {
    Atlas &base = branches_.base, &ours = branches_.ours, &theirs = branches_.theirs;
    const Atlas* owner = &ours;
    if (detail::HasMembersOfAFork(base))
      owner = &base;
    else if (!detail::HasMembersOfAFork(ours) && detail::HasMembersOfAFork(theirs))
      owner = &theirs;
    const std::string layout = owner->layout;
    for (const std::size_t side : {0, 1}) {
      Atlas& atlas = side == 0 ? ours : theirs;
      if (atlas.layout == layout) continue;
      std::uint64_t& dropped = report().dropped_members[side];
      detail::ForEachCarried(atlas, [&](Boxed<Carried>& carried) { dropped += detail::DropMembers(carried); });
      atlas.layout = layout;
    }
    base.layout = layout;
  }

  // Of points that a side fused.
  void UniteLandmarks() {
    for (Atlas* atlas : {&branches_.base, &branches_.ours, &branches_.theirs})
      for (Map& map : atlas->maps) detail::UniteLandmarks(classes_, map);
  }

  // What the format of a side has no place for.
  void TakeOver(std::size_t side) {
    const detail::Unrecorded& what = unrecorded_[side];
    if (!what.Any()) return;
    if (what.landmarks)
      report().warnings.push_back(report().names[side + 1] + ": has no landmarks, as an .osa file has none: those of " +
                                  report().names[0] + " count as unchanged there");
    places_in_base_[side] = detail::TakeOver(what, branches_.base, classes_, options_.threads,
                                             side == 0 ? branches_.ours : branches_.theirs);
  }

  // Lays landmarks that were taken over to where their points are in the side.
  void SettleLandmarks(std::size_t side, std::uint32_t row) {
    if (row < places_in_base_[side].size())
      detail::FollowPoints(places_in_base_[side][row], classes_,
                           (side == 0 ? branches_.ours : branches_.theirs).maps[row]);
  }

  static std::vector<MapId> IdsOfMaps(const Atlas& atlas) {
    std::vector<MapId> ids;
    for (const Map& map : atlas.maps) ids.push_back(map.id);
    return ids;
  }

  // ---- maps

  void MergeGroup(const MapGroup& group) {
    const auto ids = [](const std::vector<MapId>& of_atlas, const std::vector<std::uint32_t>& rows) {
      std::vector<MapId> list;
      for (const std::uint32_t row : rows) list.push_back(of_atlas[row]);
      return list;
    };
    MergedBranchMap merged{.map = {},
                           .base = ids(base_maps_, group.base),
                           .ours = ids(our_maps_, group.ours),
                           .theirs = ids(their_maps_, group.theirs)};
    std::vector<MapId> unified;  // ids of theirs by now
    for (const std::uint32_t row : group.theirs) unified.push_back(branches_.theirs.maps[row].id);
    if (group.ours.empty() && group.theirs.empty()) return;
    if (group.ours.empty() || group.theirs.empty()) return TakeWhole(group);
    const detail::LandmarkPlan landmarks = PlanLandmarks(group);
    for (const std::uint32_t row : group.ours) SettleLandmarks(0, row);
    for (const std::uint32_t row : group.theirs) SettleLandmarks(1, row);
    if (group.IsJoined()) detail::LayTogether(branches_, group, options_.threads);
    const Map* base = group.base.empty() ? nullptr : &branches_.base.maps[group.base.front()];
    Map &ours = branches_.ours.maps[group.ours.front()], &theirs = branches_.theirs.maps[group.theirs.front()];
    const MapId id = ours.id;
    if (ours.keyframes.empty() && theirs.keyframes.empty())
      MergeWithoutKeyFrames(base, landmarks, ours, theirs);
    else
      MergeMap(group, landmarks, merged);
    for (const MapId mine : merged.ours) map_of_ours_.emplace(mine.value(), id);
    for (const MapId other : unified) map_of_theirs_.emplace(other.value(), id);
    merged.map = id;
    if (merged.motion_of_ours.common + merged.motion_of_theirs.common > 0) report().maps.push_back(std::move(merged));
    parts_.push_back({group.ours.front(), std::move(ours)});
  }

  detail::LandmarkPlan PlanLandmarks(const MapGroup& group) const {
    const auto lists = [](const Atlas& atlas, const std::vector<std::uint32_t>& rows) {
      detail::LandmarkLists all;
      for (const std::uint32_t row : rows) all.emplace_back(atlas.maps[row].landmarks);
      return all;
    };
    const auto base = lists(branches_.base, group.base), ours = lists(branches_.ours, group.ours),
               theirs = lists(branches_.theirs, group.theirs);
    const bool has_landmarks = std::ranges::any_of(base, [](const auto& list) { return !list.empty(); });
    const auto moved = [&](const Atlas& side, const std::vector<std::uint32_t>& rows) {
      return has_landmarks && !group.base.empty() &&
             detail::ToAnotherFrame(side.maps[rows.front()], branches_.base.maps[group.base.front()]).has_value();
    };
    const bool with_places =
        !group.IsJoined() && !moved(branches_.ours, group.ours) && !moved(branches_.theirs, group.theirs);
    return detail::PlanLandmarks(base, ours, theirs, options_.prefer, with_places);
  }

  // What one side made, or deleted while the other went on with it, or not.
  void TakeWhole(const MapGroup& group) {
    const bool is_ours = !group.ours.empty();
    Atlas& atlas = is_ours ? branches_.ours : branches_.theirs;
    for (const std::uint32_t row : is_ours ? group.ours : group.theirs) {
      Map& map = atlas.maps[row];
      if (!group.base.empty()) {
        if (!IsExtended(map, group)) continue;
        report().conflicts.push_back({{.map = map.id}, "deletion", is_ours ? BranchSide::kOurs : BranchSide::kTheirs});
      }
      SettleLandmarks(is_ours ? 0 : 1, row);
      took_any_ = took_any_ || !is_ours;
      const std::uint64_t before = map.id.value();
      if (!is_ours) map.id = FreeMapId(map.id);
      (is_ours ? map_of_ours_ : map_of_theirs_).emplace(before, map.id);
      parts_.push_back({(is_ours ? 0 : branches_.ours.maps.size()) + row, std::move(map)});
    }
  }

  // The id of a map of theirs itself where ours has none of it.
  MapId FreeMapId(MapId id) {
    if (map_ids_.empty())
      for (const MapId taken : our_maps_) map_ids_.insert(taken.value());
    if (map_ids_.insert(id.value()).second) return id;
    const std::uint64_t shift = report().shift[static_cast<std::size_t>(IdKind::kMap)];
    std::uint64_t free = std::max(branches_.ours.next_ids.map, branches_.theirs.next_ids.map + shift);
    while (!map_ids_.insert(free).second) ++free;
    return MapId(free);
  }

  // Whether a map of the base has keyframes, observations, edges or landmarks that the base has not, or, of clouds and
  // landmarks alone, anything.
  bool IsExtended(const Map& map, const MapGroup& group) const {
    if (map.keyframes.empty())
      return group.base.empty() || HashAlone(map) != HashAlone(branches_.base.maps[group.base.front()]);
    detail::LandmarkLists landmarks;
    for (const std::uint32_t row : group.base) landmarks.emplace_back(branches_.base.maps[row].landmarks);
    if (detail::HasOtherLandmarks(landmarks, map.landmarks)) return true;
    return std::ranges::any_of(map.keyframes, [&](const KeyFrame& keyframe) {
      const EntityRow place = base_index_->LocateKeyFrame(keyframe.id);
      if (!place) return true;
      const KeyFrame& was = branches_.base.maps[place.map].keyframes[place.row];
      const Column<MapPointId>&now = keyframe.features.map_points, &before = was.features.map_points;
      if (detail::HasMore(keyframe.loop_edges, was.loop_edges) ||
          detail::HasMore(keyframe.merge_edges, was.merge_edges))
        return true;
      for (std::size_t slot = 0; slot < now.size(); ++slot)
        if (now[slot] && (slot >= before.size() || classes_.Of(now[slot]) != classes_.Of(before[slot]))) return true;
      return false;
    });
  }

  // Whatever the map is called.
  static std::uint64_t HashAlone(const Map& map) {
    Atlas alone;
    alone.maps.push_back(map);
    alone.maps.front().id = MapId();
    return HashOf(alone);
  }

  // Clouds and landmarks, of which nothing but ids tells what is what.
  void MergeWithoutKeyFrames(const Map* base, const detail::LandmarkPlan& landmarks, Map& ours, Map& theirs) {
    if (ours.points.empty() && theirs.points.empty()) {
      detail::StructureReport merged =
          detail::MergeStructure(base, ours, theirs, classes_, {}, {}, StructureOptionsOf(landmarks, false));
      took_any_ = took_any_ || merged.took_any;
      std::ranges::move(merged.conflicts, std::back_inserter(report().conflicts));
      return;
    }
    const std::uint64_t our_hash = HashAlone(ours), their_hash = HashAlone(theirs);
    const std::uint64_t base_hash = base ? HashAlone(*base) : 0;
    switch (detail::PickOf(base ? &base_hash : nullptr, our_hash, their_hash)) {
      case detail::Pick::kOurs:
        return;
      case detail::Pick::kTheirs:
        took_any_ = true;
        ours = std::move(theirs);
        return;
      case detail::Pick::kConflict:
        throw Error(ErrorKind::kNotPossible,
                    ToString(ours.id) +
                        " has points and no keyframes, and both sides changed it, so nothing tells "
                        "which point is which; `Extract` leaves it out");
    }
  }

  detail::StructureOptions StructureOptionsOf(const detail::LandmarkPlan& landmarks, bool flags_of_ours) const {
    return {.prefer = options_.prefer,
            .geometry = options_.geometry,
            .flags_of_ours = flags_of_ours,
            .landmarks = landmarks,
            .threads = options_.threads};
  }

  void MergeMap(const MapGroup& group, const detail::LandmarkPlan& landmarks, MergedBranchMap& merged) {
    Map* base = group.base.empty() ? nullptr : &branches_.base.maps[group.base.front()];
    Map &ours = branches_.ours.maps[group.ours.front()], &theirs = branches_.theirs.maps[group.theirs.front()];
    const bool flags_of_ours = !group.IsJoined() && ChooseFrame(base, ours, theirs, merged);
    const std::vector<std::uint8_t> moved_by_ours = MovedPoints(base, ours),
                                    moved_by_theirs = MovedPoints(base, theirs);
    BendSides(base, ours, theirs, merged);
    const detail::PlacesOfPoints places = detail::PlacesBeforeMerging(landmarks, ours, theirs, classes_);
    detail::StructureReport structure = detail::MergeStructure(
        base, ours, theirs, classes_, moved_by_ours, moved_by_theirs, StructureOptionsOf(landmarks, flags_of_ours));
    took_any_ = took_any_ || structure.took_any;
    report().dangling += structure.dangling;
    merged.recounted = structure.recounted;
    std::ranges::move(structure.conflicts, std::back_inserter(report().conflicts));
    detail::FollowPoints(places, classes_, ours);
    Fuse(structure, ours, merged);
  }

  // A side that lies in another frame than the base, or has another unit, keeps both: the others are moved there as a
  // whole. Returns whether flags of the IMU are those of ours though theirs changed them, because its frame is not
  // kept.
  bool ChooseFrame(Map* base, Map& ours, Map& theirs, MergedBranchMap& merged) {
    if (!detail::ToAnotherFrame(ours, theirs)) return false;
    const bool ours_left = base && detail::ToAnotherFrame(ours, *base),
               theirs_left = base && detail::ToAnotherFrame(theirs, *base);
    const bool to_theirs =
        options_.geometry == BranchGeometry::kTheirs || (options_.geometry != BranchGeometry::kOurs && theirs_left &&
                                                         (!ours_left || options_.prefer == BranchSide::kTheirs));
    Map &target = to_theirs ? theirs : ours, &source = to_theirs ? ours : theirs;
    (to_theirs ? merged.motion_of_ours : merged.motion_of_theirs).another_frame = true;
    const Similarity3d moved = *detail::ToAnotherFrame(target, source);
    for (std::string& warning : TransformWarnings(source, moved)) report().warnings.push_back(std::move(warning));
    TransformMap(source, moved, options_.threads);
    if (base != nullptr)
      if (const auto of_base = detail::ToAnotherFrame(target, *base)) TransformMap(*base, *of_base, options_.threads);
    return !to_theirs && theirs_left;
  }

  void BendSides(const Map* base, Map& ours, Map& theirs, MergedBranchMap& merged) {
    const auto bend = [&](const detail::Targets& targets, Map& map, BranchMotion& motion) {
      const bool another_frame = motion.another_frame;
      motion = detail::Bend(targets, options_.threads, map);
      motion.another_frame = another_frame;
    };
    if (options_.geometry == BranchGeometry::kOurs)
      return bend(detail::PosesOf(ours, theirs), theirs, merged.motion_of_theirs);
    if (options_.geometry == BranchGeometry::kTheirs)
      return bend(detail::PosesOf(theirs, ours), ours, merged.motion_of_ours);
    const detail::Reconciled poses = detail::Reconcile(base, ours, theirs);
    bend(poses.ours, ours, merged.motion_of_ours);
    bend(poses.theirs, theirs, merged.motion_of_theirs);
  }

  void Fuse(const detail::StructureReport& structure, Map& map, MergedBranchMap& merged) {
    if (!options_.fuse || (structure.own_points >= map.points.size() && structure.coincide.empty())) return;
    FuseOptions fuse = *options_.fuse;
    fuse.known.insert(fuse.known.end(), structure.coincide.begin(), structure.coincide.end());
    fuse.threads = options_.threads;
    const auto places = map.landmarks.empty() ? detail::PlacesOfPoints() : detail::PlacesOf(map, {});
    const FuseReport fused = FusePoints(map, structure.own_points, fuse);
    detail::FollowFusing(places, fused, map);
    cleared_ += fused.cleared_slots;
    report().fused.insert(report().fused.end(), fused.replaced.begin(), fused.replaced.end());
    merged.fused = fused;
  }

  // ---- what is around the maps

  void Assemble() {
    std::ranges::stable_sort(parts_, {}, &Part::order);
    Atlas &atlas = result_.atlas, &ours = branches_.ours, &theirs = branches_.theirs;
    std::vector<Map> maps;
    for (Part& part : parts_) maps.push_back(std::move(part.map));
    ours.maps = std::move(maps);
    atlas = std::move(ours);
    MergeCameras(theirs.cameras);
    if (took_any_)
      for (const CounterField& counter : CounterFields()) {
        std::uint64_t& next = atlas.next_ids.*counter.field;
        next = std::max(next, theirs.next_ids.*counter.field + report().shift[static_cast<std::size_t>(counter.kind)]);
      }
    RaiseCounters(atlas);
    std::ranges::sort(report().fused);
  }

  // Those of ours, and of theirs those that are used or new.
  void MergeCameras(std::vector<Camera>& theirs) {
    std::unordered_set<std::uint64_t> known, used, old;
    for (const Camera& camera : branches_.base.cameras) old.insert(camera.id.value());
    std::vector<Camera>& cameras = result_.atlas.cameras;
    for (const Camera& camera : cameras) known.insert(camera.id.value());
    for (const Map& map : result_.atlas.maps)
      for (const KeyFrame& keyframe : map.keyframes)
        used.insert({keyframe.camera.value(), keyframe.right_camera.value()});
    for (Camera& camera : theirs) {
      const std::uint64_t id = camera.id.value();
      if (known.contains(id) || (old.contains(id) && !used.contains(id))) continue;
      cameras.push_back(std::move(camera));
      took_any_ = true;
    }
  }

  void RecordIds(const detail::UnifiedIds& unified, const detail::Inventory& ours, const detail::Inventory& result) {
    const auto is_keyframe = [&](std::uint64_t id) {
      return std::ranges::binary_search(result.keyframes, id, {}, [](const auto& each) { return each.first; });
    };
    const auto map_of = [](const auto& maps, std::uint64_t id) {
      const auto found = maps.find(id);
      return found == maps.end() ? kNoId : found->second.value();
    };
    IdMap mine{.input = report().names[1]}, other{.input = report().names[2]};
    for (const MapId map : std::span(our_maps_).first(maps_of_ours_))
      mine[IdKind::kMap].push_back({map.value(), map_of(map_of_ours_, map.value())});
    for (const auto& [id, features] : ours.keyframes)
      mine[IdKind::kKeyFrame].push_back({id, is_keyframe(id) ? id : kNoId});
    for (const std::uint64_t id : ours.points) mine[IdKind::kPoint].push_back({id, SurvivorOf(id, result)});
    other.kinds = unified.pairs;
    for (IdPair& pair : other[IdKind::kMap]) pair.after = map_of(map_of_theirs_, pair.after);
    for (IdPair& pair : other[IdKind::kKeyFrame])
      if (!is_keyframe(pair.after)) pair.after = kNoId;
    for (IdPair& pair : other[IdKind::kPoint]) pair.after = SurvivorOf(pair.after, result);
    std::ranges::sort(mine[IdKind::kMap], {}, &IdPair::before);
    report().id_maps = {std::move(mine), std::move(other)};
  }

  std::uint64_t SurvivorOf(std::uint64_t id, const detail::Inventory& result) const {
    const auto& fused = result_.report.fused;
    for (std::size_t steps = 0; steps <= fused.size(); ++steps) {
      if (std::ranges::binary_search(result.points, id)) return id;
      const auto found =
          std::ranges::lower_bound(fused, MapPointId(id), {}, [](const auto& pair) { return pair.first; });
      if (found == fused.end() || found->first != MapPointId(id)) break;
      id = found->second.value();
    }
    return kNoId;
  }

  detail::Branches branches_;
  const ThreeWayOptions& options_;
  ThreeWayResult result_;
  std::optional<AtlasIndex> base_index_;
  detail::PointClasses classes_;
  std::vector<Part> parts_;
  std::unordered_map<std::uint64_t, MapId> map_of_ours_, map_of_theirs_;  // ids before (unified) and after
  std::vector<MapId> base_maps_, our_maps_, their_maps_;                  // by row, as they came
  std::size_t maps_of_ours_ = 0;                  // that came; those that were taken over stand behind
  std::unordered_set<std::uint64_t> map_ids_;     // of the result; filled when first needed
  std::uint64_t cleared_ = 0;                     // keypoints that fusing emptied
  bool took_any_ = false;                         // something of theirs is in the result
  std::array<detail::Unrecorded, 2> unrecorded_;  // of ours and theirs, as they came
  std::array<std::vector<detail::PlacesOfPoints>, 2> places_in_base_;  // by row of the maps of ours and theirs
};

}  // namespace

std::string_view NameOf(BranchSide side) { return kSides[static_cast<std::size_t>(side)]; }

std::string_view NameOf(BranchGeometry geometry) { return kGeometries[static_cast<std::size_t>(geometry)]; }

std::string MessageOf(const BranchConflict& conflict) {
  const std::string_view taken = NameOf(conflict.taken);
  if (conflict.what == "deletion")
    return detail::Concat("deleted by ", conflict.taken == BranchSide::kOurs ? "theirs" : "ours", ", extended by ",
                          taken, ": kept");
  return detail::Concat(conflict.what, ": that of ", taken, " is taken");
}

ThreeWayResult MergeThreeWays(Atlas base, Atlas ours, Atlas theirs, const ThreeWayOptions& options) {
  return ThreeWayMerger({std::move(base), std::move(ours), std::move(theirs)}, options).Run();
}

void TellWarnings(const ThreeWayReport& report, Notices& notices) {
  if (report.other_images > 0)
    notices.Warn(detail::Counted(report.other_images, "keyframe") + " of a side " +
                 (report.other_images == 1 ? "has an id" : "have ids") + " of " + report.names[0] +
                 " and another image, and count as new");
  for (const std::size_t side : {0, 1})
    if (report.dropped_members[side] > 0)
      notices.Lose(report.names[side + 1] +
                   ": the members of its fork are of another layout than those of the result, and were left out");
  for (const std::string& warning : report.warnings) notices.Warn(warning);
}

}  // namespace slamdb
