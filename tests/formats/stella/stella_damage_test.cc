// SPDX-License-Identifier: BSD-3-Clause
// One test for each kind of bytes that are no map.
#include <gmock/gmock.h>

#include <limits>

#include "slamdb/formats/formats.h"
#include "tests/formats/stella/stored_map.h"
#include "tests/support/error_of.h"

namespace slamdb {
namespace {

using std::string_literals::operator""s;
using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Error ErrorOfBytes(const std::string& bytes) {
  return ErrorOf([&] {
    Notices ignored;
    ReadStella(bytes, ignored);
  });
}
Error ErrorOfMap(const json& map) { return ErrorOfBytes(Packed(map)); }

TEST(StellaDamage, EveryCutIsAnError) {
  const std::string bytes = Packed(SmallStellaMap());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Error error = ErrorOfBytes(bytes.substr(0, size));
    ASSERT_EQ(error.kind(), ErrorKind::kDamaged) << size;
  }
  EXPECT_THAT(ErrorOfBytes(bytes + "x").problem(), HasSubstr("1 bytes stand behind it"));
}

TEST(StellaDamage, CountsThatTheFileCannotHoldTakeNoMemory) {
  EXPECT_THAT(ErrorOfBytes("\xdf\xff\xff\xff\xff"s).problem(), HasSubstr("claims 4294967295 entries"));
  std::string bytes = Packed(SmallStellaMap());
  const std::size_t at = bytes.find("lm_ids") + 6;
  bytes.replace(at, 1, "\xdd\xff\xff\xff\xf0"s);
  const Error error = ErrorOfBytes(bytes);
  EXPECT_THAT(error.problem(), HasSubstr("claims 4294967280 entries"));
  EXPECT_THAT(error.place(), HasSubstr("keyframe 12"));
}

// An unknown key holds lists in lists in lists, a million of them.
TEST(StellaDamage, DepthIsNoMatter) {
  const std::string deep = "\x81\xa1x"s + std::string(1'000'000, '\x91') + "\x01"s;
  EXPECT_THAT(ErrorOfBytes(deep).problem(), HasSubstr("holds no `keyframes`"));
}

TEST(StellaDamage, OtherTypesAreNamed) {
  json map = SmallStellaMap();
  map["keyframes"]["4"]["ts"] = "soon";
  EXPECT_THAT(ErrorOfMap(map).problem(), HasSubstr("expected a number, found a text"));
  map = SmallStellaMap();
  map["keyframes"]["4"]["span_parent"] = 0.5;
  EXPECT_THAT(ErrorOfMap(map).problem(), HasSubstr("expected an integer, found 0.5"));
  map = SmallStellaMap();
  map["keyframes"]["4"]["loop_edges"] = nullptr;
  EXPECT_THAT(ErrorOfMap(map).problem(), HasSubstr("expected a list, found nil"));
  map = SmallStellaMap();
  map["landmarks"] = 1;
  EXPECT_THAT(ErrorOfMap(map).problem(), HasSubstr("expected a map, found an integer"));
}

TEST(StellaDamage, IdsMustBeNumbersOf32Bits) {
  for (const char* id : {"", "four", "-1", "4294967296", "1 ", "0x1"}) {
    json map = SmallStellaMap();
    map["keyframes"][id] = map["keyframes"]["4"];
    EXPECT_THAT(ErrorOfMap(map).problem(), HasSubstr("the name of a keyframe is `" + std::string(id) + "`"));
  }
}

TEST(StellaDamage, LinksToIdsThatNothingHasAreTakenOut) {
  constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
  json map = SmallStellaMap();
  map["keyframes"]["12"]["span_parent"] = kLargest;
  map["keyframes"]["4"]["loop_edges"] = {kLargest, std::int64_t{1} << 40, -kLargest};
  map["keyframes"]["4"]["lm_ids"] = {7, kLargest, -kLargest};
  map["landmarks"]["7"]["ref_keyfrm"] = kLargest;
  map["landmarks"]["7"]["1st_keyfrm"] = kLargest;
  map["keyframe_next_id"] = kLargest;
  const Atlas atlas = ReadStella(map);
  EXPECT_TRUE(atlas.maps[0].keyframes[0].loop_edges.empty());
  EXPECT_EQ(atlas.maps[0].points[0].reference, KeyFrameId(4));
  EXPECT_NO_THROW(static_cast<void>(EncodeAtlas(atlas, {.format = "stella"})));
  map["keyframes"]["12"]["span_parent"] = std::uint64_t{1} << 63;
  EXPECT_THAT(ErrorOfMap(map).problem(), HasSubstr("an integer is 9223372036854775808"));
}

TEST(StellaDamage, ColumnsMustAgree) {
  for (const char* column : {"x_rights", "depths", "descs", "lm_ids"}) {
    json map = SmallStellaMap();
    json& list = map["keyframes"]["4"][column];
    list = map["keyframes"]["12"][column];
    if (list.empty()) list = {1, 2};
    const Error error = ErrorOfMap(map);
    EXPECT_THAT(error.problem(), HasSubstr("has 2 " + std::string(column) + " of 3 keypoints"));
    EXPECT_THAT(error.place(), HasSubstr("keyframe 4"));
  }
  json map = SmallStellaMap();
  map["keyframes"]["4"]["n_keypts"] = 4;
  EXPECT_THAT(ErrorOfMap(map).problem(), HasSubstr("has 4 n_keypts of 3 keypoints"));
}

TEST(StellaDamage, PosesDescriptorsAndPositionsHaveTheirNumbers) {
  json map = SmallStellaMap();
  map["keyframes"]["4"]["rot_cw"] = {1, 0, 0};
  EXPECT_THAT(ErrorOfMap(map).problem(), HasSubstr("rot_cw has 3 numbers, expected 4"));
  map = SmallStellaMap();
  map["keyframes"]["4"].erase("trans_cw");
  EXPECT_THAT(ErrorOfMap(map).problem(), HasSubstr("has no pose"));
  map = SmallStellaMap();
  map["keyframes"]["4"]["descs"][1].push_back(1);
  EXPECT_THAT(ErrorOfMap(map).problem(), HasSubstr("a descriptor has 9 words"));
  map = SmallStellaMap();
  map["landmarks"]["7"].erase("pos_w");
  const Error error = ErrorOfMap(map);
  EXPECT_THAT(error.problem(), HasSubstr("has no position"));
  EXPECT_THAT(error.place(), HasSubstr("landmark 7"));
}

TEST(StellaDamage, CamerasAndPyramidsMustBeKnown) {
  json map = SmallStellaMap();
  map["keyframes"]["4"]["cam"] = "other";
  EXPECT_THAT(ErrorOfMap(map).problem(), HasSubstr("names the camera `other`"));
  map = SmallStellaMap();
  map["cameras"]["lab"]["model_type"] = "Plenoptic";
  EXPECT_EQ(ErrorOfMap(map).kind(), ErrorKind::kUnsupported);
  map = SmallStellaMap();
  map["orb_params"]["fine"]["num_levels"] = 4'000'000'000;
  EXPECT_THAT(ErrorOfMap(map).problem(), HasSubstr("has 4000000000 levels"));
}

// Times and keypoints may be anything; poses, points and cameras may not.
TEST(StellaDamage, NumbersThatAreNoneAreRead) {
  json map = SmallStellaMap();
  map["keyframes"]["4"]["ts"] = kNan;
  map["keyframes"]["4"]["undist_keypts"][0]["pt"] = {1e300, -1e300};
  map["keyframes"]["12"]["undist_keypts"][0]["oct"] = 4'000'000'000;
  map["cameras"]["lab"]["k1"] = -1e10;
  Notices ignored;
  EXPECT_NO_THROW(ReadStella(Packed(map), ignored));
}

TEST(StellaDamage, NumbersThatNoPoseNorPointHasAreRefused) {
  const auto error_of = [](const char* list, const char* id, const char* key, const json& numbers) {
    json map = SmallStellaMap();
    map[list][id][key] = numbers;
    return ErrorOfMap(map);
  };
  const Error error = error_of("keyframes", "4", "rot_cw", {0, 0, 0, 0});
  EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
  EXPECT_THAT(error.problem(), HasSubstr("the quaternion 0 0 0 0 (x y z w) is no rotation; the file is damaged"));
  EXPECT_THAT(error.place(), HasSubstr("keyframe 4"));
  EXPECT_THAT(error_of("keyframes", "4", "rot_cw", {0, kNan, 0, 1}).problem(), HasSubstr("the quaternion 0 nan 0 1"));
  EXPECT_THAT(error_of("keyframes", "4", "trans_cw", {0, 1e39, 0}).problem(), HasSubstr("the position 0 1e+39 0"));
  EXPECT_THAT(error_of("landmarks", "7", "pos_w", {0, 1e39, 0}).problem(), HasSubstr("the position 0 1e+39 0"));
  EXPECT_THAT(error_of("landmarks", "7", "pos_w", {0, 1e39, 0}).place(), HasSubstr("landmark 7"));
}

TEST(StellaDamage, NumbersThatNoCameraHasAreRefused) {
  const auto error_of = [](const char* key, const json& number) {
    json map = SmallStellaMap();
    map["cameras"]["lab"][key] = number;
    return ErrorOfMap(map);
  };
  EXPECT_THAT(error_of("cols", 4'000'000'000).problem(), HasSubstr("images of 4000000000 x"));
  EXPECT_THAT(error_of("rows", 0).problem(), HasSubstr("pixels are impossible"));
  EXPECT_THAT(error_of("fx", 0).problem(), HasSubstr("the focal lengths 0 "));
  EXPECT_THAT(error_of("fy", kNan).problem(), HasSubstr("are not above 0, or not finite"));
  EXPECT_THAT(error_of("k1", -1e300).problem(), HasSubstr("are not all finite"));
  EXPECT_THAT(error_of("cx", kNan).place(), HasSubstr("camera `lab`"));
}

}  // namespace
}  // namespace slamdb
