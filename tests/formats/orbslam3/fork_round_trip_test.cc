// SPDX-License-Identifier: BSD-3-Clause
// Files of every known layout, and of layouts that forks could have: read, and written back byte for byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/formats/layouts/invented_layouts.h"
#include "tests/formats/orbslam3/crafted_atlases.h"
#include "tests/formats/orbslam3/fork_files.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/fuzz/osa_mutator.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/message_of.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char* kLayouts[] = {"visible-found", "obvi",     "globus",   "gnss",     "mavis-points",
                                    "mavis",         "wheel-zz", "equirect", "mono-imu", "mov",
                                    "bow-base",      "bow-vec",  "v03"};

// An atlas as a file of the layout brings it.
Atlas InLayout(const Atlas& atlas, const std::string& layout) { return ReadFork(WriteFork(atlas, layout), layout); }

// ---- What layouts lack of v1.0, or have in other numbers, taken out of an atlas

void LeaveOutStereo(KeyFrame& keyframe) {
  const KeyFrame none;
  Features& features = keyframe.features;
  keyframe.intrinsics.baseline_fx = keyframe.intrinsics.baseline = keyframe.intrinsics.depth_threshold = 0;
  features.right_x.clear(), features.depth.clear();
  keyframe.half_baseline = none.half_baseline;
  keyframe.right_camera = none.right_camera;
}
void LeaveOutFisheye(KeyFrame& keyframe) {
  const KeyFrame none;
  Features& features = keyframe.features;
  features.right_of_left.clear(), features.left_of_right.clear();
  features.left_count = none.features.left_count;
  features.right_count = none.features.right_count;
  keyframe.left_from_right = none.left_from_right;
  features.right_keypoints.clear();
  features.right_grid = {};
}
void LeaveOutInertial(KeyFrame& keyframe) {
  const KeyFrame none;
  keyframe.imu_bias = none.imu_bias;
  keyframe.preintegration = none.preintegration;
  keyframe.imu_calibration = none.imu_calibration;
  keyframe.previous = none.previous, keyframe.next = none.next;
  keyframe.imu_initialized = none.imu_initialized, keyframe.has_velocity = none.has_velocity;
  keyframe.velocity = none.velocity, keyframe.body_position = none.body_position;
}
void LeaveOutWords(KeyFrame& keyframe) {
  Features& features = keyframe.features;
  features.descriptors.clear();
  features.descriptors_form = {};
  features.bag_of_words = {};
  features.feature_vector = {};
}
void LeaveOut(std::string_view layout, KeyFrame& keyframe) {
  if (layout == "obvi") keyframe.timestamp = 0;
  if (layout == "mono-imu") LeaveOutStereo(keyframe);
  if (layout == "mono-imu" || layout == "v03") LeaveOutFisheye(keyframe);
  if (layout == "mov") LeaveOutWords(keyframe);
  if (layout != "v03") return;
  LeaveOutInertial(keyframe);
  keyframe.camera_from_world.rotation = keyframe.camera_from_parent.rotation = Eigen::Quaternionf::Identity();
  keyframe.origin_map = 0;
}
void LeaveOut(std::string_view layout, Atlas& atlas) {
  atlas.layout.clear();
  atlas.carried.Reset();
  if (layout == "globus") {
    const std::uint64_t kept = atlas.next_ids.initial_keyframe;
    atlas.next_ids = {};
    atlas.next_ids.initial_keyframe = kept;
  }
  if (layout == "mov") atlas.vocabulary = {};
  for (Map& map : atlas.maps) {
    map.carried.Reset();
    for (KeyFrame& keyframe : map.keyframes) {
      keyframe.carried.Reset();
      LeaveOut(layout, keyframe);
    }
    for (MapPoint& point : map.points) {
      point.carried.Reset();
      if (layout != "mov") continue;
      point.descriptor = {};
      point.descriptor_form = {};
    }
  }
}

class KnownLayout : public ::testing::TestWithParam<const char*> {
 protected:
  static std::string id() { return GetParam(); }

  static void ExpectSameBytes(const Atlas& atlas) {
    const std::string bytes = WriteFork(atlas, id());
    const Atlas read = ReadFork(bytes, id());
    EXPECT_EQ(read.layout, id());
    EXPECT_TRUE(EncodeOrbslam3(read) == bytes);
  }
};

TEST_P(KnownLayout, ComesBackByteForByteInEveryEncoding) {
  for (const bool text : {false, true})
    for (const int widths : {88, 48, 44}) {
      Atlas atlas = SmallWorld();
      atlas.encoding = {.text = text,
                        .boost_version = 18,
                        .long_bytes = static_cast<std::uint8_t>(widths / 10),
                        .size_bytes = static_cast<std::uint8_t>(widths % 10)};
      SCOPED_TRACE(::testing::Message() << (text ? "text " : "binary ") << widths);
      ExpectSameBytes(atlas);
    }
}

TEST_P(KnownLayout, ComesBackByteForByteFromARealAtlas) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, "session_small_a");
  Notices notices;
  ExpectSameBytes(ReadOrbslam3(path, {}, notices));
}

TEST_P(KnownLayout, ComesBackWithIrregularEntries) {
  const std::string odd = CraftOddAtlas({}).bytes;
  ExpectSameBytes(ReadFork(odd, "v1.0"));
}

TEST_P(KnownLayout, IsFoundWithoutBeingNamed) {
  const std::string bytes = WriteFork(SmallWorld(), id());
  EXPECT_EQ(ReadFork(bytes, "").layout, id());
}

// Whatever stands in any field that the layout holds is there after a round trip, to the last bit.
TEST_P(KnownLayout, HoldsEveryFieldToTheLastBit) {
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    Atlas expected = fuzz::VariationOf(SmallWorld(), seed);
    Atlas read = InLayout(expected, id());
    ASSERT_EQ(read.layout, id());
    LeaveOut(id(), read);
    LeaveOut(id(), expected);
    ASSERT_EQ(FirstDifference(read, expected), "") << "variation " << seed;
  }
}

TEST_P(KnownLayout, SaysWhatV1CannotHold) {
  const Atlas atlas = InLayout(SmallWorld(), id());
  Notices notices;
  const std::string own = WriteFork(atlas, "v1.0", &notices);
  EXPECT_EQ(ReadFork(own, "v1.0").layout, "");
  bool carries = static_cast<bool>(atlas.carried);
  for (const Map& map : atlas.maps)
    for (const MapPoint& point : map.points) carries = carries || point.carried;
  for (const KeyFrame& keyframe : atlas.maps[0].keyframes) carries = carries || keyframe.carried;
  // Of obvi and the bags of words the model knows all; what v1.0 lacks of them is nothing.
  const bool converted = id() == "obvi" || id().starts_with("bow-");
  EXPECT_EQ(notices.lossy(), carries && !converted) << TextOf(notices);
}

INSTANTIATE_TEST_SUITE_P(All, KnownLayout, ::testing::ValuesIn(kLayouts), [](const auto& test) {
  std::string name = test.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST(KnownLayouts, AreAllTested) {
  EXPECT_EQ(std::size(kLayouts) + 1, KnownLayouts().size());
  for (const char* layout : kLayouts) EXPECT_NE(FindKnownLayout(layout), nullptr) << layout;
}

// v1.0 as its own description says it, through the engine of forks, is what the compiled-in description reads.
TEST(ForkEngine, AgreesWithTheFastPathOnV1) {
  Layout layout = *FindKnownLayout("v1.0");
  for (const char* name : {"session_small_a", "mono_small_twice"}) {
    SLAMDB_REQUIRE_REAL_ATLAS(path, name);
    const std::string bytes = ReadWhole(path);
    Atlas slow = ReadFork(bytes, ToJson(layout));
    EXPECT_EQ(slow.layout, "");
    EXPECT_EQ(FirstDifference(slow, ReadFork(bytes, "v1.0")), "") << name;
  }
}

// ---- invented forks: any member of any type anywhere

TEST(InventedFork, ComesBackByteForByte) {
  const Atlas atlas = SmallWorld();
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    std::mt19937_64 random(seed);
    const testing::Invention invention =
        testing::InventLayout(random, {.insertions = 1 + static_cast<int>(seed % 4), .removals = seed % 7 == 0});
    Atlas given = atlas;
    given.encoding.text = seed % 3 == 0;
    SCOPED_TRACE(::testing::PrintToString(invention.changes));
    const LayoutClass& point = *invention.layout.Find("MapPoint");
    const auto first = std::ranges::find(point.members, "mBackupObservationsId1", &LayoutMember::name);
    // Apart they are carried besides, which Forge does not do; see ObservationsApart.
    if (first == point.members.end() || (first + 1)->name != "mBackupObservationsId2") continue;
    const std::string bytes = testing::Forge(given, invention.layout, random);
    const Atlas read = ReadFork(bytes, ToJson(invention.layout));
    EXPECT_TRUE(EncodeOrbslam3(read) == bytes) << seed;
    if (seed % 7 == 0) continue;  // where members of v1.0 went
    EXPECT_TRUE(testing::OwnBytes(read) == EncodeOrbslam3(given)) << seed;
  }
}

// ---- cameras

std::string WithoutRegistration() { return Changed(R"({"class": "Atlas", "registers": []})"); }

TEST(ForkCameras, AreFoundByTheKeysThatTheyAreExportedBy) {
  std::string layout =
      Changed(R"({"class": "Atlas", "registers": []})",
              R"({"Pinhole": {"export": "ORB_SLAM3::Pinhole", "fields": [["base", "val<GeometricCamera>"]]}})");
  Atlas atlas = SynthesizeAtlas({.keyframes = 2, .points = 5, .features = 20, .threads = 1});
  const std::string bytes = WriteFork(atlas, layout);
  EXPECT_THAT(bytes, HasSubstr(std::string("\x12\0\0\0\0\0\0\0ORB_SLAM3::Pinhole", 26)));
  const Atlas read = ReadFork(bytes, WithoutRegistration());  // which does not know the key: the file tells it
  EXPECT_TRUE(EncodeOrbslam3(read) == bytes);
  EXPECT_EQ(read.cameras.at(0).model, CameraModel::kPinhole);
}

TEST(ForkCameras, OfAThirdModelComeBack) {
  Atlas atlas = SmallWorld();
  atlas.cameras[0].model = CameraModel::kEquirectangular;
  atlas.cameras[0].parameters = {1920, 960};
  atlas.cameras[0].recorded_type = 2;
  const std::string bytes = WriteFork(atlas, "equirect");
  const Atlas read = ReadFork(bytes, "");
  EXPECT_EQ(read.layout, "equirect");
  EXPECT_EQ(read.cameras[0].model, CameraModel::kEquirectangular);
  EXPECT_THAT(read.cameras[0].parameters, ::testing::ElementsAre(1920, 960));
  EXPECT_TRUE(EncodeOrbslam3(read) == bytes);
  EXPECT_THAT(MessageOf([&] { (void)WriteFork(read, "v1.0"); }), HasSubstr("ORB-SLAM3 v1.0 has no class"));
}

TEST(ForkCameras, OfAClassThatTheModelLacksAreRefused) {
  const std::string layout = Changed(R"({"class": "Atlas", "registers": ["Fisheye", "KannalaBrandt8"]})",
                                     R"({"Fisheye": {"fields": [["base", "val<GeometricCamera>"]]}})");
  Atlas atlas = SynthesizeAtlas({.keyframes = 2, .points = 5, .features = 20, .threads = 1});
  const std::string own = EncodeOrbslam3(atlas);  // whose first registered class is Pinhole
  EXPECT_EQ(ReadFork(own, layout).layout, "") << "read as of v1.0, which fits";
}

// mavis: keyframes point to cameras, which stand inside the first keyframe that does.
TEST(ForkCameras, MayStandInsideKeyframes) {
  std::string layout = Changed(
      R"({"class": "KeyFrame", "after": "mbHasVelocity", "add": [["mpCamera", "ptr<GeometricCamera>"]]},
         {"class": "Atlas", "replace": ["mvpCameras"], "add": []},
         {"class": "Atlas", "after": "mvpBackupMaps", "add": [["mvpCameras", "vec<ptr<GeometricCamera>>"]]})");
  Atlas atlas = SynthesizeAtlas({.keyframes = 3, .points = 5, .features = 20, .threads = 1});
  Atlas read = ReadFork(WriteFork(atlas, layout), layout);
  const std::uint64_t camera = read.cameras.at(0).id.value();
  for (KeyFrame& keyframe : read.maps[0].keyframes) {  // null so far: make them lead to the camera
    ASSERT_EQ(keyframe.carried->members.size(), 1U);
    Column<std::byte>& members = keyframe.carried.Make().members;
    members.assign({std::byte{1}, std::byte{3}});  // an entity, a camera
    for (int i = 0; i < 8; ++i) members.push_back(static_cast<std::byte>(camera >> (8 * i) & 0xffU));
  }
  const std::string bytes = EncodeOrbslam3(read);
  const Atlas again = ReadFork(bytes, layout);
  EXPECT_EQ(FirstDifference(again, read), "");
  EXPECT_TRUE(EncodeOrbslam3(again) == bytes);
}

// ---- descriptors

TEST(ForkDescriptors, OfFloatsComeBackInTheLayoutOfV1) {
  const Atlas atlas = WithFloatDescriptors();
  for (const bool text : {false, true}) {
    Atlas given = atlas;
    given.encoding.text = text;
    const std::string bytes = EncodeOrbslam3(given);
    const Atlas read = ReadFork(bytes, "");
    EXPECT_EQ(read.layout, "");
    EXPECT_EQ(FirstDifference(read, given), "");
    EXPECT_TRUE(EncodeOrbslam3(read) == bytes);
  }
}

TEST(ForkDescriptors, OfFloatsComeBackInAForksLayout) {
  const std::string bytes = WriteFork(WithFloatDescriptors(), "gnss");
  const Atlas read = ReadFork(bytes, "");
  EXPECT_EQ(read.layout, "gnss");
  EXPECT_EQ(read.maps[0].keyframes[0].descriptor_count(), 30U);
  EXPECT_TRUE(EncodeOrbslam3(read) == bytes);
}

// ---- members in other types

TEST(ForkConversions, TimesOfSecondsAndNanoseconds) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 3, .points = 5, .features = 20, .threads = 1});
  Atlas read = InLayout(atlas, "obvi");
  EXPECT_NEAR(read.maps[0].keyframes[2].timestamp, atlas.maps[0].keyframes[2].timestamp, 1e-6);
  // An edited time is written anew, the others as they were.
  read.maps[0].keyframes[1].timestamp = 12.25;
  const Atlas again = ReadFork(EncodeOrbslam3(read), "obvi");
  EXPECT_EQ(again.maps[0].keyframes[1].timestamp, 12.25);
  EXPECT_EQ(again.maps[0].keyframes[2].timestamp, read.maps[0].keyframes[2].timestamp);
}

TEST(ForkConversions, PosesOfMatrices) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 3, .points = 5, .features = 20, .threads = 1});
  const Atlas read = InLayout(atlas, "v03");
  for (std::size_t i = 0; i < 3; ++i) {
    const Rigid3f &a = read.maps[0].keyframes[i].camera_from_world, &b = atlas.maps[0].keyframes[i].camera_from_world;
    EXPECT_LT(a.rotation.angularDistance(b.rotation), 1e-3F);
    EXPECT_EQ(a.translation, b.translation);
    EXPECT_EQ(read.maps[0].keyframes[i].calibration_matrix, atlas.maps[0].keyframes[i].calibration_matrix);
  }
  EXPECT_EQ(read.maps[0].points[0].position, atlas.maps[0].points[0].position);
}

// A member that a fork widened is read, edited and written in its own width.
TEST(ForkConversions, NumbersOfAnotherWidth) {
  const std::string layout = Changed(
      R"({"class": "MapPoint", "replace": ["nObs", "mWorldPos"], "add": [["nObs", "i64"], ["mWorldPos", "arr<f64,3>"]]})");
  Atlas atlas = SynthesizeAtlas({.keyframes = 3, .points = 5, .features = 20, .threads = 1});
  Atlas read = InLayout(atlas, layout);
  EXPECT_EQ(read.maps[0].points[3].observation_count, atlas.maps[0].points[3].observation_count);
  EXPECT_EQ(read.maps[0].points[3].position, atlas.maps[0].points[3].position);
  read.maps[0].points[3].position.x() = 42;
  EXPECT_EQ(ReadFork(EncodeOrbslam3(read), layout).maps[0].points[3].position.x(), 42);
}

// Observations that do not stand side by side are the model's all the same.
TEST(ForkConversions, ObservationsApart) {
  const std::string layout =
      Changed(R"({"class": "MapPoint", "after": "mBackupObservationsId1", "add": [["between", "i32"]]})");
  Atlas atlas = SmallWorld();
  atlas.maps[0].points[2].observations[0].left = Observation::kAbsent;
  atlas.maps[0].points[3].observations[0].right = Observation::kAbsent;
  Atlas read = InLayout(atlas, layout);
  for (std::size_t i = 0; i < atlas.maps[0].points.size(); ++i)
    EXPECT_EQ(read.maps[0].points[i].observations, atlas.maps[0].points[i].observations) << i;
  read.maps[0].points[4].observations.pop_back();
  EXPECT_EQ(ReadFork(EncodeOrbslam3(read), layout).maps[0].points[4].observations, read.maps[0].points[4].observations);
}

// A member that stands there twice: the first is the model's, the second travels.
TEST(ForkEngine, MembersMayStandThereTwice) {
  const std::string layout = Changed(R"({"class": "MapPoint", "after": "nObs", "add": [["nObs", "i32"]]})");
  const std::string bytes = WriteFork(SmallWorld(), layout);
  const Atlas read = ReadFork(bytes, layout);
  EXPECT_EQ(read.maps[0].points[0].carried->members.size(), 4U);
  EXPECT_TRUE(EncodeOrbslam3(read) == bytes);
}

TEST(ForkEngine, ReadsPartsAsTheOptionsSay) {
  const std::string bytes = WriteFork(SmallWorld(), "gnss");
  ReadOptions options;
  options.features = FeatureColumns::kNone;
  options.selection.map = MapId(1);
  Notices notices;
  const Atlas read = ReadOrbslam3({std::as_bytes(std::span(bytes)), "fork.osa"}, options, notices);
  EXPECT_EQ(read.layout, "gnss");
  ASSERT_EQ(read.maps.size(), 1U);
  EXPECT_TRUE(read.maps[0].keyframes[0].features.descriptors.empty());
}

}  // namespace
}  // namespace slamdb
