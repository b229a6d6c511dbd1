// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam2/detail/orbslam2.h"

#include <gmock/gmock.h>

#include <cstring>

#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam2/detail/read.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/model/index.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/edit/soundness.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/orbslam2/graph_encoder.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/boost_reference/boost_reference.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

const std::string kGolden = SLAMDB_FIXTURES "/formats/orbslam2";

Atlas ReadGraph(const std::string& bytes, Notices& notices) {
  return detail::kOrbslam2Format.read({std::as_bytes(std::span(bytes)), "map.bin"}, {}, notices);
}
Atlas ReadGraph(const std::string& bytes) {
  Notices notices;
  return ReadGraph(bytes, notices);
}

// What reading says of bytes that it refuses; "read" when it does not.
std::string Refusal(const std::string& bytes) {
  return RefusalOf([&] { ReadGraph(bytes); });
}

Atlas MonocularAtlas() {
  Atlas atlas = SynthesizeAtlas({.keyframes = 12, .points = 200, .features = 100});
  Map& map = atlas.maps[0];
  for (MapPoint& point : map.points) {
    point.visible_count = static_cast<std::int32_t>(3 + point.id.value());
    point.found_count = static_cast<std::int32_t>(2 + point.id.value());
  }
  return atlas;
}

// 31 pixels times 1.2 for each octave, without their fraction.
constexpr std::array kPatches = {31.F, 37.F, 44.F, 53.F, 64.F, 77.F, 92.F, 111.F};

// Poses are matrices there: the same but for the last bits. `read` gives those.
void ExpectAndTakePoses(KeyFrame& keyframe, const KeyFrame& read) {
  for (Rigid3f KeyFrame::*pose : {&KeyFrame::camera_from_world, &KeyFrame::camera_from_parent}) {
    const Rigid3f& given = keyframe.*pose;
    EXPECT_LT(Eigen::Quaternionf(given.rotation).angularDistance(Eigen::Quaternionf((read.*pose).rotation)), 1e-3F);
    EXPECT_EQ(given.translation, (read.*pose).translation);
    keyframe.*pose = read.*pose;
  }
}

// What an ORB-SLAM2 file gives back of a keyframe: the rest is as if it had never been set.
KeyFrame Holdable(KeyFrame keyframe) {
  const KeyFrame none;
  keyframe.distortion = none.distortion;
  keyframe.camera = CameraId(0);  // the maps here have one
  keyframe.merge_edges.clear();
  keyframe.merge_scale = 0;
  keyframe.origin_map = 0;
  keyframe.imu_bias = none.imu_bias;
  keyframe.preintegration = none.preintegration;
  keyframe.imu_calibration = none.imu_calibration;
  keyframe.body_position = none.body_position;
  keyframe.velocity = none.velocity;
  keyframe.previous = keyframe.next = {};
  keyframe.left_from_right = none.left_from_right;
  std::ranges::sort(keyframe.children);
  std::ranges::sort(keyframe.loop_edges);
  if (!keyframe.loop_edges.empty()) keyframe.not_erase = true;
  for (auto column : {&Features::keypoints, &Features::undistorted})
    for (Keypoint& keypoint : keyframe.features.*column)
      keypoint.size = kPatches.at(static_cast<std::size_t>(keypoint.octave));
  keyframe.features.right_of_left.clear();
  keyframe.features.left_of_right.clear();
  return keyframe;
}

Map Holdable(Map map, const Map& read) {
  for (std::size_t i = 0; i < map.keyframes.size(); ++i) {
    KeyFrame& keyframe = map.keyframes[i] = Holdable(map.keyframes[i]);
    ExpectAndTakePoses(keyframe, read.keyframes[i]);
    keyframe.first_connection = i == 0;
  }
  map.id = MapId(0);
  map.initial_keyframe = map.first_keyframe = map.lowest_keyframe = map.keyframes[0].id;
  return map;
}

void SortById(Map& map) {
  const auto by_id = [](const auto& a, const auto& b) { return a.id < b.id; };
  std::sort(map.keyframes.begin(), map.keyframes.end(), by_id);
  std::sort(map.points.begin(), map.points.end(), by_id);
}

// A pointer leads to an object; an id may lead to none.
void ClearDanglingSlots(Map& map) {
  const IdTable points = PointTable(map);
  for (KeyFrame& keyframe : map.keyframes)
    for (MapPointId& id : keyframe.features.map_points)
      if (points.Find(id.value()) == kNoRow) id = {};
}

void ExpectGivenBack(Atlas atlas) {
  SortById(atlas.maps[0]);
  ClearDanglingSlots(atlas.maps[0]);
  const Atlas read = ReadGraph(EncodeGraph(atlas.maps[0]).bytes);
  ASSERT_EQ(read.maps.size(), 1U);
  ASSERT_EQ(read.maps[0].keyframes.size(), atlas.maps[0].keyframes.size());
  Atlas expected = read;
  expected.maps[0] = Holdable(atlas.maps[0], read.maps[0]);
  EXPECT_THAT(read, EqualsAtlas(expected));
}

// Written by classes of the same members with stock Boost.
TEST(Orbslam2, ReadsWhatBoostWrote) {
  Notices notices;
  const Atlas atlas = ReadGraph(ReadFile(kGolden), notices);
  ASSERT_EQ(atlas.maps.size(), 1U);
  const Map& map = atlas.maps[0];
  ASSERT_EQ(map.keyframes.size(), 2U);
  ASSERT_EQ(map.points.size(), 2U);
  EXPECT_EQ(map.max_keyframe_id, 1U);
  EXPECT_THAT(map.origins, ElementsAre(KeyFrameId(0)));
  const KeyFrame& first = map.keyframes[0];
  const KeyFrame& second = map.keyframes[1];
  EXPECT_EQ(first.id, KeyFrameId(0));
  EXPECT_EQ(first.frame_id, 10U);
  EXPECT_EQ(first.timestamp, 1.5);
  EXPECT_THAT(first.children, ElementsAre(KeyFrameId(1)));
  EXPECT_FALSE(first.parent);
  EXPECT_EQ(second.parent, KeyFrameId(0));
  EXPECT_THAT(second.features.map_points, ElementsAre(MapPointId(0), MapPointId(1)));
  EXPECT_THAT(second.connections, ElementsAre(Connection{KeyFrameId(0), 2}));
  EXPECT_EQ(first.features.keypoints[1], (Keypoint{1, 2, 31, 3, 4, -1, 5}));
  EXPECT_THAT(first.features.bag_of_words.words, ElementsAre(1, 2));
  EXPECT_THAT(first.features.bag_of_words.weights, ElementsAre(0.5, 0.5));
  EXPECT_THAT(first.features.feature_vector.nodes, ElementsAre(7));
  EXPECT_THAT(first.features.feature_vector.features, ElementsAre(0, 1));
  EXPECT_THAT(first.features.grid.column_sizes, ElementsAre(1, 1));
  EXPECT_THAT(first.features.grid.keypoints, ElementsAre(0, 1));
  EXPECT_THAT(map.points[1].observations,
              ElementsAre(Observation{KeyFrameId(0), 1, -1}, Observation{KeyFrameId(1), 1, -1}));
  EXPECT_EQ(map.points[1].max_distance, 2);
  EXPECT_EQ(map.points[1].found_count, 1);
  EXPECT_EQ(atlas.next_ids.map_point, 9U);
  // Descriptors of 8 floats, which are no ORB.
  ASSERT_TRUE(first.carried);
  EXPECT_EQ(first.carried->descriptors.rows, 2);
  EXPECT_EQ(first.carried->descriptors.columns, 8);
  EXPECT_EQ(first.carried->descriptors.type, 5);
  EXPECT_EQ(map.points[0].carried->descriptors.data.size(), 32U);
}

TEST(Orbslam2, GivesBackWhatAnEncoderOfItsOwnWrote) { ExpectGivenBack(MonocularAtlas()); }

TEST(Orbslam2, GivesBackBadEntitiesAndReplacedPoints) {
  Atlas atlas = MonocularAtlas();
  Map& map = atlas.maps[0];
  map.points[3].bad = true;
  map.points[3].replaced_by = map.points[4].id;
  map.keyframes[5].bad = true;
  map.keyframes[5].to_be_erased = true;
  map.keyframes[7].loop_edges = {map.keyframes[1].id};
  ExpectGivenBack(atlas);
}

TEST(Orbslam2, GivesBackRealMaps) {
  for (const std::string name : {"mono_small", "session_small_a", "race_mono"}) {
    const std::string path = RealAtlas(name);
    if (path.empty()) continue;
    Notices notices;
    Atlas atlas = ReadOrbslam3(path, {}, notices);
    atlas.maps.resize(1);
    for (MapPoint& point : atlas.maps[0].points) point.visible_count = point.found_count = 1;
    ExpectGivenBack(atlas);
  }
}

// One keyframe leads to one point, and that to the next keyframe: nothing but the stack of the program would be deep.
TEST(Orbslam2, ReadsAChainOfAnyDepth) {
  constexpr std::uint64_t kLength = 100'000;
  Map map;
  map.keyframes.resize(kLength);
  map.points.resize(kLength);
  for (std::uint64_t i = 0; i < kLength; ++i) {
    map.keyframes[i].id = KeyFrameId(i);
    map.keyframes[i].features.map_points = {MapPointId(i + 1)};
    map.points[i].id = MapPointId(i);
    map.points[i].observations = {{.keyframe = KeyFrameId(i), .left = 0}};
  }
  const Atlas atlas = ReadGraph(EncodeGraph(map).bytes);
  ASSERT_EQ(atlas.maps[0].keyframes.size(), kLength);
  EXPECT_EQ(atlas.maps[0].points.size(), kLength);
  EXPECT_EQ(atlas.maps[0].keyframes[77].features.map_points[0], MapPointId(78));
}

// Objects are met in another order: classes and objects have other numbers.
TEST(Orbslam2, GivesBackMapsWithoutPointsOrKeyFrames) {
  Atlas atlas = MonocularAtlas();
  Map& map = atlas.maps[0];
  for (KeyFrame& keyframe : map.keyframes) std::ranges::fill(keyframe.features.map_points, MapPointId());
  map.points.clear();
  EXPECT_EQ(ReadGraph(EncodeGraph(map).bytes).maps[0].keyframes.size(), 12U);
  Map points = MonocularAtlas().maps[0];
  points.keyframes.clear();
  points.origins.clear();
  EXPECT_EQ(ReadGraph(EncodeGraph(points).bytes).maps[0].points.size(), points.points.size());
}

// What ORB-SLAM3 itself loads, with the stock Boost that it uses.
void ExpectThatOrbslam3Loads(const std::string& bytes) {
  const Atlas atlas = ReadGraph(bytes);
  EXPECT_THAT(testing::NewTroubles({"vocabulary-checksum"}, atlas), IsEmpty());  // which no map of ORB-SLAM2 has
  const TemporaryFolder folder;
  Notices notices;
  WriteOptions options;
  options.of<Orbslam3WriteOptions>().boost_version = reference::ArchiveVersion();
  WriteOrbslam3(atlas, folder.Path("map.osa"), options, notices);
  const Atlas loaded = reference::Load(folder.Path("map.osa"), reference::Encoding::kBinary);
  ASSERT_EQ(loaded.maps.size(), 1U);
  EXPECT_EQ(loaded.maps[0].keyframes.size(), atlas.maps[0].keyframes.size());
  EXPECT_EQ(loaded.maps[0].points.size(), atlas.maps[0].points.size());
}

TEST(Orbslam2, BecomesWhatOrbslam3Loads) {
  ExpectThatOrbslam3Loads(EncodeGraph(MonocularAtlas().maps[0]).bytes);
  const std::string path = RealAtlas("session_small_a");
  if (path.empty()) return;
  Notices notices;
  ExpectThatOrbslam3Loads(EncodeGraph(ReadOrbslam3(path, {}, notices).maps[0]).bytes);
}

TEST(Orbslam2, NamesWhatItLeavesOut) {
  Notices notices;
  ReadGraph(ReadFile(kGolden), notices);
  EXPECT_THAT(notices.items(), Contains(Field(&Notice::text, HasSubstr("vocabulary has no name"))));
  // Its matrices are zeros.
  EXPECT_THAT(notices.items(), Contains(Field(&Notice::text, HasSubstr("the file has no pose of 2 keyframes"))));
}

TEST(Orbslam2, EveryCutIsAnErrorWithItsPlace) {
  const std::string whole = ReadFile(kGolden);
  for (std::size_t size = 16; size < whole.size(); ++size)
    EXPECT_THAT(Refusal(whole.substr(0, size)), AnyOf(HasSubstr("truncated"), HasSubstr("does not fit"))) << size;
  EXPECT_THAT(Refusal(whole.substr(0, 1000)), StartsWith("byte "));
}

TEST(Orbslam2, AnyFlipIsReadOrRefused) {
  const std::string whole = ReadFile(kGolden);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x81);
    Refusal(flipped);
  }
}

TEST(Orbslam2, EveryNumberThatOthersHangOnIsChecked) {
  Atlas atlas = MonocularAtlas();
  const EncodedGraph graph = EncodeGraph(atlas.maps[0]);
  std::size_t of_class = 0, of_object = 0, of_count = 0;
  for (std::size_t i = 0; i < graph.fields.size(); i += i < 500 ? 1 : 97) {
    const GraphField& field = graph.fields[i];
    std::string bytes = graph.bytes;
    bytes.replace(field.offset, field.bytes, field.bytes, '\x7e');
    const std::string refusal = Refusal(bytes);
    if (field.kind != GraphField::Kind::kMatrix) {  // an empty one may have any type
      EXPECT_NE(refusal, "read") << field.offset;
    }
    of_class += field.kind == GraphField::Kind::kClass && refusal.find("a pointer to class") != refusal.npos;
    of_object += field.kind == GraphField::Kind::kObject && refusal.find("a pointer to object") != refusal.npos;
    of_count += field.kind == GraphField::Kind::kCount && refusal.find("does not fit") != refusal.npos;
  }
  EXPECT_GT(of_class, 10U);
  EXPECT_GT(of_object, 10U);
  EXPECT_GT(of_count, 10U);
}

TEST(Orbslam2, WhatIsLeftBehindTheMapIsRefused) {
  EXPECT_THAT(Refusal(ReadFile(kGolden) + '\0'), HasSubstr("bytes are left behind the map"));
}

TEST(Orbslam2, PointersOfAnotherClassAreRefused) {
  // The first observation of the first point leads to that point instead of a keyframe.
  std::string bytes = ReadFile(kGolden);
  const std::string pointer("\x06\0\x01\0\0\0\0\x02\0\0\0", 11);
  const std::size_t at = bytes.find(pointer);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at + 7, 4, std::string("\x01\0\0\0", 4));
  EXPECT_THAT(Refusal(bytes), HasSubstr("a pointer to object 1, which is of another class"));
}

TEST(Orbslam2, ClassesOfAnotherVersionAreUnsupported) {
  std::string bytes = ReadFile(kGolden);
  bytes[3] = 7;
  EXPECT_THAT(Refusal(bytes), HasSubstr("a class of version 7"));
}

TEST(Orbslam2, DanglingAndDuplicateIdsAreRead) {
  Atlas atlas = MonocularAtlas();
  Map& map = atlas.maps[0];
  map.points[1].replaced_by = MapPointId(1'000'000);
  map.keyframes[2].parent = KeyFrameId(1'000'000);
  map.keyframes[1].timestamp = std::numeric_limits<double>::infinity();
  const Atlas read = ReadGraph(EncodeGraph(map).bytes);
  EXPECT_EQ(read.maps[0].points.size(), map.points.size());
}

TEST(Orbslam2, NumbersThatNoPoseNorPointNorCameraHasAreRefused) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto refusal = [](const std::function<void(Map&)>& change) {
    Map map = MonocularAtlas().maps[0];
    change(map);
    return Refusal(EncodeGraph(map).bytes);
  };
  EXPECT_THAT(refusal([=](Map& map) { map.points[3].position.x() = kNan; }),
              AllOf(HasSubstr("mp 3, mWorldPos: the position nan"), StartsWith("byte ")));
  EXPECT_THAT(refusal([=](Map& map) { map.keyframes[2].camera_from_world.translation.y() = kNan; }),
              HasSubstr("kf 2, Tcw: the position"));
  EXPECT_THAT(refusal([=](Map& map) { map.keyframes[2].camera_from_world.rotation.coeffs().setConstant(kNan); }),
              HasSubstr("kf 2, Tcw: the matrix"));
  EXPECT_THAT(refusal([](Map& map) { map.keyframes[2].intrinsics.fy = -1; }), HasSubstr("kf 2, cy: the focal lengths"));
  EXPECT_THAT(refusal([=](Map& map) { map.keyframes[2].calibration_matrix(0, 2) = kNan; }),
              HasSubstr("kf 2, mK: the camera's numbers nan"));
}

TEST(Orbslam2, MembersAreNamedWhereTheFileEnds) {
  const std::string whole = ReadFile(kGolden);
  std::string refusals;
  for (std::size_t size = 16; size < whole.size(); ++size) refusals += Refusal(whole.substr(0, size)) + "\n";
  for (const char* member : {"fx", "fy", "cx", "cy", "invfx", "invfy", "mbf", "mb", "mThDepth", "mnMinX", "mnMaxY"})
    EXPECT_THAT(refusals, HasSubstr(", kf 0, " + std::string(member) + ": ")) << member;
}

TEST(Orbslam2, AMapWithNothingInItIsRead) {
  const Atlas atlas = ReadGraph(EncodeGraph({}).bytes);
  ASSERT_EQ(atlas.maps.size(), 1U);
  EXPECT_THAT(atlas.maps[0].keyframes, IsEmpty());
}

TEST(Orbslam2, ThreadsMakeNoDifference) {
  const std::string bytes = EncodeGraph(MonocularAtlas().maps[0]).bytes;
  Notices notices;
  const auto read = [&](int threads) {
    return detail::kOrbslam2Format.read({std::as_bytes(std::span(bytes)), "map.bin"}, {.threads = threads}, notices);
  };
  const Atlas alone = read(1);
  EXPECT_THAT(read(5), EqualsAtlas(alone));
}

}  // namespace
}  // namespace slamdb
