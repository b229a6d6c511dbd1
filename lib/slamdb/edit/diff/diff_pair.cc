// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/diff/detail/diff_pair.h"

#include <algorithm>
#include <numbers>

namespace slamdb::detail {
namespace {

// A reference and what it carries, under the number of its target in the atlas after.
struct Link {
  std::uint64_t target;
  std::uint64_t value;
  friend bool operator==(const Link&, const Link&) = default;
};
// Walks of fields.h as values.
constexpr auto kCameraFields = [](const auto& visit) { fields::ForEachCameraField(visit); };
constexpr auto kFeatureFields = [](const auto& visit) { fields::ForEachFeatureField(visit); };
constexpr auto kWordFields = [](const auto& visit) { fields::ForEachWordField(visit); };
constexpr auto kInertialFields = [](const auto& visit) {
  fields::ForEachInertialField(visit);
  fields::ForEachMotionField(visit);
};

constexpr std::uint64_t kOnlyBefore = std::uint64_t{1} << 62;  // its target has no partner
constexpr std::uint64_t kDangling = std::uint64_t{1} << 63;    // the target is in neither; the id is all there is

LinkCounts CompareLinks(std::vector<Link>& before, std::vector<Link>& after) {
  LinkCounts counts;
  if (before == after) return counts;
  const auto by_target = [](const Link& a, const Link& b) { return a.target < b.target; };
  std::ranges::stable_sort(before, by_target);
  std::ranges::stable_sort(after, by_target);
  auto a = before.begin(), b = after.begin();
  while (a != before.end() && b != after.end()) {
    if (a->target != b->target) {
      if (a->target < b->target)
        ++counts.removed, ++a;
      else
        ++counts.added, ++b;
      continue;
    }
    if (a->value != b->value) ++counts.changed;
    ++a, ++b;
  }
  counts.removed += static_cast<std::uint32_t>(before.end() - a);
  counts.added += static_cast<std::uint32_t>(after.end() - b);
  return counts;
}

std::uint64_t RowsOf(std::int32_t left, std::int32_t right) {
  return std::uint64_t{static_cast<std::uint32_t>(left)} << 32 | static_cast<std::uint32_t>(right);
}

}  // namespace

// References lead to the same when their targets are partners, or both lead nowhere.
bool PairComparison::SameKeyFrame(std::uint32_t map_a, KeyFrameId a, std::uint32_t map_b, KeyFrameId b) const {
  const std::uint32_t target_a = before_.FindKeyFrame(map_a, a), target_b = after_.FindKeyFrame(map_b, b);
  if (target_a == kNoRow || target_b == kNoRow) return target_a == target_b && a.has_value() == b.has_value();
  return pairing_.keyframes.AfterOf(target_a) == target_b;
}

bool PairComparison::SamePoint(std::uint32_t map_a, MapPointId a, std::uint32_t map_b, MapPointId b) const {
  const std::uint32_t target_a = before_.FindPoint(map_a, a), target_b = after_.FindPoint(map_b, b);
  if (target_a == kNoRow || target_b == kNoRow) return target_a == target_b && a.has_value() == b.has_value();
  return pairing_.points.AfterOf(target_a) == target_b;
}

bool PairComparison::SameCamera(CameraId a, CameraId b) const {
  const std::uint32_t row_a = before_.index().CameraRow(a), row_b = after_.index().CameraRow(b);
  if (row_a == kNoRow || row_b == kNoRow) return row_a == row_b;
  return pairing_.cameras.AfterOf(row_a) == row_b;
}

bool PairComparison::SameOrigin(std::uint32_t a, std::uint32_t b) const {
  const std::uint32_t row = before_.index().MapRow(MapId(a));
  const std::uint32_t partner = row == kNoRow ? kNoRow : pairing_.maps.AfterOf(row);
  return partner == kNoRow ? a == b : after_.atlas().maps[partner].id == MapId(b);
}

bool PairComparison::SameCalibration(const KeyFrame& a, const KeyFrame& b) const {
  return SameCamera(a.camera, b.camera) && SameCamera(a.right_camera, b.right_camera) &&
         same_.Fields<CameraId, Flag>(a, b, kCameraFields);
}

KeyFramePairDiff PairComparison::CompareKeyFrame(std::uint32_t n) const {
  const std::uint32_t partner = pairing_.keyframes.AfterOf(n);
  KeyFramePairDiff diff;
  if (partner == kNoRow) return diff;
  const KeyFrame &a = *before_.keyframes[n], &b = *after_.keyframes[partner];
  diff.renumbered = a.id != b.id;
  diff.other_ids = a.frame_id != b.frame_id;
  diff.Note(kPose, same_(a.camera_from_world, b.camera_from_world));
  if (diff.Has(kPose)) {
    const Rigid3f first = a.camera_from_world.Normalized(), second = b.camera_from_world.Normalized();
    diff.distance = (first.Center() - second.Center()).norm();
    diff.degrees = first.rotation.angularDistance(second.rotation) * 180 / std::numbers::pi_v<float>;
  }
  diff.Note(kTime, same_(a.timestamp, b.timestamp));
  diff.Note(kCalibration, SameCalibration(a, b));
  // Which points the features see is compared by where that leads, in CompareSlots.
  const bool lost = b.features.descriptors.size() < a.features.descriptors.size();
  diff.Note(lost ? kLostFeatures : kFeatures, same_.Fields<Column<MapPointId>, MatrixForm>(a, b, kFeatureFields));
  diff.Note(kBagOfWords, same_.Fields(a, b, kWordFields));
  diff.Note(kInertial, same_.Fields(a, b, kInertialFields));
  diff.Note(kState, a.first_connection == b.first_connection && a.not_erase == b.not_erase &&
                        a.to_be_erased == b.to_be_erased && a.bad == b.bad && same_(a.merge_scale, b.merge_scale) &&
                        same_(a.camera_from_parent, b.camera_from_parent));
  diff.Note(kOriginMap, SameOrigin(a.origin_map, b.origin_map));
  diff.Note(kCarriedByKeyFrame, a.carried == b.carried);
  CompareEdges(n, partner, diff);
  CompareSlots(n, partner, diff.links[kSlots]);
  return diff;
}

void PairComparison::CompareEdges(std::uint32_t n, std::uint32_t partner, KeyFramePairDiff& diff) const {
  const KeyFrame &a = *before_.keyframes[n], &b = *after_.keyframes[partner];
  const std::uint32_t map_a = before_.map_of_keyframe[n], map_b = after_.map_of_keyframe[partner];
  auto& links = diff.links;
  std::vector<Link> first, second;
  for (const Connection& each : a.connections)
    first.push_back({TargetBefore(map_a, each.keyframe), static_cast<std::uint64_t>(each.weight)});
  for (const Connection& each : b.connections)
    second.push_back({TargetAfter(map_b, each.keyframe), static_cast<std::uint64_t>(each.weight)});
  links[kCovisibility] = CompareLinks(first, second);
  const auto compare = [&](LinkKind kind, const Column<KeyFrameId>& list_a, const Column<KeyFrameId>& list_b) {
    first.clear();
    second.clear();
    for (const KeyFrameId id : list_a) first.push_back({TargetBefore(map_a, id), 0});
    for (const KeyFrameId id : list_b) second.push_back({TargetAfter(map_b, id), 0});
    links[kind] = CompareLinks(first, second);
  };
  compare(kChildren, a.children, b.children);
  compare(kLoops, a.loop_edges, b.loop_edges);
  compare(kMerges, a.merge_edges, b.merge_edges);
  const auto compare_one = [&](LinkKind kind, KeyFrameId id_a, KeyFrameId id_b) {
    if (!SameKeyFrame(map_a, id_a, map_b, id_b)) links[kind].Count(id_a.has_value(), id_b.has_value());
  };
  compare_one(kParents, a.parent, b.parent);
  compare_one(kInTime, a.previous, b.previous);
  compare_one(kInTime, a.next, b.next);
}

void PairComparison::CompareSlots(std::uint32_t n, std::uint32_t partner, LinkCounts& slots) const {
  const Column<MapPointId>& slots_a = before_.keyframes[n]->features.map_points;
  const Column<MapPointId>& slots_b = after_.keyframes[partner]->features.map_points;
  const std::uint32_t map_a = before_.map_of_keyframe[n], map_b = after_.map_of_keyframe[partner];
  const auto compare = [&](MapPointId a, MapPointId b) {
    if ((a || b) && !SamePoint(map_a, a, map_b, b)) slots.Count(a.has_value(), b.has_value());
  };
  std::vector<std::uint8_t> met(slots_b.size(), 0);
  for (std::size_t row = 0; row < slots_a.size(); ++row) {
    const auto after = static_cast<std::size_t>(pairing_.rows.AfterOf(n, static_cast<std::int32_t>(row)));
    compare(slots_a[row], after < slots_b.size() ? slots_b[after] : MapPointId());
    if (after < met.size()) met[after] = 1;
  }
  for (std::size_t row = 0; row < slots_b.size(); ++row)
    if (!met[row]) compare(MapPointId(), slots_b[row]);
}

PointPairDiff PairComparison::ComparePoint(std::uint32_t n) const {
  const std::uint32_t partner = pairing_.points.AfterOf(n);
  PointPairDiff diff;
  if (partner == kNoRow) return diff;
  const MapPoint &a = *before_.points[n], &b = *after_.points[partner];
  const std::uint32_t map_a = before_.map_of_point[n], map_b = after_.map_of_point[partner];
  diff.renumbered = a.id != b.id;
  diff.Note(kPosition, same_(a.position, b.position));
  if (diff.Has(kPosition)) diff.distance = (a.position - b.position).norm();
  diff.Note(kNormal, same_(a.normal, b.normal));
  diff.Note(kDistances, same_(a.min_distance, b.min_distance) && same_(a.max_distance, b.max_distance));
  diff.Note(kDescriptor, a.has_descriptor() == b.has_descriptor() && a.descriptor == b.descriptor);
  diff.Note(kObservationCount, a.observation_count == b.observation_count);
  diff.Note(kReference, SameKeyFrame(map_a, a.reference, map_b, b.reference));
  diff.Note(kReplacement, SamePoint(map_a, a.replaced_by, map_b, b.replaced_by));
  diff.Note(kBad, a.bad == b.bad);
  diff.Note(kPointOrigin, SameOrigin(a.origin_map, b.origin_map));
  diff.Note(kFrameCounts, a.visible_count == b.visible_count && a.found_count == b.found_count);
  diff.Note(kCarriedByPoint, a.carried == b.carried);
  CompareFirst(n, partner, diff);
  CompareObservations(n, partner, diff.observations);
  return diff;
}

// A first keyframe that was culled has only its id left, which may be renumbered too.
void PairComparison::CompareFirst(std::uint32_t n, std::uint32_t partner, PairDiff& diff) const {
  const MapPoint &a = *before_.points[n], &b = *after_.points[partner];
  const std::uint32_t map_a = before_.map_of_point[n], map_b = after_.map_of_point[partner];
  const KeyFrameId first_a(static_cast<std::uint64_t>(a.first_keyframe));
  const KeyFrameId first_b(static_cast<std::uint64_t>(b.first_keyframe));
  const bool culled = before_.FindKeyFrame(map_a, first_a) == kNoRow || after_.FindKeyFrame(map_b, first_b) == kNoRow;
  diff.other_ids = a.first_frame != b.first_frame || (culled && first_a != first_b);
  diff.Note(kFirstKeyFrame, culled || SameKeyFrame(map_a, first_a, map_b, first_b));
}

void PairComparison::CompareObservations(std::uint32_t n, std::uint32_t partner, LinkCounts& observations) const {
  const std::uint32_t map_a = before_.map_of_point[n], map_b = after_.map_of_point[partner];
  thread_local std::vector<Link> first, second;  // for their memory: there are many points, with few observations each
  first.clear();
  second.clear();
  for (const Observation& each : before_.points[n]->observations) {
    const std::uint32_t keyframe = before_.FindKeyFrame(map_a, each.keyframe);
    const auto row = [&](std::int32_t own) { return keyframe == kNoRow ? own : pairing_.rows.AfterOf(keyframe, own); };
    first.push_back({TargetBefore(map_a, each.keyframe), RowsOf(row(each.left), row(each.right))});
  }
  for (const Observation& each : after_.points[partner]->observations)
    second.push_back({TargetAfter(map_b, each.keyframe), RowsOf(each.left, each.right)});
  observations = CompareLinks(first, second);
}

PairDiff PairComparison::CompareMap(std::uint32_t row) const {
  const std::uint32_t partner = pairing_.maps.AfterOf(row);
  PairDiff diff;
  if (partner == kNoRow) return diff;
  const Map &a = before_.atlas().maps[row], &b = after_.atlas().maps[partner];
  diff.renumbered = a.id != b.id;
  diff.Note(kFlags, a.imu_initialized == b.imu_initialized && a.inertial == b.inertial && a.imu_ba1 == b.imu_ba1 &&
                        a.imu_ba2 == b.imu_ba2);
  diff.Note(kBigChange, a.big_change_index == b.big_change_index);
  const auto same = [&](KeyFrameId id_a, KeyFrameId id_b) { return SameKeyFrame(row, id_a, partner, id_b); };
  bool roots = same(a.initial_keyframe, b.initial_keyframe) && same(a.first_keyframe, b.first_keyframe) &&
               same(a.lowest_keyframe, b.lowest_keyframe) && a.origins.size() == b.origins.size();
  for (std::size_t i = 0; roots && i < a.origins.size(); ++i) roots = same(a.origins[i], b.origins[i]);
  diff.Note(kRoots, roots);
  diff.Note(kCarriedByMap, a.carried == b.carried);
  return diff;
}

PairDiff PairComparison::CompareCamera(std::uint32_t row) const {
  const std::uint32_t partner = pairing_.cameras.AfterOf(row);
  PairDiff diff;
  if (partner == kNoRow) return diff;
  const Camera &a = before_.atlas().cameras[row], &b = after_.atlas().cameras[partner];
  diff.renumbered = a.id != b.id;
  diff.Note(kParameters, same_.Fields<CameraId>(a, b, [&](const auto& visit) { ForEachField(&a, visit); }));
  return diff;
}

std::uint64_t PairComparison::TargetBefore(std::uint32_t map, KeyFrameId id) const {
  const std::uint32_t number = before_.FindKeyFrame(map, id);
  if (number == kNoRow) return kDangling | id.value();
  const std::uint32_t partner = pairing_.keyframes.AfterOf(number);
  return partner == kNoRow ? kOnlyBefore | number : partner;
}

std::uint64_t PairComparison::TargetAfter(std::uint32_t map, KeyFrameId id) const {
  const std::uint32_t number = after_.FindKeyFrame(map, id);
  return number == kNoRow ? kDangling | id.value() : number;
}

}  // namespace slamdb::detail
