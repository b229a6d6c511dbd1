// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/xyz/detail/xyz.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/formats/formats/small_atlas.h"
#include "tests/formats/points/clouds.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

const Format& kXyz = detail::kXyzFormat;

TEST(Xyz, WritesThreeNumbersALine) {
  Notices notices;
  EXPECT_EQ(Encoded(kXyz, SmallAtlas(), {}, notices), "0 0 2\n0.25 -1.5 1e-05\n0 1 0\n");
  EXPECT_EQ(notices.written(), "3 points, 1 bad one left out");
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_THAT(notices.items()[0].text, HasSubstr("2 maps are in one file"));
}

TEST(Xyz, LeavesOutPointsWithoutAPlace) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].points[0].position.y() = std::nanf("");
  Notices notices;
  EXPECT_EQ(Encoded(kXyz, atlas, {}, notices), "0.25 -1.5 1e-05\n");
  EXPECT_THAT(notices.items().at(0).text, HasSubstr("not finite: 1 point"));
}

TEST(Xyz, GivesBackEveryBitOfThePositions) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].points[0].position = {std::numeric_limits<float>::denorm_min(), -std::numeric_limits<float>::max(),
                                      -0.0F};
  const Atlas back = Decoded(kXyz, Encoded(kXyz, atlas));
  const Atlas expected = PointsAlone(atlas);
  ASSERT_EQ(back.maps.size(), 1U);
  ASSERT_EQ(back.maps[0].points.size(), expected.maps[0].points.size());
  for (std::size_t row = 0; row < back.maps[0].points.size(); ++row) {
    EXPECT_EQ(back.maps[0].points[row].id, MapPointId(row)) << "ids are rows";
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(std::bit_cast<std::uint32_t>(back.maps[0].points[row].position[axis]),
                std::bit_cast<std::uint32_t>(expected.maps[0].points[row].position[axis]));
  }
}

struct Dialect {
  const char *name, *text;
  bool loses = false;
};

// All are 1 2 3.5 and 4 5 6.
TEST(Xyz, ReadsWhatPeopleHave) {
  const Dialect dialects[] = {{"blanks", "1 2 3.5\n4 5 6\n"},
                              {"runs of blanks, without a last line end", "  1   2\t3.5  \r\n4 5 6"},
                              {"commas", "1,2,3.5\n4, 5, 6\n"},
                              {"semicolons and decimal commas", "1;2;3,5\n4;5;6\n"},
                              {"decimal commas", "1,0 2,0 3,5\n4,0 5,0 6,0\n"},
                              {"comments and empty lines", "# scan\n\n1 2 3.5\n% more\n\n4 5 6\n"},
                              {"byte order mark",
                               "\xef\xbb\xbf"
                               "1 2 3.5\n4 5 6\n"},
                              {"colours behind", "1 2 3.5 255 0 0\n4 5 6 0 255 0\n", true},
                              {"names", "x,y,z\n1,2,3.5\n4,5,6\n"},
                              {"names in another order", "Z X Y\n3.5 1 2\n6 4 5\n"},
                              {"names in a comment", "# x y z intensity\n1 2 3.5 9\n4 5 6 9\n", true},
                              {"CloudCompare's names", "//X Y Z Intensity\n1 2 3.5 9\n4 5 6 9\n", true},
                              {"plus signs and exponents", "+1 2e0 35e-1\n4 5 6\n"}};
  for (const auto& [name, text, loses] : dialects) {
    const ReadCloud read = ReadAsCloud(kXyz, text);
    ASSERT_EQ(read.atlas.maps.at(0).points.size(), 2U) << name;
    EXPECT_EQ(read.position(0), Eigen::Vector3f(1, 2, 3.5F)) << name;
    EXPECT_EQ(read.position(1), Eigen::Vector3f(4, 5, 6)) << name;
    EXPECT_EQ(read.notices.lossy(), loses) << name;
  }
}

TEST(Xyz, ReadsColumnsThatAreNamed) {
  const ReadCloud read = ReadAsCloud(kXyz, "id,x,y,z,nx,ny,nz,map,intensity\n7,1,2,3,0,0,1,4,9\n");
  EXPECT_EQ(read.atlas.maps.at(0).id, MapId(4));
  EXPECT_EQ(read.point(0).id, MapPointId(7));
  EXPECT_EQ(read.point(0).normal, Eigen::Vector3f(0, 0, 1));
  EXPECT_TRUE(read.Tells(Notice::Kind::kLoss, "the columns intensity;"));
}

// The shortest text of a float has fewer digits than the float.
TEST(Xyz, SaysByHowMuchCoordinatesOfTheWorldAreRounded) {
  EXPECT_TRUE(ReadAsCloud(kXyz, "0.1 1048576.1 1048576.125\n").notices.items().empty());
  const ReadCloud read = ReadAsCloud(kXyz, "456789.125 5412345.3 500.1\n");
  EXPECT_TRUE(read.Tells(Notice::Kind::kLoss, "rounded to the 32-bit floats of an atlas: 1, by up to 0.2"));
}

TEST(Xyz, LeavesOutWhatWasNotMeasured) {
  const ReadCloud read = ReadAsCloud(kXyz, "1 2 3\nnan nan nan\n4 5 6\n");
  EXPECT_EQ(read.atlas.maps.at(0).points.size(), 2U);
  EXPECT_EQ(read.point(1).id, MapPointId(2));
}

TEST(Xyz, SaysWhichLineIsWrong) {
  const auto error = [](std::string_view text) {
    const auto found = CloudError(kXyz, text);
    return found ? found->place() + ": " + found->problem() : "was read";
  };
  EXPECT_THAT(error("1 2\n"), HasSubstr("line 1: expected 3 numbers or more: x y z, found `1 2`"));
  EXPECT_THAT(error("1 2 3\n4 5\n"), HasSubstr("line 2: "));
  EXPECT_THAT(error("# c\n1 2 3\n4 five 6\n"), HasSubstr("line 3: expected a number, found 'five' in column y"));
  EXPECT_THAT(error("x [mm],y [mm],z [mm]\n1,2,3\n"), HasSubstr("column x [mm]: expected metres"));
  EXPECT_THAT(error("12\ncomment of a molecule\nC 0 0 0\n"), HasSubstr("line 1: expected 3 numbers or more"));
  EXPECT_THAT(error(std::string_view("1 2 3\n\0 2 3\n", 13)), HasSubstr("line 2: holds a zero byte"));
}

TEST(Xyz, IsChosenByThreeNumbersAlone) {
  const auto sniffs = [](std::string_view head) { return kXyz.sniff({.path = "", .head = std::string(head)}); };
  EXPECT_TRUE(sniffs("1 2 3\n4 5 6\n"));
  EXPECT_TRUE(sniffs("# c\n1.5,2,3\n"));
  EXPECT_FALSE(sniffs("1 2\n"));
  EXPECT_FALSE(sniffs("1 2 3 4\n"));
  EXPECT_FALSE(sniffs("x y z\n1 2 3\n"));
  EXPECT_FALSE(sniffs("1 2 three\n"));
}

}  // namespace
}  // namespace slamdb
