// SPDX-License-Identifier: BSD-3-Clause
// Trajectories as people have them: what other programs write, in every dialect of tables.
#include "tests/support/dialects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/formats/trajectory/options.h"
#include "slamdb/model/derive.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

// Two poses, at 1700000000.25 and 1700000000.5 s: at (1, 2, 3) without a turn, and at (4, 5, 6) after half a turn about
// x.
const std::vector<NamedTable>& Tables() {
  static const std::vector<NamedTable> tables = {
      {"tum",
       {"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"},
       {{"1700000000.25", "1", "2", "3", "0", "0", "0", "1"}, {"1700000000.5", "4", "5", "6", "1", "0", "0", "0"}}},
      {"euroc",
       {"#timestamp [ns]", "p_RS_R_x [m]", "p_RS_R_y [m]", "p_RS_R_z [m]", "q_RS_w []", "q_RS_x []", "q_RS_y []",
        "q_RS_z []"},
       {{"1700000000250000000", "1", "2", "3", "1", "0", "0", "0"},
        {"1700000000500000000", "4", "5", "6", "0", "1", "0", "0"}}},
      {"rostopic_pose",
       {"%time", "field.header.seq", "field.header.stamp", "field.header.frame_id", "field.pose.position.x",
        "field.pose.position.y", "field.pose.position.z", "field.pose.orientation.x", "field.pose.orientation.y",
        "field.pose.orientation.z", "field.pose.orientation.w"},
       {{"1700000009250000000", "0", "1700000000250000000", "map", "1", "2", "3", "0", "0", "0", "1"},
        {"1700000009500000000", "1", "1700000000500000000", "map", "4", "5", "6", "1", "0", "0", "0"}}},
      {"odometry",
       {"%time", "field.child_frame_id", "field.pose.pose.position.x", "field.pose.pose.position.y",
        "field.pose.pose.position.z", "field.pose.pose.orientation.x", "field.pose.pose.orientation.y",
        "field.pose.pose.orientation.z", "field.pose.pose.orientation.w", "field.pose.covariance0",
        "field.twist.twist.linear.x"},
       {{"1700000000250000000", "base", "1", "2", "3", "0", "0", "0", "1", "0.5", "9"},
        {"1700000000500000000", "base", "4", "5", "6", "1", "0", "0", "0", "0.5", "9"}}},
      {"ros2_bag",
       {"header.stamp.sec", "header.stamp.nanosec", "pose.position.x", "pose.position.y", "pose.position.z",
        "pose.orientation.x", "pose.orientation.y", "pose.orientation.z", "pose.orientation.w"},
       {{"1700000000", "250000000", "1", "2", "3", "0", "0", "0", "1"},
        {"1700000000", "500000000", "4", "5", "6", "1", "0", "0", "0"}}},
      {"plotjuggler",
       {"/pose/header/stamp", "/pose/pose/position/x", "/pose/pose/position/y", "/pose/pose/position/z",
        "/pose/pose/orientation/x", "/pose/pose/orientation/y", "/pose/pose/orientation/z", "/pose/pose/orientation/w"},
       {{"1700000000.25", "1", "2", "3", "0", "0", "0", "1"}, {"1700000000.5", "4", "5", "6", "1", "0", "0", "0"}}},
      {"umi",
       {"frame_idx", "timestamp", "state", "is_lost", "is_keyframe", "x", "y", "z", "q_x", "q_y", "q_z", "q_w"},
       {{"0", "1700000000.2", "2", "true", "false", "0", "0", "0", "0", "0", "0", "0"},
        {"1", "1700000000.25", "2", "false", "true", "1", "2", "3", "0", "0", "0", "1"},
        {"2", "1700000000.5", "2", "false", "true", "4", "5", "6", "1", "0", "0", "0"},
        {"3", "1700000000.6", "2", "true", "false", "nan", "nan", "nan", "nan", "nan", "nan", "nan"}}},
      {"millimetres",
       {"time [ms]", "x [mm]", "y [mm]", "z [mm]", "qw", "qx", "qy", "qz"},
       {{"1700000000250", "1000", "2000", "3000", "1", "0", "0", "0"},
        {"1700000000500", "4000", "5000", "6000", "0", "1", "0", "0"}}},
  };
  return tables;
}

void ExpectPoses(const std::vector<TrajectoryPose>& poses, const std::string& text) {
  ASSERT_EQ(poses.size(), 2U) << text;
  EXPECT_EQ(poses[0].timestamp, 1700000000.25) << text;
  EXPECT_EQ(poses[1].timestamp, 1700000000.5) << text;
  EXPECT_EQ(poses[0].position, Eigen::Vector3d(1, 2, 3)) << text;
  EXPECT_EQ(poses[1].position, Eigen::Vector3d(4, 5, 6)) << text;
  EXPECT_EQ(std::abs(poses[0].rotation.w()), 1) << text;
  EXPECT_EQ(std::abs(poses[1].rotation.x()), 1) << text;
}

class EveryTable : public ::testing::TestWithParam<NamedTable> {};
INSTANTIATE_TEST_SUITE_P(Trajectories, EveryTable, ::testing::ValuesIn(Tables()),
                         [](const auto& table) { return std::string(table.param.name); });

TEST_P(EveryTable, IsReadInEveryDialect) {
  const TemporaryFolder folder;
  std::mt19937_64 random(7);
  for (int round = 0; round < 200; ++round) {
    const std::string text = InSomeDialect(GetParam(), random);
    const std::string path = folder.Make("poses" + std::to_string(round) + ".csv", text);
    ExpectPoses(ReadTrajectory(path), text);
  }
}

TEST_P(EveryTable, IsReadAsAnAtlas) {
  std::mt19937_64 random(1);
  const Atlas atlas = DecodeAtlas(InSomeDialect(GetParam(), random));
  ASSERT_EQ(atlas.maps.size(), 1U);
  ASSERT_EQ(atlas.maps[0].keyframes.size(), 2U);
  EXPECT_EQ(CameraCenter(atlas.maps[0].keyframes[1]), Eigen::Vector3f(4, 5, 6));
}

std::string Problem(std::string_view text, const ReadOptions& options = {}) {
  return MessageOf([&] { static_cast<void>(DecodeAtlas(text, options)); });
}

std::string Notes(std::string_view text) {
  Notices notices;
  static_cast<void>(DecodeAtlas(text, {}, &notices));
  return TextOf(notices);
}

TEST(Dialects, WithoutNamesTheTimeTellsWhoseOrderItIs) {
  const TemporaryFolder folder;
  ExpectPoses(ReadTrajectory(
                  folder.Make("euroc.csv", "1700000000250000000,1,2,3,1,0,0,0\n1700000000500000000,4,5,6,0,1,0,0\n")),
              "euroc");
  ExpectPoses(ReadTrajectory(folder.Make("tum.csv", "1700000000.25,1,2,3,0,0,0,1\n1700000000.5,4,5,6,1,0,0,0\n")),
              "tum");
  // ORB-SLAM3's own "EuRoC" output, and its ground truth with decimals of nanoseconds.
  ExpectPoses(ReadTrajectory(folder.Make(
                  "own.txt", "1700000000250000000.000000 1 2 3 0 0 0 1\n1700000000500000000.000000 4 5 6 1 0 0 0\n")),
              "own");
  ExpectPoses(ReadTrajectory(folder.Make(
                  "gt.txt",
                  "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n"
                  "1700000000250000000.0000,1,2,3,1,0,0,0\n1700000000500000000.0000,4,5,6,0,1,0,0\n")),
              "ground truth");
}

TEST(Dialects, LostRowsAreLeftOutAndNamed) {
  EXPECT_THAT(Notes("timestamp,is_lost,x,y,z,q_x,q_y,q_z,q_w\n1,false,0,0,0,0,0,0,1\n2,true,0,0,0,0,0,0,1\n3,true,0,0,"
                    "0,0,0,0,1\n"),
              HasSubstr("tracking was lost there: 2 rows, the first in line 3"));
  EXPECT_THAT(Notes("1 0 0 0 0 0 0 1\n2 nan 0 0 0 0 0 1\n3 0 0 0 0 0 0 0\n"), HasSubstr("2 rows, the first in line 2"));
  EXPECT_THAT(Problem("1 nan 0 0 0 0 0 1\n2 nan 0 0 0 0 0 1\n"), HasSubstr("no pose"));
}

TEST(Dialects, WhatIsNoPoseIsRefused) {
  EXPECT_THAT(Problem("1 0.1 0.2 0.3 255 255 255 0.5\n"), HasSubstr("line 1: expected a quaternion of length 1"));
  EXPECT_THAT(Problem("timestamp,tx [furlong],ty,tz,qx,qy,qz,qw\n1,0,0,0,0,0,0,1\n"),
              HasSubstr("found the unit 'furlong'"));
  EXPECT_THAT(Problem("timestamp,tx,ty,tz,qx,qy,qz,qw\n1;0;0;0;0;0;0\n", {.format = "tum"}), HasSubstr("line 2"));
  EXPECT_THAT(Problem(std::string_view("1 0 0 0 0 0 0 1\n2 0 0 \0 0 0 0 1\n", 32)),
              HasSubstr("line 2: holds a zero byte"));
  EXPECT_THAT(Problem("timestamp;tx;ty;tz;qx;qy;qz;qw\n1,5;0.5;0;0;0;0;0;1\n"), HasSubstr("one decimal mark"));
}

TEST(Dialects, TheUnitOfTimesCanBeGiven) {
  const std::string rows = "0 0 0 0 0 0 0 1\n5 1 0 0 0 0 0 1\n10 1 1 0 0 0 0 1\n";
  EXPECT_THAT(Problem(rows), HasSubstr("seconds or milliseconds"));
  const ReadOptions options = ReadOptions{}.With(TrajectoryReadOptions{.time_unit = TimeUnit::kMilliseconds});
  EXPECT_EQ(DecodeAtlas(rows, options).maps[0].keyframes[2].timestamp, 0.01);
}

// ---- KITTI

constexpr const char* kMatrices = "1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 4 0 -1 0 5 0 0 -1 6\n";

TEST(Kitti, ReadsTimesBesideIt) {
  const TemporaryFolder folder;
  const std::string path = folder.Make("a.kitti", kMatrices);
  folder.Make("a.kitti.times", "1700000000.25\n1700000000.5\n");
  ExpectPoses(ReadTrajectory(path), "a.kitti.times");
  const std::string named = folder.Make("00.txt", kMatrices);
  folder.Make("times.txt", "1.700000000250000000e+09\n1.700000000500000000e+09\n");
  ExpectPoses(ReadTrajectory(named), "times.txt");
  const std::string other = folder.Make("other.times", "1700000000250000000\n1700000000500000000\n");
  ExpectPoses(ReadTrajectory(named, ReadOptions{}.With(TrajectoryReadOptions{.times = other})), "given");
}

TEST(Kitti, FrameNumbersStandForTimesAndThatIsTold) {
  Notices notices;
  const Atlas atlas = DecodeAtlas(kMatrices, {}, &notices);
  EXPECT_EQ(atlas.maps[0].keyframes[1].timestamp, 1);
  EXPECT_THAT(notices.items().at(0).text, HasSubstr("frame numbers stand for seconds"));
}

TEST(Kitti, RefusesWhatIsNoTrajectory) {
  EXPECT_THAT(Problem("1 0 0 1 0 1 0 2 0 0 2 3\n"), HasSubstr("expected a rotation"));
  EXPECT_THAT(Problem("1 0 0 1 0 1 0 2 0 0 -1 3\n"), HasSubstr("expected a rotation"));
  const TemporaryFolder folder;
  const std::string path = folder.Make("a.kitti", kMatrices);
  folder.Make("a.kitti.times", "1\n");
  try {
    static_cast<void>(ReadTrajectory(path));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.kitti.times: holds 1 time for the 2 poses"));
  }
}

TEST(Kitti, ComesBackFromWhatItWrites) {
  const TemporaryFolder folder;
  const std::string path =
      folder.Make("a.tum", "1700000000.123456789 1 2 3 0 0 0 1\n1700000000.987654321 4 5 6 1 0 0 0\n");
  ConvertTrajectory(path, folder.Path("a.kitti"));
  ConvertTrajectory(folder.Path("a.kitti"), folder.Path("b.tum"));
  EXPECT_EQ(ReadFile(folder.Path("b.tum")), "# timestamp tx ty tz qx qy qz qw\n" + ReadFile(path));
}

// ---- digits

TEST(ConvertTrajectory, KeepsEveryDigit) {
  const TemporaryFolder folder;
  const std::string rows =
      "1403636579.763555527 465012.250000123 5247013.500000456 408.000000001 0.7071067811865475 0 0 "
      "0.7071067811865476\n"
      "1403636579.763555528 465012.350000123 5247013.500000456 408.000000001 0.7071067811865475 0 0 "
      "0.7071067811865476\n";
  const std::string path = folder.Make("a.tum", rows);
  Notices notices;
  EXPECT_EQ(ConvertTrajectory(path, folder.Path("b.tum"), {}, {}, &notices), 2U);
  EXPECT_EQ(ReadFile(folder.Path("b.tum")), "# timestamp tx ty tz qx qy qz qw\n" + rows);
  EXPECT_TRUE(notices.items().empty());
  ConvertTrajectory(path, folder.Path("c.euroc.csv"));
  EXPECT_THAT(ReadFile(folder.Path("c.euroc.csv")),
              HasSubstr("\n1403636579763555527,465012.250000123,5247013.500000456,408.000000001,0.7071067811865476,0."
                        "7071067811865475,0,0\n"));
  ConvertTrajectory(folder.Path("c.euroc.csv"), folder.Path("d.tum"));
  EXPECT_EQ(ReadFile(folder.Path("d.tum")), "# timestamp tx ty tz qx qy qz qw\n" + rows);
}

TEST(ConvertTrajectory, WritesWhatIsSelected) {
  const TemporaryFolder folder;
  const std::string path =
      folder.Make("a.tum", "# map 3\n2.5 1 0 0 0 0 0 1\n1.5 0 0 0 0 0 0 1\n# map 4\n5.5 0 0 0 0 0 0 1\n");
  ReadOptions read;
  read.selection.map = MapId(3);
  read.selection.begin_time = 2;
  ConvertTrajectory(path, folder.Path("b.tum"), read);
  EXPECT_EQ(ReadFile(folder.Path("b.tum")), "# timestamp tx ty tz qx qy qz qw\n2.5 1 0 0 0 0 0 1\n");
  ConvertTrajectory(path, folder.Path("c.tum"));
  EXPECT_EQ(
      ReadFile(folder.Path("c.tum")),
      "# timestamp tx ty tz qx qy qz qw\n# map 3\n1.5 0 0 0 0 0 0 1\n2.5 1 0 0 0 0 0 1\n# map 4\n5.5 0 0 0 0 0 0 1\n");
}

TEST(Trajectory, WhatSinglePrecisionLosesIsALoss) {
  Notices notices;
  static_cast<void>(DecodeAtlas("1 465012.25 5247013.3 408 0 0 0 1\n", {}, &notices));
  ASSERT_TRUE(notices.lossy());
  EXPECT_THAT(notices.items().at(0).text, HasSubstr("positions reach 5247013"));
  Notices none;
  static_cast<void>(DecodeAtlas("1 46.123456789 52.3 408 0 0 0 1\n", {}, &none));
  EXPECT_TRUE(none.items().empty());
}

}  // namespace
}  // namespace slamdb
