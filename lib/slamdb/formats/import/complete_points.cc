// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/import/detail/completed.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/observed.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kGrain = 1024;

bool IsRight(const Features& features, std::size_t row) {
  return features.is_fisheye_stereo() && row >= static_cast<std::size_t>(features.left_count);
}

// Of one keyframe. A point is one keypoint of each picture: the first that says so.
void Observe(KeyFrame& keyframe, Map& map, const IdTable& points, Completed& completed) {
  Column<MapPointId>& slots = keyframe.features.map_points;
  for (std::size_t slot = 0; slot < slots.size(); ++slot) {
    const std::uint32_t row = points.Find(slots[slot].value());
    if (row == kNoRow) continue;
    Column<Observation>& observations = map.points[row].observations;
    if (observations.empty() || observations.back().keyframe != keyframe.id) observations.push_back({keyframe.id});
    Observation& observation = observations.back();
    std::int32_t& seen = IsRight(keyframe.features, slot) ? observation.right : observation.left;
    if (seen >= 0) {
      slots[slot] = {};
      ++completed.freed;
      continue;
    }
    seen = static_cast<std::int32_t>(slot);
    ++completed.observations;
  }
}

void CollectObservations(Map& map, Completed& completed) {
  const IdTable points = PointTable(map);
  for (KeyFrame& keyframe : map.keyframes) Observe(keyframe, map, points, completed);
  for (MapPoint& point : map.points)
    if (!std::ranges::is_sorted(point.observations, {}, &Observation::keyframe))
      std::ranges::stable_sort(point.observations, {}, &Observation::keyframe);
}

void FillSlots(Map& map, Completed& completed) {
  const IdTable keyframes = KeyFrameTable(map);
  for (const MapPoint& point : map.points) {
    for (const Observation& observation : point.observations) {
      const std::uint32_t row = keyframes.Find(observation.keyframe.value());
      if (row == kNoRow) continue;
      Column<MapPointId>& slots = map.keyframes[row].features.map_points;
      for (const std::int32_t slot : {observation.left, observation.right}) {
        if (slot < 0 || static_cast<std::size_t>(slot) >= slots.size()) continue;
        slots[static_cast<std::size_t>(slot)] = point.id;
        ++completed.slots;
      }
    }
  }
}

class Summary {
 public:
  Summary(const Map& map, Completed& completed) : map_(map), keyframes_(KeyFrameTable(map)), completed_(completed) {}

  void Complete(MapPoint& point) const {
    const auto find = [this](KeyFrameId id) { return Find(id); };
    CompleteCounts(point);
    if (!point.has_descriptor()) CompleteDescriptor(point, find);
    if (point.normal.isZero(0)) {
      const auto normal = ObservedNormal(point, find);
      if (normal) point.normal = *normal, ++completed_.normals;
    }
    const KeyFrame* reference = Find(point.reference);
    if (point.min_distance != 0 || point.max_distance != 0 || reference == nullptr) return;
    const DistanceRange range = ObservedRange(point, *reference);
    if (!(range.max > 0)) return;
    point.min_distance = range.min;
    point.max_distance = range.max;
    ++completed_.ranges;
  }

 private:
  const KeyFrame* Find(KeyFrameId id) const {
    const std::uint32_t row = keyframes_.Find(id.value());
    return row == kNoRow ? nullptr : &map_.keyframes[row];
  }

  void CompleteCounts(MapPoint& point) const {
    std::int32_t count = 0;
    const KeyFrame* first = nullptr;
    for (const Observation& observation : point.observations) {
      const KeyFrame* keyframe = Find(observation.keyframe);
      if (keyframe == nullptr) continue;
      count += ObservationWeight(*keyframe, observation);
      if (first == nullptr) first = keyframe;
    }
    if (point.observation_count == 0) point.observation_count = count;
    if (point.reference || first == nullptr) return;
    point.reference = first->id;
    point.first_keyframe = static_cast<std::int64_t>(first->id.value());
    point.first_frame = static_cast<std::int64_t>(first->frame_id);
    ++completed_.references;
  }

  template <class Of>
  void CompleteDescriptor(MapPoint& point, const Of& find) const {
    const std::vector<Descriptor> descriptors = ObservedDescriptors(point, find);
    if (descriptors.empty()) {
      point.descriptor_form = MatrixForm::kEmpty;
      return;
    }
    point.descriptor = descriptors[MostDistinctiveDescriptor(descriptors)];
    point.descriptor_form = MatrixForm::kUsual;
    ++completed_.descriptors;
  }

  const Map& map_;
  const IdTable keyframes_;
  Completed& completed_;
};

}  // namespace

void CompletePoints(Map& map, int threads, Completed& completed) {
  const auto has_observations = [](const MapPoint& point) { return !point.observations.empty(); };
  const auto sees_points = [](const KeyFrame& keyframe) {
    return std::ranges::any_of(keyframe.features.map_points, [](MapPointId id) { return id.has_value(); });
  };
  if (!std::ranges::any_of(map.points, has_observations))
    CollectObservations(map, completed);
  else if (!std::ranges::any_of(map.keyframes, sees_points))
    FillSlots(map, completed);
  SummarizePoints(map, 0, threads, completed);
}

void SummarizePoints(Map& map, std::size_t first, int threads, Completed& completed) {
  const Summary summary(map, completed);
  ParallelFor(map.points.size() - first, kGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) summary.Complete(map.points[first + row]);
  });
}

}  // namespace slamdb::detail
