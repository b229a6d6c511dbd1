// SPDX-License-Identifier: BSD-3-Clause
// Steps: 1. what cannot be an entity goes: ids that are none or taken, landmarks at no finite place, maps with nothing;
//        2. what stands at the end of a file is found again: members of maps, cameras, counters;
//        3. points whose bytes are lost are triangulated from what keyframes saw of them;
//        4. the repairs of the rules drop what depends on what is lost;
//        5. entities that break a rule without repair go, and 4 again, until no error is left.
#include "slamdb/edit/repair/recover.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "slamdb/base/detail/steps.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/edit/repair/detail/triangulate.h"
#include "slamdb/model/detail/irregular_entries.h"

namespace slamdb {
namespace {

using detail::kLargestId;

constexpr int kMostRounds = 8;
constexpr std::size_t kMostWitnesses = 1000;  // of one entity: enough to tell two apart

template <class Entity>
bool IsId(Id<Entity> id) {
  return id.value() <= kLargestId;
}

// Who in a map can say which id an entity has.
struct Witnesses {
  const Map& map;
  const IdTable keyframes, points;

  explicit Witnesses(const Map& of) : map(of), keyframes(KeyFrameTable(of)), points(PointTable(of)) {}

  static bool Observes(const MapPoint& point, KeyFrameId keyframe, std::size_t row) {
    const auto feature = static_cast<std::int32_t>(row);
    const auto first = point.observations.begin();
    const auto last = first + static_cast<std::ptrdiff_t>(std::min(point.observations.size(), kMostWitnesses));
    return std::any_of(first, last, [&](const Observation& observation) {
      return observation.keyframe == keyframe && (observation.left == feature || observation.right == feature);
    });
  }

  // How many points observe the keyframe, by its id, where it has them.
  std::size_t Count(const KeyFrame& keyframe) const {
    const Column<MapPointId>& slots = keyframe.features.map_points;
    std::size_t count = 0;
    for (std::size_t row = 0; row < std::min(slots.size(), kMostWitnesses); ++row) {
      const std::uint32_t point = points.Find(slots[row].value());
      count += point != kNoRow && Observes(map.points[point], keyframe.id, row);
    }
    return count;
  }
  // How many keyframes have the point, by its id, where it observes.
  std::size_t Count(const MapPoint& point) const {
    std::size_t count = 0;
    for (const Observation& observation : point.observations) {
      const std::uint32_t keyframe = keyframes.Find(observation.keyframe.value());
      if (keyframe == kNoRow) continue;
      const Column<MapPointId>& slots = map.keyframes[keyframe].features.map_points;
      for (const std::int32_t row : {observation.left, observation.right})
        count += row >= 0 && static_cast<std::size_t>(row) < slots.size() &&
                 slots[static_cast<std::size_t>(row)] == point.id;
    }
    return count;
  }
};

// Of several entities with one id, one of which has it from damage, the one with most witnesses counts, the first of
// equals.
template <class Entity>
std::uint64_t DropImpossible(const Witnesses& witnesses, Column<Entity>& list) {
  std::map<Id<Entity>, std::size_t> rows;
  std::vector<std::uint8_t> dropped(list.size(), 0);
  for (std::size_t row = 0; row < list.size(); ++row) {
    if (!IsId(list[row].id)) {
      dropped[row] = 1;
      continue;
    }
    const auto [first, is_new] = rows.try_emplace(list[row].id, row);
    if (is_new) continue;
    if (witnesses.Count(list[row]) > witnesses.Count(list[first->second]))
      dropped[std::exchange(first->second, row)] = 1;
    else
      dropped[row] = 1;
  }
  std::size_t row = 0;
  return std::erase_if(list, [&](const Entity&) { return dropped[row++] != 0; });
}

void DropImpossible(Atlas& atlas, RecoverReport& report) {
  detail::DropIrregularEntries(atlas);
  for (Map& map : atlas.maps) {
    report.dropped_keyframes += DropImpossible(Witnesses(map), map.keyframes);
    report.dropped_points += DropImpossible(Witnesses(map), map.points);
    report.dropped_landmarks += std::erase_if(map.landmarks, [](const Landmark& landmark) {
      return !landmark.mean.allFinite() || !landmark.normal.allFinite();
    });
  }
  report.dropped_maps =
      std::erase_if(atlas.maps, [](const Map& map) { return map.keyframes.empty() && map.landmarks.empty(); });
}

// A map whose members behind the lists were lost has no initial keyframe; its links the repairs choose anew.
void RebuildMaps(Atlas& atlas, RecoverReport& report) {
  for (Map& map : atlas.maps) {
    if (map.first_keyframe || map.keyframes.empty()) continue;
    report.rebuilt_maps.push_back(map.id);
    const auto any = [&](const auto& has) { return std::ranges::any_of(map.keyframes, has); };
    map.inertial = any([](const KeyFrame& keyframe) {
      return keyframe.imu_calibration.is_set && keyframe.preintegration.duration > 0;
    });
    map.imu_initialized = map.inertial && any([](const KeyFrame& keyframe) { return bool{keyframe.imu_initialized}; });
  }
}

bool IsUsable(const Camera& camera) {
  const std::size_t expected = camera.model == CameraModel::kKannalaBrandt8 ? 8 : 4;
  return camera.parameters.size() == expected && camera.parameters[0] > 0 && camera.parameters[1] > 0 &&
         std::ranges::all_of(camera.parameters, [](float value) { return std::isfinite(value); });
}

const Camera* FindCamera(const Atlas& atlas, CameraId id) {
  const auto found = std::ranges::find(atlas.cameras, id, &Camera::id);
  return found == atlas.cameras.end() ? nullptr : &*found;
}

// A keyframe holds the four parameters of a pinhole camera, and of a fisheye camera all but those of its lens: its left
// one, with which it is built.
Camera CameraOf(const KeyFrame& keyframe, CameraId id) {
  const bool fisheye = keyframe.features.is_fisheye_stereo();
  const Intrinsics& k = keyframe.intrinsics;
  Camera camera{.id = id,
                .model = fisheye ? CameraModel::kKannalaBrandt8 : CameraModel::kPinhole,
                .recorded_type = fisheye ? 1U : 0U,
                .parameters = {k.fx, k.fy, k.cx, k.cy}};
  if (fisheye) camera.parameters.resize(8, 0.0F);
  return camera;
}

// Whether a fisheye camera would have left the same keyframe: one image, of which no lens distortion was removed.
bool MayBeFisheye(const KeyFrame& keyframe) {
  const Features& features = keyframe.features;
  return !features.is_fisheye_stereo() && !(keyframe.intrinsics.baseline_fx > 0) &&
         features.keypoints == features.undistorted;
}

enum class Side { kLeft, kRight };

void RebuildCamera(const KeyFrame& keyframe, Side side, const RecoverOptions& options, Atlas& atlas,
                   RecoverReport& report) {
  const CameraId id = side == Side::kLeft ? keyframe.camera : keyframe.right_camera;
  if (!id || id.value() > std::numeric_limits<std::uint32_t>::max() || FindCamera(atlas, id) != nullptr) return;
  if (const Camera* known = options.rig == nullptr ? nullptr : FindCamera(*options.rig, id); known != nullptr) {
    atlas.cameras.push_back(*known);
    report.taken_cameras.push_back(id);
    return;
  }
  Camera camera = CameraOf(keyframe, id);
  if (!IsUsable(camera)) return;
  (side == Side::kLeft ? report.rebuilt_cameras : report.guessed_cameras).push_back(id);
  if (MayBeFisheye(keyframe)) report.guessed_models.push_back(id);
  if (camera.model == CameraModel::kKannalaBrandt8) report.guessed_lenses.push_back(id);
  atlas.cameras.push_back(std::move(camera));
}

void RebuildCameras(const RecoverOptions& options, Atlas& atlas, RecoverReport& report) {
  std::erase_if(atlas.cameras, [](const Camera& camera) { return !IsUsable(camera); });
  if (!atlas.cameras.empty()) return;  // the repairs decide what a keyframe without its camera means
  for (const Side side : {Side::kLeft, Side::kRight})
    for (const Map& map : atlas.maps)
      for (const KeyFrame& keyframe : map.keyframes)
        if (side == Side::kLeft || keyframe.features.is_fisheye_stereo())
          RebuildCamera(keyframe, side, options, atlas, report);
  std::ranges::sort(atlas.cameras, {}, &Camera::id);
}

// Above all ids that are mentioned too, so that the ids of what is lost are not given to something else.
void RaiseCounters(Atlas& atlas, RecoverReport& report) {
  const Counters before = atlas.next_ids;
  const auto raise = [](std::uint64_t& next, std::uint64_t id) {
    if (id <= kLargestId) next = std::max(next, id + 1);
  };
  Counters& next = atlas.next_ids;
  for (Map& map : atlas.maps) {
    raise(next.map, map.id.value());
    if (!map.keyframes.empty()) raise(next.keyframe, map.max_keyframe_id);
    for (const KeyFrame& keyframe : map.keyframes) {
      raise(next.frame, keyframe.frame_id);
      raise(next.map, keyframe.origin_map);
      for (const MapPointId slot : keyframe.features.map_points) raise(next.map_point, slot.value());
    }
    for (const MapPoint& point : map.points) {
      if (point.origin_map != MapPoint::kNoOrigin) raise(next.map, point.origin_map);
      for (const Observation& observation : point.observations) raise(next.keyframe, observation.keyframe.value());
    }
  }
  if (next == before) return;
  report.rebuilt_counters = true;
  next.initial_keyframe = std::max(next.initial_keyframe, next.keyframe);
}

void Repair(const RecoverOptions& options, Atlas& atlas, RecoverReport& report) {
  const std::optional<std::uint64_t> words = report.words.words == 0 ? std::nullopt : std::optional(report.words.words);
  RepairReport repair = RepairAtlas(atlas, {.vocabulary_words = words, .journal = false, .threads = options.threads});
  std::ranges::move(repair.applied, std::back_inserter(report.repairs));
  report.left = std::move(repair.left);
}

// Takes the keyframes and points that errors name out of `subset`; returns how many.
std::uint64_t LeaveOutErrors(const Atlas& atlas, const RecoverOptions& options, Subset& subset, RecoverReport& report) {
  const CheckReport check =
      CheckAtlas(atlas, {.max_findings = std::numeric_limits<std::size_t>::max(), .threads = options.threads});
  const AtlasIndex index(atlas);
  std::uint64_t left_out = 0;
  const auto leave_out = [&](std::vector<std::uint8_t>& rows, std::uint32_t row, std::uint64_t& dropped) {
    if (row == kNoRow || rows[row] == 0) return;
    rows[row] = 0;
    ++dropped;
    ++left_out;
  };
  for (const RuleResult& result : check.results) {
    if (result.severity != Severity::kError) continue;
    for (const Finding& finding : result.findings) {
      const std::uint32_t map = index.MapRow(finding.place.map);
      if (map == kNoRow) continue;
      if (finding.place.point)
        leave_out(subset.maps[map].points, index.PointRow(map, finding.place.point), report.dropped_points);
      else
        leave_out(subset.maps[map].keyframes, index.KeyFrameRow(map, finding.place.keyframe), report.dropped_keyframes);
    }
  }
  return left_out;
}

}  // namespace

bool RecoverReport::sound() const {
  return std::ranges::none_of(left, [](const Unrepaired& rule) { return rule.severity == Severity::kError; });
}

bool RecoverReport::pointless() const {
  const auto is_other = [](const Unrepaired& rule) {
    return rule.severity == Severity::kError && rule.rule != "atlas-not-empty";
  };
  return !sound() && std::ranges::none_of(left, is_other);
}

RecoverReport RecoverAtlas(Atlas& atlas, const RecoverOptions& options) {
  RecoverReport report;
  detail::Steps steps(options.progress, "recovering", 3);
  steps.Next();
  if (atlas.vocabulary == Vocabulary() && options.rig != nullptr) {
    atlas.vocabulary = options.rig->vocabulary;
    report.taken_vocabulary = true;
  }
  DropImpossible(atlas, report);
  report.words = MendWords(atlas, {.tree = options.vocabulary,
                                   .identity = options.vocabulary_identity,
                                   .damaged = true,
                                   .threads = options.threads});
  RebuildMaps(atlas, report);
  RebuildCameras(options, atlas, report);
  if (options.triangulate)
    report.triangulated_points = detail::TriangulateLostPoints(atlas, report.guessed_lenses, options.threads);
  RaiseCounters(atlas, report);
  steps.Next();
  Repair(options, atlas, report);
  for (int round = 0; round < kMostRounds && !report.sound() && !report.pointless(); ++round) {
    Subset subset = Subset::Everything(atlas);
    if (LeaveOutErrors(atlas, options, subset, report) == 0) break;
    KeepSubset(atlas, subset);
    Repair(options, atlas, report);
  }
  const AtlasIndex index(atlas);
  std::erase_if(report.triangulated_points, [&](MapPointId id) { return !index.LocatePoint(id); });
  steps.Next();
  return report;
}

}  // namespace slamdb
