// SPDX-License-Identifier: BSD-3-Clause
// Whole atlases between stock archives and slamdb. The worlds and crafted atlases of
// formats/orbslam3/boost_reference_test.cc are the other half of this.
#include "slamdb/boost.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/boost/archives.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using testing::Binary;
using testing::Load;
using testing::Loaded;
using testing::Saved;
using testing::Text;

Atlas Read(const std::string& path) {
  Notices notices;
  return ReadOrbslam3(path, {}, notices);
}

Atlas MakeAtlas(std::uint64_t seed) {
  return SynthesizeAtlas({.sensor = Sensor::kStereo,
                          .inertial = true,
                          .maps = 2,
                          .keyframes = 3,
                          .points = 50,
                          .features = 60,
                          .seed = seed,
                          .threads = 1});
}

// What slamdb writes of it in that kind, as the Boost of this program would.
template <class Kind>
std::string Encoded(Atlas atlas) {
  atlas.encoding = {.text = Kind::kText, .boost_version = testing::BoostVersion()};
  return EncodeOrbslam3(atlas);
}

class BoostRealFile : public ::testing::TestWithParam<const char*> {};

TEST_P(BoostRealFile, IsTheSameAtlasToBoostAndToSlamdb) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Atlas expected = Read(path);
  // Stock Boost reads no nan in text, which the text file has.
  const auto loaded = Loaded<Atlas, Binary>(expected.encoding.text ? Encoded<Binary>(expected) : ReadWhole(path));
  expected.encoding = {};
  EXPECT_EQ(FirstDifference(loaded, expected), "");
  EXPECT_TRUE(Saved<Binary>(loaded) == Encoded<Binary>(expected));
}

// In text as far as stock Boost can: without the nan and inf of uninitialised members.
TEST_P(BoostRealFile, IsTheSameTextToBoostAndToSlamdb) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Atlas expected = Read(path);
  for (Map& map : expected.maps) {
    for (KeyFrame& keyframe : map.keyframes) {
      keyframe.merge_scale = 0;
      keyframe.preintegration = {};
      keyframe.body_position.setZero();
      keyframe.imu_calibration.noise.setZero();
      keyframe.imu_calibration.walk_noise.setZero();
    }
  }
  const std::string text = Encoded<Text>(expected);
  const auto loaded = Loaded<Atlas, Text>(text);
  expected.encoding = {};
  EXPECT_EQ(FirstDifference(loaded, expected), "");
  EXPECT_TRUE(Saved<Text>(loaded) == text);
}

INSTANTIATE_TEST_SUITE_P(OrbSlam3, BoostRealFile, ::testing::ValuesIn(kRealAtlases),
                         [](const auto& test) { return std::string(test.param); });

template <class Kind>
class BoostAtlas : public ::testing::Test {};
TYPED_TEST_SUITE(BoostAtlas, testing::Kinds);

// An archive may hold several atlases, in one place of memory or many, and a program's own members around them.
TYPED_TEST(BoostAtlas, SeveralInOneArchive) {
  std::ostringstream stream;
  {
    typename TypeParam::Output archive(stream);
    for (const std::uint64_t seed : {1, 2, 3}) {
      const int number = static_cast<int>(seed) * 11;
      const Atlas atlas = MakeAtlas(seed);
      archive << number << atlas << atlas.maps[1].points[3];
    }
  }
  std::istringstream input(stream.str());
  typename TypeParam::Input archive(input);
  for (const std::uint64_t seed : {1, 2, 3}) {
    int number = 0;
    Atlas atlas;
    MapPoint point;
    archive >> number >> atlas >> point;
    EXPECT_EQ(number, static_cast<int>(seed) * 11);
    Atlas expected = MakeAtlas(seed);
    expected.encoding = {};
    EXPECT_EQ(FirstDifference(atlas, expected), "");
    EXPECT_EQ(point.position, expected.maps[1].points[3].position);
  }
}

TYPED_TEST(BoostAtlas, LoadingReplacesAllButTheEncoding) {
  Atlas expected = MakeAtlas(4), atlas = MakeAtlas(5);
  atlas.encoding.boost_version = 14;
  atlas.maps[0].landmarks.emplace_back();
  Load<TypeParam>(Saved<TypeParam>(expected), atlas);
  expected.encoding = {.boost_version = 14};
  EXPECT_EQ(FirstDifference(atlas, expected), "");
}

TYPED_TEST(BoostAtlas, StaysAsItWasWhenLoadingFails) {
  const std::string bytes = Saved<TypeParam>(MakeAtlas(4));
  const Atlas expected = MakeAtlas(5);
  Atlas atlas = expected;
  EXPECT_THROW(Load<TypeParam>(bytes.substr(0, bytes.size() / 2), atlas), boost::archive::archive_exception);
  EXPECT_EQ(FirstDifference(atlas, expected), "");
}

// Maps, keyframes of other maps, points and cameras that are listed again, and null pointers.
TYPED_TEST(BoostAtlas, IrregularEntriesAreThePointersOfTheFile) {
  Atlas expected = MakeAtlas(6);
  expected.cameras.push_back(expected.cameras[0]);
  expected.cameras[1].model = CameraModel::kKannalaBrandt8;
  expected.repeated_maps = {{.position = 1, .owner_map = 0, .row = 0}, {.position = 3}};
  expected.repeated_cameras = {{.position = 0}, {.position = 3, .owner_map = 0, .row = 1}};
  expected.maps[0].repeated_points = {{.position = 4}, {.position = 9, .owner_map = 0, .row = 6}};
  expected.maps[1].repeated_keyframes = {{.position = 0, .owner_map = 0, .row = 2},
                                         {.position = 4, .owner_map = 1, .row = 1}};
  const std::string bytes = Encoded<TypeParam>(expected);
  expected.encoding = {};
  const auto loaded = Loaded<Atlas, TypeParam>(bytes);
  EXPECT_EQ(FirstDifference(loaded, expected), "");
  EXPECT_TRUE(Saved<TypeParam>(expected) == bytes);
}

// Relations that a std::map would sort or thin out, and observations that one image's map lacks.
TYPED_TEST(BoostAtlas, UnsoundRelationsAreKept) {
  Atlas expected = MakeAtlas(7);
  KeyFrame& keyframe = expected.maps[0].keyframes[1];
  keyframe.connections = {{KeyFrameId(9), 1}, {KeyFrameId(2), 5}, {KeyFrameId(2), 6}};
  std::swap(keyframe.features.bag_of_words.words[0], keyframe.features.bag_of_words.words[1]);
  expected.maps[0].points[0].observations = {
      {KeyFrameId(1), 3, Observation::kAbsent}, {KeyFrameId(2), Observation::kAbsent, 4}, {KeyFrameId(5), 6, 7}};
  const std::string bytes = Encoded<TypeParam>(expected);
  expected.encoding = {};
  EXPECT_TRUE(Saved<TypeParam>(expected) == bytes);
  EXPECT_EQ(FirstDifference(Loaded<Atlas, TypeParam>(bytes), expected), "");
}

TYPED_TEST(BoostAtlas, AnEmptyOneIsAFile) {
  const Atlas empty;
  const std::string bytes = Saved<TypeParam>(empty);
  EXPECT_TRUE(bytes == Encoded<TypeParam>(empty));
  EXPECT_EQ(FirstDifference(Loaded<Atlas, TypeParam>(bytes), empty), "");
}

}  // namespace
}  // namespace slamdb
