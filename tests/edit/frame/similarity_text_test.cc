// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/similarity_text.h"

#include <gmock/gmock.h>

#include "slamdb/base/error.h"
#include "slamdb/edit/frame/axes.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

template <class Parse>
std::string MessageOf(const Parse& parse) {
  try {
    parse();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}
std::string TransformMessage(const char* text) {
  return MessageOf([text] { return ParseSimilarity(text); });
}
std::string AxesMessage(const char* text) {
  return MessageOf([text] { return ParseAxes(text); });
}

void ExpectTakes(const Similarity3d& transform, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  EXPECT_LT((transform * from - to).norm(), 1e-9) << (transform * from).transpose();
}

TEST(ParseSimilarity, SevenEightTwelveAndSixteenNumbers) {
  // A quarter turn about z.
  ExpectTakes(ParseSimilarity("1 2 3 0 0 0.7071068 0.7071068"), {1, 0, 0}, {1, 3, 3});
  ExpectTakes(ParseSimilarity("# t q s\n1, 2, 3;\t0 0 0.7071068 0.7071068\n2 # twice\n"), {1, 0, 0}, {1, 4, 3});
  ExpectTakes(ParseSimilarity("0 -1 0 1\n1 0 0 2\n0 0 1 3\n"), {1, 0, 0}, {1, 3, 3});
  ExpectTakes(ParseSimilarity("\xef\xbb\xbf% by hand\r\n+1 +2 +3\r\n0 0 +0.7071068 +0.7071068 2"), {1, 0, 0},
              {1, 4, 3});
  ExpectTakes(ParseSimilarity("0 -2 0 1  2 0 0 2  0 0 2 3  0 0 0 1"), {1, 0, 0}, {1, 4, 3});
}

// The dialects of tables: commas are decimal commas where something else separates.
TEST(ParseSimilarity, InTheDialectsOfTables) {
  for (const char* text :
       {"1,5;2;3;0;0;0;1", "1,5;2,0;3,0;0,0;0,0;0,0;1,0;1,0\n", "1,5 2 3 0 0 0 1", "\"1,5\",\"2\",\"3\",0,0,0,1",
        "sep=;\n1,5;2;3;0;0;0;1", "1.5,2,3,0,0,0,1", "1.5 2 3,0 0 0 1", "1.5 , 2 , 3 , 0 , 0 , 0 , 1",
        "1.5\t2\t3\t0\t0\t0\t1", "1,0 0 0 1,5\n0 1,0 0 2\n0 0 1 3\n", "1,0,0,1.5;0,1,0,2;0,0,1,3",
        "tx,ty,tz,qx,qy,qz,qw\n1.5,2,3,0,0,0,1\n", "qw;qx;qy;qz;tx;ty;tz;scale\n1;0;0;0;1,5;2;3;1\n",
        "# tx ty tz qx qy qz qw\n1.5 2 3 0 0 0 1\n", "x [cm],y [cm],z [cm],qx,qy,qz,qw\n150,200,300,0,0,0,1\n",
        "timestamp,tx,ty,tz,qx,qy,qz,qw\n9,1.5,2,3,0,0,0,1\n"}) {
    SCOPED_TRACE(text);
    ExpectTakes(ParseSimilarity(text), {0, 0, 0}, {1.5, 2, 3});
    ExpectTakes(ParseSimilarity(text), {1, 0, 0}, {2.5, 2, 3});
  }
  EXPECT_THAT(TransformMessage("0,5;2.5;1;0;0;0;1"), HasSubstr("one decimal mark"));
  EXPECT_THAT(TransformMessage("tx,ty,tz,qx,qy,qz,qw\n1,2,3,0,0,0,1\n1,2,3,0,0,0,1\n"),
              HasSubstr("line 3: expected one row"));
  EXPECT_THAT(TransformMessage("tx,ty,tz,qx,qy,qz,qw\n1,2,3,0,0,0,x\n"), HasSubstr("found 'x' in column qw"));
  EXPECT_THAT(TransformMessage("tx,ty,tz,qx,qy,qz,qw\n"), HasSubstr("no row"));
}

TEST(ParseSimilarity, ALineOfATrajectoryIsNone) {
  for (const char* line : {"1403636580.25 4.6 -1.7 0.8 0.53 -0.15 -0.82 -0.06", "0 1 2 3 0 0 0 1",
                           "0.25 1 2 0 0 0 0.6 0.8", "1700000000 5 6 1 0 0 0 1"})
    EXPECT_THAT(TransformMessage(line), HasSubstr("a line of a TUM trajectory")) << line;
  EXPECT_THAT(TransformMessage("1403636580.25 4.6 -1.7 0.8 0.53 -0.15 -0.82 -0.06"),
              HasSubstr("a time: 1403636580.25; give the 7 behind it"));
  ExpectTakes(ParseSimilarity("1 2 3 1 0 0 0 1"), {0, 1, 0}, {1, 1, 3});
}

TEST(ParseSimilarity, QuaternionsAreOfUnitLength) {
  EXPECT_THAT(TransformMessage("1 2 3 255 255 255 0.5"),
              HasSubstr("qx qy qz qw = 255 255 255 0.5, is of length 441.6"));
  EXPECT_THAT(TransformMessage("1 2 3 0 0 1 1"), HasSubstr("of length 1.41"));
  ExpectTakes(ParseSimilarity("1 2 3 0 0 0 1.05"), {0, 0, 0}, {1, 2, 3});
}

TEST(ParseSimilarity, TextComesBackExactly) {
  const Similarity3d transform{1.1, Eigen::Quaterniond(0.1, 0.2, -0.3, 0.4).normalized(), {1e-7, -3e5, 1.0 / 3}};
  const Similarity3d again = ParseSimilarity(ToText(transform));
  EXPECT_EQ(again.scale, transform.scale);
  EXPECT_EQ(again.translation, transform.translation);
  EXPECT_LE(again.rotation.angularDistance(transform.rotation), 1e-15);
}

TEST(ReadSimilarity, OfATextOrAFile) {
  const TemporaryFolder folder;
  ExpectTakes(ReadSimilarity("1 2 3 0 0 0 1"), {0, 0, 0}, {1, 2, 3});
  ExpectTakes(ReadSimilarity(folder.Make("good.txt", "1 2 3 0 0 0 1\n")), {0, 0, 0}, {1, 2, 3});
  const auto error_of = [](const std::string& text_or_path) {
    try {
      static_cast<void>(ReadSimilarity(text_or_path));
    } catch (const Error& error) {
      return error;
    }
    return Error(ErrorKind::kInternal, "no error");
  };
  const std::string bad = folder.Make("bad.txt", "1 2 3\n");
  EXPECT_EQ(error_of(bad).path(), bad);
  EXPECT_EQ(error_of(bad).kind(), ErrorKind::kDamaged);
  EXPECT_EQ(error_of("1 2 3").kind(), ErrorKind::kUsage);
  EXPECT_EQ(error_of("nowhere").kind(), ErrorKind::kNotFound);
}

TEST(ParseSimilarity, RefusesWhatIsNone) {
  EXPECT_THAT(TransformMessage("1 2 3"), HasSubstr("not 3"));
  EXPECT_THAT(TransformMessage(""), HasSubstr("not 0"));
  EXPECT_THAT(TransformMessage("1 2 3 0 0 0 x"), HasSubstr("'x' is none"));
  EXPECT_THAT(TransformMessage("1 2 3 0 0 0 0"), HasSubstr("quaternion of the transform is zero"));
  EXPECT_THAT(TransformMessage("1 2 3 0 0 0 1 0"), HasSubstr("scale"));
  EXPECT_THAT(TransformMessage("1 2 3 0 0 0 1 -2"), HasSubstr("scale"));
  EXPECT_THAT(TransformMessage("1 2 nan 0 0 0 1"), HasSubstr("NaN"));
  EXPECT_THAT(TransformMessage("0 0 0 1  0 0 0 2  0 0 1 3"), HasSubstr("singular"));
  EXPECT_THAT(TransformMessage("-1 0 0 0  0 1 0 0  0 0 1 0"), HasSubstr("mirrors"));
  EXPECT_THAT(TransformMessage("2 0 0 0  0 1 0 0  0 0 1 0"), HasSubstr("shears"));
  EXPECT_THAT(TransformMessage("nan 0 0 0  0 1 0 0  0 0 1 0"), HasSubstr("NaN"));
  EXPECT_THAT(TransformMessage("1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 2"), HasSubstr("last row"));
}

Eigen::Vector3d Turned(const char* axes, const Eigen::Vector3d& x) { return ParseAxes(axes) * x; }

TEST(ParseAxes, ListsAndConventions) {
  const Eigen::Vector3d x(1, 2, 3);  // of a camera: 1 right, 2 down, 3 forward
  EXPECT_TRUE(Turned("x,y,z", x).isApprox(x));
  EXPECT_TRUE(Turned("x,-z,y", x).isApprox(Eigen::Vector3d(1, -3, 2)));
  EXPECT_TRUE(Turned("+z,-x,-y", x).isApprox(Eigen::Vector3d(3, -1, -2)));
  EXPECT_TRUE(Turned("camera:ros", x).isApprox(Eigen::Vector3d(3, -1, -2)));
  EXPECT_TRUE(Turned("camera:enu", x).isApprox(Eigen::Vector3d(1, 3, -2)));
  EXPECT_TRUE(Turned("camera:ned", x).isApprox(Eigen::Vector3d(3, 1, 2)));
  EXPECT_TRUE(Turned("camera:opengl", x).isApprox(Eigen::Vector3d(1, -2, -3)));
  EXPECT_TRUE(Turned("ros:camera", {3, -1, -2}).isApprox(x));
  EXPECT_TRUE(Turned("ned:enu", {3, 1, 2}).isApprox(Eigen::Vector3d(1, 3, -2)));
}

TEST(ParseAxes, RefusesWhatIsNone) {
  EXPECT_THAT(AxesMessage("x,y"), HasSubstr("as camera:ros"));
  EXPECT_THAT(AxesMessage("x,y,z,"), HasSubstr("'x,y,z,'"));
  EXPECT_THAT(AxesMessage("camera:ros:enu"), HasSubstr("'camera:ros:enu'"));
  EXPECT_THAT(AxesMessage("x,y,z,x"), HasSubstr("'x,y,z,x'"));
  EXPECT_THAT(AxesMessage("ros"), HasSubstr("'ros'"));
  EXPECT_THAT(AxesMessage("camera:mars"), HasSubstr("'camera:mars'"));
  EXPECT_THAT(AxesMessage("x,x,z"), HasSubstr("twice"));
  EXPECT_THAT(AxesMessage("y,x,z"), HasSubstr("mirror"));
}

}  // namespace
}  // namespace slamdb
