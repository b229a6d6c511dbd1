// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>

#include "slamdb/formats/formats.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";
const std::string kTinyText = SLAMDB_FIXTURES "/tiny/tiny_text.osa";

TEST(Convert, KeepsEveryByte) {
  const TemporaryFolder folder;
  const ProcessResult result = RunSlamdb({"convert", kTiny, folder / "copy.osa"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, StartsWith("wrote " + (folder / "copy.osa")));
  EXPECT_EQ(ReadWholeFile(folder / "copy.osa"), ReadWholeFile(kTiny));
}

TEST(Convert, TextAndBack) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"convert", kTiny, folder / "text.osa", "--text"}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(folder / "text.osa"), ReadWholeFile(kTinyText));
  ASSERT_EQ(RunSlamdb({"convert", folder / "text.osa", folder / "binary.osa", "--to", "orbslam3"}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(folder / "binary.osa"), ReadWholeFile(kTiny));
}

TEST(Convert, ByWayOfAStore) {
  const TemporaryFolder folder;
  const std::string stored = (folder / "lab.db") + "#tiny map";
  ASSERT_EQ(RunSlamdb({"convert", kTiny, stored}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"convert", stored, folder / "back.osa"}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(folder / "back.osa"), ReadWholeFile(kTiny));
}

TEST(Convert, StandardInputAndOutput) {
  const ProcessResult result =
      RunSlamdb({"convert", "-", "-", "--from", "orbslam3", "--to", "orbslam3"}, ReadWholeFile(kTiny));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(result.out == ReadWholeFile(kTiny));
}

TEST(Convert, RefusesToOverwrite) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "there.osa", "precious");
  const ProcessResult refused = RunSlamdb({"convert", kTiny, folder / "there.osa"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("--overwrite"));
  EXPECT_EQ(ReadWholeFile(folder / "there.osa"), "precious");
  EXPECT_EQ(RunSlamdb({"convert", kTiny, folder / "there.osa", "-O"}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(folder / "there.osa"), ReadWholeFile(kTiny));
}

TEST(Convert, NeverWritesItsInput) {
  const TemporaryFolder folder;
  const std::string path = folder / "map.osa", link = folder / "link.osa", before = ReadWholeFile(kTiny);
  WriteWholeFile(path, before);
  std::filesystem::create_symlink(path, link);
  for (const std::string& output : {path, link}) {
    const ProcessResult result = RunSlamdb({"convert", path, output, "-O", "--boost-version", "12"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr("is the input"));
  }
  EXPECT_EQ(ReadWholeFile(path), before);
}

TEST(Convert, AnExportIsDoneAndSaysInOneLineWhatItHolds) {
  const TemporaryFolder folder;
  for (const char* format : {"ply", "pcd", "csv", "csv-keyframes", "csv-observations", "tum", "kitti", "euroc"}) {
    SCOPED_TRACE(format);
    const std::string output = folder / format;
    const ProcessResult result = RunSlamdb({"convert", kTiny, output, "--to", format});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("slamdb: loss: ")));
    EXPECT_THAT(result.out, ContainsRegex("^wrote " + output + ": [1-9][0-9,]* (points|poses|keyframes|observations)"));
    EXPECT_EQ(std::ranges::count(result.out, '\n'), 1);
    EXPECT_TRUE(std::filesystem::exists(output));
    const ProcessResult quiet = RunSlamdb({"convert", kTiny, output, "--to", format, "-O", "-q"});
    EXPECT_EQ(quiet.exit_code, 0);
    EXPECT_EQ(quiet.out + quiet.err, "");
    EXPECT_EQ(RunSlamdb({"convert", kTiny, output, "--to", format, "-O", "--strict"}).exit_code, 1);
    const ProcessResult piped = RunSlamdb({"convert", kTiny, "-", "--to", format});
    EXPECT_THAT(piped.err, HasSubstr("slamdb: note: wrote "));
  }
}

TEST(Convert, LossOfWhatClaimsToHoldAnAtlasIsNamedAndExitsThree) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"landmarks", "from-points", kTiny, folder / "a.db"}).exit_code, 0);
  const ProcessResult result = RunSlamdb({"convert", folder / "a.db", folder / "a.mrpt"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("slamdb: loss: mrpt cannot hold keyframe poses"));
}

TEST(Convert, StrictRefusesLossAndWritesNothing) {
  const TemporaryFolder folder;
  const ProcessResult result = RunSlamdb({"convert", kTiny, folder / "points.ply", "--strict"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("slamdb: error: "));
  EXPECT_FALSE(std::filesystem::exists(folder / "points.ply"));
}

TEST(Convert, StrictRefusesWhatTheReaderLeavesOut) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "longer.osa", ReadWholeFile(kTiny) + "behind the end");
  EXPECT_EQ(RunSlamdb({"convert", folder / "longer.osa", folder / "copy.osa"}).exit_code, 3);
  const ProcessResult result = RunSlamdb({"convert", folder / "longer.osa", folder / "strict.osa", "--strict"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("14 bytes behind the end"));
  EXPECT_FALSE(std::filesystem::exists(folder / "strict.osa"));
}

TEST(Convert, WritesTheBoostVersionAndLongThatAreNamed) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"convert", kTiny, folder / "old.osa", "--boost-version", "11", "--long-bytes", "4"}).exit_code,
            0);
  const std::string bytes = ReadWholeFile(folder / "old.osa");
  EXPECT_EQ(bytes.at(0x1e), 11);
  EXPECT_EQ(bytes.at(0x21), 4);
  ASSERT_EQ(RunSlamdb({"convert", folder / "old.osa", folder / "new.osa", "--boost-version",
                       std::to_string(ReadWholeFile(kTiny).at(0x1e)), "--long-bytes", "8"})
                .exit_code,
            0);
  EXPECT_EQ(ReadWholeFile(folder / "new.osa"), ReadWholeFile(kTiny));
}

TEST(Convert, UnknownSuffixNamesTheKnownOnes) {
  const ProcessResult result = RunSlamdb({"convert", kTiny, "map.xyzzy"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr(".osa"));
}

TEST(Convert, MapThatIsNotThere) {
  const TemporaryFolder folder;
  const ProcessResult result = RunSlamdb({"convert", kTiny, folder / "out.osa", "--map", "77"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("77"));
}

TEST(Convert, PartOfAMapIsWrittenWithAWarning) {
  const TemporaryFolder folder;
  const ProcessResult part = RunSlamdb({"convert", kTiny, folder / "part.osa", "--keyframes", "0:0"});
  EXPECT_EQ(part.exit_code, 0) << part.err;
  EXPECT_THAT(part.err, HasSubstr("only the selected part"));
  EXPECT_THAT(part.out, HasSubstr("1 keyframe,"));
  const ProcessResult whole = RunSlamdb({"convert", kTiny, folder / "whole.osa", "--map", "0"});
  EXPECT_EQ(whole.err, "");
}

TEST(Convert, TextAndToExcludeEachOther) {
  EXPECT_EQ(RunSlamdb({"convert", kTiny, "out.osa", "--text", "--to", "orbslam3"}).exit_code, 2);
}

TEST(Convert, PathsWithBlanksAndQuotes) {
  const TemporaryFolder folder;
  const std::string odd = folder / "it's \"my\" $map; #1.osa";
  WriteWholeFile(odd, ReadWholeFile(kTiny));
  EXPECT_EQ(RunSlamdb({"info", odd}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"convert", odd, folder / "out put.osa"}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(folder / "out put.osa"), ReadWholeFile(kTiny));
}

// The archive version in the header, and which names mean it.
TEST(Convert, BoostVersionByName) {
  const TemporaryFolder folder;
  const std::pair<const char*, unsigned char> cases[] = {
      {"1.53", 10},   {"1.57", 11},        {"1.58.0", 12},   {"ubuntu16.04", 12}, {"kinetic", 12},  {"1.59", 13},
      {"1.63", 14},   {"ubuntu18.04", 15}, {"melodic", 15},  {"1.67", 16},        {"1.71", 17},     {"ubuntu20.04", 17},
      {"noetic", 17}, {"debian11", 18},    {"debian13", 19}, {"stretch", 14},     {"debian12", 18}, {"humble", 18},
      {"1.74.0", 18}, {"ubuntu24.04", 19}, {"jazzy", 19},    {"1.85", 20},        {"12", 12},       {"20", 20}};
  for (const auto& [name, version] : cases) {
    ASSERT_EQ(RunSlamdb({"convert", kTiny, folder / "out.osa", "-O", "--boost-version", name}).exit_code, 0) << name;
    EXPECT_EQ(static_cast<unsigned char>(ReadWholeFile(folder / "out.osa").at(0x1e)), version) << name;
  }
  ASSERT_EQ(RunSlamdb({"extract", kTiny, folder / "part.osa", "--map", "0", "--boost-version", "focal"}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(folder / "part.osa").at(0x1e), 17) << "in every verb that writes one";
  EXPECT_EQ(RunSlamdb({"extract", kTiny, folder / "part.db", "--map", "0", "--boost-version", "focal"}).exit_code, 2);
}

TEST(Convert, ReportsAsJsonAndDry) {
  using nlohmann::json;
  const TemporaryFolder folder;
  const std::string out = folder / "out.osa";
  json dry = json::parse(RunSlamdb({"convert", kTiny, out, "--json", "--dry-run"}).out);
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_EQ(BreachOf(dry, "convert.schema.json"), "");
  EXPECT_TRUE(dry.at("output").is_null());
  json wet = json::parse(RunSlamdb({"convert", kTiny, out, "--json"}).out);
  EXPECT_EQ(BreachOf(wet, "convert.schema.json"), "");
  EXPECT_EQ(wet.at("output"), out);
  EXPECT_EQ(wet.at("bytes"), std::filesystem::file_size(out));
  dry["output"] = out;
  EXPECT_EQ(dry, wet);
  EXPECT_EQ(wet.at("maps"), 1);
  EXPECT_EQ(wet.at("keyframes"), 2);
  EXPECT_EQ(wet.at("points"), 2);
  const json poses = json::parse(RunSlamdb({"convert", kTiny, folder / "a.tum", "--json"}).out);
  EXPECT_EQ(poses.at("keyframes"), 2);
  EXPECT_EQ(poses.at("points"), 0);  // a trajectory has none
  EXPECT_EQ(poses.at("format"), "tum");
  const json again = json::parse(RunSlamdb({"convert", folder / "a.tum", folder / "b.tum", "--json", "--dry-run"}).out);
  EXPECT_EQ(BreachOf(again, "convert.schema.json"), "");
  EXPECT_TRUE(again.at("maps").is_null());
  EXPECT_EQ(again.at("keyframes"), 2);
  const json store = json::parse(RunSlamdb({"convert", kTiny, folder / "m.db", "--json", "--dry-run"}).out);
  EXPECT_TRUE(store.at("bytes").is_null());
  EXPECT_THAT(RunSlamdb({"convert", kTiny, out, "--dry-run"}).out, ::testing::StartsWith("would write "));
}

// Folders and formats of several files, too: what is counted, lost and warned of is the same.
TEST(Convert, SaysTheSameInADryRun) {
  using nlohmann::json;
  const TemporaryFolder folder;
  const std::string map = folder / "a.osa", tum = folder / "a.tum";
  Atlas atlas =
      SynthesizeAtlas({.sensor = Sensor::kFisheyeStereo, .maps = 2, .keyframes = 8, .points = 100, .features = 150});
  atlas.maps[0].keyframes[1].camera_from_world.rotation.coeffs().setZero();
  atlas.maps[0].points[2].bad = true;
  WriteAtlas(atlas, map);
  ASSERT_EQ(RunSlamdb({"convert", map, tum}).exit_code, 0);
  for (const std::string& input : {map, tum})
    for (const std::string format :
         {"colmap", "colmap-text", "colmap-database", "3dgs", "nerf", "osmap", "kitti", "euroc", "g2o", "stella"}) {
      SCOPED_TRACE(input + " as " + format);
      const TemporaryFolder outputs;
      const std::string output = outputs / "out";
      const auto run = [&](const char* more) {
        std::vector<std::string> words = {"convert", input, output, "--to", format, "--json"};
        if (*more != 0) words.push_back(more);
        return RunSlamdb(words);
      };
      const ProcessResult dry = run("--dry-run");
      EXPECT_THAT(outputs.Names(), ::testing::IsEmpty());
      const ProcessResult wet = run("");
      if (wet.exit_code == 1) continue;  // it would hold nothing, of which a dry run warns
      EXPECT_EQ(dry.exit_code, wet.exit_code) << dry.err << wet.err;
      EXPECT_EQ(dry.err, wet.err);
      json of_dry = json::parse(dry.out);
      of_dry["output"] = output;
      EXPECT_EQ(of_dry, json::parse(wet.out));
    }
}

TEST(Convert, ColoursAndCamerasOfPoints) {
  const TemporaryFolder folder;
  const ProcessResult result =
      RunSlamdb({"convert", kTiny, folder / "a.ply", "--color", "observations", "--cameras", "--ascii"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("note: colours tell observations from "));
  EXPECT_THAT(result.out, HasSubstr(" poses\n"));
  EXPECT_THAT(ReadWholeFile(folder / "a.ply"), HasSubstr("element edge "));
}

// What would have no effect.
TEST(Convert, RefusesOptionsOfOtherViewers) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::vector<std::string>& options, const std::string& output, const char* problem) {
    std::vector<std::string> words = {"convert", kTiny, folder / output};
    words.insert(words.end(), options.begin(), options.end());
    const ProcessResult result = RunSlamdb(words);
    EXPECT_EQ(result.exit_code, 2) << output;
    EXPECT_THAT(result.err, HasSubstr(problem));
    EXPECT_FALSE(std::filesystem::exists(folder / output));
  };
  expect({"--color", "age"}, "a.tum", "--color is for PLY, PCD, glTF and MCAP only; the output is TUM trajectory");
  expect({"--color", "rainbow"}, "a.ply", "--color");
  expect({"--cameras"}, "a.pcd", "--cameras is for PLY only");
  expect({"--cameras"}, "a.glb", "the output is glTF scene, which always has them");
  expect({"--origin", "48,11"}, "a.glb", "--origin and --most-points are for KML and GeoJSON only");
  expect({"--most-points", "5"}, "a.ply", "--origin and --most-points are for KML and GeoJSON only");
  expect({}, "a.geojson", "a GeoJSON map needs --origin LAT,LON,ALT");
}

TEST(Convert, RefusesAnOriginThatIsNoPlace) {
  for (const char* origin : {"north", "0", "91,0", "nan,0", "1,2,3,4", "0,0,1e300"}) {
    const ProcessResult result = RunSlamdb({"convert", kTiny, "-", "--to", "kml", "--origin", origin});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("a place is LATITUDE,LONGITUDE[,ALTITUDE]"));
    EXPECT_EQ(result.out, "");
  }
}

TEST(Convert, SaysWhichLongitudeIsWritten) {
  const ProcessResult result = RunSlamdb({"convert", kTiny, "-", "--to", "kml", "--origin", "1,181"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("note: the longitude 181 is written as -179"));
}

TEST(Convert, RefusesValuesThatAreNone) {
  const TemporaryFolder folder;
  const auto code = [&](const char* output, const char* option, const char* value) {
    return RunSlamdb({"convert", kTiny, folder / output, option, value}).exit_code;
  };
  EXPECT_EQ(code("a.kml", "--most-points", "-1"), 2);
  EXPECT_EQ(code("a.ply", "--color", ""), 2);
  EXPECT_EQ(code("a.ply", "--color", "never"), 0);
  EXPECT_EQ(code("a.osa", "--boost-version", "1.075"), 2);
}

TEST(Convert, WarnsThatAnOriginByHandTakesTheFrameAsOneOnEarth) {
  const TemporaryFolder folder;
  ASSERT_EQ(
      RunSlamdb({"synthesize", folder / "mono.osa", "--sensor", "monocular", "--keyframes", "6", "--points", "100"})
          .exit_code,
      0);
  const ProcessResult result = RunSlamdb({"convert", folder / "mono.osa", folder / "a.kml", "--origin", "48.15,11.57"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("is taken as east, north and up in metres"));
  EXPECT_THAT(result.err, HasSubstr("map 0 has no scale"));
}

TEST(Convert, FindsTheOriginBesideTheInput) {
  const TemporaryFolder folder;
  std::filesystem::copy_file(kTiny, folder / "enu.osa");
  const auto convert = [&] { return RunSlamdb({"convert", folder / "enu.osa", folder / "a.geojson", "-O"}); };
  WriteWholeFile(folder / "enu.osa.georeference.json",
                 R"({"maps": [{"id": 0}], "georeference": {"latitude": 48.15, "longitude": 11.57, "altitude": 519}})");
  const ProcessResult found = convert();
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_THAT(found.err, Not(HasSubstr("is taken as")));
  EXPECT_THAT(found.err, HasSubstr("note: the origin is that of " + (folder / "enu.osa.georeference.json")));
  EXPECT_THAT(found.err, Not(HasSubstr("not georeferenced")));
  EXPECT_THAT(ReadWholeFile(folder / "a.geojson"), HasSubstr("[11.57000"));
  WriteWholeFile(folder / "enu.osa.georeference.json",
                 R"({"maps": [{"id": 7}], "georeference": {"latitude": 48.15, "longitude": 11.57, "altitude": 519}})");
  EXPECT_THAT(convert().err, HasSubstr("map 0 was not georeferenced"));
  for (const char* broken :
       {"{}", "[", R"({"maps": [], "georeference": {"latitude": 99, "longitude": 0, "altitude": 0}})",
        R"({"maps": [{"id": -1}], "georeference": {"latitude": 9, "longitude": 0, "altitude": 0}})"}) {
    WriteWholeFile(folder / "enu.osa.georeference.json", broken);
    EXPECT_EQ(convert().exit_code, 1) << broken;
  }
}

const std::string kSession = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";

TEST(Convert, PosesThatNobodyMovedGiveTheSameBytes) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--sim3"}}) {
    std::vector<std::string> there = {"convert", kSession, folder / "map.g2o", "-O"};
    there.insert(there.end(), more.begin(), more.end());
    ASSERT_EQ(RunSlamdb(there).exit_code, 0);
    const ProcessResult back =
        RunSlamdb({"convert", folder / "map.g2o", folder / "back.osa", "-O", "--onto", kSession});
    EXPECT_EQ(back.exit_code, 0) << back.err;
    EXPECT_THAT(back.err, HasSubstr("put 14 poses and 0 points into " + kSession));
    EXPECT_EQ(ReadWholeFile(folder / "back.osa"), ReadWholeFile(kSession));
  }
}

// Of a trajectory by time; of another atlas by id, with its points.
TEST(Convert, TakesPosesOfAnyInputOntoAnAtlas) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"transform", kSession, folder / "moved.osa", "--by", "1,2,3,0,0,0,1"}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"convert", folder / "moved.osa", folder / "moved.tum"}).exit_code, 0);
  for (const std::string name : {"moved.tum", "moved.osa"}) {
    const ProcessResult put = RunSlamdb({"convert", folder / name, folder / "put.osa", "-O", "--onto", kSession});
    ASSERT_EQ(put.exit_code, 0) << put.err;
    EXPECT_THAT(put.err, HasSubstr("the largest shift of a camera is 3.74"));
    const ProcessResult again =
        RunSlamdb({"convert", folder / "moved.osa", folder / "again.osa", "-O", "--onto", folder / "put.osa"});
    EXPECT_THAT(again.err, ContainsRegex("the largest shift of a camera is (0|[0-9.]+e-0[67])\n"));
  }
}

TEST(Convert, TakesPosesOfTheBodyOntoAnAtlas) {
  const TemporaryFolder folder;
  const std::string map = folder / "vi.osa", poses = folder / "body.tum";
  ASSERT_EQ(RunSlamdb({"synthesize", map, "--sensor", "stereo", "--inertial", "--keyframes", "5", "--points", "60"})
                .exit_code,
            0);
  ASSERT_EQ(RunSlamdb({"convert", map, poses, "--body"}).exit_code, 0);
  const ProcessResult put = RunSlamdb({"convert", poses, folder / "put.osa", "--onto", map, "--body"});
  EXPECT_EQ(put.exit_code, 0) << put.err;
  EXPECT_THAT(put.err, ContainsRegex("the largest shift of a camera is (0|[0-9.]+e-0[67])\n"));
  const ProcessResult other = RunSlamdb({"convert", map, folder / "o.osa", "--onto", map, "--body"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("--body with --onto is for trajectories only"));
  const ProcessResult bare = RunSlamdb({"convert", poses, folder / "o.osa", "--onto", kSession, "--body"});
  EXPECT_EQ(bare.exit_code, 1);
}

// What is no map of ORB-SLAM3 is a loss of every verb that writes one.
TEST(Convert, LosesUseToOrbslam3AsOtherVerbsDo) {
  const TemporaryFolder folder;
  const std::string model = folder / "model";
  ASSERT_EQ(RunSlamdb({"convert", kSession, model, "--to", "colmap"}).exit_code, 3);
  for (const std::vector<std::string>& line :
       std::vector<std::vector<std::string>>{{"convert", model},
                                             {"transform", model, "--scale", "2"},
                                             {"merge", model, kSession, "--force"},
                                             {"renumber", model}}) {
    std::vector<std::string> words = line;
    words.insert(words.end(), {"-o", folder / "out.osa", "-O"});
    const ProcessResult lost = RunSlamdb(words);
    EXPECT_EQ(lost.exit_code, 3) << line[0] << lost.err;
    EXPECT_THAT(lost.err, HasSubstr("loss: ORB-SLAM3 cannot use this map: ")) << line[0];
    words[words.size() - 2] = folder / "store.db";
    EXPECT_THAT(RunSlamdb(words).err, Not(HasSubstr("cannot use this map"))) << line[0];
  }
}

TEST(Convert, RefusesToPutPosesOfAnotherMap) {
  const TemporaryFolder folder;
  const std::string other = SLAMDB_FIXTURES "/session_small_b/session_small_b.osa";
  ASSERT_EQ(RunSlamdb({"convert", other, folder / "other.g2o"}).exit_code, 0);
  for (const std::string& poses : {folder / "other.g2o", other}) {
    const ProcessResult put = RunSlamdb({"convert", poses, folder / "o.osa", "--onto", kSession});
    EXPECT_EQ(put.exit_code, 1) << put.err;
    EXPECT_THAT(put.err, ContainsRegex("the poses are of another atlas: kf [0-9]+ is of [0-9.]+ s there, and of"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "o.osa"));
}

TEST(Convert, SaysWhichWayRoundOntoIs) {
  const TemporaryFolder folder;
  for (const std::string name : {"a.g2o", "a.ply", "a.tum"}) {
    ASSERT_EQ(RunSlamdb({"convert", kSession, folder / name}).exit_code, 0);
    const ProcessResult put = RunSlamdb({"convert", kSession, folder / "o.osa", "--onto", folder / name});
    EXPECT_EQ(put.exit_code, 1) << name;
    EXPECT_FALSE(std::filesystem::exists(folder / "o.osa"));
    if (name == "a.ply") continue;  // of points, and of no keyframe
    EXPECT_THAT(put.err, HasSubstr("The other way round it is `slamdb convert " + (folder / name) + " " +
                                   (folder / "o.osa") + " --onto " + kSession + "`"));
  }
}

TEST(Convert, RefusesToPutWhatDoesNotFit) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "other.g2o", "VERTEX_SE3:QUAT 77777 0 0 0 0 0 0 1\n");
  const ProcessResult other = RunSlamdb({"convert", folder / "other.g2o", folder / "o.osa", "--onto", kSession});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("none of the 1 pose is of a keyframe of the atlas"));
  const ProcessResult part =
      RunSlamdb({"convert", folder / "other.g2o", folder / "o.osa", "--onto", kSession, "--map", "0"});
  EXPECT_EQ(part.exit_code, 2);
  EXPECT_THAT(part.err, HasSubstr("--onto takes all poses"));
  EXPECT_EQ(RunSlamdb({"convert", kSession, folder / "o.osa", "--onto", folder / "none.osa"}).exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "o.osa"));
}

}  // namespace
}  // namespace slamdb::testing
