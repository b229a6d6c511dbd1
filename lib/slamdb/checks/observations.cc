// SPDX-License-Identifier: BSD-3-Clause
// Observations: what points and keyframes say about each other.
#include <algorithm>
#include <utility>

#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/observers.h"
#include "slamdb/checks/detail/visit.h"

namespace slamdb::detail {
namespace {

template <class Accept>
void CheckCounts(const Subject& subject, const Accept& accept, Findings& findings) {
  for (std::size_t row = 0; row < subject.atlas.maps.size(); ++row) {
    const Map& map = subject.atlas.maps[row];
    for (std::uint32_t i = 0; i < map.points.size(); ++i) {
      const MapPoint& point = map.points[i];
      const std::int64_t count = subject.observers[row].CountOf(i);
      if (!point.bad && !accept(point.observation_count, count))
        findings.Add(PlaceOf(map, point), "is recorded with ", point.observation_count, " observations, but has ",
                     count);
    }
  }
}

// Points have few observations, so a plain search is the fastest.
const Observation* FindObservation(const MapPoint& point, KeyFrameId keyframe) {
  const auto found = std::ranges::find(point.observations, keyframe, &Observation::keyframe);
  return found == point.observations.end() ? nullptr : &*found;
}

// The first row in [begin, end) of a keyframe's slots that holds the point; -1 when none does.
std::int32_t FindSlot(const Features& features, MapPointId point, std::int32_t begin, std::int32_t end) {
  for (std::int32_t row = std::max(begin, 0); row < end; ++row)
    if (SlotPoint(features, row) == point) return row;
  return -1;
}

bool IsRow(std::int32_t row) { return row != -1 && row != Observation::kAbsent; }

// Adds what the slots of a keyframe say about the points of `map` that `is_unobserved` tells.
void ObserveBySlots(const KeyFrame& keyframe, const IdTable& points, const std::vector<std::uint8_t>& is_unobserved,
                    Map& map) {
  const Features& features = keyframe.features;
  for (std::int32_t slot = 0; slot < static_cast<std::int32_t>(features.map_points.size()); ++slot) {
    const std::uint32_t row = points.Find(SlotPoint(features, slot).value());
    if (row == kNoRow || is_unobserved[row] == 0) continue;
    Column<Observation>& observations = map.points[row].observations;
    if (observations.empty() || observations.back().keyframe != keyframe.id) observations.push_back({keyframe.id});
    std::int32_t& side = slot < LeftRows(features) ? observations.back().left : observations.back().right;
    if (side < 0) side = slot;
  }
}

// By row: the points of which a slot that an observation names holds another one, or none.
std::vector<std::uint8_t> FindMisplaced(const Map& map, const Observers& observers) {
  std::vector<std::uint8_t> is_misplaced(map.points.size(), 0);
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
    const Features& features = map.keyframes[row].features;
    for (const Observers::Sight& sight : observers.By(row)) {
      const Observation observation{map.keyframes[row].id, sight.left, sight.right};
      const MapPointId id = observers.IdOf(sight.point);
      if ((LeftRowFits(features, observation) && SlotPoint(features, sight.left) != id) ||
          (RightRowFits(features, observation) && SlotPoint(features, sight.right) != id))
        is_misplaced[sight.point] = 1;
    }
  }
  return is_misplaced;
}

// Sets is_recorded[slot] of slots whose points record them; not of all, where ids repeat.
void MarkRecorded(const Subject& subject, std::size_t map_row, const KeyFrame& keyframe,
                  std::vector<std::uint8_t>& is_recorded) {
  const Map& map = subject.atlas.maps[map_row];
  is_recorded.assign(keyframe.features.map_points.size(), 0);
  if (subject.index.FindKeyFrame(map_row, keyframe.id) != &keyframe) return;
  if (!subject.index.duplicate_points().empty()) return;
  const Observers& observers = subject.observers[map_row];
  std::uint32_t before = kNoRow;
  for (const Observers::Sight& sight : observers.By(static_cast<std::uint32_t>(&keyframe - map.keyframes.data()))) {
    if (std::exchange(before, sight.point) == sight.point) continue;  // of several the first counts
    for (const std::int32_t slot : {sight.left, sight.right})
      if (slot >= 0 && SlotPoint(keyframe.features, slot) == observers.IdOf(sight.point))
        is_recorded[static_cast<std::size_t>(slot)] = 1;
  }
}

// What the slots that a point's observations name hold instead of it.
void ReportSlots(const Subject& subject, std::size_t map_row, const MapPoint& point, Findings& findings) {
  const Map& map = subject.atlas.maps[map_row];
  for (const Observation& observation : point.observations) {
    const KeyFrame* keyframe = subject.index.FindKeyFrame(map_row, observation.keyframe);
    if (keyframe == nullptr) continue;
    const auto report = [&](std::int32_t row) {
      const MapPointId held = SlotPoint(keyframe->features, row);
      if (held == point.id) return;
      findings.Add(PlaceOf(map, point), "is keypoint ", row, " of ", keyframe->id, ", whose slot ",
                   [&] { return held ? "holds " + ToString(held) : std::string("is empty"); });
    };
    if (LeftRowFits(keyframe->features, observation)) report(observation.left);
    if (RightRowFits(keyframe->features, observation)) report(observation.right);
  }
}

bool HasDepth(const KeyFrame& keyframe, const Observation& observation) {
  const Features& features = keyframe.features;
  if (features.is_fisheye_stereo()) return true;
  const auto left = static_cast<std::size_t>(std::max(observation.left, 0));
  return left < features.right_x.size() &&
         (features.right_x[left] >= 0 || features.depth.size() <= left || features.depth[left] > 0);
}

}  // namespace

void CheckObservationSides(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    for (const Observation& observation : point.observations) {
      if (observation.left == Observation::kAbsent)
        findings.Add(PlaceOf(map, point), observation.keyframe, " is only among the right observations");
      if (observation.right == Observation::kAbsent)
        findings.Add(PlaceOf(map, point), observation.keyframe, " is only among the left observations");
    }
  });
}

std::size_t CompleteObservationSides(Atlas& atlas) {
  std::size_t completed = 0;
  for (Map& map : atlas.maps)
    for (MapPoint& point : map.points)
      for (Observation& observation : point.observations)
        for (std::int32_t* side : {&observation.left, &observation.right}) {
          if (*side != Observation::kAbsent) continue;
          *side = -1;
          ++completed;
        }
  return completed;
}

void CheckObservationSeen(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    for (const Observation& observation : point.observations)
      if (observation.left < 0 && observation.right < 0)
        findings.Add(PlaceOf(map, point), "observed by ", observation.keyframe, ", but by no keypoint of it");
  });
}

std::size_t EraseUnseenObservations(Atlas& atlas) {
  std::size_t erased = 0;
  for (Map& map : atlas.maps)
    for (MapPoint& point : map.points)
      erased += std::erase_if(point.observations, [](const Observation& observation) {
        return observation.left < 0 && observation.right < 0;
      });
  return erased;
}

void CheckObservationIndex(const Subject& subject, Findings& findings) {
  ForEachObservation(subject, [&](std::size_t, const Map& map, const MapPoint& point, const Observation& observation,
                                  const KeyFrame& keyframe) {
    const Features& features = keyframe.features;
    if (IsRow(observation.left) && !LeftRowFits(features, observation))
      findings.Add(PlaceOf(map, point), "is left keypoint ", observation.left, " of ", keyframe.id, ", which has ",
                   LeftRows(features));
    if (IsRow(observation.right) && !RightRowFits(features, observation))
      findings.Add(PlaceOf(map, point), "is right keypoint ", observation.right, " of ", keyframe.id,
                   ", whose right keypoints ", [&]() -> std::string {
                     if (!features.is_fisheye_stereo()) return "are no rows of their own";
                     return "are " + std::to_string(features.left_count) + " to " +
                            std::to_string(std::int64_t{features.count} - 1);
                   });
  });
}

// The slot that holds the point tells the keypoint; without one the observation is of no keypoint.
std::size_t ReseatObservations(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t changed = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (MapPoint& point : atlas.maps[row].points) {
      if (point.bad) continue;
      std::erase_if(point.observations, [&](Observation& seen) {
        const KeyFrame* keyframe = index.FindKeyFrame(row, seen.keyframe);
        if (keyframe == nullptr) return false;
        const Features& features = keyframe->features;
        const bool left_is_wild = IsRow(seen.left) && !LeftRowFits(features, seen);
        const bool right_is_wild = IsRow(seen.right) && !RightRowFits(features, seen);
        if (!left_is_wild && !right_is_wild) return false;
        ++changed;
        if (left_is_wild) seen.left = FindSlot(features, point.id, 0, LeftRows(features));
        if (right_is_wild) seen.right = FindSlot(features, point.id, LeftRows(features), features.count);
        return seen.left < 0 && seen.right < 0;
      });
    }
  return changed;
}

void CheckPointObserved(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t, const Map& map, const MapPoint& point) {
    if (point.observations.empty()) findings.Add(PlaceOf(map, point), "is observed by no keyframe");
  });
}

// The slots that hold a point tell who observes it. A point that no slot holds goes, as ORB-SLAM3 drops one that has
// lost its last observation.
std::size_t RestoreObservations(Atlas& atlas) {
  std::size_t restored = 0;
  for (Map& map : atlas.maps) {
    std::vector<std::uint8_t> is_unobserved(map.points.size(), 0);
    for (std::size_t row = 0; row < map.points.size(); ++row)
      is_unobserved[row] = !map.points[row].bad && map.points[row].observations.empty();
    if (std::ranges::find(is_unobserved, 1) == is_unobserved.end()) continue;
    const IdTable points = PointTable(map);
    for (const KeyFrame& keyframe : map.keyframes)
      if (!keyframe.bad) ObserveBySlots(keyframe, points, is_unobserved, map);
    for (std::size_t row = 0; row < map.points.size(); ++row) {
      if (is_unobserved[row] == 0) continue;
      std::ranges::sort(map.points[row].observations, {}, &Observation::keyframe);
      restored += map.points[row].observations.empty() ? 0 : 1;
    }
  }
  return restored + DropPoints(atlas, [](const MapPoint& point) { return !point.bad && point.observations.empty(); });
}

void CheckPointSupport(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t row, const Map& map, const MapPoint& point) {
    if (point.observations.size() != 1) return;
    const KeyFrame* keyframe = subject.index.FindKeyFrame(row, point.observations[0].keyframe);
    if (keyframe != nullptr && !HasDepth(*keyframe, point.observations[0]))
      findings.Add(PlaceOf(map, point), "is observed once, by ", keyframe->id, ", and without depth");
  });
}

// Points without observation, and references that dangle, are other rules' business.
void CheckReferenceObserves(const Subject& subject, Findings& findings) {
  ForEachPoint(subject.atlas, [&](std::size_t row, const Map& map, const MapPoint& point) {
    const KeyFrame* reference = subject.index.FindKeyFrame(row, point.reference);
    if (reference == nullptr || point.observations.empty()) return;
    if (FindObservation(point, point.reference) == nullptr)
      findings.Add(PlaceOf(map, point), "reference keyframe ", point.reference, ", which does not observe it");
  });
}

// The observer with the lowest id takes over.
std::size_t ReplaceUnseeingReferences(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t replaced = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (MapPoint& point : atlas.maps[row].points) {
      if (point.bad || index.KeyFrameRow(row, point.reference) == kNoRow) continue;
      if (FindObservation(point, point.reference) != nullptr) continue;
      KeyFrameId lowest;
      for (const Observation& observation : point.observations)
        if (index.KeyFrameRow(row, observation.keyframe) != kNoRow) lowest = std::min(lowest, observation.keyframe);
      if (!lowest) continue;
      point.reference = lowest;
      ++replaced;
    }
  return replaced;
}

void CheckObservationCount(const Subject& subject, Findings& findings) {
  CheckCounts(
      subject, [](std::int64_t recorded, std::int64_t counted) { return recorded >= counted; }, findings);
}

void CheckObservationCountExcess(const Subject& subject, Findings& findings) {
  CheckCounts(
      subject, [](std::int64_t recorded, std::int64_t counted) { return recorded <= counted; }, findings);
}

std::size_t RecountObservations(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t changed = 0;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    const Observers observers(index, row);
    for (std::uint32_t i = 0; i < atlas.maps[row].points.size(); ++i) {
      MapPoint& point = atlas.maps[row].points[i];
      const auto count = static_cast<std::int32_t>(observers.CountOf(i));
      if (point.bad || point.observation_count == count) continue;
      point.observation_count = count;
      ++changed;
    }
  }
  return changed;
}

void CheckObservationSlot(const Subject& subject, Findings& findings) {
  for (std::size_t map_row = 0; map_row < subject.atlas.maps.size(); ++map_row) {
    const Map& map = subject.atlas.maps[map_row];
    const std::vector<std::uint8_t> is_misplaced = FindMisplaced(map, subject.observers[map_row]);
    for (std::size_t row = 0; row < map.points.size(); ++row)
      if (is_misplaced[row]) ReportSlots(subject, map_row, map.points[row], findings);
  }
}

void CheckSlotObserved(const Subject& subject, Findings& findings) {
  std::vector<std::uint8_t> is_recorded;
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    const Column<MapPointId>& slots = keyframe.features.map_points;
    MarkRecorded(subject, row, keyframe, is_recorded);
    for (std::size_t slot = 0; slot < slots.size(); ++slot) {
      if (is_recorded[slot]) continue;
      const MapPoint* point = slots[slot] ? subject.index.FindPoint(row, slots[slot]) : nullptr;
      if (point == nullptr || point->bad) continue;
      const Observation* observation = FindObservation(*point, keyframe.id);
      const auto feature = static_cast<std::int64_t>(slot);
      if (observation != nullptr && (observation->left == feature || observation->right == feature)) continue;
      findings.Add(PlaceOf(map, keyframe, slot), "sees ", point->id,
                   observation == nullptr ? ", which does not record that" : ", which records another keypoint of it");
    }
  });
}

}  // namespace slamdb::detail
