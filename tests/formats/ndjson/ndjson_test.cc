// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ndjson/detail/ndjson.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "slamdb/formats/export/options.h"
#include "slamdb/formats/ndjson/json.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"

namespace slamdb {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;

std::vector<std::string> Lines(const Atlas& atlas, const WriteOptions& options = {}) {
  std::istringstream text(Encoded(detail::kNdjsonFormat, atlas, options));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

TEST(Ndjson, WritesOneObjectPerLineInOrder) {
  std::vector<std::string> kinds;
  for (const std::string& line : Lines(SmallAtlas())) {
    const json object = json::parse(line);
    const bool entity = object["type"] == "keyframe" || object["type"] == "map_point";
    kinds.push_back(object["type"].get<std::string>() + (entity ? " in map " + object["map"].dump() : ""));
  }
  EXPECT_THAT(
      kinds, ElementsAre("atlas", "camera", "map", "keyframe in map 0", "keyframe in map 0", "map_point in map 0",
                         "map_point in map 0", "map_point in map 0", "map", "keyframe in map 1", "map_point in map 1"));
}

TEST(Ndjson, WritesTheSmallEntitiesByteForByte) {
  const std::vector<std::string> lines = Lines(OneMapAtlas());
  EXPECT_EQ(lines[0],
            R"({"type":"atlas","vocabulary":{"name":"ORBvoc.txt","checksum":"0123456789abcdef0123456789abcdef"},)"
            R"("maps":[0],"repeated_maps":[],"cameras":[0],"repeated_cameras":[],)"
            R"("next_ids":{"map":1,"frame":80,"keyframe":8,"map_point":21,"camera":1,"initial_keyframe":4},)"
            R"("encoding":{"text":false,"boost_version":12,"long_bytes":8,"size_bytes":8}})");
  EXPECT_EQ(lines[1], R"({"type":"camera","id":0,"model":"pinhole","recorded_type":0,)"
                      R"("parameters":[100,100,64,48],"precision":1e-06})");
  EXPECT_EQ(lines[2], R"({"type":"map","id":0,"initial_keyframe":1,"max_keyframe_id":3,"big_change_index":0,)"
                      R"("keyframe_count":2,"point_count":3,"repeated_keyframes":[],"repeated_points":[],"origins":[],)"
                      R"("first_keyframe":1,"lowest_keyframe":1,"imu_initialized":false,"inertial":false,)"
                      R"("imu_ba1":false,"imu_ba2":false})");
  EXPECT_EQ(lines[5], R"({"type":"map_point","map":0,"id":10,"first_keyframe":0,"first_frame":0,)"
                      R"("observation_count":2,"position":[0,0,2],"normal":[0,0,1],)"
                      R"("observations":[{"keyframe":1,"left":0,"right":-1},{"keyframe":3,"left":0,"right":-1}],)"
                      R"("descriptor":"0000000000000000000000000000000000000000000000000000000000000000",)"
                      R"("descriptor_form":"usual","bad":false,"reference":1,"replaced_by":null,)"
                      R"("min_distance":0.5,"max_distance":4})");
}

TEST(Ndjson, WritesLandmarksBehindThePoints) {
  const std::vector<std::string> lines = Lines(LandmarkAtlas());
  EXPECT_EQ(lines[8], R"({"type":"landmark","map":0,"id":10,"mean":[0,0,2],"normal":[0,0,1],"cov_11":0.25,)"
                      R"("cov_22":0.25,"cov_33":0.5,"cov_12":0,"cov_13":0,"cov_23":0,)"
                      R"("last_seen":116444736015000000,"seen_count":2,"features":[{"type":"orb","x":17,"y":52,)"
                      R"("keypoint_id":18446744073709551615,"track_status":0,"response":0,"orientation":0,"octave":0,)"
                      R"("user_flags":0,"depth":0,"initial_depth":0,"position_in_camera":[0,0,0],"patch_size":21,)"
                      R"("spin_image_rows":0,"polar_images_without_rotation":false,"descriptors":{"orb":"010203"}}]})");
  EXPECT_EQ(json::parse(lines[9])["id"], nullptr);
}

TEST(Ndjson, WritesFeatureColumns) {
  const json keyframe = json::parse(Lines(OneMapAtlas())[3]);
  const json& features = keyframe["features"];
  EXPECT_EQ(keyframe["id"], 3);
  EXPECT_EQ(keyframe["timestamp"], 1.5);
  EXPECT_EQ(keyframe["camera_from_world"], json::parse(R"({"rotation_xyzw":[0,0,0,1],"translation":[-1,0,0]})"));
  EXPECT_EQ(features["keypoints"]["x"], json::parse("[17]"));
  EXPECT_EQ(features["undistorted"]["octave"], json::parse("[1]"));
  EXPECT_EQ(features["descriptors"][0], "03ab" + std::string(60, '0'));
  EXPECT_EQ(features["map_points"], json::parse("[10]"));
  EXPECT_EQ(keyframe["connections"], json::parse(R"([{"keyframe":1,"weight":1}])"));
  EXPECT_TRUE(keyframe["right_camera"].is_null());
}

TEST(Ndjson, LeavesOutWhatOfAPointIsNotRecorded) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].points[0].origin_map = 0;
  atlas.maps[0].points[0].found_count = 3;
  const std::string line = Lines(atlas)[5];
  EXPECT_THAT(line, ::testing::EndsWith(R"("max_distance":4,"origin_map":0,"found_count":3})"));
}

TEST(Ndjson, KeepsWhatJsonHasNoWordFor) {
  Atlas atlas = OneMapAtlas();
  MapPoint& point = atlas.maps[0].points[0];
  point.position = {std::nanf(""), HUGE_VALF, -HUGE_VALF};
  point.id = MapPointId(18446744073709551614U);
  point.first_keyframe = -1;
  point.bad.recorded = 7;
  point.observations[0].right = Observation::kAbsent;
  const json object = json::parse(Lines(atlas)[5]);
  EXPECT_EQ(object["position"], json::parse(R"(["NaN","Infinity","-Infinity"])"));
  EXPECT_EQ(object["id"].get<std::uint64_t>(), 18446744073709551614U);
  EXPECT_EQ(object["first_keyframe"], -1);
  EXPECT_EQ(object["bad"], 7);
  EXPECT_EQ(object["observations"][0], json::parse(R"({"keyframe":1,"left":0})"));
}

TEST(Ndjson, EscapesNames) {
  Atlas atlas;
  atlas.vocabulary.name = "a\"b\\c\n\xc3\xa4\xff";  // the last byte is not UTF-8
  const json object = json::parse(Lines(atlas)[0]);
  EXPECT_EQ(object["vocabulary"]["name"], "a\"b\\c\n\xc3\xa4\xc3\xbf");
}

TEST(Ndjson, ReadsBackToTheSameFloats) {
  Atlas atlas = OneMapAtlas();
  MapPoint& point = atlas.maps[0].points[0];
  point.position = {0.1F, std::numeric_limits<float>::denorm_min(), -std::numeric_limits<float>::max()};
  const json object = json::parse(Lines(atlas)[5]);
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(object["position"][axis].get<float>(), point.position[axis]);
}

TEST(Ndjson, WritesDistortionAsNumbersOrBytes) {
  Atlas atlas = OneMapAtlas();
  Matrix& distortion = atlas.maps[0].keyframes[0].distortion;
  distortion = {.rows = 1, .columns = 1, .type = 5, .continuous = true, .data = Column<std::byte>(4)};
  const float value = -0.25F;
  std::memcpy(distortion.data.data(), &value, sizeof value);
  EXPECT_EQ(json::parse(Lines(atlas)[3])["distortion"],
            json::parse(R"({"rows":1,"columns":1,"type":5,"continuous":true,"values":[-0.25]})"));
  distortion.type = 6;
  EXPECT_EQ(json::parse(Lines(atlas)[3])["distortion"]["bytes"], "000080be");
}

TEST(Ndjson, NamesRepeatedEntries) {
  Atlas atlas = OneMapAtlas();
  atlas.repeated_maps = {{.position = 1, .owner_map = 0, .row = 0}, {.position = 2}};
  EXPECT_EQ(json::parse(Lines(atlas)[0])["repeated_maps"],
            json::parse(R"([{"position":1,"owner_map":0,"row":0},{"position":2}])"));
}

TEST(Ndjson, WritesOneMap) {
  const std::vector<std::string> lines = Lines(SmallAtlas(), WriteOptions{}.With(ExportOptions{.map = MapId(1)}));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(json::parse(lines[2])["id"], 1);
}

TEST(Ndjson, TellsProgressFromZeroToOne) {
  std::vector<double> fractions;
  WriteOptions options;
  options.progress = [&](std::string_view, double fraction) { fractions.push_back(fraction); };
  Lines(SmallAtlas(), options);
  ASSERT_FALSE(fractions.empty());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_DOUBLE_EQ(fractions.back(), 1);
}

TEST(ToJson, IsTheLineWithoutItsMap) {
  const Atlas atlas = InertialAtlas();
  const std::vector<std::string> lines = Lines(atlas);
  json line = json::parse(lines[3]);
  line.erase("map");
  EXPECT_EQ(json::parse(ToJson(atlas.maps[0].keyframes[0])), line);
  EXPECT_EQ(ToJson(atlas, -1), lines[0]);
  EXPECT_EQ(ToJson(atlas.cameras[0], -1), lines[1]);
  EXPECT_EQ(ToJson(atlas.maps[0], -1), lines[2]);
}

TEST(ToJson, IndentsObjectsAndKeepsNumbersTogether) {
  MapPoint point = OneMapAtlas().maps[0].points[0];
  point.observations.resize(1);
  EXPECT_EQ(ToJson(point, 2),
            "{\n"
            "  \"type\": \"map_point\",\n"
            "  \"id\": 10,\n"
            "  \"first_keyframe\": 0,\n"
            "  \"first_frame\": 0,\n"
            "  \"observation_count\": 2,\n"
            "  \"position\": [0, 0, 2],\n"
            "  \"normal\": [0, 0, 1],\n"
            "  \"observations\": [\n"
            "    {\n"
            "      \"keyframe\": 1,\n"
            "      \"left\": 0,\n"
            "      \"right\": -1\n"
            "    }\n"
            "  ],\n"
            "  \"descriptor\": \"0000000000000000000000000000000000000000000000000000000000000000\",\n"
            "  \"descriptor_form\": \"usual\",\n"
            "  \"bad\": false,\n"
            "  \"reference\": 1,\n"
            "  \"replaced_by\": null,\n"
            "  \"min_distance\": 0.5,\n"
            "  \"max_distance\": 4\n"
            "}");
}

TEST(ToJson, SurvivesBracketsInStrings) {
  Atlas atlas;
  atlas.vocabulary.name = R"(a\"]}{[,:)";
  const std::string text = ToJson(atlas, 4);
  EXPECT_EQ(json::parse(text)["vocabulary"]["name"], atlas.vocabulary.name);
  EXPECT_EQ(json::parse(text), json::parse(ToJson(atlas, -1)));
}

}  // namespace
}  // namespace slamdb
