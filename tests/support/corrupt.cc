// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/corrupt.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

constexpr std::uint64_t kNowhere = 999'999;  // an id that no small atlas has; far enough for hash tables
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Atlas MakeSound(Base base) {
  SyntheticOptions options;
  options.keyframes = 12;
  options.points = 200;
  options.features = 600;
  options.threads = 1;
  switch (base) {
    case Base::kMonocular:
      break;
    case Base::kRgbd:
      options.sensor = Sensor::kRgbd;
      break;
    case Base::kFisheyeStereo:
      options.sensor = Sensor::kFisheyeStereo;
      break;
    case Base::kInertial:
      options.sensor = Sensor::kStereo;
      options.inertial = true;
      break;
    case Base::kTwoMaps:
      options.maps = 2;
      break;
  }
  return SynthesizeAtlas(options);
}

Map& FirstMap(Atlas& atlas) { return atlas.maps[0]; }
KeyFrame& SomeKeyFrame(Atlas& atlas) { return atlas.maps[0].keyframes[5]; }
MapPoint& SomePoint(Atlas& atlas) { return atlas.maps[0].points[7]; }
KeyFrame& KeyFrameOf(Map& map, KeyFrameId id) { return *std::ranges::find(map.keyframes, id, &KeyFrame::id); }

// The first depth that there is of a keyframe of a depth camera.
float* FirstDepth(Atlas& atlas) {
  return &*std::ranges::find_if(SomeKeyFrame(atlas).features.depth, [](float depth) { return depth > 0; });
}

// A point of the first map with several observers, and one of its observations that is not by its reference keyframe.
MapPoint& SeenPoint(Atlas& atlas) {
  return *std::ranges::find_if(FirstMap(atlas).points,
                               [](const MapPoint& point) { return point.observations.size() > 2; });
}
Observation& OtherObservation(MapPoint& point) {
  return *std::ranges::find_if(point.observations,
                               [&](const Observation& seen) { return seen.keyframe != point.reference; });
}

// A filled slot of a keyframe.
MapPointId& FilledSlot(KeyFrame& keyframe) {
  return *std::ranges::find_if(keyframe.features.map_points, [](MapPointId id) { return id.has_value(); });
}

// A keyframe with a parent, and that parent.
KeyFrame& Child(Atlas& atlas) {
  return *std::ranges::find_if(FirstMap(atlas).keyframes,
                               [](const KeyFrame& keyframe) { return bool{keyframe.parent}; });
}
KeyFrame& ParentOf(Atlas& atlas, const KeyFrame& child) { return KeyFrameOf(FirstMap(atlas), child.parent); }

void AddEmptyMap(Atlas& atlas) {
  Map map;
  map.id = MapId(atlas.next_ids.map++);
  atlas.maps.push_back(std::move(map));
}

// Times that count another unit than seconds.
void CountTimesBy(Atlas& atlas, double per_second) {
  for (KeyFrame& keyframe : FirstMap(atlas).keyframes) keyframe.timestamp *= per_second;
}

// Times as 32 bits of seconds and 32 bits of nanoseconds, read as one double.
void PackTimes(Atlas& atlas, bool seconds_last) {
  for (KeyFrame& keyframe : FirstMap(atlas).keyframes) {
    const auto seconds = static_cast<std::uint64_t>(keyframe.timestamp);
    const auto nanoseconds = static_cast<std::uint64_t>((keyframe.timestamp - static_cast<double>(seconds)) * 1e9) + 1;
    keyframe.timestamp =
        std::bit_cast<double>(seconds_last ? seconds << 32 | nanoseconds : nanoseconds << 32 | seconds);
  }
}

// Three sound landmarks in the first map: of an id, of another one, and of none.
std::vector<Landmark>& AddLandmarks(Atlas& atlas) {
  Landmark landmark;
  landmark.mean = {1, 2, 3};
  landmark.cov_11 = landmark.cov_22 = landmark.cov_33 = 2;
  landmark.CreateOneFeature().descriptors = {{DescriptorKind::kSurf, {}}, {DescriptorKind::kOrb, {}}};
  std::vector<Landmark>& landmarks = FirstMap(atlas).landmarks;
  landmarks.assign(3, landmark);
  landmarks[0].id = LandmarkId(5);
  landmarks[1].id = LandmarkId(6);
  return landmarks;
}

const std::vector<Twin>& AllTwins() {
  static const std::vector<Twin> twins = {
      // Lists
      {"list-entry-null", Base::kMonocular, [](Atlas& atlas) { FirstMap(atlas).repeated_points.push_back({3}); }},
      {"list-entry-null", Base::kMonocular, [](Atlas& atlas) { atlas.repeated_maps.push_back({1}); }},
      {"map-listed-once", Base::kMonocular, [](Atlas& atlas) { atlas.repeated_maps.push_back({1, 0, 0}); }},
      {"listed-in-one-map", Base::kTwoMaps,
       [](Atlas& atlas) { atlas.maps[1].repeated_keyframes.push_back({0, 0, 3}); }},
      {"listed-once", Base::kMonocular, [](Atlas& atlas) { FirstMap(atlas).repeated_points.push_back({9, 0, 2}); }},
      {"atlas-not-empty", Base::kMonocular, [](Atlas& atlas) { atlas.maps.clear(); }},
      {"map-not-empty", Base::kMonocular, AddEmptyMap},
      {"keyframe-bad", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).bad = true; },
       {"bad-keyframe-referenced"}},
      {"point-bad", Base::kMonocular, [](Atlas& atlas) { SomePoint(atlas).bad = true; },
       {"bad-point-referenced", "connection-weight"}},

      // Ids
      {"map-id-unique", Base::kTwoMaps, [](Atlas& atlas) { atlas.maps[1].id = atlas.maps[0].id; }},
      {"camera-id-unique", Base::kMonocular, [](Atlas& atlas) { atlas.cameras.push_back(atlas.cameras[0]); }},
      {"keyframe-id-unique", Base::kMonocular,
       [](Atlas& atlas) { FirstMap(atlas).keyframes.push_back(FirstMap(atlas).keyframes[3]); },
       {"connection-weight"}},
      {"point-id-unique", Base::kMonocular,
       [](Atlas& atlas) { FirstMap(atlas).points.push_back(FirstMap(atlas).points[3]); },
       {"connection-weight", "observation-slot", "slot-observed"}},
      {"keyframe-id-unique-in-atlas", Base::kTwoMaps,
       [](Atlas& atlas) {
         atlas.maps[1] = atlas.maps[0];
         atlas.maps[1].id = MapId(1);
       },
       {"point-id-unique-in-atlas"}},
      {"point-id-unique-in-atlas", Base::kTwoMaps,
       [](Atlas& atlas) {
         atlas.maps[1] = atlas.maps[0];
         atlas.maps[1].id = MapId(1);
       },
       {"keyframe-id-unique-in-atlas"}},
      {"keyframe-id-range", Base::kMonocular,
       [](Atlas& atlas) {
         KeyFrame lonely = SomeKeyFrame(atlas);
         lonely.id = KeyFrameId(std::uint64_t{1} << 31);
         lonely.timestamp += 1000;
         FirstMap(atlas).max_keyframe_id = atlas.next_ids.keyframe = lonely.id.value() + 1;
         FirstMap(atlas).keyframes.push_back(lonely);
       },
       {"parent-lists-child", "child-has-parent", "connection-mutual", "connection-weight", "slot-observed",
        "loop-edge-mutual", "temporal-mutual"}},
      {"max-keyframe-id", Base::kMonocular, [](Atlas& atlas) { --FirstMap(atlas).max_keyframe_id; }},
      {"counters-above-ids", Base::kMonocular, [](Atlas& atlas) { atlas.next_ids.map_point = 5; }},
      {"counters-above-ids", Base::kMonocular, [](Atlas& atlas) { atlas.next_ids.frame = 0; }},
      {"origin-map-id", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).origin_map = 17; },},
      {"origin-map-id", Base::kMonocular, [](Atlas& atlas) { SomePoint(atlas).origin_map = 17; }},
      {"vocabulary-checksum", Base::kMonocular, [](Atlas& atlas) { atlas.vocabulary.checksum.clear(); }},
      {"vocabulary-checksum", Base::kMonocular, [](Atlas& atlas) { atlas.vocabulary.checksum.back() = 'G'; }},

      // Cameras
      {"camera-parameters", Base::kMonocular, [](Atlas& atlas) { atlas.cameras[0].parameters.pop_back(); }},
      {"camera-parameters", Base::kFisheyeStereo, [](Atlas& atlas) { atlas.cameras[1].parameters[5] = kNan; }},
      {"camera-type", Base::kMonocular, [](Atlas& atlas) { atlas.cameras[0].recorded_type = 1; }},
      {"camera-target", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).camera = CameraId(kNowhere); }},
      {"camera-target", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).camera = CameraId(); }},
      {"right-camera", Base::kFisheyeStereo, [](Atlas& atlas) { SomeKeyFrame(atlas).right_camera = CameraId(); }},
      {"right-camera", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).right_camera = SomeKeyFrame(atlas).camera; }},

      // Links that lead nowhere
      {"observation-target", Base::kMonocular,
       [](Atlas& atlas) {
         SeenPoint(atlas).observations.push_back({KeyFrameId(kNowhere), 0, -1});
       }},
      {"observation-target", Base::kTwoMaps,
       [](Atlas& atlas) {
         MapPoint& point = atlas.maps[1].points[0];
         point.observations.insert(point.observations.begin(), {atlas.maps[0].keyframes[0].id, 0, -1});
       }},
      {"slot-target", Base::kMonocular,
       [](Atlas& atlas) {
         *std::ranges::find(SomeKeyFrame(atlas).features.map_points, MapPointId()) = MapPointId(kNowhere);
       }},
      {"replacement-target", Base::kMonocular,
       [](Atlas& atlas) { SomePoint(atlas).replaced_by = MapPointId(kNowhere); }},
      {"connection-target", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).connections.push_back({KeyFrameId(kNowhere), 20}); }},
      {"parent-target", Base::kMonocular,
       [](Atlas& atlas) {
         KeyFrame& child = Child(atlas);
         std::erase(ParentOf(atlas, child).children, child.id);
         child.parent = KeyFrameId(kNowhere);
       }},
      {"child-target", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).children.push_back(KeyFrameId(kNowhere)); }},
      {"loop-edge-target", Base::kMonocular,
       [](Atlas& atlas) {
         SomeKeyFrame(atlas).loop_edges.push_back(KeyFrameId(kNowhere));
         SomeKeyFrame(atlas).not_erase = true;
       }},
      {"merge-edge-target", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).merge_edges.push_back(KeyFrameId(kNowhere)); }},
      {"temporal-target", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).next = KeyFrameId(kNowhere); },
       {"temporal-mutual"}},
      {"self-link", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).merge_edges.push_back(SomeKeyFrame(atlas).id); }},
      {"self-link", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).children.push_back(SomeKeyFrame(atlas).id); }},
      {"bad-keyframe-referenced", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).bad = true; },
       {"keyframe-bad"}},
      {"bad-point-referenced", Base::kMonocular, [](Atlas& atlas) { SeenPoint(atlas).bad = true; },
       {"point-bad", "connection-weight"}},
      {"links-unique", Base::kMonocular,
       [](Atlas& atlas) {
         KeyFrame& parent = ParentOf(atlas, Child(atlas));
         parent.children.push_back(parent.children[0]);
       }},

      // Features
      {"feature-count", Base::kFisheyeStereo, [](Atlas& atlas) { ++SomeKeyFrame(atlas).features.count; },
       {"column-length"}},
      {"column-length", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).features.depth.pop_back(); }},
      {"column-length", Base::kFisheyeStereo,
       [](Atlas& atlas) { SomeKeyFrame(atlas).features.left_of_right.push_back(-1); }},
      {"pyramid-tables", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).pyramid.sigma2.pop_back(); }},
      {"pyramid-scale", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).pyramid.sigma2[2] *= 2; }},
      {"octave-range", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).features.keypoints[3].octave = 8; }},
      {"octave-range", Base::kFisheyeStereo,
       [](Atlas& atlas) { SomeKeyFrame(atlas).features.right_keypoints[3].octave = -1; }},
      {"keypoint-finite", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).features.keypoints[3].x = kNan; }},
      {"stereo-match-range", Base::kFisheyeStereo,
       [](Atlas& atlas) {
         Features& features = SomeKeyFrame(atlas).features;
         features.right_of_left[0] = features.right_count;
       }},
      {"keypoint-undistorted", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).features.keypoints[3].x += 0.5F; }},
      {"stereo-finite", Base::kRgbd, [](Atlas& atlas) { *FirstDepth(atlas) = kNan; }},
      {"stereo-finite", Base::kRgbd,
       [](Atlas& atlas) {
         Features& features = SomeKeyFrame(atlas).features;
         features.right_x[static_cast<std::size_t>(FirstDepth(atlas) - features.depth.data())] = kNan;
       },
       {"observation-count-excess"}},
      {"stereo-finite", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).features.right_x[3] = kNan; }},
      {"stereo-depth", Base::kRgbd, [](Atlas& atlas) { *FirstDepth(atlas) = -1; }},
      {"stereo-depth", Base::kRgbd, [](Atlas& atlas) { *FirstDepth(atlas) *= 1.1F; }},
      {"image-bounds", Base::kMonocular,
       [](Atlas& atlas) {
         KeyFrame& keyframe = SomeKeyFrame(atlas);
         keyframe.bounds.max_x = keyframe.bounds.min_x;
       }},
      {"grid-shape", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).features.grid.column_sizes.pop_back(); }},
      {"grid-index", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).features.grid.keypoints[0] = 1u << 30; }},
      {"grid-cell", Base::kMonocular,
       [](Atlas& atlas) {
         auto& keypoints = SomeKeyFrame(atlas).features.grid.keypoints;
         std::swap(keypoints.front(), keypoints.back());
       }},
      {"feature-vector-index", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).features.feature_vector.features[0] = 1u << 30; }},
      {"feature-vector-index", Base::kMonocular,
       [](Atlas& atlas) {
         auto& features = SomeKeyFrame(atlas).features.feature_vector.features;
         features[0] = features[1];
       }},
      {"bag-of-words-paired", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).features.bag_of_words = BagOfWords(); }},
      {"bag-of-words-weight", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).features.bag_of_words.weights[0] += 0.5; }},
      {"bag-of-words-sorted", Base::kMonocular,
       [](Atlas& atlas) {
         auto& words = SomeKeyFrame(atlas).features.bag_of_words.words;
         std::swap(words[0], words[1]);
       }},
      {"word-range", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).features.bag_of_words.words.back() = 0xFFFFFFF0u; }},

      // Observations
      {"observation-sides", Base::kMonocular,
       [](Atlas& atlas) { SeenPoint(atlas).observations[0].right = Observation::kAbsent; }},
      {"observation-seen", Base::kMonocular,
       [](Atlas& atlas) { OtherObservation(SeenPoint(atlas)).left = -1; },
       {"slot-observed", "observation-count-excess"}},
      {"observation-index", Base::kMonocular, [](Atlas& atlas) { OtherObservation(SeenPoint(atlas)).left = 1 << 20; },
       {"slot-observed"}},
      {"observation-index", Base::kMonocular, [](Atlas& atlas) { OtherObservation(SeenPoint(atlas)).right = 0; },
       {"observation-count"}},
      {"observation-index", Base::kFisheyeStereo, [](Atlas& atlas) { OtherObservation(SeenPoint(atlas)).right = 0; },
       {"observation-count", "slot-observed"}},
      {"observation-count", Base::kMonocular, [](Atlas& atlas) { --SomePoint(atlas).observation_count; }},
      {"observation-count-excess", Base::kMonocular, [](Atlas& atlas) { ++SomePoint(atlas).observation_count; }},
      {"reference-target", Base::kMonocular, [](Atlas& atlas) { SomePoint(atlas).reference = KeyFrameId(kNowhere); }},
      {"reference-target", Base::kMonocular, [](Atlas& atlas) { SomePoint(atlas).reference = KeyFrameId(); }},
      {"reference-observes", Base::kMonocular,
       [](Atlas& atlas) {
         MapPoint& point = *std::ranges::find_if(FirstMap(atlas).points, [&](const MapPoint& candidate) {
           return candidate.observations.size() < FirstMap(atlas).keyframes.size();
         });
         for (const KeyFrame& keyframe : FirstMap(atlas).keyframes)
           if (std::ranges::find(point.observations, keyframe.id, &Observation::keyframe) == point.observations.end())
             point.reference = keyframe.id;
       }},
      {"point-observed", Base::kMonocular,
       [](Atlas& atlas) {
         MapPoint point = SomePoint(atlas);
         point.id = MapPointId(atlas.next_ids.map_point++);
         point.observations.clear();
         point.observation_count = 0;
         FirstMap(atlas).points.push_back(point);
       }},
      {"point-support", Base::kMonocular,
       [](Atlas& atlas) {
         MapPoint point = SeenPoint(atlas);
         point.id = MapPointId(atlas.next_ids.map_point++);
         KeyFrame& reference = KeyFrameOf(FirstMap(atlas), point.reference);
         const auto slot = std::ranges::find(reference.features.map_points, MapPointId());
         *slot = point.id;
         const auto row = static_cast<std::int32_t>(slot - reference.features.map_points.begin());
         point.observations.assign(1, {point.reference, row, -1});
         point.observation_count = 1;
         FirstMap(atlas).points.push_back(point);
       }},
      {"observation-slot", Base::kMonocular,
       [](Atlas& atlas) {
         MapPoint& point = SeenPoint(atlas);
         const Observation& observation = point.observations[0];
         KeyFrame& keyframe = KeyFrameOf(FirstMap(atlas), observation.keyframe);
         keyframe.features.map_points[static_cast<std::size_t>(observation.left)] = MapPointId();
       }},
      {"slot-observed", Base::kMonocular,
       [](Atlas& atlas) {
         KeyFrame& keyframe = SomeKeyFrame(atlas);
         const MapPointId seen = FilledSlot(keyframe);
         *std::ranges::find(keyframe.features.map_points, MapPointId()) = seen;
       }},

      // Graphs
      {"tree-acyclic", Base::kMonocular,
       [](Atlas& atlas) {
         KeyFrame& child = Child(atlas);
         std::erase(ParentOf(atlas, child).children, child.id);
         child.parent = child.id;
       }},
      {"tree-root", Base::kMonocular,
       [](Atlas& atlas) {
         KeyFrame& child = Child(atlas);
         std::erase(ParentOf(atlas, child).children, child.id);
         child.parent = KeyFrameId();
       }},
      {"parent-lists-child", Base::kMonocular,
       [](Atlas& atlas) {
         KeyFrame& child = Child(atlas);
         std::erase(ParentOf(atlas, child).children, child.id);
       }},
      {"child-has-parent", Base::kMonocular,
       [](Atlas& atlas) {
         const KeyFrame& child = Child(atlas);
         for (KeyFrame& other : FirstMap(atlas).keyframes)
           if (other.id != child.id && other.id != child.parent) {
             other.children.push_back(child.id);
             return;
           }
       }},
      {"first-connection", Base::kMonocular, [](Atlas& atlas) { Child(atlas).first_connection = true; }},
      {"initial-keyframe", Base::kMonocular,
       [](Atlas& atlas) { FirstMap(atlas).first_keyframe = KeyFrameId(kNowhere); },
       {"tree-root", "initial-keyframe-fixed"}},
      {"fixed-keyframe", Base::kMonocular,
       [](Atlas& atlas) { FirstMap(atlas).initial_keyframe = KeyFrameId(kNowhere); }, {"initial-keyframe-fixed"}},
      {"initial-keyframe-fixed", Base::kMonocular,
       [](Atlas& atlas) { FirstMap(atlas).initial_keyframe = Child(atlas).id; }},
      {"lowest-keyframe", Base::kMonocular, [](Atlas& atlas) { FirstMap(atlas).lowest_keyframe = Child(atlas).id; }},
      {"origin-target", Base::kMonocular, [](Atlas& atlas) { FirstMap(atlas).origins.push_back(KeyFrameId(kNowhere)); }},
      {"origin-given", Base::kMonocular, [](Atlas& atlas) { FirstMap(atlas).origins.clear(); }},
      {"connection-mutual", Base::kMonocular, [](Atlas& atlas) { ++SomeKeyFrame(atlas).connections[0].weight; },
       {"connection-weight"}},
      {"connection-weight", Base::kMonocular, [](Atlas& atlas) { ++SomeKeyFrame(atlas).connections[0].weight; },
       {"connection-mutual"}},
      {"connection-positive", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).connections[0].weight = 0; },
       {"connection-mutual", "connection-weight"}},
      {"loop-edge-mutual", Base::kMonocular,
       [](Atlas& atlas) {
         KeyFrame& keyframe = FirstMap(atlas).keyframes[1];
         keyframe.loop_edges.assign(1, FirstMap(atlas).keyframes[4].id);
         keyframe.not_erase = true;
       }},
      {"merge-edge-mutual", Base::kMonocular,
       [](Atlas& atlas) { FirstMap(atlas).keyframes[1].merge_edges.push_back(FirstMap(atlas).keyframes[4].id); }},
      {"loop-edge-kept", Base::kMonocular,
       [](Atlas& atlas) {
         KeyFrame &one = FirstMap(atlas).keyframes[1], &other = FirstMap(atlas).keyframes[4];
         one.loop_edges.push_back(other.id);
         other.loop_edges.push_back(one.id);
         one.not_erase = false;
         other.not_erase = true;
       }},
      {"temporal-mutual", Base::kMonocular,
       [](Atlas& atlas) {
         FirstMap(atlas).keyframes[4].previous = FirstMap(atlas).keyframes[1].id;
         FirstMap(atlas).keyframes[1].next = FirstMap(atlas).keyframes[2].id;
         FirstMap(atlas).keyframes[2].previous = FirstMap(atlas).keyframes[1].id;
       }},

      // Numbers
      {"pose-finite", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).camera_from_world.translation.y() = kNan; }},
      {"rotation-unit", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).camera_from_world.rotation.coeffs() *= 1.1F; }},
      {"rotation-unit", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).camera_from_parent.rotation.coeffs().setZero(); }},
      {"point-finite", Base::kMonocular, [](Atlas& atlas) { SomePoint(atlas).position.x() = kNan; }},
      {"point-normal", Base::kMonocular, [](Atlas& atlas) { SomePoint(atlas).normal *= 3; }},
      {"point-descriptor", Base::kMonocular,
       [](Atlas& atlas) { SomePoint(atlas).descriptor_form = MatrixForm::kEmpty; }},
      {"distance-range", Base::kMonocular, [](Atlas& atlas) { SomePoint(atlas).min_distance = kNan; }},
      {"distance-range", Base::kMonocular, [](Atlas& atlas) { SomePoint(atlas).max_distance = 0; }},
      {"distance-ratio", Base::kMonocular, [](Atlas& atlas) { SomePoint(atlas).max_distance *= 2; }},
      {"point-in-front", Base::kMonocular,
       [](Atlas& atlas) {
         MapPoint& point = SomePoint(atlas);
         const Rigid3f world_from_camera =
             KeyFrameOf(FirstMap(atlas), point.reference).camera_from_world.Normalized().Inverse();
         point.position = world_from_camera * Eigen::Vector3f(0, 0, -1);
       }},
      {"reprojection", Base::kMonocular,
       [](Atlas& atlas) {
         for (KeyFrame& keyframe : FirstMap(atlas).keyframes)
           for (Keypoint& keypoint : keyframe.features.undistorted) keypoint.x += 50;
       },
       {"grid-cell", "keypoint-undistorted"}},
      {"timestamp-finite", Base::kMonocular,
       [](Atlas& atlas) { SomeKeyFrame(atlas).timestamp = std::numeric_limits<double>::infinity(); }},
      {"timestamp-seconds", Base::kMonocular, [](Atlas& atlas) { CountTimesBy(atlas, 1e9); }},
      {"timestamp-seconds", Base::kMonocular, [](Atlas& atlas) { CountTimesBy(atlas, 1e6); }},
      {"timestamp-seconds", Base::kMonocular, [](Atlas& atlas) { CountTimesBy(atlas, 1e3); }},
      {"timestamp-seconds", Base::kMonocular, [](Atlas& atlas) { PackTimes(atlas, false); }, {"timestamp-order"}},
      {"timestamp-seconds", Base::kMonocular, [](Atlas& atlas) { PackTimes(atlas, true); }, {"timestamp-order"}},
      {"timestamp-order", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).timestamp += 1000; }},
      {"timestamp-gap", Base::kMonocular, [](Atlas& atlas) {
         for (KeyFrame& keyframe : FirstMap(atlas).keyframes)
           if (keyframe.id >= SomeKeyFrame(atlas).id) keyframe.timestamp += 7200;
       }},
      {"intrinsics-positive", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).intrinsics.fx = 0; }},
      {"intrinsics-agree", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).calibration_matrix(0, 2) += 10; }},
      {"flag-byte", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).has_velocity.recorded = 77; }},

      // Inertial
      {"imu-chain", Base::kInertial, [](Atlas& atlas) { SomeKeyFrame(atlas).next = KeyFrameId(); }},
      {"imu-chain", Base::kInertial,
       [](Atlas& atlas) { SomeKeyFrame(atlas).previous = SomeKeyFrame(atlas).next; }, {"imu-duration"}},
      {"imu-calibration", Base::kInertial, [](Atlas& atlas) { SomeKeyFrame(atlas).imu_calibration.is_set = false; },
       {"uninitialised"}},
      {"imu-calibration-inverse", Base::kInertial,
       [](Atlas& atlas) { SomeKeyFrame(atlas).imu_calibration.body_from_camera.translation.x() += 1; }},
      {"imu-preintegration", Base::kInertial, [](Atlas& atlas) { SomeKeyFrame(atlas).preintegration.duration = -1; }},
      {"imu-duration", Base::kInertial, [](Atlas& atlas) { SomeKeyFrame(atlas).preintegration.duration *= 2; }},
      {"imu-motion", Base::kInertial, [](Atlas& atlas) { SomeKeyFrame(atlas).velocity.z() = kNan; }},
      {"imu-stages", Base::kMonocular, [](Atlas& atlas) { FirstMap(atlas).imu_ba1 = true; }},

      // What is written without being set
      {"uninitialised", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).merge_scale = 1e20F; }},
      {"uninitialised", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).preintegration.covariance(3, 3) = kNan; }},
      {"uninitialised", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).body_position.x() = -1e30F; }},
      {"uninitialised", Base::kMonocular, [](Atlas& atlas) { SomeKeyFrame(atlas).imu_calibration.noise[2] = kNan; }},
      {"text-numbers", Base::kMonocular,
       [](Atlas& atlas) {
         atlas.encoding.text = true;
         SomeKeyFrame(atlas).merge_scale = kNan;
       },
       {"uninitialised"}},

      // Landmarks of MRPT
      {"landmark-id-unique", Base::kMonocular, [](Atlas& atlas) { AddLandmarks(atlas)[1].id = LandmarkId(5); }},
      {"landmark-finite", Base::kMonocular, [](Atlas& atlas) { AddLandmarks(atlas)[1].mean.y() = kNan; }},
      {"landmark-finite", Base::kMonocular, [](Atlas& atlas) { AddLandmarks(atlas)[1].normal.z() = kNan; }},
      {"landmark-normal", Base::kMonocular,
       [](Atlas& atlas) {
         const MapPoint& point = FirstMap(atlas).points[2];
         Landmark& landmark = AddLandmarks(atlas)[1];
         landmark.id = LandmarkId(point.id.value());
         landmark.normal = point.normal.cast<double>();
       }},
      {"landmark-covariance", Base::kMonocular, [](Atlas& atlas) { AddLandmarks(atlas)[1].cov_12 = 3; }},
      {"landmark-covariance", Base::kMonocular, [](Atlas& atlas) { AddLandmarks(atlas)[1].cov_33 = kNan; }},
      {"landmark-descriptors", Base::kMonocular,
       [](Atlas& atlas) { AddLandmarks(atlas)[1].features[0].descriptors[1].kind = DescriptorKind::kSift; }},
      {"landmark-descriptors", Base::kMonocular,
       [](Atlas& atlas) { AddLandmarks(atlas)[1].features[0].descriptors[1].kind = DescriptorKind{9}; }},
  };
  return twins;
}

}  // namespace

const Atlas& SoundAtlas(Base base) {
  static const std::vector<Atlas> atlases = [] {
    std::vector<Atlas> made;
    for (const Base kind : {Base::kMonocular, Base::kRgbd, Base::kFisheyeStereo, Base::kInertial, Base::kTwoMaps})
      made.push_back(MakeSound(kind));
    return made;
  }();
  return atlases[static_cast<std::size_t>(base)];
}

std::span<const Twin> Twins() { return AllTwins(); }

}  // namespace slamdb
