// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/trajectory/detail/trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "slamdb/base/error.h"
#include "slamdb/formats/export/options.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string Write(const Format& format, const Atlas& atlas, const WriteOptions& options, Notices& notices) {
  return Encoded(format, atlas, options, notices);
}

std::string Write(const Format& format, const Atlas& atlas, const WriteOptions& options = {}) {
  return Encoded(format, atlas, options);
}

const WriteOptions kBody = WriteOptions{}.With(TrajectoryOptions{.pose_frame = PoseFrame::kBody});

WriteOptions OnlyMap(std::uint64_t id) { return WriteOptions{}.With(ExportOptions{.map = MapId(id)}); }

std::string ReadProblem(const Format& format, std::string_view text) {
  try {
    Decoded(format, text);
  } catch (const Error& error) {
    return error.place() + ": " + error.problem();
  }
  return "";
}

TEST(Tum, WritesCameraPosesByTime) {
  EXPECT_EQ(Write(detail::kTumFormat, OneMapAtlas()),
            "# timestamp tx ty tz qx qy qz qw\n"
            "0.5 0 0 0 0 0 0 1\n"
            "1.5 1 0 0 0 0 0 1\n");
}

TEST(Tum, WritesBodyPoses) {
  Notices notices;
  EXPECT_EQ(Write(detail::kTumFormat, InertialAtlas(), kBody, notices),
            "# timestamp tx ty tz qx qy qz qw\n"
            "0.5 0 0 1 0 0 0 1\n"
            "1.5 1 0 1 0 0 0 1\n");
  EXPECT_TRUE(notices.items().empty());
}

TEST(Tum, WarnsWhenThereIsNoBody) {
  Notices notices;
  Write(detail::kTumFormat, OneMapAtlas(), kBody, notices);
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_THAT(notices.items()[0].text, HasSubstr("for want of IMU calibration: 2 keyframes"));
}

TEST(Tum, SeparatesMaps) {
  Notices notices;
  const std::string text = Write(detail::kTumFormat, SmallAtlas(), {}, notices);
  EXPECT_THAT(text, HasSubstr("# map 0\n0.5 0 0 0 "));
  EXPECT_THAT(text, HasSubstr("# map 1\n2 0 -3 0 -0.5 -0.5 -0.5 0.5\n"));
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_EQ(notices.items()[0].kind, Notice::Kind::kWarning);
  EXPECT_THAT(notices.items()[0].text, HasSubstr("frame of reference of its own"));

  const std::string one = Write(detail::kTumFormat, SmallAtlas(), OnlyMap(1));
  EXPECT_EQ(one, "# timestamp tx ty tz qx qy qz qw\n2 0 -3 0 -0.5 -0.5 -0.5 0.5\n");
}

TEST(Tum, NormalizesQuaternions) {
  Atlas atlas = OneMapAtlas();
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) keyframe.camera_from_world.rotation.coeffs() *= 3;
  EXPECT_EQ(Write(detail::kTumFormat, atlas), Write(detail::kTumFormat, OneMapAtlas()));
}

TEST(Tum, LeavesOutWhatHasNoPose) {
  Atlas atlas = SmallAtlas();
  atlas.maps[0].keyframes[0].bad = true;
  atlas.maps[0].keyframes[1].camera_from_world.rotation.coeffs().setZero();
  atlas.maps[1].keyframes[0].timestamp = std::nan("");
  Notices notices;
  EXPECT_EQ(Write(detail::kTumFormat, atlas, {}, notices), "# timestamp tx ty tz qx qy qz qw\n");
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_THAT(notices.written(), HasSubstr(", 1 bad one left out"));
  EXPECT_EQ(notices.items()[0],
            (Notice{Notice::Kind::kWarning, "left out because pose or time is not finite: 2 keyframes"}));
}

TEST(Tum, WritesTimesInFull) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].keyframes[0].timestamp = 1403636579.7635555;
  atlas.maps[0].keyframes[1].timestamp = 1e-7;
  const std::string text = Write(detail::kTumFormat, atlas);
  EXPECT_THAT(text, HasSubstr("\n1403636579.7635555 1 0 0 "));
  EXPECT_THAT(text, HasSubstr("\n0.0000001 0 0 0 "));
}

TEST(Tum, ReadsWhatItWrites) {
  const Atlas atlas = Decoded(detail::kTumFormat, Write(detail::kTumFormat, SmallAtlas()));
  ASSERT_EQ(atlas.maps.size(), 2U);
  EXPECT_EQ(atlas.maps[0].id, MapId(0));
  EXPECT_EQ(atlas.maps[1].id, MapId(1));
  ASSERT_EQ(atlas.maps[0].keyframes.size(), 2U);
  ASSERT_EQ(atlas.maps[1].keyframes.size(), 1U);
  EXPECT_EQ(atlas.maps[0].keyframes[1].timestamp, 1.5);
  EXPECT_EQ(atlas.maps[0].keyframes[1].camera_from_world.translation, Eigen::Vector3f(-1, 0, 0));
  EXPECT_EQ(atlas.maps[1].keyframes[0].id, KeyFrameId(2));
  EXPECT_EQ(atlas.maps[1].keyframes[0].camera_from_world.translation, Eigen::Vector3f(0, 0, 3));
  EXPECT_EQ(atlas.maps[1].keyframes[0].camera_from_world.rotation.z(), 0.5F);
  EXPECT_EQ(atlas.next_ids.map, 2U);
  EXPECT_EQ(atlas.next_ids.keyframe, 3U);
}

TEST(Tum, ReadsOtherWritersLines) {
  const Atlas atlas = Decoded(detail::kTumFormat, "#comment\r\n\n  1.25\t1 2 3 0 0 0 0.99\r\n1e1 0 0 0 0 0 0 1");
  ASSERT_EQ(atlas.maps.size(), 1U);
  ASSERT_EQ(atlas.maps[0].keyframes.size(), 2U);
  EXPECT_EQ(atlas.maps[0].keyframes[0].timestamp, 1.25);
  EXPECT_EQ(atlas.maps[0].keyframes[0].camera_from_world.Center(), Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(atlas.maps[0].keyframes[1].timestamp, 10);
}

TEST(Tum, ReadsASelection) {
  ReadOptions options;
  options.selection.map = MapId(0);
  options.selection.begin_time = 1;
  const Atlas atlas = Decoded(detail::kTumFormat, Write(detail::kTumFormat, SmallAtlas()), options);
  ASSERT_EQ(atlas.maps.size(), 1U);
  ASSERT_EQ(atlas.maps[0].keyframes.size(), 1U);
  EXPECT_EQ(atlas.maps[0].keyframes[0].timestamp, 1.5);
}

TEST(Tum, NamesTheLineThatIsWrong) {
  const std::string expected = "expected 8 numbers: timestamp tx ty tz qx qy qz qw, found ";
  EXPECT_EQ(ReadProblem(detail::kTumFormat, "1 0 0 0 0 0 0 1\n# c\n2 0 0 0 0 0 1\n"),
            "line 3: " + expected + "`2 0 0 0 0 0 1`");
  EXPECT_EQ(ReadProblem(detail::kTumFormat, "1 0 0 0 0 0 0 1x\n"),
            "line 1: expected a number, found '1x' in column qw");
  EXPECT_EQ(ReadProblem(detail::kTumFormat, "t 0 0 0 0 0 0 1\n"), "line 1: " + expected + "`t 0 0 0 0 0 0 1`");
}

TEST(Kitti, WritesMatricesAndTimes) {
  const TemporaryFolder folder;
  Notices notices;
  detail::kKittiFormat.write(SmallAtlas(), {folder.Path("a.kitti"), ""}, {}, notices);
  EXPECT_EQ(ReadFile(folder.Path("a.kitti.times")), "0.5\n1.5\n2\n");
  const std::string text = ReadFile(folder.Path("a.kitti"));
  EXPECT_THAT(text, HasSubstr("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_THAT(notices.items()[0].text, HasSubstr("lines 1-2 are map 0, lines 3-3 are map 1"));
  EXPECT_EQ(notices.written(), "3 poses; their times are in " + folder.Path("a.kitti.times"));
}

TEST(Kitti, OverwritesNeitherFile) {
  const TemporaryFolder folder;
  folder.Make("a.kitti.times", "mine");
  Notices notices;
  EXPECT_THROW(detail::kKittiFormat.write(SmallAtlas(), {folder.Path("a.kitti"), ""}, {}, notices), Error);
  EXPECT_EQ(ReadFile(folder.Path("a.kitti.times")), "mine");
  EXPECT_THAT(folder.Names(), ::testing::ElementsAre("a.kitti.times"));
}

TEST(Kitti, WarnsOfNoTimesOnStandardOutput) {
  Notices notices;
  const std::string text = CaptureStandardOutput([&] {
    detail::kKittiFormat.write(OneMapAtlas(), {"-", ""}, {}, notices);
  });
  EXPECT_EQ(text, "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n");
  EXPECT_FALSE(notices.lossy());
  EXPECT_THAT(notices.items().front().text, HasSubstr("no timestamps"));
}

TEST(Kitti, WarnsOfNoTimesInMemory) {
  Notices notices;
  EXPECT_EQ(Encoded(detail::kKittiFormat, OneMapAtlas(), {}, notices),
            "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(notices.items()[0].text, HasSubstr("memory has no second file for them"));
}

TEST(Euroc, WritesNanosecondsAndScalarFirst) {
  EXPECT_EQ(Write(detail::kEurocFormat, SmallAtlas(), OnlyMap(1)),
            "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
            "2000000000,0,-3,0,0.5,-0.5,-0.5,-0.5\n");
}

TEST(Euroc, WritesVelocityAndBiases) {
  const std::string text = Write(detail::kEurocFormat, InertialAtlas(), kBody);
  EXPECT_THAT(text, HasSubstr("b_a_RS_S_z [m s^-2]\n"
                              "500000000,0,0,1,1,0,0,0,0.5,0,1,0,0.0625,0,0.125,0,0\n"
                              "1500000000,1,0,1,1,0,0,0,0.5,0,3,0,0.0625,0,0.125,0,0\n"));
}

TEST(Euroc, RoundsToTheNearestNanosecond) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].keyframes[0].timestamp = 1403636579.7635555;
  atlas.maps[0].keyframes[1].timestamp = -0.25;
  const std::string text = Write(detail::kEurocFormat, atlas);
  EXPECT_THAT(text, HasSubstr("\n1403636579763555527,"));  // the double is 1403636579.76355552673...
  EXPECT_THAT(text, HasSubstr("\n-250000000,"));
}

TEST(Euroc, LeavesOutTimesThatAreNotSeconds) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].keyframes[0].timestamp = 1.4e18;
  Notices notices;
  Write(detail::kEurocFormat, atlas, {}, notices);
  EXPECT_EQ(notices.written(), "1 pose");
  EXPECT_THAT(notices.items()[0].text, HasSubstr("left out because their time does not fit"));
}

TEST(Euroc, ReadsWhatItWrites) {
  Atlas atlas = InertialAtlas();
  atlas.maps[0].keyframes[0].timestamp = 1403636579.7635555;
  const Atlas back = Decoded(detail::kEurocFormat, Write(detail::kEurocFormat, atlas));
  ASSERT_EQ(back.maps.size(), 1U);
  ASSERT_EQ(back.maps[0].keyframes.size(), 2U);
  EXPECT_EQ(back.maps[0].keyframes[1].timestamp, 1403636579.7635555);
  EXPECT_EQ(back.maps[0].keyframes[1].camera_from_world.Center(), Eigen::Vector3f(1, 0, 0));
}

TEST(Euroc, NamesTheLineThatIsWrong) {
  const std::string expected =
      "expected at least 8 cells: timestamp [ns], position x y z, quaternion w x y z, found `15,0,0,0,1,0,0`";
  EXPECT_EQ(ReadProblem(detail::kEurocFormat, "#timestamp, p_RS_R_x\nnan,0,0,0,1,0,0,0\n"),
            "line 2: expected a number, or date and time as 2023-11-14T22:13:20Z, found 'nan' in column timestamp");
  EXPECT_EQ(ReadProblem(detail::kEurocFormat, "#timestamp, p_RS_R_x\n15,0,0,0,1,0,0\n"), "line 2: " + expected);
}

// Two poses, the second at (1, 2, 3), turned by half a turn about x.
constexpr const char* kTumDialects[] = {
    "0.5 0 0 0 0 0 0 1\n1.5 1 2 3 1 0 0 0\n",
    "\xef\xbb\xbf# timestamp tx ty tz qx qy qz qw\r\n0.5 0 0 0 0 0 0 1\r\n1.5 1 2 3 1 0 0 0",
    "timestamp,tx,ty,tz,qx,qy,qz,qw\n0.5,0,0,0,0,0,0,1\n1.5,1,2,3,1,0,0,0\n",
    "Time [s];qw;qx;qy;qz;tx [m];ty [m];tz [m]\n+0.5;1;0;0;0;0;0;0\n+1.5;0;+1;0;0;+1;+2;+3\n",
    "% made by hand\n\"0.5\"\t0\t0\t0\t0\t0\t0\t1\n1.5  1  2  3\t1 0 0 0\n",
};

class TumDialect : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Tum, TumDialect, ::testing::ValuesIn(kTumDialects));

TEST_P(TumDialect, IsToldAndRead) {
  const TemporaryFolder folder;
  Notices notices;
  const std::string path = folder.Make("a.csv", GetParam());
  EXPECT_TRUE(detail::kTumFormat.sniff(Probe::Of(path)));
  EXPECT_FALSE(detail::kEurocFormat.sniff(Probe::Of(path)) || detail::kKittiFormat.sniff(Probe::Of(path)));
  const Atlas atlas = detail::kTumFormat.read({path, ""}, {}, notices);
  ASSERT_EQ(atlas.maps.size(), 1U);
  ASSERT_EQ(atlas.maps[0].keyframes.size(), 2U);
  const KeyFrame& keyframe = atlas.maps[0].keyframes[1];
  EXPECT_EQ(keyframe.timestamp, 1.5);
  EXPECT_EQ(keyframe.camera_from_world.Center(), Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(std::abs(keyframe.camera_from_world.rotation.x()), 1);
}

// ---- Rows between commas, without names

// A walk on a circle, looking ahead, with the quaternions in either order.
std::string Walk(bool scalar_first, const Eigen::Quaterniond& looking, double step, int rows) {
  std::ostringstream text;
  text.precision(12);
  for (int i = 0; i < rows; ++i) {
    const double angle = 0.1 * i;
    const Eigen::Quaterniond q = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * looking;
    text << i * step << ',' << std::sin(angle) << ',' << -std::cos(angle) << ",0.5,";
    if (scalar_first) text << q.w() << ',';
    text << q.x() << ',' << q.y() << ',' << q.z();
    if (!scalar_first) text << ',' << q.w();
    text << '\n';
  }
  return text.str();
}

Atlas ReadAsFound(const std::string& text, Notices& notices, const std::string& name = "a.csv",
                  ReadOptions options = {}) {
  const TemporaryFolder folder;
  const std::string path = folder.Make(name, text);
  const Probe probe = Probe::Of(path);
  const bool euroc = options.format.empty() ? detail::kEurocFormat.sniff(probe) : options.format == "euroc";
  EXPECT_TRUE(euroc || detail::kTumFormat.sniff(probe)) << text;
  return (euroc ? detail::kEurocFormat : detail::kTumFormat).read({path, ""}, options, notices);
}

std::string FoundProblem(const std::string& text, const std::string& name = "a.csv") {
  Notices notices;
  try {
    ReadAsFound(text, notices, name);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Order, IsToldByTheStart) {
  for (const bool scalar_first : {false, true}) {
    Notices notices;
    const Atlas atlas = ReadAsFound(Walk(scalar_first, Eigen::Quaterniond::Identity(), 0.05, 5), notices);
    for (const KeyFrame& keyframe : atlas.maps.at(0).keyframes)
      EXPECT_NEAR(keyframe.camera_from_world.rotation.x(), 0, 1e-6) << scalar_first;
    EXPECT_EQ(atlas.maps[0].keyframes.at(1).timestamp, 0.05);
    EXPECT_THAT(notices.items().at(0).text,
                HasSubstr(scalar_first ? "quaternions are taken as w x y z" : "quaternions are taken as x y z w"));
  }
}

TEST(Order, IsToldByTheMotion) {
  const Eigen::Quaterniond looking = Eigen::Quaterniond(0.62, -0.6, 0.36, -0.36).normalized();
  for (const bool scalar_first : {false, true}) {
    Notices notices;
    const Atlas atlas = ReadAsFound(Walk(scalar_first, looking, 0.05, 60), notices);
    const Quaternionf& first = atlas.maps.at(0).keyframes.at(0).camera_from_world.rotation;
    EXPECT_NEAR(std::abs(first.cast<double>().dot(looking.conjugate())), 1, 1e-6) << scalar_first;
    EXPECT_THAT(notices.items().at(0).text, HasSubstr("the camera goes steadily one way"));
  }
}

TEST(Order, ThatCannotBeToldIsAnErrorWithBothReadings) {
  const std::string text = Walk(true, Eigen::Quaterniond(0.1, 0.7, 0.1, 0.7), 0.05, 4);
  EXPECT_THAT(FoundProblem(text), AllOf(HasSubstr("x y z w (tum), the first pose turned by 91 degrees"),
                                        HasSubstr("w x y z (euroc), the first pose turned by 169 degrees"),
                                        HasSubstr("ReadOptions::format tum or euroc")));
  Notices notices;
  ReadOptions options;
  for (const char* format : {"tum", "euroc"}) {
    options.format = format;
    const Atlas atlas = ReadAsFound(text, notices, "a.csv", options);
    const float w = std::string_view(format) == "tum" ? 0.7F : 0.1F;
    EXPECT_FLOAT_EQ(std::abs(atlas.maps.at(0).keyframes.at(0).camera_from_world.rotation.w()), w);
  }
  EXPECT_EQ(FoundProblem(text, "a.tum"), "no error");
  std::string spaced = text;
  std::ranges::replace(spaced, ',', ' ');
  EXPECT_EQ(FoundProblem(spaced), "no error");
}

// Between blanks it is TUM's, whatever the rotations say; but they may say it.
TEST(Order, BetweenBlanksIsDoubtedAloud) {
  const Eigen::Quaterniond looking = Eigen::Quaterniond(0.62, -0.6, 0.36, -0.36).normalized();
  for (const bool scalar_first : {false, true}) {
    std::string text = Walk(scalar_first, looking, 0.05, 60);
    std::ranges::replace(text, ',', ' ');
    Notices notices;
    ReadAsFound(text, notices);
    EXPECT_EQ(notices.items().size(), scalar_first ? 1U : 0U);
    for (const Notice& notice : notices.items())
      EXPECT_THAT(notice.text, HasSubstr("between blanks quaternions are x y z w"));
  }
}

TEST(Order, OfNanosecondsIsThatOfEurocUnlessRotationsContradict) {
  const std::string start = "1403636579763555072,0,0,0,";
  EXPECT_EQ(FoundProblem(start + "0.5,0.5,-0.5,0.5\n"), "no error");
  EXPECT_EQ(FoundProblem(start + "1,0,0,0,\n"), "no error");  // as VINS writes it
  EXPECT_EQ(FoundProblem(start + "1,0,0,0,0.5,0,0,\n"), "no error");
  EXPECT_THAT(FoundProblem(start + "0,0,0,1\n"), HasSubstr("tum or euroc"));
}

TEST(Kitti, TakesTheTimesOfRawRecordings) {
  const TemporaryFolder folder;
  Notices notices;
  folder.Make("times.txt", "2011-09-26 13:02:25.594360375\n2011-09-26 13:02:25.694360375\n");
  const std::string path = folder.Make("a.kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n");
  const Atlas atlas = detail::kKittiFormat.read({path, ""}, {}, notices);
  EXPECT_EQ(atlas.maps.at(0).keyframes.at(1).timestamp, 1317042145.694360375);
}

// The atlas rounds what it reads, and the text what it takes from the atlas.
TEST(Tum, NamesEveryRounding) {
  Notices read, written;
  const Atlas atlas = ReadAsFound("1 448251.123456 5411932.678901 500 0.1 0.2 0.3 0.92736184954957\n", read, "a.tum");
  EXPECT_THAT(read.items().at(0).text, HasSubstr("rounded by up to"));
  const TemporaryFolder folder;
  detail::kTumFormat.write(atlas, {folder / "b.tum", ""}, {}, written);
  EXPECT_THAT(written.items().at(0).text, HasSubstr("rounded again as they are written, by up to"));
}

TEST(Euroc, ReadsColumnsByName) {
  const TemporaryFolder folder;
  Notices notices;
  const std::string path = folder.Make(
      "a.csv",
      "\xef\xbb\xbf#timestamp [ns];q_RS_x [];q_RS_y [];q_RS_z [];q_RS_w [];p_RS_R_x [m];p_RS_R_y [m];p_RS_R_z [m]\r\n"
      "1403636580838555648;1;0;0;0;+1;2;3\r\n");
  EXPECT_TRUE(detail::kEurocFormat.sniff(Probe::Of(path)));
  EXPECT_FALSE(detail::kTumFormat.sniff(Probe::Of(path)));
  const Atlas atlas = detail::kEurocFormat.read({path, ""}, {}, notices);
  ASSERT_EQ(atlas.maps.size(), 1U);
  EXPECT_EQ(atlas.maps[0].keyframes.at(0).timestamp, 1403636580.838555648);
  EXPECT_EQ(atlas.maps[0].keyframes[0].camera_from_world.Center(), Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(std::abs(atlas.maps[0].keyframes[0].camera_from_world.rotation.x()), 1);
}

TEST(Euroc, IsNoOtherTableOfItsDataSet) {
  const TemporaryFolder folder;
  const Probe imu = Probe::Of(folder.Make(
      "imu.csv",
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],a_RS_S_y [m "
      "s^-2],a_RS_S_z [m s^-2]\n1403636579758555392,-0.1,0.15,0.08,8.18,-0.37,-2.4\n"));
  EXPECT_FALSE(detail::kEurocFormat.sniff(imu) || detail::kTumFormat.sniff(imu) || detail::kKittiFormat.sniff(imu));
}

TEST(Trajectory, WithoutPosesIsNone) {
  const std::string problem = ": holds no pose; was it cut off after its first lines?";
  EXPECT_EQ(ReadProblem(detail::kTumFormat, "# timestamp tx ty tz qx qy qz qw\n"), problem);
  EXPECT_EQ(ReadProblem(detail::kTumFormat, "# map 0\n# map 1\n"), problem);
  EXPECT_EQ(ReadProblem(detail::kEurocFormat,
                        "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], "
                        "q_RS_x [], q_RS_y [], q_RS_z []\n"),
            problem);
}

TEST(Trajectory, ErrorsHaveKinds) {
  const TemporaryFolder folder;
  Notices notices;
  const auto kind_of = [&](const std::string& path) {
    try {
      detail::kTumFormat.read({path, ""}, {}, notices);
    } catch (const Error& error) {
      EXPECT_EQ(error.path(), path);
      return error.kind();
    }
    return ErrorKind::kInternal;
  };
  EXPECT_EQ(kind_of(folder.Make("short.tum", "1 2 3\n")), ErrorKind::kDamaged);
  EXPECT_EQ(kind_of(folder.Make("utf16.tum",
                                "\xff\xfe"
                                "1")),
            ErrorKind::kUnsupported);
}

}  // namespace
}  // namespace slamdb
