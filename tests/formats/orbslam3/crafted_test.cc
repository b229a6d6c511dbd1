// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slamdb/base/detail/hash.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/formats/orbslam3/crafted_atlases.h"
#include "tests/formats/orbslam3/real_atlases.h"

// Archives that this machine's Boost cannot make, crafted from the description of the format.
namespace slamdb {
namespace {

using ::testing::Combine;
using ::testing::HasSubstr;
using ::testing::Values;

std::string Md5Of(const std::string& bytes) { return detail::Md5(std::as_bytes(std::span(bytes))); }

Atlas ReadBytes(const std::string& bytes, Notices& notices) {
  return ReadOrbslam3({std::as_bytes(std::span(bytes)), "crafted.osa"}, {}, notices);
}

// The generator itself, against the same atlas saved by Boost 1.74 from ORB-SLAM3's own classes.
TEST(Crafted, TinyAtlasIsTheGoldenFile) {
  EXPECT_EQ(Md5Of(CraftTinyAtlas({}).bytes), kTinyMd5);
  EXPECT_EQ(Md5Of(CraftTinyAtlas({.text = true}).bytes), kTinyTextMd5);
}

// Sizes of long and size_t: 64-bit Unix, 64-bit Windows, 32-bit.
struct Machine {
  const char* name;
  int long_bytes, size_bytes;
};
void PrintTo(const Machine& machine, std::ostream* stream) { *stream << machine.name; }

class EveryWriter : public ::testing::TestWithParam<std::tuple<bool, int, Machine>> {
 protected:
  static Craft GetCraft() {
    const auto& [text, version, machine] = GetParam();
    return {text, version, machine.long_bytes, machine.size_bytes};
  }
};

TEST_P(EveryWriter, TinyAtlasKeepsEveryByte) {
  const std::string bytes = CraftTinyAtlas(GetCraft()).bytes;
  Notices notices;
  const Atlas atlas = ReadBytes(bytes, notices);
  EXPECT_EQ(atlas.encoding.boost_version, static_cast<std::uint32_t>(GetCraft().version));
  EXPECT_EQ(atlas.maps.at(0).keyframes.at(1).camera_from_world.translation.x(), -0.1F);
  EXPECT_TRUE(EncodeOrbslam3(atlas) == bytes);
}

TEST_P(EveryWriter, OddAtlasKeepsEveryByte) {
  const std::string bytes = CraftOddAtlas(GetCraft()).bytes;
  Notices notices;
  const Atlas atlas = ReadBytes(bytes, notices);
  EXPECT_FALSE(atlas.maps.at(1).points.at(1).reference) << "all ones mean none in any width";
  EXPECT_TRUE(EncodeOrbslam3(atlas) == bytes);
}

TEST_P(EveryWriter, OnlyNewerThanKnownWarns) {
  Notices notices;
  ReadBytes(CraftTinyAtlas(GetCraft()).bytes, notices);
  if (GetCraft().version <= 20) {
    EXPECT_THAT(notices.items(), ::testing::IsEmpty());
  } else {
    ASSERT_EQ(notices.items().size(), 1U);
    EXPECT_EQ(notices.items()[0].kind, Notice::Kind::kWarning);
    EXPECT_THAT(notices.items()[0].text, HasSubstr("version 25, newest known is 20"));
  }
}

std::string NameOf(const ::testing::TestParamInfo<EveryWriter::ParamType>& test) {
  const auto& [text, version, machine] = test.param;
  return std::string(text ? "text_" : "binary_") + std::to_string(version) + "_" + machine.name;
}

constexpr Machine kUnix64{"unix64", 8, 8}, kWindows64{"windows64", 4, 8}, kBits32{"bits32", 4, 4};
const auto kVersions = Values(10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 25);

INSTANTIATE_TEST_SUITE_P(Binary, EveryWriter, Combine(Values(false), kVersions, Values(kUnix64, kWindows64, kBits32)),
                         NameOf);
INSTANTIATE_TEST_SUITE_P(Text, EveryWriter, Combine(Values(true), kVersions, Values(kUnix64)), NameOf);

// A text archive does not tell the width of its writer's long, which changes class ids; it is found by trying.
TEST(Crafted, TextOfFourByteLongsIsRead) {
  for (const Machine& machine : {kWindows64, kBits32}) {
    const Craft craft{true, 18, machine.long_bytes, machine.size_bytes};
    for (const std::string& bytes : {CraftTinyAtlas(craft).bytes, CraftOddAtlas(craft).bytes}) {
      Notices notices;
      EXPECT_TRUE(EncodeOrbslam3(ReadBytes(bytes, notices)) == bytes) << machine.name;
    }
  }
}

class OddAtlas : public ::testing::TestWithParam<bool> {
 protected:
  OddAtlas() : atlas_(ReadBytes(CraftOddAtlas({.text = GetParam()}).bytes, notices_)) {}
  Notices notices_;
  const Atlas atlas_;
};

TEST_P(OddAtlas, MapsAndTheirRepetition) {
  ASSERT_EQ(atlas_.maps.size(), 2U);
  EXPECT_TRUE(atlas_.maps[0].keyframes.empty());
  EXPECT_FALSE(atlas_.maps[0].first_keyframe);
  EXPECT_EQ(atlas_.maps[1].id, MapId(1));
  EXPECT_EQ(atlas_.maps[1].origins, std::vector{KeyFrameId(3)});
  EXPECT_TRUE(atlas_.maps[1].imu_ba2);
  EXPECT_THAT(atlas_.repeated_maps, ::testing::ElementsAre(RepeatedEntry{2, 0, 1}));
}

TEST_P(OddAtlas, KeyframesAroundTheNullPointer) {
  const Map& map = atlas_.maps.at(1);
  ASSERT_EQ(map.keyframes.size(), 2U);
  EXPECT_EQ(map.keyframes[0].id, KeyFrameId(3));
  EXPECT_EQ(map.keyframes[0].preintegration.measurements.size(), 2U);
  EXPECT_TRUE(map.keyframes[0].features.bag_of_words.words.empty());
  EXPECT_EQ(map.keyframes[0].connections[1], (Connection{KeyFrameId(77), 1}));
  EXPECT_EQ(map.keyframes[1].id, KeyFrameId(4));
  ASSERT_EQ(map.repeated_keyframes.size(), 1U);
  EXPECT_EQ(map.repeated_keyframes[0].position, 1U);
  EXPECT_EQ(map.repeated_keyframes[0].owner_map, RepeatedEntry::kNull);
}

TEST_P(OddAtlas, FisheyeStereoColumns) {
  const Features& features = atlas_.maps.at(1).keyframes.at(1).features;
  EXPECT_EQ(features.count, 3);
  EXPECT_EQ(features.left_count, 2);
  EXPECT_EQ(features.right_count, 1);
  EXPECT_EQ(features.keypoints.size(), 2U);
  EXPECT_EQ(features.right_keypoints.size(), 1U);
  EXPECT_EQ(features.descriptors.size(), 3U);
  EXPECT_EQ(features.descriptors[2][0], 0x40 + 2 * 16);
  EXPECT_EQ(features.right_grid.keypoints.size(), 1U);
  EXPECT_EQ(features.left_of_right.size(), 1U);
  EXPECT_EQ(features.map_points[2], MapPointId(8));
}

TEST_P(OddAtlas, PointsAndTheirRepetition) {
  const Map& map = atlas_.maps.at(1);
  ASSERT_EQ(map.points.size(), 2U);
  EXPECT_EQ(map.points[0].observations[1], (Observation{KeyFrameId(4), 0, 2}));
  EXPECT_FALSE(map.points[1].has_descriptor());
  EXPECT_FALSE(map.points[1].reference);
  EXPECT_EQ(map.points[1].replaced_by, MapPointId(8));
  EXPECT_THAT(map.repeated_points, ::testing::ElementsAre(RepeatedEntry{2, 1, 0}));
}

TEST_P(OddAtlas, Cameras) {
  ASSERT_EQ(atlas_.cameras.size(), 2U);
  EXPECT_EQ(atlas_.cameras[0].model, CameraModel::kKannalaBrandt8);
  EXPECT_EQ(atlas_.cameras[0].parameters.size(), 8U);
  EXPECT_EQ(atlas_.cameras[1].model, CameraModel::kPinhole);
  EXPECT_EQ(atlas_.cameras[1].id, CameraId(0));
  EXPECT_EQ(atlas_.next_ids, (Counters{2, 42, 5, 10, 2, 5}));
}

INSTANTIATE_TEST_SUITE_P(Encodings, OddAtlas, Values(false, true),
                         [](const auto& test) { return test.param ? "text" : "binary"; });

}  // namespace
}  // namespace slamdb
