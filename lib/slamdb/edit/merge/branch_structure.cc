// SPDX-License-Identifier: BSD-3-Clause
// Ours becomes the result.
// 1. Which keypoints see which points in each of the three, points by their classes.
// 2. Who stays: what one side deleted goes, unless the other went on with it.
// 3. Keypoint by keypoint, whom it sees in the result.
// 4. Fields and edges of keyframes and points that both sides have; those of theirs alone are appended.
// 5. Lists of observations are made of the keypoints; what changed is computed anew.
// 6. What is gone is cut out, and what hung on it hung up elsewhere.
#include "slamdb/edit/merge/detail/branch_structure.h"

#include <algorithm>
#include <iterator>

#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/edit/merge/detail/branch_view.h"
#include "slamdb/edit/merge/detail/refresh_points.h"
#include "slamdb/edit/merge/detail/three_ways.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/covisibility.h"
#include "slamdb/model/detail/observed.h"
#include "slamdb/model/detail/row_hash.h"

namespace slamdb::detail {
namespace {

using Flags = std::vector<std::uint8_t>;

// What becomes of one keyframe or class of points.
enum class Fate { kStays, kGone, kKept };

class Merge {
 public:
  Merge(const Map* base, Map& ours, Map& theirs, const PointClasses& classes, const Flags& moved_by_ours,
        const Flags& moved_by_theirs, const StructureOptions& options)
      : ours_map_(ours),
        theirs_map_(theirs),
        classes_(classes),
        moved_by_ours_(moved_by_ours),
        moved_by_theirs_(moved_by_theirs),
        options_(options),
        base_(base ? View(*base, classes) : View()),
        ours_(ours, classes),
        theirs_(theirs, classes) {}

  StructureReport Run() {
    ListClasses();
    DecideKeyFrames();
    DecidePoints();
    CollectExtras();
    MergeKeypoints();
    MergeKeyFrames();
    MergePoints();
    MergeHeader();
    if (changed_) Close();
    return std::move(report_);
  }

 private:
  // ---- classes of points

  struct Class {
    MapPointId id;
    bool in_base = false;
    std::uint32_t ours = kNoRow, theirs = kNoRow;  // rows of the points that go by its name, or else of any
    bool extended_by_ours = false, extended_by_theirs = false;
    Fate fate = Fate::kStays;
    std::vector<Observation> observations;  // of the result
  };

  Class& ClassOf(MapPointId id) { return class_list_[class_rows_.at(id.value())]; }
  Class* FindClass(MapPointId id) {
    const auto found = id ? class_rows_.find(id.value()) : class_rows_.end();
    return found == class_rows_.end() ? nullptr : &class_list_[found->second];
  }

  void ListClasses() {
    const auto each = [&](const View& view, const auto& note) {
      if (view.map == nullptr) return;
      for (std::uint32_t row = 0; row < view.map->points.size(); ++row) {
        const MapPointId point = view.map->points[row].id, id = classes_.Of(point);
        const auto [found, is_new] = class_rows_.emplace(id.value(), class_list_.size());
        if (is_new) class_list_.push_back({.id = id});
        note(class_list_[found->second], row, point == id);
      }
    };
    each(ours_, [](Class& of, std::uint32_t row, bool own) {
      if (of.ours == kNoRow || own) of.ours = row;
    });
    each(base_, [](Class& of, std::uint32_t, bool) { of.in_base = true; });
    each(theirs_, [](Class& of, std::uint32_t row, bool own) {
      if (of.theirs == kNoRow || own) of.theirs = row;
    });
  }

  // ---- who stays

  // visit(slot, its class in the base or none, its class in the side) for the keypoints of a keyframe of a side.
  template <class Visit>
  void ForEachGain(const View& side, std::uint32_t row, const Visit& visit) const {
    const std::uint32_t in_base = base_.Row(side.map->keyframes[row].id);
    const std::vector<MapPointId>& slots = side.sightings.Of(row);
    for (std::size_t slot = 0; slot < slots.size(); ++slot)
      if (slots[slot] && slots[slot] != base_.sightings.Of(in_base, slot)) visit(slots[slot]);
  }

  static bool HasMore(const Column<KeyFrameId>& now, const Column<KeyFrameId>& before) {
    return std::ranges::any_of(now, [&](KeyFrameId id) { return std::ranges::find(before, id) == before.end(); });
  }

  // Whether a side did more to a keyframe of the base than optimising it.
  bool IsExtended(const View& side, const KeyFrame& before, const KeyFrame& now) const {
    bool gains = false;
    ForEachGain(side, side.Row(now.id), [&](MapPointId) { gains = true; });
    const auto is_new_child = [&](KeyFrameId child) { return side.Find(child) && !base_.Find(child); };
    return gains || HasMore(now.loop_edges, before.loop_edges) || HasMore(now.merge_edges, before.merge_edges) ||
           std::ranges::any_of(now.children, is_new_child);
  }

  void Conflict(Place place, std::string_view what, BranchSide taken) {
    place.map = ours_map_.id;
    report_.conflicts.push_back({place, what, taken});
  }

  void DecideKeyFrames() {
    gone_keyframes_.assign(ours_map_.keyframes.size(), 0);
    taken_keyframes_.assign(theirs_map_.keyframes.size(), 0);
    for (std::uint32_t row = 0; row < ours_map_.keyframes.size(); ++row) {
      const KeyFrame& keyframe = ours_map_.keyframes[row];
      const KeyFrame* before = base_.map ? base_.Find(keyframe.id) : nullptr;
      if (before == nullptr || theirs_.Find(keyframe.id)) continue;
      if (IsExtended(ours_, *before, keyframe)) {
        Conflict({.keyframe = keyframe.id}, "deletion", BranchSide::kOurs);
      } else {
        gone_keyframes_[row] = 1;
        changed_ = true;
      }
    }
    for (std::uint32_t row = 0; row < theirs_map_.keyframes.size(); ++row) {
      const KeyFrame& keyframe = theirs_map_.keyframes[row];
      if (ours_.Find(keyframe.id)) continue;
      const KeyFrame* before = base_.map ? base_.Find(keyframe.id) : nullptr;
      if (before != nullptr && !IsExtended(theirs_, *before, keyframe)) continue;
      if (before != nullptr) Conflict({.keyframe = keyframe.id}, "deletion", BranchSide::kTheirs);
      taken_keyframes_[row] = 1;
      changed_ = report_.took_any = true;
    }
  }

  // Whether the result has a keyframe.
  bool Stays(KeyFrameId id) const {
    if (const std::uint32_t row = ours_.Row(id); row != kNoRow) return !gone_keyframes_[row];
    const std::uint32_t row = theirs_.Row(id);
    return row != kNoRow && taken_keyframes_[row];
  }

  void DecidePoints() {
    const auto gains = [&](const View& side, bool Class::*extended) {
      for (std::uint32_t row = 0; row < side.map->keyframes.size(); ++row)
        if (Stays(side.map->keyframes[row].id))
          ForEachGain(side, row, [&](MapPointId id) {
            if (Class* of = FindClass(id)) of->*extended = true;
          });
    };
    gains(ours_, &Class::extended_by_ours);
    gains(theirs_, &Class::extended_by_theirs);
    for (Class& of : class_list_) {
      if (of.ours != kNoRow && of.theirs != kNoRow) continue;
      if (of.ours == kNoRow && of.theirs == kNoRow) {
        of.fate = Fate::kGone;
      } else if (of.in_base) {
        const bool is_ours = of.ours != kNoRow;
        of.fate = (is_ours ? of.extended_by_ours : of.extended_by_theirs) ? Fate::kKept : Fate::kGone;
        if (of.fate == Fate::kKept)
          Conflict({.point = of.id}, "deletion", is_ours ? BranchSide::kOurs : BranchSide::kTheirs);
      }
    }
  }

  // ---- keypoints

  void MergeKeypoints() {
    slots_.resize(ours_map_.keyframes.size() + theirs_map_.keyframes.size());
    listed_.resize(slots_.size());
    for (std::uint32_t row = 0; row < ours_map_.keyframes.size(); ++row) {
      if (gone_keyframes_[row]) continue;
      const std::uint32_t there = theirs_.Row(ours_map_.keyframes[row].id);
      slots_[row] = ours_.sightings.Of(row);
      listed_[row].resize(slots_[row].size());
      for (std::size_t slot = 0; slot < slots_[row].size(); ++slot) MergeKeypoint(row, there, slot);
      Settle(ours_map_.keyframes[row], slots_[row], listed_[row]);
    }
    for (std::uint32_t row = 0; row < theirs_map_.keyframes.size(); ++row) {
      if (!taken_keyframes_[row]) continue;
      const std::size_t to = ours_map_.keyframes.size() + row;
      slots_[to] = theirs_.sightings.Of(row);
      listed_[to].resize(slots_[to].size());
      for (std::size_t slot = 0; slot < slots_[to].size(); ++slot)
        listed_[to][slot] = theirs_.sightings.IsListed(row, slot);
      Settle(theirs_map_.keyframes[row], slots_[to], listed_[to]);
    }
  }

  void MergeKeypoint(std::uint32_t row, std::uint32_t there, std::size_t slot) {
    MapPointId& result = slots_[row][slot];
    std::uint8_t& listed = listed_[row][slot];
    listed = ours_.sightings.IsListed(row, slot);
    if (there == kNoRow) return;
    const KeyFrameId keyframe = ours_map_.keyframes[row].id;
    const std::uint32_t in_base = base_.Row(keyframe);
    const MapPointId before = base_.sightings.Of(in_base, slot), ours = Unless(Deletes(ours_, before), result, before),
                     theirs = Unless(Deletes(theirs_, before), theirs_.sightings.Of(there, slot), before);
    const bool take = PickKeypoint(in_base != kNoRow ? &before : nullptr, ours, theirs, keyframe, slot);
    const auto lists = [&](const View& view, std::uint32_t of) {
      return view.sightings.Of(of, slot) == result && view.sightings.IsListed(of, slot);
    };
    result = take ? theirs : ours;
    listed = lists(ours_, row) || lists(theirs_, there) || lists(base_, in_base);
  }

  // Whether a side lost a point that is in the result all the same.
  bool Deletes(const View& side, MapPointId before) {
    const Class* of = FindClass(before);
    return of != nullptr && of->fate == Fate::kKept && (&side == &ours_ ? of->ours : of->theirs) == kNoRow;
  }
  static MapPointId Unless(bool deletes, MapPointId now, MapPointId before) { return deletes && !now ? before : now; }

  // Whether what theirs sees is taken.
  bool PickKeypoint(const MapPointId* before, MapPointId ours, MapPointId theirs, KeyFrameId keyframe,
                    std::size_t slot) {
    if (ours == theirs || (before && theirs == *before)) return false;
    if ((before && ours == *before) || !ours) return true;
    if (!theirs) return false;
    const bool take = options_.prefer == BranchSide::kTheirs;
    Conflict({.keyframe = keyframe, .feature = static_cast<std::int64_t>(slot)}, "point", options_.prefer);
    report_.coincide.emplace_back(take ? theirs : ours, take ? ours : theirs);
    return take;
  }

  // Keypoints see no point that is not there, and no two of one picture the same one.
  void Settle(const KeyFrame& keyframe, std::vector<MapPointId>& slots, Flags& listed) {
    std::vector<std::pair<MapPointId, std::size_t>> seen;
    for (std::size_t slot = 0; slot < slots.size(); ++slot) {
      if (!slots[slot]) continue;
      const Class* of = FindClass(slots[slot]);
      if (of == nullptr) ++report_.dangling;
      if (of == nullptr || of->fate == Fate::kGone)
        slots[slot] = {};
      else if (listed[slot])
        seen.emplace_back(slots[slot], slot);
    }
    std::ranges::sort(seen);
    for (std::size_t i = 1; i < seen.size(); ++i)
      if (seen[i].first == seen[i - 1].first &&
          IsRight(keyframe, seen[i].second) == IsRight(keyframe, seen[i - 1].second)) {
        slots[seen[i].second] = {};
        seen[i].second = seen[i - 1].second;
      }
  }

  static bool IsRight(const KeyFrame& keyframe, std::size_t slot) {
    return keyframe.right_camera && static_cast<std::int64_t>(slot) >= keyframe.features.left_count;
  }

  // ---- keyframes

  void MergeKeyFrames() {
    std::size_t at = 0;
    for (; at < ours_map_.keyframes.size(); ++at) {
      KeyFrame& keyframe = ours_map_.keyframes[at];
      if (gone_keyframes_[at]) continue;
      if (const KeyFrame* there = theirs_.Find(keyframe.id)) MergeFields(keyframe, *there);
      SetSlots(keyframe, slots_[at]);
    }
    own_keyframes_ = at;
    for (std::uint32_t row = 0; row < theirs_map_.keyframes.size(); ++row) {
      if (!taken_keyframes_[row]) continue;
      KeyFrame& keyframe = ours_map_.keyframes.emplace_back(theirs_map_.keyframes[row]);
      gone_keyframes_.push_back(0);
      SetSlots(keyframe, slots_[own_keyframes_ + row]);
      if (own_keyframes_ + row != ours_map_.keyframes.size() - 1) {
        slots_[ours_map_.keyframes.size() - 1] = std::move(slots_[own_keyframes_ + row]);
        listed_[ours_map_.keyframes.size() - 1] = std::move(listed_[own_keyframes_ + row]);
      }
    }
    slots_.resize(ours_map_.keyframes.size());
    listed_.resize(ours_map_.keyframes.size());
    CutUnlinked();
  }

  void CutUnlinked() {
    if (unlinked_.empty()) return;
    const IdTable rows = KeyFrameTable(ours_map_);
    for (const Unlinked& each : unlinked_)
      if (const std::uint32_t row = rows.Find(each.keyframe.value());
          row != kNoRow && ours_map_.keyframes[row].*each.field == each.other)
        ours_map_.keyframes[row].*each.field = {};
  }

  void SetSlots(KeyFrame& keyframe, const std::vector<MapPointId>& slots) {
    Column<MapPointId>& points = keyframe.features.map_points;
    if (std::ranges::equal(points, slots)) return;
    points.assign(slots.begin(), slots.end());
    changed_ = true;
  }

  // A reference to a keyframe that a side no longer has, and the result has all the same, is as it was.
  KeyFrameId Restored(const View& side, KeyFrameId before, KeyFrameId now) const {
    return before && before != now && !side.Find(before) && Stays(before) ? before : now;
  }

  bool Take(Pick pick, const KeyFrame& keyframe, std::string_view what) {
    if (pick == Pick::kOurs) return false;
    const bool take = pick == Pick::kTheirs || options_.prefer == BranchSide::kTheirs;
    if (pick == Pick::kConflict) Conflict({.keyframe = keyframe.id}, what, options_.prefer);
    changed_ |= take;
    report_.took_any |= take;
    return take;
  }

  template <class Walk>
  void MergeGroup(const KeyFrame* before, const KeyFrame& theirs, std::string_view what, const Walk& walk,
                  KeyFrame& ours) {
    const auto equal = [&](const KeyFrame& a, const KeyFrame& b) { return AreFieldsEqual(a, b, walk); };
    if (before == nullptr) return;  // of what both made, ours stands
    if (Take(PickOf(before, std::as_const(ours), theirs, equal), ours, what)) CopyFields(theirs, ours, walk);
  }

  void MergeFields(KeyFrame& ours, const KeyFrame& theirs) {
    const KeyFrame* before = base_.map ? base_.Find(ours.id) : nullptr;
    const auto group = [&](std::string_view what, const auto& walk) { MergeGroup(before, theirs, what, walk, ours); };
    group("camera", [](const auto& visit) { fields::ForEachCameraField(visit); });
    group("features", [](const auto& visit) {
      fields::ForEachFeatureField([&](std::string_view name, auto... members) {
        if (name != "features.map_points") visit(name, members...);
      });
    });
    group("words", [](const auto& visit) { fields::ForEachWordField(visit); });
    group("imu calibration", [](const auto& visit) { fields::ForEachImuCalibrationField(visit); });
    group("members of a fork", [](const auto& visit) { visit("carried", &KeyFrame::carried); });
    group("origin map", [](const auto& visit) { visit("origin_map", &KeyFrame::origin_map); });
    group("merge scale", [](const auto& visit) { visit("merge_scale", &KeyFrame::merge_scale); });
    group("frame", [](const auto& visit) { visit("frame_id", &KeyFrame::frame_id); });
    for (const auto flag : {&KeyFrame::first_connection, &KeyFrame::not_erase, &KeyFrame::to_be_erased, &KeyFrame::bad,
                            &KeyFrame::imu_initialized, &KeyFrame::has_velocity})
      group("flags", [flag](const auto& visit) { visit("", flag); });
    static const KeyFrame kNone;  // of what both made: what one side alone tells stands
    MergeReferences(before != nullptr ? *before : kNone, theirs, ours);
    if (before != nullptr) MergeConnections(*before, theirs, ours);
    MergeEdges(before, theirs, &KeyFrame::loop_edges, ours);
    MergeEdges(before, theirs, &KeyFrame::merge_edges, ours);
  }

  void MergeReferences(const KeyFrame& before, const KeyFrame& theirs, KeyFrame& ours) {
    const auto merge = [&](KeyFrameId KeyFrame::*field, std::string_view what) {
      const KeyFrameId was = before.*field, our = Restored(ours_, was, ours.*field),
                       their = Restored(theirs_, was, theirs.*field);
      const bool take = Take(PickOf(&was, our, their), ours, what);
      if (const KeyFrameId now = take ? their : our; now != ours.*field) {
        ours.*field = now;
        changed_ = true;
      }
      return take;
    };
    merge(&KeyFrame::parent, "parent");
    const KeyFrameId next_of_ours = ours.next;
    merge(&KeyFrame::next, "next");
    Unlink(ours, next_of_ours, theirs.next, &KeyFrame::next, &KeyFrame::previous);
    // What the IMU measured leads to the keyframe before.
    const KeyFrameId was = ours.previous;
    if (merge(&KeyFrame::previous, "previous"))
      ours.preintegration = theirs.preintegration;
    else if (ours.previous != was)
      ours.preintegration = before.preintegration;
    Unlink(ours, was, theirs.previous, &KeyFrame::previous, &KeyFrame::next);
  }

  // A keyframe has one before it and one after it: whom it does not have in the result does not have it.
  void Unlink(const KeyFrame& keyframe, KeyFrameId of_ours, KeyFrameId of_theirs, KeyFrameId KeyFrame::*field,
              KeyFrameId KeyFrame::*back) {
    for (const KeyFrameId loser : {of_ours, of_theirs})
      if (loser && loser != keyframe.*field) unlinked_.push_back({loser, keyframe.id, back});
  }

  // What theirs recorded otherwise than the base, and ours as that. Where points changed it is counted anew later.
  void MergeConnections(const KeyFrame& before, const KeyFrame& theirs, KeyFrame& ours) {
    if (std::ranges::equal(before.connections, theirs.connections)) return;
    const auto find = [](const Column<Connection>& list, KeyFrameId id) -> const Connection* {
      const auto place = std::ranges::lower_bound(list, id, {}, &Connection::keyframe);
      return place != list.end() && place->keyframe == id ? &*place : nullptr;
    };
    const auto weight = [](const Connection* connection) { return connection ? connection->weight : 0; };
    Column<Connection> merged;
    const auto add = [&](KeyFrameId id) {
      const Connection *was = find(before.connections, id), *our = find(ours.connections, id),
                       *their = find(theirs.connections, id);
      const std::int32_t base = weight(was);
      const Connection* taken = PickOf(&base, weight(our), weight(their)) == Pick::kTheirs ? their : our;
      if (taken != nullptr) merged.push_back(*taken);
    };
    auto our = ours.connections.begin();
    for (const Connection& their : theirs.connections) {
      for (; our != ours.connections.end() && our->keyframe < their.keyframe; ++our) add(our->keyframe);
      if (our != ours.connections.end() && our->keyframe == their.keyframe) ++our;
      add(their.keyframe);
    }
    for (; our != ours.connections.end(); ++our) add(our->keyframe);
    if (std::ranges::equal(merged, ours.connections)) return;
    ours.connections = std::move(merged);
    changed_ = true;
  }

  // An edge that one side added is there, one that a side removed is not.
  void MergeEdges(const KeyFrame* before, const KeyFrame& theirs, Column<KeyFrameId> KeyFrame::*list, KeyFrame& ours) {
    const auto has = [](const Column<KeyFrameId>& edges, KeyFrameId id) {
      return std::ranges::find(edges, id) != edges.end();
    };
    const std::size_t removed = std::erase_if(ours.*list, [&](KeyFrameId id) {
      return before != nullptr && has(before->*list, id) && !has(theirs.*list, id) && theirs_.Find(id);
    });
    std::size_t added = 0;
    for (const KeyFrameId id : theirs.*list) {
      const bool was_removed = before != nullptr && has(before->*list, id) && (ours_.Find(id) || !Stays(id));
      if (has(ours.*list, id) || was_removed) continue;
      (ours.*list).push_back(id);
      ++added;
    }
    changed_ |= removed + added > 0;
    report_.took_any |= added > 0;
  }

  // ---- points

  void MergePoints() {
    CollectObservations();
    for (Class& of : class_list_) {
      if (of.ours == kNoRow || of.theirs == kNoRow || of.fate == Fate::kGone) continue;
      MergePoint(of, ours_map_.points[of.ours], theirs_map_.points[of.theirs]);
    }
    report_.own_points = ours_map_.points.size();
    for (Class& of : class_list_) {
      if (of.fate == Fate::kGone) continue;
      if (of.ours != kNoRow) {
        SetObservations(of, ours_map_.points[of.ours]);
      } else {
        MapPoint& point = ours_map_.points.emplace_back(theirs_map_.points[of.theirs]);
        point.id = of.id;
        point.replaced_by = classes_.Of(point.replaced_by);
        SetObservations(of, point);
        changed_ = report_.took_any = true;
      }
    }
    MarkGonePoints();
    CullPoints();
  }

  // Observations that no keypoint confirms stay as they are, but for those by keyframes that are not there.
  void CollectExtras() {
    extras_.resize(class_list_.size());
    for (const View* side : {&ours_, &theirs_})
      for (const MapPoint& point : side->map->points) {
        const std::size_t row = class_rows_.at(classes_.Of(point.id).value());
        if (side == &theirs_ && class_list_[row].ours != kNoRow) continue;
        for (const Observation& observation : point.observations) {
          const KeyFrame* keyframe = side->Find(observation.keyframe);
          if (keyframe == nullptr)
            ++report_.dangling;
          else if (Stays(observation.keyframe) && !Sightings::Sees(*keyframe, observation.left, point.id) &&
                   !Sightings::Sees(*keyframe, observation.right, point.id))
            extras_[row].push_back(observation);
        }
      }
  }

  void CollectObservations() {
    std::vector<std::uint32_t> order(ours_map_.keyframes.size());
    for (std::uint32_t row = 0; row < order.size(); ++row) order[row] = row;
    std::ranges::sort(order, {}, [&](std::uint32_t row) { return ours_map_.keyframes[row].id; });
    for (const std::uint32_t row : order) {
      const KeyFrame& keyframe = ours_map_.keyframes[row];
      for (std::size_t slot = 0; slot < slots_[row].size(); ++slot) {
        if (!slots_[row][slot] || !listed_[row][slot]) continue;
        std::vector<Observation>& observations = ClassOf(slots_[row][slot]).observations;
        if (observations.empty() || observations.back().keyframe != keyframe.id)
          observations.push_back({.keyframe = keyframe.id});
        (IsRight(keyframe, slot) ? observations.back().right : observations.back().left) =
            static_cast<std::int32_t>(slot);
      }
    }
    for (std::size_t row = 0; row < extras_.size(); ++row)
      for (const Observation& extra : extras_[row]) {
        std::vector<Observation>& observations = class_list_[row].observations;
        const auto place = std::ranges::lower_bound(observations, extra.keyframe, {}, &Observation::keyframe);
        if (place == observations.end() || place->keyframe != extra.keyframe) observations.insert(place, extra);
      }
  }

  void SetObservations(const Class& of, MapPoint& point) {
    const auto differs = [&](const Column<Observation>& list) { return !std::ranges::equal(list, of.observations); };
    if (of.theirs != kNoRow && differs(theirs_map_.points[of.theirs].observations)) seen_otherwise_.push_back(point.id);
    if (of.ours != kNoRow && differs(point.observations)) seen_otherwise_.push_back(point.id);
    if (of.ours == kNoRow || of.theirs == kNoRow) of_one_side_.push_back(point.id);
    if (!differs(point.observations)) return;
    point.observations.assign(of.observations.begin(), of.observations.end());
    changed_points_.push_back(point.id);
    changed_ = true;
  }

  // Points that lost too many observations, as in ORB-SLAM3's MapPoint::EraseObservation, but for those that a side has
  // just so.
  void CullPoints() {
    const IdTable keyframes = KeyFrameTable(ours_map_), points = PointTable(ours_map_);
    for (const MapPointId id : changed_points_) {
      MapPoint& point = ours_map_.points[points.Find(id.value())];
      std::int32_t weight = 0;
      for (const Observation& observation : point.observations)
        if (const std::uint32_t row = keyframes.Find(observation.keyframe.value()); row != kNoRow)
          weight += ObservationWeight(ours_map_.keyframes[row], observation);
      const std::int32_t before = point.observation_count;
      point.observation_count = weight;
      Class& of = ClassOf(classes_.Of(id));
      const MapPoint* there = of.theirs == kNoRow ? nullptr : &theirs_map_.points[of.theirs];
      if (weight > kCulledAt || std::max(before, there ? there->observation_count : 0) <= kCulledAt ||
          (there && std::ranges::equal(there->observations, point.observations)))
        continue;
      of.fate = Fate::kGone;
      gone_points_[points.Find(id.value())] = 1;
      for (const Observation& observation : point.observations)
        if (const std::uint32_t row = keyframes.Find(observation.keyframe.value()); row != kNoRow)
          std::ranges::replace(ours_map_.keyframes[row].features.map_points, id, MapPointId());
    }
  }

  void MergePoint(const Class& of, MapPoint& ours, const MapPoint& theirs) {
    const MapPoint* before = base_.map ? base_.Find(ours.id) : nullptr;
    if (ours.id != theirs.id) before = nullptr;
    if (before != nullptr) {
      const auto merge = [&](auto field, std::string_view what) {
        const auto equal = [](const auto& a, const auto& b) { return a == b; };
        const Pick pick = PickOf(&(before->*field), ours.*field, theirs.*field, equal);
        if (pick == Pick::kOurs) return false;
        if (pick == Pick::kConflict) Conflict({.point = of.id}, what, options_.prefer);
        if (pick == Pick::kConflict && options_.prefer == BranchSide::kOurs) return false;
        ours.*field = theirs.*field;
        changed_ = report_.took_any = true;
        return true;
      };
      merge(&MapPoint::bad, "flags");
      merge(&MapPoint::replaced_by, "replacement");
      merge(&MapPoint::first_keyframe, "first keyframe");
      merge(&MapPoint::first_frame, "first frame");
      merge(&MapPoint::origin_map, "origin map");
      merge(&MapPoint::carried, "members of a fork");
      MergeReference(*before, theirs, ours);
      AddCounts(*before, theirs, &MapPoint::visible_count, ours);
      AddCounts(*before, theirs, &MapPoint::found_count, ours);
    }
    MergePosition(of, ours, theirs);
  }

  void AddCounts(const MapPoint& before, const MapPoint& theirs, std::int32_t MapPoint::*count, MapPoint& ours) {
    if (theirs.*count == before.*count || theirs.*count == MapPoint::kNoCount) return;
    if (ours.*count == MapPoint::kNoCount || before.*count == MapPoint::kNoCount) {
      ours.*count = std::max(ours.*count, theirs.*count);
    } else {
      const std::int64_t sum = std::int64_t{ours.*count} + theirs.*count - before.*count;
      ours.*count =
          static_cast<std::int32_t>(std::clamp<std::int64_t>(sum, 0, std::numeric_limits<std::int32_t>::max()));
    }
    changed_ = report_.took_any = true;
  }

  // The reference keyframe is where a point is measured from; another one is no conflict, as nothing of it is lost.
  void MergeReference(const MapPoint& before, const MapPoint& theirs, MapPoint& ours) {
    const KeyFrameId was = before.reference, our = Restored(ours_, was, ours.reference),
                     their = Restored(theirs_, was, theirs.reference);
    const Pick pick = PickOf(&was, our, their);
    const bool take = pick == Pick::kTheirs || (pick == Pick::kConflict && options_.prefer == BranchSide::kTheirs);
    const KeyFrameId now = take ? their : our;
    if (now == ours.reference) return;
    ours.reference = now;
    moved_points_.push_back(ours.id);
    changed_ = true;
  }

  // Where a point is that both sides have.
  void MergePosition(const Class& of, MapPoint& ours, const MapPoint& theirs) {
    const bool by_ours = moved_by_ours_[of.ours] != 0, by_theirs = moved_by_theirs_[of.theirs] != 0;
    Eigen::Vector3f position = ours.position;
    if (options_.geometry == BranchGeometry::kTheirs || (AlignsPoints() && by_theirs && !by_ours)) {
      position = theirs.position;
    } else if (AlignsPoints() && by_theirs) {
      const auto weight_of_ours = static_cast<float>(ours.observations.size() + 1),
                 weight_of_theirs = static_cast<float>(theirs.observations.size() + 1);
      position =
          (weight_of_ours * ours.position + weight_of_theirs * theirs.position) / (weight_of_ours + weight_of_theirs);
    }
    if (position == ours.position || !position.allFinite()) return;
    ours.position = position;
    moved_points_.push_back(ours.id);
    changed_ = true;
  }

  bool AlignsPoints() const {
    return options_.geometry == BranchGeometry::kAlign || options_.geometry == BranchGeometry::kOptimize;
  }

  void MarkGonePoints() {
    gone_points_.assign(ours_map_.points.size(), 0);
    for (std::size_t row = 0; row < report_.own_points; ++row) {
      const MapPointId id = ours_map_.points[row].id;
      const Class& of = ClassOf(classes_.Of(id));
      if (of.fate != Fate::kGone && of.ours == row) continue;
      gone_points_[row] = 1;
      changed_ = true;
    }
  }

  // ---- the map

  void MergeHeader() {
    const Map* before = base_.map;
    const Map& theirs = theirs_map_;
    const auto merge = [&](auto field) {
      if (before == nullptr) return;
      const Pick pick = PickOf(&(before->*field), ours_map_.*field, theirs.*field);
      if (pick == Pick::kTheirs || (pick == Pick::kConflict && options_.prefer == BranchSide::kTheirs))
        ours_map_.*field = theirs.*field;
    };
    const Map was = HeaderOf(ours_map_);
    merge(&Map::initial_keyframe);
    merge(&Map::first_keyframe);
    merge(&Map::carried);
    if (!options_.flags_of_ours)
      for (const auto flag : {&Map::imu_initialized, &Map::inertial, &Map::imu_ba1, &Map::imu_ba2}) merge(flag);
    if (before != nullptr)
      ours_map_.big_change_index =
          static_cast<std::int32_t>(std::int64_t{ours_map_.big_change_index} +
                                    (std::int64_t{theirs.big_change_index} - before->big_change_index));
    for (const KeyFrameId origin : theirs.origins)
      if (std::ranges::find(ours_map_.origins, origin) == ours_map_.origins.end() &&
          (before == nullptr || std::ranges::find(before->origins, origin) == before->origins.end()))
        ours_map_.origins.push_back(origin);
    MergeLandmarks();
    if (report_.took_any) {
      ours_map_.max_keyframe_id = std::max(ours_map_.max_keyframe_id, theirs.max_keyframe_id);
      for (const KeyFrame& keyframe : theirs.keyframes)
        if (keyframe.id < ours_map_.lowest_keyframe && Stays(keyframe.id)) ours_map_.lowest_keyframe = keyframe.id;
    }
    changed_ |= HashOfHeader(HeaderOf(ours_map_)) != HashOfHeader(was);
  }

  static Map HeaderOf(const Map& map) {
    Map header;
    ForEachField(&map, [&](std::string_view, auto member) { header.*member = map.*member; });
    return header;
  }

  void MergeLandmarks() {
    if (theirs_map_.landmarks.empty() && ours_map_.landmarks.empty()) return;
    std::unordered_map<std::uint64_t, const Landmark*> before, ours, theirs;
    const auto list = [](const std::vector<Landmark>& landmarks, auto& table) {
      for (const Landmark& landmark : landmarks)
        if (landmark.is_numbered()) table.emplace(landmark.id.value(), &landmark);
    };
    if (base_.map != nullptr) list(base_.map->landmarks, before);
    list(theirs_map_.landmarks, theirs);
    const auto find = [](const auto& table, LandmarkId id) {
      const auto found = table.find(id.value());
      return found == table.end() ? nullptr : found->second;
    };
    const auto differ = [](const Landmark& a, const Landmark& b) { return HashOf(a) != HashOf(b); };
    const std::size_t removed = std::erase_if(ours_map_.landmarks, [&](Landmark& ours_one) {
      const Landmark *was = find(before, ours_one.id), *other = find(theirs, ours_one.id);
      if (other != nullptr) MergeLandmark(was, *other, ours_one);
      if (was == nullptr || other != nullptr) return false;
      if (differ(*was, ours_one)) Conflict({.landmark = ours_one.id}, "deletion", BranchSide::kOurs);
      return !differ(*was, ours_one);
    });
    list(ours_map_.landmarks, ours);
    std::vector<Landmark> added;
    for (const Landmark& landmark : theirs_map_.landmarks) {
      if (find(ours, landmark.id) != nullptr) continue;
      const Landmark* was = find(before, landmark.id);
      if (was != nullptr && !differ(*was, landmark)) continue;
      if (was != nullptr) Conflict({.landmark = landmark.id}, "deletion", BranchSide::kTheirs);
      added.push_back(landmark);
    }
    changed_ |= removed + added.size() > 0;
    report_.took_any |= !added.empty();
    TakeLandmarks(ours_map_.landmarks, added);
  }

  void MergeLandmark(const Landmark* before, const Landmark& theirs, Landmark& ours) {
    const std::int64_t was = before != nullptr ? HashOf(*before) : 0, our = HashOf(ours), their = HashOf(theirs);
    const Pick pick = PickOf(before != nullptr ? &was : nullptr, our, their);
    if (pick == Pick::kConflict) Conflict({.landmark = ours.id}, "landmark", options_.prefer);
    if (pick == Pick::kOurs || (pick == Pick::kConflict && options_.prefer == BranchSide::kOurs)) return;
    ours = theirs;
    changed_ = report_.took_any = true;
  }

  // ---- what follows

  void Close() {
    RefreshPoints(ours_map_, changed_points_);
    RecountCovisibility();
    RefreshViews();
    CutOut();
  }

  // Where keyframes see other points than a side recorded: those of points that are not seen as in both sides, and
  // those of both sides that see points of one.
  void RecountCovisibility() {
    const IdTable keyframes = KeyFrameTable(ours_map_), points = PointTable(ours_map_);
    std::vector<std::uint32_t> rows;
    const auto add = [&](const std::vector<MapPointId>& list, const auto& counts) {
      for (const MapPointId id : list)
        for (const Observation& observation : ours_map_.points[points.Find(id.value())].observations)
          if (const std::uint32_t row = keyframes.Find(observation.keyframe.value()); row != kNoRow && counts(row))
            rows.push_back(row);
    };
    add(seen_otherwise_, [](std::uint32_t) { return true; });
    add(of_one_side_,
        [&](std::uint32_t row) { return row < own_keyframes_ && theirs_.Find(ours_map_.keyframes[row].id); });
    std::ranges::sort(rows);
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    UpdateCovisibility(ours_map_, rows);
    report_.recounted = rows.size();
  }

  // Of points that moved, or are measured from elsewhere.
  void RefreshViews() {
    const IdTable keyframes = KeyFrameTable(ours_map_), points = PointTable(ours_map_);
    const auto find = [&](KeyFrameId id) -> const KeyFrame* {
      const std::uint32_t row = keyframes.Find(id.value());
      return row == kNoRow ? nullptr : &ours_map_.keyframes[row];
    };
    for (const MapPointId id : moved_points_)
      if (const std::uint32_t row = points.Find(id.value()); row != kNoRow)
        RefreshView(find, /*own_normal=*/false, /*own_range=*/false, ours_map_.points[row]);
  }

  void CutOut() {
    Atlas alone;
    alone.maps.push_back(std::move(ours_map_));
    Subset subset = Subset::Everything(alone);
    Subset::MapRows& rows = subset.maps.front();
    for (std::size_t row = 0; row < gone_keyframes_.size(); ++row) rows.keyframes[row] = !gone_keyframes_[row];
    for (std::size_t row = 0; row < gone_points_.size(); ++row) rows.points[row] = !gone_points_[row];
    report_.own_points -= static_cast<std::size_t>(
        std::count_if(alone.maps.front().points.begin(),
                      alone.maps.front().points.begin() + static_cast<std::ptrdiff_t>(report_.own_points),
                      [&](const MapPoint& point) {
                        const auto row = static_cast<std::size_t>(&point - alone.maps.front().points.data());
                        return gone_points_[row] || point.observations.empty();
                      }));
    KeepSubset(alone, subset, options_.threads);
    if (!alone.maps.empty()) ours_map_ = std::move(alone.maps.front());
  }

  Map &ours_map_, &theirs_map_;
  const PointClasses& classes_;
  const Flags &moved_by_ours_, &moved_by_theirs_;
  const StructureOptions& options_;
  const View base_, ours_, theirs_;  // as they came
  StructureReport report_;
  bool changed_ = false;  // ours is no longer what it was

  std::vector<Class> class_list_;
  std::unordered_map<std::uint64_t, std::size_t> class_rows_;
  Flags gone_keyframes_;                        // by row of the result
  Flags taken_keyframes_;                       // by row of theirs
  std::vector<std::vector<MapPointId>> slots_;  // of the result: by row, those of theirs behind ours
  std::vector<Flags> listed_;                   // whether the point says so, too
  std::size_t own_keyframes_ = 0;
  struct Unlinked {
    KeyFrameId keyframe, other;  // the first names the second, which names another one instead
    KeyFrameId KeyFrame::*field;
  };
  std::vector<Unlinked> unlinked_;
  std::vector<std::vector<Observation>> extras_;  // by class
  Flags gone_points_;                             // by row of the result
  std::vector<MapPointId> changed_points_, seen_otherwise_, of_one_side_, moved_points_;
};

}  // namespace

StructureReport MergeStructure(const Map* base, Map& ours, Map& theirs, const PointClasses& classes,
                               const std::vector<std::uint8_t>& moved_by_ours,
                               const std::vector<std::uint8_t>& moved_by_theirs, const StructureOptions& options) {
  return Merge(base, ours, theirs, classes, moved_by_ours, moved_by_theirs, options).Run();
}

}  // namespace slamdb::detail
