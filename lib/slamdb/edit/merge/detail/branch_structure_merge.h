// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "slamdb/edit/merge/detail/branch_structure.h"
#include "slamdb/edit/merge/detail/branch_view.h"
#include "slamdb/edit/merge/detail/three_ways.h"

// What MergeStructure (branch_structure.h) is made of.
namespace slamdb::detail {

using Flags = std::vector<std::uint8_t>;

// What becomes of one keyframe or class of points.
enum class Fate { kStays, kGone, kKept };

inline bool IsRight(const KeyFrame& keyframe, std::size_t slot) {
  return keyframe.right_camera && static_cast<std::int64_t>(slot) >= keyframe.features.left_count;
}

// Ours becomes the result.
// 1. Which keypoints see which points in each of the three, points by their classes.
// 2. Who stays: what one side deleted goes, unless the other went on with it.
// 3. Keypoint by keypoint, whom it sees in the result.
// 4. Fields and edges of keyframes and points that both sides have; those of theirs alone are appended.
// 5. Lists of observations are made of the keypoints; what changed is computed anew.
// 6. What is gone is cut out, and what hung on it hung up elsewhere.
class StructureMerge {
 public:
  StructureMerge(const Map* base, Map& ours, Map& theirs, const PointClasses& classes, const Flags& moved_by_ours,
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

  StructureReport Run();

 private:
  struct Class {
    MapPointId id;
    bool in_base = false;
    std::uint32_t ours = kNoRow, theirs = kNoRow;  // rows of the points that go by its name, or else of any
    bool extended_by_ours = false, extended_by_theirs = false;
    Fate fate = Fate::kStays;
    std::vector<Observation> observations;  // of the result
  };

  // ---- classes of points (branch_structure.cc)
  Class& ClassOf(MapPointId id) { return class_list_[class_rows_.at(id.value())]; }
  Class* FindClass(MapPointId id);
  void ListClasses();

  // ---- who stays (branch_structure.cc)
  // visit(class) for the keypoints of a keyframe of a side that see a class of points which they did not in the base.
  template <class Visit>
  void ForEachGain(const View& side, std::uint32_t row, const Visit& visit) const {
    const std::uint32_t in_base = base_.Row(side.map->keyframes[row].id);
    const std::vector<MapPointId>& slots = side.sightings.Of(row);
    for (std::size_t slot = 0; slot < slots.size(); ++slot)
      if (slots[slot] && slots[slot] != base_.sightings.Of(in_base, slot)) visit(slots[slot]);
  }
  // Whether a side did more to a keyframe of the base than optimising it.
  bool IsExtended(const View& side, const KeyFrame& before, const KeyFrame& now) const;
  void Conflict(Place place, std::string_view what, BranchSide taken);
  void DecideKeyFrames();
  // Whether the result has a keyframe.
  bool Stays(KeyFrameId id) const;
  void DecidePoints();

  // ---- keypoints (branch_structure_keyframes.cc)
  void MergeKeypoints();
  void MergeKeypoint(std::uint32_t row, std::uint32_t there, std::size_t slot);
  // Whether a side lost a point that is in the result all the same.
  bool Deletes(const View& side, MapPointId before);
  // Whether what theirs sees is taken.
  bool PickKeypoint(const MapPointId* before, MapPointId ours, MapPointId theirs, KeyFrameId keyframe,
                    std::size_t slot);
  // Keypoints see no point that is not there, and no two of one picture the same one.
  void Settle(const KeyFrame& keyframe, std::vector<MapPointId>& slots, Flags& listed);

  // ---- keyframes (branch_structure_keyframes.cc)
  void MergeKeyFrames();
  void CutUnlinked();
  void SetSlots(KeyFrame& keyframe, const std::vector<MapPointId>& slots);
  // A reference to a keyframe that a side no longer has, and the result has all the same, is as it was.
  KeyFrameId Restored(const View& side, KeyFrameId before, KeyFrameId now) const;
  bool Take(Pick pick, const KeyFrame& keyframe, std::string_view what);
  template <class Walk>
  void MergeGroup(const KeyFrame* before, const KeyFrame& theirs, std::string_view what, const Walk& walk,
                  KeyFrame& ours) {
    const auto equal = [&](const KeyFrame& a, const KeyFrame& b) { return AreFieldsEqual(a, b, walk); };
    if (before == nullptr) return;  // of what both made, ours stands
    if (Take(PickOf(before, std::as_const(ours), theirs, equal), ours, what)) CopyFields(theirs, ours, walk);
  }
  void MergeFields(KeyFrame& ours, const KeyFrame& theirs);
  void MergeReferences(const KeyFrame& before, const KeyFrame& theirs, KeyFrame& ours);
  // A keyframe has one before it and one after it: whom it does not have in the result does not have it.
  void Unlink(const KeyFrame& keyframe, KeyFrameId of_ours, KeyFrameId of_theirs, KeyFrameId KeyFrame::*field,
              KeyFrameId KeyFrame::*back);
  // What theirs recorded otherwise than the base, and ours as that. Where points changed it is counted anew later.
  void MergeConnections(const KeyFrame& before, const KeyFrame& theirs, KeyFrame& ours);
  // An edge that one side added is there, one that a side removed is not.
  void MergeEdges(const KeyFrame* before, const KeyFrame& theirs, Column<KeyFrameId> KeyFrame::*list, KeyFrame& ours);

  // ---- points (branch_structure_points.cc)
  void MergePoints();
  // Observations that no keypoint confirms stay as they are, but for those by keyframes that are not there.
  void CollectExtras();
  void CollectObservations();
  void SetObservations(const Class& of, MapPoint& point);
  // Points that lost too many observations, as in ORB-SLAM3's MapPoint::EraseObservation, but for those that a side has
  // just so.
  void CullPoints();
  void MergePoint(const Class& of, MapPoint& ours, const MapPoint& theirs);
  void Restore(const MapPoint& before, MapPoint& ours);
  void AddCounts(const MapPoint& before, const MapPoint& theirs, std::int32_t MapPoint::*count, MapPoint& ours);
  // The reference keyframe is where a point is measured from; another one is no conflict, as nothing of it is lost.
  void MergeReference(const MapPoint& before, const MapPoint& theirs, MapPoint& ours);
  // Where a point is that both sides have.
  void MergePosition(const Class& of, MapPoint& ours, const MapPoint& theirs);
  bool AlignsPoints() const;
  void MarkGonePoints();

  // ---- the map (branch_structure_map.cc)
  void MergeHeader();
  void MergeLandmarks();

  // ---- what follows (branch_structure.cc)
  void Close();
  // Where keyframes see other points than a side recorded: those of points that are not seen as in both sides, and
  // those of both sides that see points of one.
  void RecountCovisibility();
  // Of points that moved, or are measured from elsewhere.
  void RefreshViews();
  void CutOut();

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

}  // namespace slamdb::detail
