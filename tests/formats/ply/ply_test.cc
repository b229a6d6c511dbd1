// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ply/detail/ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "slamdb/base/error.h"
#include "slamdb/formats/export/options.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const WriteOptions kAscii = WriteOptions{}.With(PointCloudOptions{.binary = false});

std::string Write(const Atlas& atlas, const WriteOptions& options, Notices& notices) {
  return Encoded(detail::kPlyFormat, atlas, options, notices);
}

constexpr std::string_view kHeaderEnd = "end_header\n";

TEST(Ply, WritesAscii) {
  Notices notices;
  EXPECT_EQ(Write(SmallAtlas(), kAscii, notices),
            "ply\n"
            "format ascii 1.0\n"
            "comment written by slamdb: map points\n"
            "element vertex 3\n"
            "property float x\nproperty float y\nproperty float z\n"
            "property float nx\nproperty float ny\nproperty float nz\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "property float min_distance\nproperty float max_distance\n"
            "property uint observations\nproperty float reprojection_error\n"
            "property uint map\nproperty uint id\n"
            "end_header\n"
            "0 0 2 0 0 1 63 144 218 0.5 4 2 2.5 0 10\n"
            "0.25 -1.5 1e-05 0 0 1 63 144 218 0.5 4 0 nan 0 12\n"
            "0 1 0 0 0 1 255 169 14 0.5 4 1 0 1 20\n");
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_THAT(notices.written(), HasSubstr(", 1 bad one left out"));
  EXPECT_EQ(notices.items()[0].kind, Notice::Kind::kWarning);
  EXPECT_THAT(notices.items()[0].text, HasSubstr("2 maps are in one file"));
}

TEST(Ply, WritesBinaryRowsWithoutPadding) {
  Notices notices;
  const std::string text = Write(OneMapAtlas(), {}, notices);
  EXPECT_THAT(text, HasSubstr("ply\nformat binary_little_endian 1.0\n"));
  const std::string rows = text.substr(text.find(kHeaderEnd) + kHeaderEnd.size());
  constexpr std::size_t kRow = 6 * 4 + 3 + 2 * 4 + 4 + 4 + 4 + 4;
  ASSERT_EQ(rows.size(), 2 * kRow);
  std::string expected;
  const auto add = [&expected](auto value) { expected.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const float value : {0.F, 0.F, 2.F, 0.F, 0.F, 1.F}) add(value);
  for (const std::uint8_t value : std::array<std::uint8_t, 3>{63, 144, 218}) add(value);
  add(0.5F), add(4.F), add(std::uint32_t{2}), add(2.5F), add(std::uint32_t{0}), add(std::uint32_t{10});
  EXPECT_EQ(rows.substr(0, kRow), expected);
}

TEST(Ply, WritesLargeIdsAsDoubles) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].points[0].id = MapPointId(std::uint64_t{1} << 40);
  Notices notices;
  const std::string text = Write(atlas, kAscii, notices);
  EXPECT_THAT(text, HasSubstr("property uint map\nproperty double id\n"));
  EXPECT_THAT(text, HasSubstr(" 2.5 0 1099511627776\n"));
  const std::string binary = Write(atlas, {}, notices);
  double id = 0;
  std::memcpy(&id, binary.data() + binary.find(kHeaderEnd) + kHeaderEnd.size() + 47, sizeof id);
  EXPECT_EQ(id, 1099511627776.0);
}

TEST(Ply, WritesOneMap) {
  Notices notices;
  const std::string text = Write(SmallAtlas(), kAscii.With(ExportOptions{.map = MapId(1)}), notices);
  EXPECT_THAT(text, HasSubstr("element vertex 1\n"));
  EXPECT_TRUE(notices.items().empty());
}

TEST(Ply, RefusesAMapThatIsNotThere) {
  Notices notices;
  try {
    Write(SmallAtlas(), WriteOptions{}.With(ExportOptions{.map = MapId(5)}), notices);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.problem(), "the atlas has no map 5; it has map 0, map 1");
  }
}

std::string Colored(Atlas atlas, PointColor by, Notices& notices) {
  return Write(atlas, WriteOptions{}.With(PointCloudOptions{.binary = false, .color = by}), notices);
}

// Of one map with two points that are written, 10 and 12: the lower value is violet, the higher yellow, none grey.
TEST(Ply, ColoursTellWhatWasAskedFor) {
  const std::string violet = " 68 1 84 0.5 4", yellow = " 253 231 37 0.5 4", grey = " 128 128 128 0.5 4";
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].points[0].first_keyframe = 3;
  atlas.maps[0].points[2].first_keyframe = 1;
  const auto expect = [&](PointColor by, const std::string& first, const std::string& second, const char* legend) {
    Notices notices;
    const std::string text = Colored(atlas, by, notices);
    EXPECT_THAT(text, HasSubstr("\n0 0 2 0 0 1" + first)) << legend;
    EXPECT_THAT(text, HasSubstr("\n0.25 -1.5 1e-05 0 0 1" + second)) << legend;
    EXPECT_THAT(text, HasSubstr("comment colours: " + std::string(legend) + "\n"));
    ASSERT_EQ(notices.items().size(), 1U);
    EXPECT_EQ(notices.items()[0], (Notice{Notice::Kind::kNote, "colours tell " + std::string(legend)}));
  };
  expect(PointColor::kObservations, yellow, violet, "observations from 0 (violet) to 2 (yellow)");
  // The cameras hold y downwards.
  expect(PointColor::kHeight, violet, yellow, "height from 0 (violet) to 1.5 (yellow)");
  expect(PointColor::kAge, yellow, violet, "age: made by kf from 1 (violet) to 3 (yellow)");
  atlas.maps[0].points[0].first_keyframe = -1;  // then by kf 1, the first that sees it
  atlas.maps[0].points[2].first_keyframe = -1;
  expect(PointColor::kAge, " 68 1 84", grey, "age: made by kf from 1 (violet) to 1 (yellow)");
}

TEST(Ply, ColoursOfErrorsAreGreyWhereThereIsNone) {
  Notices notices;
  const std::string text = Colored(OneMapAtlas(), PointColor::kError, notices);
  EXPECT_THAT(text, HasSubstr("\n0.25 -1.5 1e-05 0 0 1 128 128 128 0.5 4"));
}

TEST(Ply, WritesCamerasAndTheirPathAsEdges) {
  Notices notices;
  const WriteOptions options = WriteOptions{}.With(PointCloudOptions{.binary = false, .cameras = true});
  const std::string text = Write(OneMapAtlas(), options, notices);
  EXPECT_THAT(text, HasSubstr("element vertex 12\n"));  // two points, and five of each of two keyframes
  EXPECT_THAT(text, HasSubstr("property uchar camera\nelement edge 17\nproperty int vertex1\nproperty int vertex2\n"
                              "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"));
  // Half of the metre between them deep; kf 1 comes first by time.
  EXPECT_THAT(text, HasSubstr("2.5 0 10 0\n0.25 -1.5 1e-05 0 0 1 63 144 218 0.5 4 0 nan 0 12 0\n"
                              "0 0 0 0 0 1 63 144 218 0 0 0 nan 0 1 1\n"
                              "-0.33333334 -0.25 0.5 0 0 1 63 144 218 0 0 0 nan 0 1 2\n"
                              "0.33333334 -0.25 0.5 0 0 1 63 144 218 0 0 0 nan 0 1 2\n"
                              "0.33333334 0.25 0.5 0 0 1 63 144 218 0 0 0 nan 0 1 2\n"
                              "-0.33333334 0.25 0.5 0 0 1 63 144 218 0 0 0 nan 0 1 2\n"
                              "1 0 0 0 0 1 63 144 218 0 0 0 nan 0 3 1\n"));
  EXPECT_THAT(text, HasSubstr("\n2 3 63 144 218\n2 4 63 144 218\n2 5 63 144 218\n2 6 63 144 218\n3 4 63 144 218\n"
                              "4 5 63 144 218\n5 6 63 144 218\n6 3 63 144 218\n2 7 63 144 218\n7 8 63 144 218\n"));
  EXPECT_EQ(notices.written(), "2 points, 1 bad one left out; 2 poses");
}

TEST(Ply, CamerasInBinary) {
  Notices notices;
  const std::string text = Write(OneMapAtlas(), WriteOptions{}.With(PointCloudOptions{.cameras = true}), notices);
  const std::size_t rows = text.size() - text.find(kHeaderEnd) - kHeaderEnd.size();
  EXPECT_EQ(rows, 12U * (51 + 1) + 17U * (4 + 4 + 3));
}

TEST(Ply, LargeIdsOfCamerasAreDoublesToo) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].keyframes[0].id = KeyFrameId(std::uint64_t{1} << 40);
  Notices notices;
  const WriteOptions options = WriteOptions{}.With(PointCloudOptions{.binary = false, .cameras = true});
  EXPECT_THAT(Write(atlas, options, notices), HasSubstr("property double id\n"));
  EXPECT_THAT(Write(atlas, kAscii, notices), HasSubstr("property uint id\n"));
}

// The focal length and the borders of the image; the centre is not in the middle.
TEST(Ply, CamerasHaveTheAngleOfViewOfTheirImage) {
  Atlas atlas = OneMapAtlas();
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) {
    keyframe.intrinsics = {.fx = 100, .fy = 200, .cx = 50, .cy = 100};
    keyframe.bounds.max_x = 200;
    keyframe.bounds.max_y = 300;
  }
  Notices notices;
  const WriteOptions options = WriteOptions{}.With(PointCloudOptions{.binary = false, .cameras = true});
  EXPECT_THAT(Write(atlas, options, notices), HasSubstr("\n-0.25 -0.25 0.5 0 0 1"));
  EXPECT_THAT(Write(atlas, options, notices), HasSubstr("\n0.75 0.5 0.5 0 0 1"));
}

TEST(Ply, WritesAnEmptyAtlas) {
  Notices notices;
  EXPECT_THAT(Write({}, {}, notices), HasSubstr("element vertex 0\n"));
  EXPECT_TRUE(notices.items().empty());
}

}  // namespace
}  // namespace slamdb
