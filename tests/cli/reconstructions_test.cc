// SPDX-License-Identifier: BSD-3-Clause
// Folders of COLMAP and scenes, as the command writes and reads them.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

const std::string kSession = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";
const std::string kOther = SLAMDB_FIXTURES "/session_small_b/session_small_b.osa";
const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";
const std::string kModel = SLAMDB_FIXTURES "/formats/colmap";

std::vector<std::string> Names(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  return names;
}

class Reconstructions : public ::testing::Test {
 protected:
  std::string In(std::string_view name) const { return folder_ / name; }
  // What a run that has to succeed, with losses or without, prints as JSON, if anything.
  static json Json(const std::vector<std::string>& arguments) {
    const ProcessResult result = RunSlamdb(arguments);
    EXPECT_THAT(result.exit_code, AnyOf(0, 3)) << result.err;
    return json::parse(result.out, nullptr, /*allow_exceptions=*/false);
  }
  TemporaryFolder folder_;
};

// What COLMAP left as it was goes back onto the atlas without a change.
TEST_F(Reconstructions, GoBackOntoTheirAtlas) {
  ASSERT_EQ(RunSlamdb({"convert", kSession, In("model"), "--to", "colmap", "--with-database"}).exit_code, 3);
  EXPECT_THAT(Names(In("model")), UnorderedElementsAre("cameras.bin", "images.bin", "points3D.bin", "rigs.bin",
                                                       "frames.bin", "database.db"));
  const ProcessResult back = RunSlamdb({"convert", In("model"), In("back.osa"), "--onto", kSession});
  EXPECT_THAT(back.err, HasSubstr("put 14 poses and 2,074 points into"));
  EXPECT_EQ(back.exit_code, 0) << back.err;  // what the model lacks, the atlas has
  EXPECT_THAT(back.err, AllOf(Not(HasSubstr("loss:")), Not(HasSubstr("derived")), Not(HasSubstr("lens"))));
  EXPECT_EQ(RunSlamdb({"diff", kSession, In("back.osa"), "--tolerance", "1e-6"}).exit_code, 0);
}

// Far from the origin they are read about one among them, and go back to where the atlas has them.
TEST_F(Reconstructions, GoBackOntoAnAtlasThatIsFarAway) {
  Json({"transform", kSession, In("far.osa"), "--by", "50000,-20000,300,0,0,0,1"});
  Json({"convert", In("far.osa"), In("model"), "--to", "colmap"});
  const json put = Json({"convert", In("model"), In("back.osa"), "--onto", In("far.osa"), "--json"});
  EXPECT_EQ(put["put"]["keyframes"], 14);
  EXPECT_LT(put["put"]["largest_shift"], 0.01);  // what floats are off by there
  const ProcessResult alone = RunSlamdb({"convert", In("model"), In("near.osa")});
  EXPECT_THAT(alone.err, HasSubstr("was taken off all positions"));
  const ProcessResult onto = RunSlamdb({"convert", In("model"), In("again.osa"), "--onto", In("near.osa")});
  EXPECT_THAT(onto.err, HasSubstr("positions stay as the atlas has them: without (49997, -20000, 300)"));
  // Of a part the middle is elsewhere, and of what is no model, too: nothing moves but by what floats were off by.
  Json({"convert", In("far.osa"), In("part"), "--to", "colmap", "--box", "49000,-21000,0:49997,-19000,600"});
  EXPECT_THAT(RunSlamdb({"convert", In("part"), In("part.osa")}).err, Not(HasSubstr("(49997, -20000, 300)")));
  for (const std::string poses : {"part", "far.g2o", "far.tum"}) {
    if (poses != "part") Json({"convert", In("far.osa"), In(poses)});
    const ProcessResult moved =
        RunSlamdb({"convert", In(poses), In("o.osa"), "-O", "--onto", In("near.osa"), "--json"});
    EXPECT_EQ(moved.exit_code, 0) << moved.err;
    EXPECT_LT(json::parse(moved.out)["put"]["largest_shift"], 0.01) << poses;
    EXPECT_THAT(moved.err, HasSubstr("positions stay as the atlas has them: without (49997, -20000, 300)"));
  }
}

// Onto an atlas that reaches as far, floats round what is new: the loss that reading it alone is.
TEST_F(Reconstructions, LoseOntoAFarAtlasWhatFloatsRound) {
  Json({"transform", kSession, In("far.osa"), "--by", "500000,5400000,500,0,0,0,1"});
  const auto put = [&] { return RunSlamdb({"convert", In("far.g2o"), In("o.osa"), "-O", "--onto", In("far.osa")}); };
  Json({"convert", In("far.osa"), In("far.g2o")});
  const ProcessResult same = put();
  EXPECT_EQ(same.exit_code, 0) << same.err;
  WriteWholeFile(In("far.g2o"), "VERTEX_SE3:QUAT 4 500001.3 5400001.6 500.2 0 0 0 1\n");
  const ProcessResult rounded = put();
  EXPECT_EQ(rounded.exit_code, 3) << rounded.err;
  EXPECT_THAT(rounded.err, HasSubstr("loss: coordinates are rounded to the 32-bit floats of an atlas: 1, by up to 0."));
}

// By their list, too: names keep its folders, however the list is named.
TEST_F(Reconstructions, NameImagesAsTheListDoes) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  std::string list;
  const ProcessResult poses = RunSlamdb({"convert", kSession, "poses.tum"});
  ASSERT_EQ(poses.exit_code, 0) << poses.err;
  std::istringstream lines(ReadWholeFile("poses.tum"));
  for (std::string line; std::getline(lines, line);)
    if (line.front() != '#')
      list += line.substr(0, line.find(' ')) + " cam0/" + line.substr(0, line.find(' ')) + ".png\n";
  WriteWholeFile("list.txt", list);
  for (const std::string& named : std::vector<std::string>{"list.txt", "./list.txt", In("list.txt")}) {
    Json({"convert", kSession, "model", "-O", "--to", "colmap-text", "--images", named});
    EXPECT_THAT(ReadWholeFile("model/images.txt"), HasSubstr(" cam0/1403636579.763555.png")) << named;
  }
  fs::current_path(before);
}

TEST_F(Reconstructions, OfAnotherMapDoNotGoOnto) {
  Json({"convert", kOther, In("model"), "--to", "colmap"});
  const ProcessResult result = RunSlamdb({"convert", In("model"), In("back.osa"), "--onto", kSession});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("the poses are of another atlas: kf "));
  EXPECT_FALSE(fs::exists(In("back.osa")));
}

TEST_F(Reconstructions, TellWhatWentOnto) {
  Json({"convert", kSession, In("model"), "--to", "colmap-text"});
  const json put = Json({"convert", In("model"), In("back.osa"), "--onto", kSession, "--json"});
  EXPECT_EQ(BreachOf(put, "convert.schema.json"), "");
  EXPECT_EQ(put["put"]["keyframes"], 14);
  EXPECT_EQ(put["put"]["points"], 2074);
  EXPECT_LT(put["put"]["largest_shift"], 1e-6);
  EXPECT_EQ(Json({"convert", kSession, In("copy.osa"), "--json"})["put"], nullptr);
}

// COLMAP's bundle adjustment changes focal lengths unless it is told not to.
TEST_F(Reconstructions, SayWhereTheirCamerasAreOthers) {
  Json({"convert", kSession, In("model"), "--to", "colmap-text"});
  std::string cameras = ReadWholeFile(In("model/cameras.txt"));
  const std::size_t at = cameras.find(" 450 ");
  ASSERT_NE(at, std::string::npos) << cameras;
  cameras.replace(at, 4, " 470");
  WriteWholeFile(In("model/cameras.txt"), cameras);
  const ProcessResult result = RunSlamdb({"convert", In("model"), In("back.osa"), "--onto", kSession});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("14 poses of another lens than the atlas has, as that of kf "));
  EXPECT_THAT(result.err, HasSubstr("470 450 319.5 239.5; in the atlas 450 450 319.5 239.5"));
}

// Descriptors are what ORB-SLAM3 matches by.
TEST_F(Reconstructions, WithoutDescriptorsAreNoUseToOrbslam3) {
  Json({"convert", kSession, In("model"), "--to", "colmap"});
  const ProcessResult lossy = RunSlamdb({"convert", In("model"), In("map.osa")});
  EXPECT_EQ(lossy.exit_code, 3);
  EXPECT_THAT(lossy.err, HasSubstr("loss: ORB-SLAM3 cannot use this map: 14,097 keypoints and 2,074 points have no "
                                   "descriptors of ORB, by which it matches; `slamdb convert --onto` puts"));
  EXPECT_THAT(lossy.err, HasSubstr("--database names the database that has"));
  EXPECT_EQ(RunSlamdb({"convert", In("model"), In("strict.osa"), "--strict"}).exit_code, 1);
  EXPECT_FALSE(fs::exists(In("strict.osa")));
  const ProcessResult words = RunSlamdb({"vocabulary", "recompute", In("map.osa"), In("words.osa"), "--vocabulary",
                                         SLAMDB_FIXTURES "/vocabulary/small.txt"});
  EXPECT_EQ(words.exit_code, 1);
  EXPECT_THAT(words.err, HasSubstr("no keyframe has a descriptor"));
  EXPECT_THAT(RunSlamdb({"convert", In("model"), In("points.ply")}).err, Not(HasSubstr("cannot use")));
  Json({"convert", kSession, In("whole"), "--to", "colmap", "--with-database"});
  EXPECT_THAT(RunSlamdb({"convert", In("whole"), In("map.osa"), "-O"}).err, Not(HasSubstr("cannot use")));
}

// So are graphs, trajectories and points alone.
TEST_F(Reconstructions, AndPartsOfMapsAreNoUseToOrbslam3) {
  for (const char* part : {"part.g2o", "part.tum", "part.ply"}) {
    ASSERT_EQ(RunSlamdb({"convert", kSession, In(part)}).exit_code, 0);
    const ProcessResult result = RunSlamdb({"convert", In(part), In("map.osa"), "-O"});
    EXPECT_EQ(result.exit_code, 3) << part;
    EXPECT_THAT(result.err, HasSubstr("ORB-SLAM3 cannot use this map")) << part;
  }
}

// SQLite would play it into the new one when that is opened.
TEST_F(Reconstructions, AreNoDatabasesWhereTheLogOfAnotherLies) {
  Json({"convert", kSession, In("model"), "--to", "colmap", "--with-database"});
  fs::remove(In("model/database.db"));
  const std::string cameras = ReadWholeFile(In("model/cameras.bin"));
  struct Case {
    std::string database;
    std::vector<std::string> command;
  };
  for (const char* suffix : {"-wal", "-journal"})
    for (const Case& each :
         {Case{In("model/database.db"), {"convert", kOther, In("model"), "--to", "colmap", "--with-database", "-O"}},
          Case{In("cd.db"), {"convert", kOther, In("cd.db"), "--to", "colmap-database"}},
          Case{In("stella.db"), {"convert", kOther, In("stella.db"), "--to", "stella-sqlite"}}}) {
      const std::string log = each.database + suffix;
      WriteWholeFile(log, "what was changed in a database that is gone");
      const ProcessResult result = RunSlamdb(each.command);
      EXPECT_EQ(result.exit_code, 1) << log;
      EXPECT_THAT(result.err, HasSubstr(log + ": is the log of a database that is gone"));
      EXPECT_FALSE(fs::exists(each.database));
      fs::remove(log);
    }
  EXPECT_EQ(ReadWholeFile(In("model/cameras.bin")), cameras);
}

// What stays may be the user's, whose images need not be those of the model.
TEST_F(Reconstructions, SayThatTheDatabaseBesideThemIsOfAnother) {
  const auto warnings = [&](const std::string& atlas, const std::string& model, const char* format = "colmap") {
    return RunSlamdb({"convert", atlas, In(model), "--to", format, "-O"}).err;
  };
  const auto names = [&](const std::string& database) {
    return HasSubstr("slamdb: warning: " + In(database) + ": is not the database of the model that is written");
  };
  Json({"convert", kSession, In("model"), "--to", "colmap", "--with-database"});
  const std::string database = ReadWholeFile(In("model/database.db"));
  EXPECT_THAT(warnings(kSession, "model"), Not(HasSubstr("database of the model")));
  EXPECT_THAT(warnings(kOther, "model"),
              AllOf(names("model/database.db"), HasSubstr("--with-database into a new folder")));
  fs::create_directories(In("workspace/sparse"));
  fs::copy_file(In("model/database.db"), In("workspace/database.db"));
  EXPECT_THAT(warnings(kOther, "workspace/sparse/0", "colmap-text"), names("workspace/database.db"));
  EXPECT_EQ(ReadWholeFile(In("model/database.db")), database);
  Json({"convert", kSession, In("plain"), "--to", "colmap"});
  WriteWholeFile(In("plain/database.db"), "no database at all");
  EXPECT_THAT(warnings(kSession, "plain"), names("plain/database.db"));
}

TEST_F(Reconstructions, AreReadBesideAnotherDatabase) {
  Json({"convert", kSession, In("there"), "--to", "colmap"});
  WriteWholeFile(In("database.db"), "no database at all");
  const ProcessResult found = RunSlamdb({"convert", In("there"), In("map.osa")});
  EXPECT_EQ(found.exit_code, 3) << found.err;
  EXPECT_THAT(found.err, HasSubstr("the model is read without it"));
  EXPECT_EQ(RunSlamdb({"convert", In("there"), In("map.osa"), "-O", "--database", In("database.db")}).exit_code, 1);
}

// COLMAP before 3.12 writes no rigs.
TEST_F(Reconstructions, SayWhichOfTheirImagesAreRightOnes) {
  ASSERT_EQ(
      RunSlamdb({"synthesize", In("pair.osa"), "--sensor", "fisheye", "--keyframes", "4", "--points", "100"}).exit_code,
      0);
  Json({"convert", In("pair.osa"), In("model"), "--to", "colmap"});
  fs::remove(In("model/rigs.bin"));
  fs::remove(In("model/frames.bin"));
  EXPECT_THAT(RunSlamdb({"convert", In("model"), In("back.osa"), "--onto", In("pair.osa")}).err,
              HasSubstr("4 images named as right ones of fisheye pairs"));
}

TEST_F(Reconstructions, AreFoldersThatAreReplacedOnlyWhenTold) {
  const auto write = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"convert", kTiny, In("model"), "--to", "colmap"});
    return RunSlamdb(more);
  };
  EXPECT_EQ(write({"--dry-run"}).exit_code, 3) << "it loses what the run would";
  EXPECT_FALSE(fs::exists(In("model")));
  EXPECT_EQ(write({}).exit_code, 3);
  const ProcessResult again = write({});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, HasSubstr("--overwrite replaces those of the same names"));
  EXPECT_EQ(write({"-O"}).exit_code, 3);
  EXPECT_THAT(RunSlamdb({"convert", kTiny, In("model"), "--to", "colmap-text", "-O"}).err,
              HasSubstr("that would be read with what is written, or in its place"));
  EXPECT_THAT(RunSlamdb({"convert", kTiny, "-", "--to", "colmap"}).err, HasSubstr("is a folder of files"));
  EXPECT_THAT(Names(folder_.path()), ElementsAre("model"));
}

// A model is an input that is never changed, by whatever path it is named.
TEST_F(Reconstructions, AreNotWrittenOverWhatIsRead) {
  fs::copy(kModel, In("model"), fs::copy_options::recursive);
  fs::create_symlink(In("model"), In("link"));
  for (const char* output : {"model", "model/", "link", "./link/../model"}) {
    const ProcessResult result = RunSlamdb({"convert", In("model"), In(output), "--to", "colmap", "-O"});
    EXPECT_EQ(result.exit_code, 1) << output;
    EXPECT_THAT(result.err, HasSubstr("is the input, which is never changed")) << output;
  }
  EXPECT_EQ(ReadWholeFile(In("model/0/images.bin")), ReadWholeFile(kModel + "/0/images.bin"));
  // A folder in it is another one.
  EXPECT_EQ(RunSlamdb({"convert", In("model"), In("model/text"), "--to", "colmap-text"}).exit_code, 3);
  EXPECT_TRUE(fs::exists(In("model/text/1/images.txt")));
}

TEST_F(Reconstructions, AreWrittenWhereALinkLeads) {
  fs::create_directory(In("there"));
  fs::create_directory_symlink(In("there"), In("link"));
  EXPECT_EQ(RunSlamdb({"convert", kTiny, In("link"), "--to", "colmap"}).exit_code, 3);
  EXPECT_TRUE(fs::is_symlink(In("link")));
  EXPECT_TRUE(fs::exists(In("there/points3D.bin")));
}

TEST_F(Reconstructions, InScenesAreNotMixedWithWhatWasLeft) {
  Json({"convert", kSession, In("scene"), "--to", "3dgs"});
  const std::string model = In("scene/sparse/0");
  const auto problem = [&] { return RunSlamdb({"convert", kTiny, model, "--to", "colmap", "-O"}).err; };
  EXPECT_THAT(problem(), HasSubstr("points3D.ply: is the cloud of another model"));
  WriteWholeFile(model + "/.slamdb-unfinished", "words:\ncameras.bin\n");
  EXPECT_THAT(RunSlamdb({"info", In("scene")}).err, HasSubstr("was killed"));
  Json({"convert", kSession, In("scene"), "--to", "3dgs", "-O"});
  Json({"info", In("scene")});
  WriteWholeFile(In("scene/.slamdb-unfinished"), "words:\nsparse/0/cameras.bin\n");
  EXPECT_THAT(problem(), HasSubstr("was killed"));
}

TEST_F(Reconstructions, OfSeveralFilesAreKnownThroughLinks) {
  fs::create_directory(In("maps"));
  fs::create_symlink("maps/m.yaml", In("link.yaml"));
  fs::create_symlink("maps/p.kitti", In("link.kitti"));
  for (const char* name : {"link.yaml", "link.kitti"}) {
    const std::string format = std::string(name).ends_with("kitti") ? "kitti" : "osmap";
    Json({"convert", kTiny, In(name), "--to", format});
    Json({"convert", kTiny, In(name), "--to", format, "-O"});
  }
  EXPECT_THAT(Names(In("maps")),
              UnorderedElementsAre("m.yaml", "m.mappoints", "m.keyframes", "m.features", "p.kitti", "p.kitti.times"));
  Json({"info", In("link.yaml")});
  EXPECT_THAT(RunSlamdb({"convert", In("link.kitti"), In("p.tum")}).err, HasSubstr("p.kitti.times"));
  fs::copy_file(In("maps/m.yaml"), In("maps/copy.yaml"));
  WriteWholeFile(In("maps/.m.slamdb-unfinished"), "words:\nm.mappoints\n");
  for (const char* name : {"link.yaml", "maps/m.yaml", "maps/copy.yaml"})
    EXPECT_THAT(RunSlamdb({"info", In(name)}).err, HasSubstr("was killed")) << name;
}

// The last file of them is a FIFO: when it is opened, the others are read, and one of them is replaced.
TEST_F(Reconstructions, OfSeveralFilesAreNotReadWhileTheyAreReplaced) {
  Json({"convert", kTiny, In("m.yaml"), "--to", "osmap"});
  Json({"convert", kTiny, In("p.kitti")});
  const auto read = [&](const std::string& last, const std::string& replaced, const std::vector<std::string>& line) {
    fs::rename(last, In("kept"));
    ASSERT_EQ(::mkfifo(last.c_str(), 0600), 0);
    std::thread other([&] {
      std::ofstream fifo(last);
      fs::copy_file(replaced, In("new"));
      fs::rename(In("new"), replaced);
      fifo << ReadWholeFile(In("kept"));
    });
    const ProcessResult result = RunSlamdb(line);
    const int release = ::open(last.c_str(), O_RDONLY | O_NONBLOCK);  // where nothing has opened it
    other.join();
    ::close(release);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr(replaced + ": was replaced while it was read"));
  };
  read(In("m.features"), In("m.mappoints"), {"info", In("m.yaml")});
  read(In("p.kitti.times"), In("p.kitti"), {"convert", In("p.kitti"), In("p.tum"), "--times", In("p.kitti.times")});
}

TEST_F(Reconstructions, RefuseOptionsWithoutEffect) {
  const auto expect = [&](const std::string& to, std::vector<std::string> more, const std::string& says) {
    more.insert(more.begin(), {"convert", kTiny, In("out"), "--to", to});
    const ProcessResult result = RunSlamdb(more);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_THAT(result.err, HasSubstr(says));
  };
  expect("ply", {"--images", "."}, "--images is for COLMAP, NeRF and Gaussian splatting only");
  expect("nerf", {"--with-database"}, "--with-database is for COLMAP models only");
  expect("colmap", {"--colmap-schema", "new"}, "without --with-database");
  expect("colmap", {"--with-database", "--colmap-schema", "3.8"}, "--colmap-schema");
  EXPECT_THAT(RunSlamdb({"convert", kTiny, In("out"), "--to", "3dgs", "--images", In("none")}).err,
              HasSubstr("none: cannot open: No such file or directory"));
  expect("ply", {"--database", "foo"}, "--database is for COLMAP models only; the input is ");
  EXPECT_FALSE(fs::exists(In("out")));
}

}  // namespace
}  // namespace slamdb::testing
