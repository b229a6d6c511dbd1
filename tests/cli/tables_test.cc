// SPDX-License-Identifier: BSD-3-Clause
// Tables as people have them, through the command: each row here once moved a map wrongly, or was refused.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "slamdb/edit/frame/georeference.h"
#include "slamdb/formats/trajectories.h"
#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"
#include "tests/support/needs_proc.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Tables : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    RunSlamdb(
        {"synthesize", In("a.osa"), "--sensor", "rgbd", "--keyframes", "5", "--points", "60", "--features", "80"});
    RunSlamdb({"convert", In("a.osa"), In("a.tum"), "-q"});
    RunSlamdb({"transform", In("a.osa"), In("a50.osa"), "--scale", "50"});
    poses_ = ReadTrajectory(In("a.tum"));
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string In(const std::string& name) { return *folder_ / name; }

  // A table of the keyframes' poses, a line each.
  static std::string Rows(const std::function<std::string(const TrajectoryPose&)>& row) {
    std::string text;
    for (const TrajectoryPose& pose : poses_) text += row(pose) + "\n";
    return text;
  }
  static std::string Digits(double value, int decimals) {
    std::ostringstream text;
    text.precision(decimals);
    text << std::fixed << value;
    return text.str();
  }
  static std::string Nanoseconds(double seconds) {
    return std::to_string(static_cast<long long>(std::llround((seconds - 1.7e9) * 1e9)) + 1'700'000'000'000'000'000);
  }
  static std::string Place(const TrajectoryPose& pose, const char* separator,
                           const Eigen::Vector3d& offset = {0, 0, 0}) {
    const Eigen::Vector3d x = pose.position + offset;
    return Digits(x.x(), 9) + separator + Digits(x.y(), 9) + separator + Digits(x.z(), 9);
  }
  static std::string Turn(const TrajectoryPose& pose, const char* separator) {
    const Eigen::Quaterniond& q = pose.rotation;
    return Digits(q.x(), 9) + separator + Digits(q.y(), 9) + separator + Digits(q.z(), 9) + separator +
           Digits(q.w(), 9);
  }

  // Lays a.osa onto a reference of this text.
  static ProcessResult Onto(const std::string& text, std::vector<std::string> more = {}) {
    WriteWholeFile(In("reference.txt"), text);
    more.insert(more.begin(), {"transform", In("a.osa"), In("o.osa"), "-O", "--json", "--onto", In("reference.txt")});
    return RunSlamdb(more);
  }
  static void ExpectOnto(const ProcessResult& result, const Eigen::Vector3d& translation = {0, 0, 0},
                         int exit_code = 0) {
    ASSERT_EQ(result.exit_code, exit_code) << result.err;
    const json report = json::parse(result.out);
    EXPECT_EQ(BreachOf(report, "transform.schema.json"), "");
    const json& map = report["maps"][0];
    EXPECT_EQ(map["alignment"]["pairs"], 5);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(map["target_from_source"]["translation"][static_cast<std::size_t>(i)], translation[i], 1e-5);
      EXPECT_NEAR(map["target_from_source"]["rotation_xyzw"][static_cast<std::size_t>(i)], 0, 1e-5);
    }
  }

  // Fixes of the keyframes of a50.osa, with a rotation of east, north, up.
  static Geodetic FixOf(const TrajectoryPose& pose) {
    static const LocalFrame frame({47, 8, 400});
    return frame.ToGeodetic(50 * Eigen::Vector3d(pose.position.x(), pose.position.z(), -pose.position.y()));
  }
  static ProcessResult OntoEarth(const std::string& text, std::vector<std::string> more = {}) {
    WriteWholeFile(In("fixes.csv"), text);
    more.insert(more.begin(),
                {"transform", In("a50.osa"), In("e.osa"), "-O", "--json", "--georeference", In("fixes.csv")});
    return RunSlamdb(more);
  }
  static void ExpectOntoEarth(const ProcessResult& result, int pairs = 5, int inliers = -1) {
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json report = json::parse(result.out);
    EXPECT_EQ(BreachOf(report, "transform.schema.json"), "");
    const json& map = report["maps"][0];
    EXPECT_EQ(map["alignment"]["pairs"], pairs);
    EXPECT_EQ(map["alignment"]["inliers"], inliers < 0 ? pairs : inliers);
    EXPECT_LT(map["alignment"]["residuals"]["rmse"], 0.01);
    EXPECT_NEAR(report["georeference"]["altitude"], 400, 0.01);
    // A quarter turn about x, to the other side.
    EXPECT_NEAR(std::abs(map["target_from_source"]["rotation_xyzw"][0].get<double>()), std::sqrt(0.5), 1e-3);
  }
  static std::string FixRows(const std::string& header, const std::function<std::string(const TrajectoryPose&)>& row) {
    return header + "\n" + Rows(row);
  }
  static std::string PlaceOnEarth(const TrajectoryPose& pose, const char* separator = ",") {
    const Geodetic fix = FixOf(pose);
    return Digits(fix.latitude, 10) + separator + Digits(fix.longitude, 10) + separator + Digits(fix.altitude, 4);
  }

  static std::unique_ptr<TemporaryFolder> folder_;
  static std::vector<TrajectoryPose> poses_;
};
std::unique_ptr<TemporaryFolder> Tables::folder_;
std::vector<TrajectoryPose> Tables::poses_;

TEST_F(Tables, GroundTruthWithDecimalsOfNanoseconds) {
  ExpectOnto(Onto("#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n" +
                  Rows([](const TrajectoryPose& pose) {
                    return Nanoseconds(pose.timestamp) + ".0000000000," + Place(pose, ",") + "," +
                           Digits(pose.rotation.w(), 9) + "," + Digits(pose.rotation.x(), 9) + "," +
                           Digits(pose.rotation.y(), 9) + "," + Digits(pose.rotation.z(), 9);
                  })));
}

TEST_F(Tables, NanosecondsBetweenBlanks) {
  const ProcessResult result = Onto(Rows([](const TrajectoryPose& pose) {
    return Nanoseconds(pose.timestamp) + ".000000 " + Place(pose, " ") + " " + Turn(pose, " ");
  }));
  ExpectOnto(result);
  EXPECT_THAT(result.err, HasSubstr("times are taken as nanoseconds"));
  EXPECT_THAT(RunSlamdb({"info", In("reference.txt")}).out, Not(HasSubstr("277,777")));
  const ProcessResult euroc = RunSlamdb({"convert", In("reference.txt"), In("own.euroc.csv"), "-O"});
  EXPECT_EQ(euroc.exit_code, 0) << euroc.err;
  EXPECT_THAT(euroc.out, HasSubstr("5 poses"));
}

TEST_F(Tables, ByteOrderMarkAndCarriageReturns) {
  const std::string text = ReadWholeFile(In("a.tum"));
  ExpectOnto(Onto("\xef\xbb\xbf" + text));
  std::string old = text;
  std::ranges::replace(old, '\n', '\r');
  ExpectOnto(Onto(old));
  std::string wide = "\xff\xfe";
  for (const char letter : text) wide += std::string{letter, '\0'};
  WriteWholeFile(In("wide.tum"), wide);
  EXPECT_THAT(RunSlamdb({"transform", In("a.osa"), In("o.osa"), "-O", "--onto", In("wide.tum")}).err,
              HasSubstr("UTF-16"));
}

TEST_F(Tables, CommasAndAHeader) {
  const auto row = [](const TrajectoryPose& pose) {
    return "+" + Digits(pose.timestamp, 3) + "," + Place(pose, ",") + "," + Turn(pose, ",");
  };
  ExpectOnto(Onto("timestamp,tx,ty,tz,qx,qy,qz,qw\n" + Rows(row)));
}

TEST_F(Tables, AReferenceFarFromTheOriginTurnsNothing) {
  const Eigen::Vector3d utm(465012.25, 5247013.5, 408);
  const ProcessResult result = Onto(Rows([&](const TrajectoryPose& pose) {
    return Digits(pose.timestamp, 3) + " " + Place(pose, " ", utm) + " " + Turn(pose, " ");
  }));
  ExpectOnto(result, utm, 3);
  EXPECT_THAT(result.err, HasSubstr("loss: map 0: coordinates reach"));
}

// A stream keeps its digits, too: by way of an atlas it would turn the map.
TEST_F(Tables, AReferenceFarFromTheOriginMayBeAStream) {
  SLAMDB_NEEDS_PROC();
  const Eigen::Vector3d utm(465012.25, 5247013.5, 408);
  const std::string text = Rows([&](const TrajectoryPose& pose) {
    return Digits(pose.timestamp, 3) + " " + Place(pose, " ", utm) + " " + Turn(pose, " ");
  });
  WriteWholeFile(In("utm.tum"), text);
  ExpectOnto(RunProgram({"bash", "-c",
                         std::string(SLAMDB_COMMAND) + " transform " + In("a.osa") + " " + In("o.osa") +
                             " -O --json --onto <(cat " + In("utm.tum") + ")"}),
             utm, 3);
  ASSERT_EQ(RunSlamdb({"convert", In("utm.tum"), In("file.tum"), "-O"}).exit_code, 0);
  for (const std::vector<std::string>& from : std::vector<std::vector<std::string>>{{}, {"--from", "tum"}}) {
    std::vector<std::string> line = {"convert", "-", In("stream.tum"), "-O"};
    line.insert(line.end(), from.begin(), from.end());
    const ProcessResult result = RunSlamdb(line, text);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(ReadWholeFile(In("stream.tum")), ReadWholeFile(In("file.tum")));
  }
}

TEST_F(Tables, NothingSelectedIsNoSuccess) {
  WriteWholeFile(In("old.tum"), "old");
  for (const std::vector<std::string>& none :
       std::vector<std::vector<std::string>>{{"--time", "1:2"}, {"--map", "7"}, {"--keyframes", "900:"}}) {
    std::vector<std::string> line = {"convert", In("a.tum"), In("old.tum"), "-O"};
    line.insert(line.end(), none.begin(), none.end());
    EXPECT_EQ(RunSlamdb(line).exit_code, 1) << none[0];
    EXPECT_EQ(ReadWholeFile(In("old.tum")), "old");
  }
  WriteWholeFile(In("far.tum"), "1e11 0 0 0 0 0 0 1\n5 0 0 0 0 0 0 1\n");
  EXPECT_THAT(RunSlamdb({"convert", In("far.tum"), In("far.euroc.csv"), "--time-unit", "s"}).out,
              HasSubstr(": 1 pose"));
}

TEST_F(Tables, PointsAreNoPoses) {
  const ProcessResult result = Onto("# 3D point list\n1 0.1 0.2 0.3 255 255 255 0.5\n2 0.4 0.5 0.6 10 20 30 0.7\n");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("length 1"));
}

TEST_F(Tables, AClockThatIsAhead) {
  const std::string text = Rows([](const TrajectoryPose& pose) {
    return Digits(pose.timestamp + 3600.05, 6) + " " + Place(pose, " ") + " " + Turn(pose, " ");
  });
  const ProcessResult none = Onto(text);
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err,
              AllOf(HasSubstr("3600.050 s"), HasSubstr("--time-offset"), HasSubstr("--estimate-time-offset")));
  ExpectOnto(Onto(text, {"--time-offset", "3600.05"}));
  const ProcessResult estimated = Onto(text, {"--estimate-time-offset"});
  ExpectOnto(estimated);
  EXPECT_NEAR(json::parse(estimated.out)["maps"][0]["alignment"]["time_offset"], 3600.05, 1e-3);
  EXPECT_EQ(Onto(text, {"--time-offset", "1", "--estimate-time-offset"}).exit_code, 2);
}

TEST_F(Tables, TimesThatCannotBeToldNeedTheirUnit) {
  const auto text = [](const char* step) {
    return std::string("0 0 0 0 0 0 0 1\n") + step + " 1 0 0 0 0 0 1\n1" + step + "0 1 1 0 0 0 0 1\n";
  };
  const ProcessResult result = Onto("0 0 0 0 0 0 0 1\n5 1 0 0 0 0 0 1\n10 1 1 0 0 0 0 1\n");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("seconds or milliseconds"), HasSubstr("--time-unit")));
  WriteWholeFile(In("ms.tum"), text("5"));
  EXPECT_EQ(RunSlamdb({"convert", In("ms.tum"), In("s.tum"), "-O", "--time-unit", "ms"}).exit_code, 0);
  EXPECT_THAT(ReadWholeFile(In("s.tum")), HasSubstr("\n0.005 1 0 0 0 0 0 1\n"));
}

// Positions are laid onto each other whatever the order of the quaternions is; a map that is made of them needs it.
TEST_F(Tables, QuaternionsOfEitherOrder) {
  const std::string text = Rows([](const TrajectoryPose& pose) {
    return Digits(pose.timestamp, 3) + "," + Place(pose, ",") + ",0.1,0.7,0.1,0.7";
  });
  ExpectOnto(Onto(text));
  const ProcessResult result = RunSlamdb({"convert", In("reference.txt"), In("order.tum"), "-O"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("--from tum or euroc settles it"));
  EXPECT_EQ(RunSlamdb({"convert", In("reference.txt"), In("order.tum"), "-O", "--from", "euroc"}).exit_code, 0);
  EXPECT_THAT(ReadWholeFile(In("order.tum")), HasSubstr(" 0.7 0.1 0.7 0.1\n"));
}

TEST_F(Tables, HemispheresInColumnsOfAnyName) {
  const ProcessResult result = OntoEarth(
      FixRows("timestamp,Latitude,LatitudeRef,Longitude,LongitudeRef,Altitude", [](const TrajectoryPose& pose) {
        const Geodetic fix = FixOf(pose);
        return Digits(pose.timestamp, 3) + "," + Digits(fix.latitude, 10) + ",S," + Digits(fix.longitude, 10) + ",W," +
               Digits(fix.altitude, 4);
      }));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_LT(json::parse(result.out)["georeference"]["latitude"], -46);
  EXPECT_LT(json::parse(result.out)["georeference"]["longitude"], -7);
}

TEST_F(Tables, FixesInEveryUnit) {
  const auto seconds = [](const TrajectoryPose& pose) { return Digits(pose.timestamp, 3) + "," + PlaceOnEarth(pose); };
  ExpectOntoEarth(OntoEarth(FixRows("timestamp,latitude,longitude,altitude", seconds)));
  ExpectOntoEarth(OntoEarth(FixRows("timestamp,latitude,longitude,altitude_ft", [](const TrajectoryPose& pose) {
    const Geodetic fix = FixOf(pose);
    return Digits(pose.timestamp, 3) + "," + Digits(fix.latitude, 10) + "," + Digits(fix.longitude, 10) + "," +
           Digits(fix.altitude / 0.3048, 4);
  })));
  ExpectOntoEarth(OntoEarth(FixRows("timestamp_ns,latitude,longitude,altitude", [](const TrajectoryPose& pose) {
    return Nanoseconds(pose.timestamp) + "," + PlaceOnEarth(pose);
  })));
  ExpectOntoEarth(OntoEarth(FixRows("timestamp;latitude;longitude;altitude", [](const TrajectoryPose& pose) {
    std::string row = Digits(pose.timestamp, 3) + ";+" + PlaceOnEarth(pose, ";+");
    std::ranges::replace(row, '.', ',');
    return row;
  })));
}

TEST_F(Tables, FixesOfRostopic) {
  ExpectOntoEarth(OntoEarth(
      FixRows("%time,field.header.seq,field.header.stamp,field.header.frame_id,field.status.status,field.latitude,"
              "field.longitude,field.altitude,field.position_covariance0",
              [](const TrajectoryPose& pose) {
                return Nanoseconds(pose.timestamp + 0.5) + ",0," + Nanoseconds(pose.timestamp) + ",gps,0," +
                       PlaceOnEarth(pose) + ",1";
              })));
}

TEST_F(Tables, ReceiversWithoutAFixMoveNothing) {
  for (const char* no_fix : {"0.0,0.0,0.0", "nan,nan,nan", ",,"}) {
    int row = 0;
    const ProcessResult result =
        OntoEarth(FixRows("timestamp,latitude,longitude,altitude", [&](const TrajectoryPose& pose) {
          return Digits(pose.timestamp, 3) + "," + (row++ == 1 ? no_fix : PlaceOnEarth(pose));
        }));
    ExpectOntoEarth(result, 4);
    EXPECT_THAT(result.err, HasSubstr("no fix: 1 row of 5"));
  }
}

TEST_F(Tables, AnOutlierMovesNothingAndIsNamed) {
  int row = 0;
  const ProcessResult result =
      OntoEarth(FixRows("timestamp,latitude,longitude,altitude", [&](const TrajectoryPose& pose) {
        return Digits(pose.timestamp, 3) + "," + (row++ == 2 ? "40,8,400" : PlaceOnEarth(pose));
      }));
  ExpectOntoEarth(result, 5, 4);
  EXPECT_THAT(result.err, AllOf(HasSubstr("1 pair of 5"), HasSubstr("gross outliers"), HasSubstr("--robust")));
}

TEST_F(Tables, LatitudesBeyondThePole) {
  const ProcessResult result = OntoEarth("timestamp,latitude,longitude,altitude\n1,153,47,400\n2,153.1,47,400\n");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(
      result.err,
      HasSubstr("line 2: no row has a fix: latitude 153 is outside -90 to 90; are latitude and longitude swapped?"));
}

TEST_F(Tables, AnchorsAsPeopleWriteThem) {
  for (const char* text : {"\xef\xbb\xbf"
                           "first,second\r\n0,0\r\n2,2\r\n4,4\r\n",
                           "0,0\n2,2\n4,4\n", "first;second\n0;0\n2;2\n4;4\n", "First, Second\n0, 0\n2, 2\n4, 4",
                           "first second\r0 0\r2 2\r4 4\r", "# pairs\n% first\tsecond\n+0\t+0\n2\t2\n4\t4\n",
                           "\"first\",\"second\",\"who\"\n\"0\",\"0\",\"a, b\"\n2,2,\n4,4,\n"}) {
    WriteWholeFile(In("anchors.csv"), text);
    const ProcessResult result = RunSlamdb({"merge", In("a.osa"), In("a.osa"), "-o", In("j.osa"), "-O", "--join",
                                            "--anchors", In("anchors.csv"), "--json"});
    ASSERT_EQ(result.exit_code, 0) << text << result.err;
    EXPECT_THAT(result.out, HasSubstr("\"rmse\""));
  }
}

// A shorter number is a number, too: the tables are read, and what they do is wrong.
TEST_F(Tables, CutInTheirLastNumberAreSaid) {
  const std::string table = In("open.csv"), ids = In("open-ids.csv");
  RunSlamdb({"synthesize", In("b.osa"), "--sensor", "rgbd", "--keyframes", "12", "--points", "60", "--features", "80"});
  RunSlamdb({"transform", In("b.osa"), In("moved.osa"), "--by", "1,0,0,0,0,0,1"});
  RunSlamdb({"renumber", In("a.osa"), In("o.osa"), "-O", "--start", "50", "--id-map", ids});
  int quarter = 0;
  const std::string fixes =
      "timestamp,latitude,longitude,altitude\n" + Rows([&](const TrajectoryPose& pose) {
        const double east = 1e-5 * ++quarter, north = 1e-5 * quarter * quarter;
        return Digits(pose.timestamp, 2) + "," + Digits(47 + north, 8) + "," + Digits(8 + east, 8) + ",400.25";
      });
  const std::string anchors = "first,second\n0,0\n3,3\n6,6\n9,9\n11,11\n";
  const std::string constraints = "first,second,qx,qy,qz,qw,tx,ty,tz\n0,3,0,0,0,1,0.1,0.1,0.25\n";
  const std::string out = In("o.osa");
  struct Case {
    std::string text;
    std::vector<std::string> command;
  };
  for (const Case& each :
       {Case{fixes, {"transform", In("a.osa"), out, "-O", "--georeference", table}},
        Case{anchors, {"merge", In("b.osa"), In("moved.osa"), "-o", out, "-O", "--join", "--anchors", table}},
        Case{constraints, {"optimize", In("a.osa"), out, "-O", "--constraints", table}},
        Case{ReadWholeFile(ids), {"renumber", In("a.osa"), out, "-O", "--apply", table}}}) {
    SCOPED_TRACE(each.command[0]);
    const std::string warning =
        "slamdb: warning: " + table + ": the last line has no end of line: the file may be cut there";
    WriteWholeFile(table, each.text);
    const ProcessResult whole = RunSlamdb(each.command);
    EXPECT_EQ(whole.exit_code, 0) << whole.err;
    EXPECT_THAT(whole.err, Not(HasSubstr(warning)));
    WriteWholeFile(table, each.text.substr(0, each.text.size() - 2));
    EXPECT_THAT(RunSlamdb(each.command).err, HasSubstr(warning));
  }
}

TEST_F(Tables, ATransformFileAsPeopleWriteIt) {
  for (const char* text : {"\xef\xbb\xbf"
                           "1 2 3 0 0 0 1\r\n",
                           "1,2,3,0,0,0,1", "+1;+2;+3;0;0;0;+1\n", "# tx ty tz\r1\t2\t3\t0\t0\t0\t1\r",
                           "1 0 0 1\n0 1 0 2\n0 0 1 3\n0 0 0 1\n"}) {
    WriteWholeFile(In("t.txt"), text);
    const ProcessResult result =
        RunSlamdb({"transform", In("a.osa"), In("o.osa"), "-O", "--json", "--by", In("t.txt")});
    ASSERT_EQ(result.exit_code, 0) << text << result.err;
    EXPECT_EQ(json::parse(result.out)["maps"][0]["target_from_source"]["translation"], json({1.0, 2.0, 3.0})) << text;
  }
}

TEST_F(Tables, WhatIsNoReferenceIsNamed) {
  WriteWholeFile(In("lacking.csv"), "time,x,y,z,qx,qy,qz\n1,2,3,4,0,0,0\n");
  EXPECT_THAT(RunSlamdb({"transform", In("a.osa"), In("o.osa"), "-O", "--onto", In("lacking.csv")}).err,
              HasSubstr("neither an atlas nor a trajectory: no column is named qw"));
  EXPECT_THAT(OntoEarth("<?xml version=\"1.0\"?>\n<gpx version=\"1.1\"><trk/></gpx>\n").err,
              AllOf(HasSubstr("GPX track"), HasSubstr("gpsbabel")));
  EXPECT_THAT(OntoEarth("<kml><Placemark/></kml>\n").err, AllOf(HasSubstr("KML track"), HasSubstr("gpsbabel")));
  WriteWholeFile(In("no_times.kitti"), "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n1 0 0 2 0 1 0 0 0 0 1 1\n");
  const ProcessResult result = RunSlamdb({"transform", In("a.osa"), In("o.osa"), "-O", "--onto", In("no_times.kitti")});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("times are frame numbers, 0, 1, 2"), HasSubstr("give --times")));
}

TEST_F(Tables, OptionsWithoutEffectAreRefused) {
  const auto expect = [](const std::vector<std::string>& arguments, const char* message) {
    const ProcessResult result = RunSlamdb(arguments);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  const std::string a = In("a.osa"), o = In("idle.osa");
  expect({"transform", a, o, "--scale", "2", "--body"}, "--body is for --onto and --georeference only");
  expect({"transform", a, o, "--by", "1 2 3 0 0 0 1", "--time-unit", "ns"}, "--time-unit is for --onto");
  expect({"transform", a, o, "--onto", In("a.tum"), "--times", "t.txt"}, "--times is for KITTI trajectories only");
  expect({"transform", a, o, "--onto", a, "--time-unit", "ns"}, "--time-unit is for trajectories only");
  expect({"convert", a, o, "--body"}, "--body is for trajectories only");
  expect({"convert", a, In("idle.tum"), "--boost-version", "12"}, "--boost-version is for archives of ORB-SLAM3 only");
  expect({"convert", a, In("idle.tum"), "--time-unit", "ns"}, "--time-unit is for trajectories only");
  expect({"convert", In("a.tum"), In("idle.kitti"), "--times", "t.txt"}, "--times is for KITTI trajectories only");
}

}  // namespace
}  // namespace slamdb::testing
