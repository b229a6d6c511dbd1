// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/gltf/detail/gltf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"

namespace slamdb {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

template <class Number>
Number At(std::string_view bytes, std::size_t place) {
  Number number{};
  std::memcpy(&number, bytes.data() + place, sizeof number);
  return number;
}

struct Scene {
  json document;
  std::string binary;

  const json& Node(const std::string& name) const {
    for (const json& node : document.at("nodes"))
      if (node.at("name") == name) return node;
    throw std::runtime_error("no node " + name);
  }
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    if (document.contains("nodes"))
      for (const json& node : document.at("nodes")) names.push_back(node.at("name"));
    return names;
  }
};

Scene Written(const Atlas& atlas, Notices& notices) {
  const std::string bytes = Encoded(detail::kGltfFormat, atlas, {}, notices);
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(At<std::uint32_t>(bytes, 4), 2U);
  EXPECT_EQ(At<std::uint32_t>(bytes, 8), bytes.size());
  const auto length = At<std::uint32_t>(bytes, 12);
  EXPECT_EQ(length % 4, 0U);
  Scene scene{json::parse(bytes.substr(20, length)), {}};
  if (bytes.size() > 20 + length) {
    EXPECT_EQ(At<std::uint32_t>(bytes, 20 + length), bytes.size() - length - 28);
    scene.binary = bytes.substr(28 + length);
    EXPECT_EQ(scene.document["buffers"][0]["byteLength"], scene.binary.size());
  }
  return scene;
}

Scene Written(const Atlas& atlas) {
  Notices ignored;
  return Written(atlas, ignored);
}

TEST(Gltf, HasANodeForEachMapAndKeyFrame) {
  const Scene scene = Written(SmallAtlas());
  EXPECT_THAT(scene.Names(), ElementsAre("map 0 points", "map 0 trajectory", "kf 1", "kf 3", "map 0 keyframes", "map 0",
                                         "map 1 points", "kf 7", "map 1 keyframes", "map 1"));
  EXPECT_EQ(scene.document["scenes"], json::parse(R"([{"name":"atlas","nodes":[5,9]}])"));
  EXPECT_EQ(scene.Node("map 0")["children"], json({0, 1, 4}));
  EXPECT_EQ(scene.Node("map 0")["extras"], json({{"map", 0}}));
  const json& keyframe = scene.Node("kf 3");
  EXPECT_EQ(keyframe["translation"], json({1, 0, 0}));
  EXPECT_EQ(keyframe["rotation"], json({0, 0, 0, 1}));
  EXPECT_EQ(keyframe["extras"], json({{"keyframe", 3}, {"timestamp", 1.5}}));
  EXPECT_EQ(keyframe["mesh"], scene.Node("kf 1")["mesh"]) << "cameras that are alike share what they look like";
}

TEST(Gltf, UpIsY) {
  Atlas atlas = OneMapAtlas();
  EXPECT_NEAR(std::abs(Written(atlas).Node("map 0")["rotation"][0].get<double>()), 1, 1e-6) << "from y down";
  for (KeyFrame& keyframe : atlas.maps[0].keyframes)  // z up: the camera looks along x
    keyframe.camera_from_world.rotation = Quaternionf(0.5F, 0.5F, -0.5F, 0.5F);
  const json rotation = Written(atlas).Node("map 0")["rotation"];
  EXPECT_NEAR(rotation[0], -0.70710678, 1e-6);
  EXPECT_NEAR(rotation[3], 0.70710678, 1e-6);
}

// Position, normal, colour, id, observations, error of the first of two points.
TEST(Gltf, WritesPoints) {
  const Scene scene = Written(OneMapAtlas());
  const json& accessor = scene.document["accessors"][0];
  EXPECT_EQ(accessor["count"], 2);
  EXPECT_EQ(accessor["min"][1], -1.5);
  EXPECT_EQ(accessor["min"][2], static_cast<double>(1e-5F)) << "as exact as the float";
  EXPECT_EQ(accessor["max"], json({0.25, 0, 2}));
  EXPECT_EQ(At<float>(scene.binary, 8), 2.F);
  EXPECT_EQ(At<float>(scene.binary, 20), -1.F) << "to the camera, which ORB-SLAM3's looks away from";
  // sRGB 63 is 0.04970657 of 65535, opaque.
  EXPECT_EQ(At<std::uint16_t>(scene.binary, 24), 3258);
  EXPECT_EQ(At<std::uint16_t>(scene.binary, 30), 65535);
  EXPECT_EQ(At<std::uint64_t>(scene.binary, 32), 10U);
  EXPECT_EQ(At<float>(scene.binary, 40), 2.F);
  EXPECT_EQ(At<float>(scene.binary, 44), 2.5F);
  EXPECT_EQ(At<float>(scene.binary, 48 + 44), -1.F) << "none";
  EXPECT_EQ(scene.document["meshes"][0]["primitives"][0]["mode"], 0);
}

TEST(Gltf, HasNoNumberThatIsNone) {
  Atlas atlas = OneMapAtlas();
  Map& map = atlas.maps[0];
  map.points[0].position.x() = kNaN;
  map.points[2].normal = Eigen::Vector3f(kNaN, 0, 0);
  map.keyframes[0].camera_from_world.translation.y() = std::numeric_limits<float>::infinity();
  Notices notices;
  const Scene scene = Written(atlas, notices);
  EXPECT_EQ(scene.document["accessors"][0]["count"], 1);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(At<float>(scene.binary, 12 + 4 * i), i == 1 ? -1.F : 0.F) << "up";
  EXPECT_THAT(scene.Names(), ElementsAre("map 0 points", "kf 1", "map 0 keyframes", "map 0"));
  ASSERT_EQ(notices.items().size(), 2U);
  EXPECT_THAT(notices.items()[1].text, HasSubstr("position is not finite: 1 point"));
}

TEST(Gltf, HasNothingOfAnEmptyAtlas) {
  EXPECT_EQ(Written({}).document,
            json::parse(R"({"asset":{"version":"2.0","generator":"slamdb"},"scene":0,"scenes":[{"name":"atlas"}]})"));
  Atlas atlas;
  atlas.maps.resize(1);
  const Scene scene = Written(atlas);
  EXPECT_THAT(scene.Names(), ElementsAre("map none"));
  EXPECT_EQ(scene.binary, "");
}

TEST(Gltf, LargeIdsAreText) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].keyframes[0].id = KeyFrameId((std::uint64_t{1} << 53) + 1);
  atlas.maps[0].points[0].id = MapPointId(~std::uint64_t{1});
  const Scene scene = Written(atlas);
  EXPECT_EQ(scene.Node("kf 9007199254740993")["extras"]["keyframe"], "9007199254740993");
  EXPECT_EQ(At<std::uint64_t>(scene.binary, 32), ~std::uint64_t{1});
}

// Where a trajectory would lose a millimetre, a picture does not.
TEST(Gltf, RoundingIsNoLoss) {
  Atlas atlas = OneMapAtlas();
  KeyFrame& keyframe = atlas.maps[0].keyframes[0];
  keyframe.camera_from_world = {Quaternionf(0.5F, 0.1F, 0.7F, 0.3F), Eigen::Vector3f(54321.1F, 6543.21F, 765.4321F)};
  Notices notices;
  Written(atlas, notices);
  EXPECT_FALSE(notices.lossy());
}

// Distances beyond what a float holds, twice the same keyframe, all at one place.
TEST(Gltf, CamerasAreFinite) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].keyframes[0].camera_from_world.translation.x() = 3e38F;
  for (const json& accessor : Written(atlas).document["accessors"])
    if (accessor.contains("max")) {
      EXPECT_TRUE(accessor["max"][0].is_number());
    }
  atlas.maps[0].keyframes[0] = atlas.maps[0].keyframes[1];
  const Scene scene = Written(atlas);
  EXPECT_EQ(scene.document["accessors"].back()["max"][2], static_cast<double>(0.1F)) << "of its depth";
}

}  // namespace
}  // namespace slamdb
