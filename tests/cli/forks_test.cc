// SPDX-License-Identifier: BSD-3-Clause
// Files of ORB-SLAM3's forks: --layout, --to-layout, and what is said of them.
#include <gmock/gmock.h>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";

class Forks : public ::testing::Test {
 protected:
  // The tiny atlas in a layout.
  std::string Forged(const std::string& layout) {
    std::string path = folder_ / ("fork_" + std::to_string(files_++) + ".osa");
    const ProcessResult made = RunSlamdb({"convert", kTiny, path, "--to-layout", layout});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return path;
  }
  // One that slamdb does not come with, as a file.
  std::string OwnLayout() {
    std::string path = folder_ / "mine.json";
    WriteWholeFile(path, R"({"base": "v1.0", "changes": [
      {"class": "KeyFrame", "after": "mnFrameId", "add": [["mnRobot", "i32"], ["mName", "string"]]}]})");
    return path;
  }

  TemporaryFolder folder_;
  int files_ = 0;
};

TEST_F(Forks, AreReadByThemselvesAndWrittenBackByteForByte) {
  for (const char* layout : {"gnss", "visible-found", "mavis", "globus"}) {
    const std::string fork = Forged(layout), again = fork + ".again.osa";
    const ProcessResult copied = RunSlamdb({"convert", fork, again});
    EXPECT_EQ(copied.exit_code, 0) << copied.err;
    EXPECT_THAT(copied.err, HasSubstr(std::string("read in the layout ") + layout));
    EXPECT_TRUE(ReadWholeFile(fork) == ReadWholeFile(again)) << layout;
  }
}

// Also of those that lack what is lost to them on the way there.
TEST_F(Forks, LoseNothingInTheirOwnLayout) {
  const std::string map = folder_ / "map.osa";
  ASSERT_EQ(RunSlamdb({"synthesize", map, "--keyframes", "4", "--points", "60", "--features", "100"}).exit_code, 0);
  const json known = json::parse(RunSlamdb({"layouts", "list", "--json"}).out);
  ASSERT_FALSE(known["layouts"].empty());
  for (const json& layout : known["layouts"]) {
    const std::string id = layout["id"], fork = folder_ / (id + ".osa"), again = folder_ / (id + ".again.osa");
    RunSlamdb({"convert", map, fork, "--to-layout", id});
    const ProcessResult copied = RunSlamdb({"convert", fork, again, "--strict"});
    EXPECT_EQ(copied.exit_code, 0) << id << copied.err;
    EXPECT_TRUE(ReadWholeFile(fork) == ReadWholeFile(again)) << id;
  }
}

TEST_F(Forks, OfLayoutsThatNobodyKnowsAreReadByTheirFile) {
  const std::string fork = Forged(OwnLayout()), again = folder_ / "again.osa", stored = folder_ / "maps.db#fork";
  EXPECT_EQ(RunSlamdb({"info", fork}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"info", fork, "--layout", OwnLayout()}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"list", fork, "--layout", OwnLayout()}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"add", folder_ / "all.db", fork, "--layout", OwnLayout()}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"check", fork, "--layout", OwnLayout()}).exit_code, RunSlamdb({"check", kTiny}).exit_code);
  EXPECT_EQ(RunSlamdb({"dump", fork, "--layout", OwnLayout()}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"convert", fork, stored, "--layout", OwnLayout()}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"convert", stored, again}).exit_code, 0);
  EXPECT_TRUE(ReadWholeFile(fork) == ReadWholeFile(again));
}

TEST_F(Forks, ConvertedToV1SayWhatIsDropped) {
  const std::string fork = Forged(OwnLayout()), own = folder_ / "own.osa";
  const ProcessResult result = RunSlamdb({"convert", fork, own, "--layout", OwnLayout(), "--to-layout", "v1.0"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("the layout v1.0 cannot hold mnRobot, mName of 2 keyframes"));
  EXPECT_TRUE(ReadWholeFile(own) == ReadWholeFile(kTiny));
  const ProcessResult refused =
      RunSlamdb({"convert", fork, own, "-O", "--layout", OwnLayout(), "--to-layout", "v1.0", "--strict"});
  EXPECT_EQ(refused.exit_code, 1);
  const ProcessResult report =
      RunSlamdb({"convert", fork, own, "-O", "--layout", OwnLayout(), "--to-layout", "v1.0", "--json"});
  EXPECT_EQ(BreachOf(json::parse(report.out), "convert.schema.json"), "");
}

TEST_F(Forks, SayInInfoOfWhatLayoutTheyAre) {
  const std::string fork = Forged("gnss");
  EXPECT_THAT(RunSlamdb({"info", fork}).out, HasSubstr("layout      gnss: calibration of a GNSS antenna in keyframes"));
  const json report = json::parse(RunSlamdb({"info", fork, "--json"}).out);
  EXPECT_EQ(BreachOf(report, "info.schema.json"), "");
  EXPECT_EQ(report.at("layout"), "gnss");
}

TEST_F(Forks, WhoseLayoutsHoldNothingMoreAreConvertedWithoutALoss) {
  const ProcessResult result = RunSlamdb({"convert", Forged("bow-vec"), folder_ / "own.osa", "--to-layout", "v1.0"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(ReadWholeFile(folder_ / "own.osa") == ReadWholeFile(kTiny));
}

TEST_F(Forks, OfTwoLayoutsAreMergedWithALoss) {
  const std::string gnss = Forged("gnss"), mavis = Forged("mavis"), both = folder_ / "both.osa";
  const ProcessResult result = RunSlamdb({"merge", gnss, mavis, "-o", both, "--json"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr(mavis + ": the members of its fork are of another layout"));
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "merge.schema.json"), "");
  EXPECT_EQ(report.at("other_layouts"), json::array({mavis}));
  EXPECT_GT(report.at("dropped_members"), 0);
}

// Members of v1.0 that a layout lacks are a loss where the atlas has them, and only there.
TEST_F(Forks, LackingMembersLoseThem) {
  const std::string session = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa", out = folder_ / "out.osa";
  const auto convert = [&](const std::string& changes, const std::vector<std::string>& more = {}) {
    const std::string layout = folder_ / "lacking.json";
    WriteWholeFile(layout, R"({"id": "lacking", "base": "v1.0", "changes": [)" + changes + "]}");
    std::vector<std::string> words = {"convert", session, out, "-O", "--to-layout", layout};
    words.insert(words.end(), more.begin(), more.end());
    return RunSlamdb(words);
  };
  const std::string places =
      R"({"class": "KeyFrame", "replace": ["mTcw"]}, {"class": "MapPoint", "replace": ["mWorldPos"]})";
  EXPECT_EQ(convert(places, {"--strict"}).exit_code, 1);
  EXPECT_NE(RunSlamdb({"info", out}).exit_code, 0) << "nothing was written";
  const ProcessResult result = convert(places);
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err,
              HasSubstr("the layout lacking cannot hold mTcw of 14 keyframes; mWorldPos of 3,162 map points"));
  const ProcessResult other_type =
      convert(R"({"class": "KeyFrame", "replace": ["mTcw"], "add": [["mTcw", "arr<f32,5>"]]})");
  EXPECT_THAT(other_type.err, HasSubstr("cannot hold mTcw of 14 keyframes"));
  const ProcessResult half = convert(R"({"class": "MapPoint", "replace": ["mBackupObservationsId1"]})");
  EXPECT_THAT(half.err, HasSubstr("cannot hold mBackupObservationsId1 of 3,162 map points"));
  EXPECT_EQ(convert(R"({"class": "MapPoint", "replace": ["mBackupObservationsId2"]})").exit_code, 0)
      << "no right image sees one";
  // No keypoint has a match in a right image; a pose has the same in another form.
  EXPECT_EQ(convert(R"({"class": "KeyFrame", "replace": ["mvLeftToRightMatch", "mvRightToLeftMatch", "mvKeysRight"]})")
                .exit_code,
            0);
  EXPECT_EQ(convert(R"({"class": "KeyFrame", "replace": ["mTcw"], "add": [["mTcw.xyzw", "arr<f64,7>"]]})").exit_code,
            0);
}

TEST_F(Forks, MisspeltFormsAreRefused) {
  const auto refusal = [&](const std::string& member) {
    WriteWholeFile(folder_ / "bad.json", R"({"base": "v1.0", "changes": [
      {"class": "KeyFrame", "replace": ["mTcw"], "add": [)" +
                                             member + "]}]}");
    const ProcessResult refused = RunSlamdb({"layouts", "show", folder_ / "bad.json"});
    EXPECT_EQ(refused.exit_code, 1);
    return refused.err;
  };
  EXPECT_THAT(refusal(R"(["mTcw.foo", "arr<f32,7>"])"),
              HasSubstr("changes[0].add[0]: no form 'foo' of mTcw; forms are xyzw, columns, rows, inverse"));
  EXPECT_THAT(refusal(R"(["mTcw.xyzw", "arr<f32,16>"])"),
              HasSubstr("mTcw.xyzw is of type arr<f32,16>, expected arr<f32,7>, arr<f64,7>"));
}

TEST_F(Forks, LayoutsThatAreNoneAreRefused) {
  const ProcessResult missing = RunSlamdb({"info", kTiny, "--layout", "no-such-layout"});
  EXPECT_NE(missing.exit_code, 0);
  EXPECT_THAT(missing.err, AllOf(HasSubstr("no-such-layout"), HasSubstr("known are v1.0, visible-found")));
  WriteWholeFile(folder_ / "bad.json", R"({"base": "v1.0", "changes": [{"class": "Maps"}]})");
  const ProcessResult bad = RunSlamdb({"info", kTiny, "--layout", folder_ / "bad.json"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr("bad.json: changes[0].class: the base has no such class"));
  const ProcessResult idle = RunSlamdb({"convert", kTiny, folder_ / "a.db#a", "--to-layout", "gnss"});
  EXPECT_EQ(idle.exit_code, 2);
  EXPECT_THAT(idle.err, HasSubstr("--to-layout is for archives of ORB-SLAM3 only"));
  EXPECT_THAT(RunSlamdb({"convert", kTiny, folder_ / "a.osa", "--to", "v1.0"}).err,
              HasSubstr("did you mean '--to-layout v1.0'?"));
}

}  // namespace
}  // namespace slamdb::testing
