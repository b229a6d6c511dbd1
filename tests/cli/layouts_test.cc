// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kSession = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";

// A file in a layout with one more member, and the layout.
void MakeFork(const TemporaryFolder& folder) {
  WriteWholeFile(folder / "lab.json",
                 R"({"id": "lab", "base": "v1.0", "changes": [{"class": "KeyFrame", "after": "mnId",
                     "add": [["mnLabel", "u64"]]}]})");
  const ProcessResult result =
      RunSlamdb({"convert", kSession, folder / "fork.osa", "--to-layout", folder / "lab.json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
}

TEST(Layouts, ListIsWhatStandsAloneMeans) {
  const ProcessResult list = RunSlamdb({"layouts", "list"});
  EXPECT_EQ(list.exit_code, 0) << list.err;
  EXPECT_THAT(list.out, AllOf(HasSubstr("v1.0"), HasSubstr("visible-found")));
  EXPECT_EQ(RunSlamdb({"layouts"}).out, list.out);
  const json report = json::parse(RunSlamdb({"layouts", "list", "--json"}).out);
  EXPECT_EQ(BreachOf(report, "layouts.schema.json"), "");
  EXPECT_EQ(report["layouts"][0]["id"], "v1.0");
}

TEST(Layouts, ShowPrintsWhatLayoutTakes) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "own.json", RunSlamdb({"layouts", "show", "v1.0"}).out);
  EXPECT_EQ(RunSlamdb({"info", kSession, "--layout", folder / "own.json"}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"layouts", "show", folder / "own.json"}).out, ReadWholeFile(folder / "own.json"));
  EXPECT_THAT(RunSlamdb({"layouts", "show", "nobodys"}).err, HasSubstr("known are v1.0"));
}

TEST(Layouts, InferFindsWhatNobodyDescribed) {
  const TemporaryFolder folder;
  MakeFork(folder);
  EXPECT_THAT(RunSlamdb({"info", folder / "fork.osa"}).err, HasSubstr("`slamdb layouts infer`"));
  const ProcessResult result = RunSlamdb({"layouts", "infer", folder / "fork.osa", "-o", folder / "fork.json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("KeyFrame: unknown1, 8 bytes, between mnId and mnFrameId"),
                                HasSubstr("14 keyframes and 3,162 points"), HasSubstr("the same bytes")));
  EXPECT_EQ(RunSlamdb({"layouts", "infer", folder / "fork.osa", "-o", folder / "fork.json"}).exit_code, 1);
  ASSERT_EQ(
      RunSlamdb({"convert", folder / "fork.osa", folder / "same.osa", "--layout", folder / "fork.json"}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(folder / "same.osa"), ReadWholeFile(folder / "fork.osa"));
}

TEST(Layouts, InferTellsScripts) {
  const TemporaryFolder folder;
  MakeFork(folder);
  const json known = json::parse(RunSlamdb({"layouts", "infer", kSession, "--json"}).out);
  EXPECT_EQ(BreachOf(known, "layouts-infer.schema.json"), "");
  EXPECT_EQ(known["known"], "v1.0");
  const json found = json::parse(RunSlamdb({"layouts", "infer", folder / "fork.osa", "--json"}).out);
  EXPECT_EQ(BreachOf(found, "layouts-infer.schema.json"), "");
  EXPECT_TRUE(found["known"].is_null());
  EXPECT_EQ(found["same_bytes"], true);
  WriteWholeFile(folder / "found.json", found["layout"].dump());
  EXPECT_EQ(RunSlamdb({"info", folder / "fork.osa", "--layout", folder / "found.json"}).exit_code, 0);
}

TEST(Layouts, InferSaysWhatToDoWhereNoneIsFound) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "cut.osa", ReadWholeFile(kSession).substr(0, 2'000'000));
  const ProcessResult result = RunSlamdb({"layouts", "infer", folder / "cut.osa"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("no layout found"), HasSubstr("as in v1.0"), HasSubstr("`slamdb recover`")));
}

TEST(Layouts, RecoverMakesAFileThatIsReadOfOneThatWasInferred) {
  const TemporaryFolder folder;
  MakeFork(folder);
  const ProcessResult result = RunSlamdb({"recover", folder / "fork.osa", folder / "rescued.osa"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("a layout that was inferred"), HasSubstr("3,162 of 3,162 points"),
                                HasSubstr("none, every byte can be read")));
  EXPECT_EQ(RunSlamdb({"info", folder / "rescued.osa"}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"recover", folder / "rescued.osa", folder / "again.osa"}).exit_code, 0);
}

// The members of a fork that nobody knows are kept in the layout that is given, of a whole file and of one that is cut.
TEST(Layouts, RecoverReadsInTheLayoutThatIsGiven) {
  const TemporaryFolder folder;
  MakeFork(folder);
  const std::string fork = folder / "fork.osa", cut = folder / "cut.osa", out = folder / "rescued.osa";
  const std::string layout = folder / "lab.json";
  const ProcessResult whole = RunSlamdb({"recover", fork, out, "--layout", layout});
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_TRUE(ReadWholeFile(out) == ReadWholeFile(fork));
  const std::string bytes = ReadWholeFile(fork);
  WriteWholeFile(cut, bytes.substr(0, bytes.size() * 97 / 100));
  const ProcessResult result = RunSlamdb({"recover", cut, out, "-O", "--layout", layout});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.out, HasSubstr("14 of 14 keyframes"));
  EXPECT_THAT(RunSlamdb({"convert", out, folder / "own.osa", "--layout", layout, "--to-layout", "v1.0"}).err,
              HasSubstr("cannot hold mnLabel of 14 keyframes"));
  const ProcessResult other = RunSlamdb({"recover", cut, out, "-O", "--layout", "obvi"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("no keyframe is whole in the layout obvi that is given"));
}

TEST(Layouts, RecoverDoesWithoutAHeader) {
  const TemporaryFolder folder;
  MakeFork(folder);
  const std::string fork = folder / "fork.osa", damaged = folder / "damaged.osa", out = folder / "out.osa";
  for (const std::string& file : {kSession, fork}) {
    std::string bytes = ReadWholeFile(file);
    bytes[12] = '\xff';
    WriteWholeFile(damaged, bytes);
    const ProcessResult result = RunSlamdb({"recover", damaged, out, "-O"});
    EXPECT_EQ(result.exit_code, 3) << file << result.err;
    EXPECT_THAT(result.out, HasSubstr("14 of 14 keyframes")) << file;
  }
}

// Points that were moved do not make another layout of it; every verb says that something is wrong.
TEST(Layouts, ABrokenMapIsOneOfV1InDoubt) {
  const TemporaryFolder folder;
  const std::string table = folder / "points.csv", broken = folder / "broken.osa";
  ASSERT_EQ(RunSlamdb({"convert", kSession, table}).exit_code, 0);
  std::string text = ReadWholeFile(table);
  ASSERT_TRUE(text.starts_with("x,y,z,"));
  WriteWholeFile(table, text.replace(0, 6, "y,z,x,"));
  ASSERT_EQ(RunSlamdb({"edit", kSession, broken, "--points", table}).exit_code, 0);
  const std::string doubt = "map points are not where keyframes see them";
  const ProcessResult inferred = RunSlamdb({"layouts", "infer", broken});
  EXPECT_THAT(inferred.out, AllOf(HasSubstr("the layout v1.0"), HasSubstr("in doubt\n  " + doubt),
                                  ::testing::Not(HasSubstr("--choose"))));
  EXPECT_THAT(inferred.err, AllOf(HasSubstr("is in doubt"), ::testing::Not(HasSubstr("other layouts"))));
  EXPECT_THAT(RunSlamdb({"info", broken}).err, HasSubstr(doubt));
  EXPECT_THAT(RunSlamdb({"recover", broken, folder / "out.osa"}).out,
              HasSubstr("the layout v1.0 is in doubt: " + doubt));
}

TEST(Layouts, DiffNamesThem) {
  const TemporaryFolder folder;
  MakeFork(folder);
  const ProcessResult diff = RunSlamdb({"diff", kSession, folder / "fork.osa", "--layout", folder / "lab.json"});
  EXPECT_THAT(diff.out, HasSubstr("layout: v1.0 -> lab\n"));
}

// Several flags that are 0 everywhere fit as well: none of them costs a point.
TEST(Layouts, RecoverDropsNothingForAFlagInDoubt) {
  const TemporaryFolder folder;
  WriteWholeFile(
      folder / "lab.json",
      R"({"base": "v1.0", "changes": [{"class": "MapPoint", "after": "mBackupRefKFId", "add": [["x", "u8"]]}]})");
  ASSERT_EQ(RunSlamdb({"convert", kSession, folder / "fork.osa", "--to-layout", folder / "lab.json"}).exit_code, 0);
  const ProcessResult result = RunSlamdb({"recover", folder / "fork.osa", folder / "rescued.osa"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr(" as well (`slamdb layouts infer` lists them)"), HasSubstr("3,162 of 3,162 points")));
  const ProcessResult second = RunSlamdb({"layouts", "infer", folder / "fork.osa", "--choose", "2"});
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_THAT(second.out, HasSubstr("\n  1: MapPoint:"));
  EXPECT_EQ(RunSlamdb({"layouts", "infer", folder / "fork.osa", "--choose", "99"}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"layouts", "infer", folder / "fork.osa", "--choose", "0"}).exit_code, 2);
}

// One layout is given for all inputs.
TEST(Layouts, AnInputThatIsOfNoForkIsReadBesideOneThatIs) {
  const TemporaryFolder folder;
  MakeFork(folder);
  const std::string fork = folder / "fork.osa", layout = folder / "lab.json";
  const ProcessResult diff = RunSlamdb({"diff", fork, kSession, "--layout", layout});
  EXPECT_LE(diff.exit_code, 1) << diff.err;
  EXPECT_THAT(diff.err, AllOf(HasSubstr("read as of ORB-SLAM3 v1.0"), ::testing::Not(HasSubstr("error"))));
  EXPECT_EQ(RunSlamdb({"diff", kSession, fork, "--layout", layout}).exit_code, diff.exit_code);
  EXPECT_EQ(RunSlamdb({"check", fork, kSession, "--layout", layout}).exit_code,
            RunSlamdb({"check", kSession}).exit_code);
  EXPECT_EQ(RunSlamdb({"info", SLAMDB_FIXTURES "/conformance/layouts/obvi.osa", "--layout", layout}).exit_code, 0);
  // What fits neither is refused as of the layout that is given.
  WriteWholeFile(folder / "cut.osa", ReadWholeFile(kSession).substr(0, 2'000'000));
  EXPECT_EQ(RunSlamdb({"info", folder / "cut.osa", "--layout", layout}).exit_code, 1);
}

TEST(Layouts, ErrorsOfALayoutNameItsFile) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "root.json", R"({"root": "q", "classes": {}})");
  EXPECT_THAT(RunSlamdb({"layouts", "show", folder / "root.json"}).err, HasSubstr("root.json: root: type 'q'"));
  WriteWholeFile(folder / "broken.json", "{");
  EXPECT_THAT(RunSlamdb({"layouts", "show", folder / "broken.json"}).err,
              AllOf(HasSubstr("broken.json: no JSON: parse error"), ::testing::Not(HasSubstr("json.exception"))));
}

TEST(Layouts, FromSourceAsksWhatItDoesNotUnderstand) {
  const TemporaryFolder folder, sources;
  WriteWholeFile(
      sources / "Map.h",
      "class Map {\n  int a;\n  Blob b;\n  template <class A> void serialize(A& ar, const unsigned int) {\n"
      "    ar & a;\n    ar & b;\n  }\n};\nvoid Save(Map* map) { boost::archive::binary_oarchive oa(f); oa << "
      "map; }\n");
  const ProcessResult result = RunSlamdb({"layouts", "from-source", sources.path().string()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.out, AllOf(HasSubstr("Map.h:"), HasSubstr("`?`"), HasSubstr("the members of class Atlas")));
  const json report = json::parse(RunSlamdb({"layouts", "from-source", sources.path().string(), "--json"}).out);
  EXPECT_EQ(BreachOf(report, "layouts-from-source.schema.json"), "");
  EXPECT_EQ(report["sources"], 1);
  EXPECT_EQ(report["lacks"].size(), 3U);
}

// Damage in the middle of a fork's file costs what it hits.
TEST(Layouts, RecoverKeepsTheRecordsOfAFork) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"convert", kSession, folder / "fork.osa", "--to-layout", "visible-found"}).exit_code, 0);
  std::string bytes = ReadWholeFile(folder / "fork.osa");
  for (std::size_t i = 0; i < 400; ++i) bytes[bytes.size() * 9 / 10 + i] = static_cast<char>(0xee);  // among the points
  WriteWholeFile(folder / "damaged.osa", bytes);
  const ProcessResult result =
      RunSlamdb({"recover", folder / "damaged.osa", folder / "rescued.osa", "--no-triangulate", "--json"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(report["keyframes"]["recovered"], 14) << result.out;
  EXPECT_GE(report["points"]["recovered"], 3162 - 8) << result.out;
}

}  // namespace
}  // namespace slamdb::testing
