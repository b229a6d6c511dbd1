// SPDX-License-Identifier: BSD-3-Clause
// What stella_vslam's files hold comes back to the last bit, and what is read is sound.
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "slamdb/formats/export/options.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/index.h"
#include "tests/edit/soundness.h"
#include "tests/formats/formats/in_memory.h"

namespace slamdb {
namespace {

using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

bool SameBits(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }

std::vector<KeyFrameId> Sorted(const Column<KeyFrameId>& ids) {
  std::vector<KeyFrameId> sorted(ids.begin(), ids.end());
  std::ranges::sort(sorted);
  return sorted;
}

// Databases keep size and response of keypoints.
enum class Sizes { kKept, kDerived };

void ExpectSameKeypoints(const Column<Keypoint>& actual, const Column<Keypoint>& expected, Sizes sizes) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t row = 0; row < actual.size(); ++row) {
    ASSERT_TRUE(SameBits(actual[row].x, expected[row].x) && SameBits(actual[row].y, expected[row].y)) << row;
    ASSERT_TRUE(SameBits(actual[row].angle, expected[row].angle) && actual[row].octave == expected[row].octave) << row;
    if (sizes == Sizes::kKept) {
      ASSERT_EQ(actual[row], expected[row]);
    }
  }
}

void ExpectSame(const KeyFrame& actual, const KeyFrame& expected, const AtlasIndex& index, std::size_t map,
                Sizes sizes) {
  SCOPED_TRACE(ToString(expected.id));
  EXPECT_EQ(actual.id, expected.id);
  EXPECT_EQ(actual.timestamp, expected.timestamp);
  EXPECT_EQ(actual.camera_from_world.rotation.coeffs(), expected.camera_from_world.rotation.coeffs());
  EXPECT_EQ(actual.camera_from_world.translation, expected.camera_from_world.translation);
  EXPECT_EQ(actual.camera, expected.camera);
  EXPECT_EQ(actual.intrinsics.fx, expected.intrinsics.fx);
  EXPECT_EQ(actual.intrinsics.cy, expected.intrinsics.cy);
  EXPECT_EQ(actual.intrinsics.baseline_fx, expected.intrinsics.baseline_fx);
  EXPECT_EQ(actual.bounds, expected.bounds);
  EXPECT_EQ(actual.parent, expected.parent);
  EXPECT_EQ(Sorted(actual.children), Sorted(expected.children));
  EXPECT_EQ(Sorted(actual.loop_edges), Sorted(expected.loop_edges));
  const Features &a = actual.features, &e = expected.features;
  ExpectSameKeypoints(a.undistorted, e.undistorted, sizes);
  EXPECT_EQ(a.right_x, e.right_x);
  EXPECT_EQ(a.depth, e.depth);
  EXPECT_EQ(a.descriptors, e.descriptors);
  for (std::size_t row = 0; row < a.map_points.size(); ++row) {
    if (!a.map_points[row]) continue;
    const MapPoint* point = index.FindPoint(map, a.map_points[row]);
    ASSERT_NE(point, nullptr);
    EXPECT_THAT(point->observations, Contains(Observation{expected.id, static_cast<std::int32_t>(row)}));
  }
}

// Of two points that are the same keypoint, one stays it.
Column<Observation> Kept(const MapPoint& point, const AtlasIndex& read, std::size_t map) {
  Column<Observation> kept = point.observations;
  std::erase_if(kept, [&](const Observation& observation) {
    const KeyFrame* keyframe = read.FindKeyFrame(map, observation.keyframe);
    const MapPointId seen = keyframe->features.map_points[static_cast<std::size_t>(observation.left)];
    return seen && seen != point.id;
  });
  return kept;
}

void ExpectSame(const MapPoint& actual, const MapPoint& expected, const AtlasIndex& read, std::size_t map) {
  SCOPED_TRACE(ToString(expected.id));
  EXPECT_EQ(actual.position, expected.position);
  EXPECT_EQ(actual.reference, expected.reference);
  EXPECT_EQ(actual.first_keyframe, expected.first_keyframe);
  EXPECT_EQ(actual.visible_count, std::max(expected.visible_count, 1));
  EXPECT_EQ(actual.found_count, std::max(expected.found_count, 1));
  const Column<Observation> observations = Kept(expected, read, map);
  EXPECT_EQ(actual.observations, observations);
  if (observations == expected.observations) {
    EXPECT_EQ(actual.observation_count, expected.observation_count);
  }
}

void ExpectSame(const Atlas& actual, const Atlas& expected, Sizes sizes) {
  ASSERT_EQ(actual.maps.size(), expected.maps.size());
  ASSERT_EQ(actual.cameras.size(), expected.cameras.size());
  for (std::size_t row = 0; row < actual.cameras.size(); ++row)
    EXPECT_EQ(actual.cameras[row].parameters, expected.cameras[row].parameters);
  EXPECT_EQ(actual.next_ids.keyframe, expected.next_ids.keyframe);
  EXPECT_EQ(actual.next_ids.map_point, expected.next_ids.map_point);
  const AtlasIndex read(actual), index(expected);
  for (std::size_t map = 0; map < expected.maps.size(); ++map) {
    for (const KeyFrame& keyframe : expected.maps[map].keyframes) {
      const KeyFrame* found = read.FindKeyFrame(map, keyframe.id);
      ASSERT_NE(found, nullptr);
      ExpectSame(*found, keyframe, index, map, sizes);
    }
    for (const MapPoint& point : expected.maps[map].points) {
      const MapPoint* found = read.FindPoint(map, point.id);
      if (point.bad || point.observations.empty()) {
        EXPECT_EQ(found, nullptr);
        continue;
      }
      ASSERT_NE(found, nullptr);
      ExpectSame(*found, point, read, map);
    }
  }
}

class StellaRoundTrip : public ::testing::TestWithParam<std::string> {
 protected:
  Sizes sizes() const { return GetParam() == "stella-sqlite" ? Sizes::kKept : Sizes::kDerived; }
  std::string Write(const Atlas& atlas) { return EncodeAtlas(atlas, {.format = GetParam()}); }
};

// Rotations of double precision have no sign of their quaternion.
void FixSigns(Atlas& atlas) {
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes)
      if (keyframe.camera_from_world.rotation.w() < 0) keyframe.camera_from_world.rotation.coeffs() *= -1;
}

TEST_P(StellaRoundTrip, OfEverySensorComesBackToTheLastBit) {
  for (const SyntheticOptions& kind : testing::SensorKinds()) {
    if (kind.sensor == Sensor::kFisheyeStereo) continue;
    SCOPED_TRACE(testing::NameOf(kind));
    Atlas atlas = SynthesizeAtlas(kind);
    FixSigns(atlas);
    const std::string bytes = Write(atlas);
    Atlas back = DecodeAtlas(bytes);
    FixSigns(back);
    ExpectSame(back, atlas, sizes());
    EXPECT_TRUE(Write(DecodeAtlas(bytes)) == bytes);
  }
}

TEST_P(StellaRoundTrip, IsSoundAndLoadsInBoost) {
  const TemporaryFolder folder;
  for (const SyntheticOptions& kind : testing::SensorKinds()) {
    SCOPED_TRACE(testing::NameOf(kind));
    const Atlas atlas = SynthesizeAtlas(kind), back = DecodeAtlas(Write(atlas));
    std::set<std::string> before = testing::Troubles(atlas);
    before.insert("vocabulary-checksum");                                       // which no file of stella_vslam has
    if (kind.sensor == Sensor::kFisheyeStereo) before.insert("point-support");  // the left camera is left
    EXPECT_THAT(testing::NewTroubles(before, back), IsEmpty());
    std::size_t keyframes = 0;
    for (const Map& map : atlas.maps) keyframes += map.keyframes.size();
    EXPECT_EQ(testing::KeyFramesThatBoostReads(back, folder.Path("back.osa")), keyframes);
  }
}

// Of a fisheye pair the left camera, whose keypoints go through its lens twice.
TEST_P(StellaRoundTrip, OfAFisheyePairIsItsLeftCamera) {
  const Atlas atlas =
      SynthesizeAtlas({.sensor = Sensor::kFisheyeStereo, .keyframes = 6, .points = 100, .features = 200});
  Notices notices;
  const Atlas back = DecodeAtlas(EncodeAtlas(atlas, {.format = GetParam()}, &notices));
  EXPECT_TRUE(notices.lossy());
  ASSERT_THAT(back.maps, SizeIs(1));
  const KeyFrame &left = back.maps[0].keyframes[3], &was = atlas.maps[0].keyframes[3];
  EXPECT_FALSE(left.features.is_fisheye_stereo());
  ASSERT_EQ(left.features.keypoints.size(), was.features.keypoints.size());
  for (std::size_t row = 0; row < left.features.keypoints.size(); ++row)
    EXPECT_NEAR(left.features.keypoints[row].x, was.features.keypoints[row].x, 1e-2F);
  EXPECT_EQ(back.cameras[0].parameters, atlas.cameras[0].parameters);
}

TEST_P(StellaRoundTrip, LeavesOutWhatWouldNotBeRead) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 100, .features = 200});
  Map& map = atlas.maps[0];
  map.keyframes[2].camera_from_world.rotation.coeffs().setZero();
  map.keyframes[3].camera_from_world.translation.x() = std::numeric_limits<float>::quiet_NaN();
  map.points[4].position.x() = std::numeric_limits<float>::infinity();
  Notices notices;
  const Atlas back = DecodeAtlas(EncodeAtlas(atlas, {.format = GetParam()}, &notices));
  for (const char* said : {"2 keyframes whose pose is none", "1 point whose position is not finite"})
    EXPECT_THAT(notices.items(), Contains(Field(&Notice::text, HasSubstr(said))));
  EXPECT_EQ(back.maps[0].keyframes.size(), map.keyframes.size() - 2);
}

// By ORB-SLAM3 itself: with distortion, several maps, points that keypoints see which do not know it.
TEST_P(StellaRoundTrip, OfRealAtlases) {
  for (const char* name : {"session_small_a", "session_small_b"}) {
    SCOPED_TRACE(name);
    Atlas atlas = ReadAtlas(std::string(SLAMDB_FIXTURES "/") + name + "/" + name + ".osa");
    FixSigns(atlas);
    Atlas back = DecodeAtlas(Write(atlas));
    FixSigns(back);
    ExpectSame(back, atlas, sizes());
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, StellaRoundTrip, ::testing::Values("stella", "stella-sqlite"),
                         [](const auto& instance) { return instance.param == "stella" ? "MessagePack" : "Sqlite"; });

}  // namespace
}  // namespace slamdb
