// SPDX-License-Identifier: BSD-3-Clause
// What every verb that changes an atlas keeps to: inputs stay, nothing is replaced unasked, text stays text.
#include <gmock/gmock.h>

#include <filesystem>

#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class Edit : public ::testing::Test {
 protected:
  Edit() {
    std::filesystem::copy_file(SLAMDB_FIXTURES "/session_small_a/session_small_a.osa", input_);
    std::filesystem::copy_file(SLAMDB_FIXTURES "/session_small_b/session_small_b.osa", other_);
    bytes_ = ReadWholeFile(input_);
  }
  void ExpectRefused(const std::vector<std::string>& arguments, const std::string& why, int code = 1) const {
    const ProcessResult result = RunSlamdb(arguments);
    EXPECT_EQ(result.exit_code, code) << arguments[0];
    EXPECT_THAT(result.err, HasSubstr(why)) << arguments[0];
    EXPECT_EQ(ReadWholeFile(input_), bytes_) << arguments[0] << " changed its input";
  }

  TemporaryFolder folder_;
  const std::string input_ = folder_ / "a.osa", other_ = folder_ / "b.osa", output_ = folder_ / "out.osa";
  std::string bytes_;
};

TEST_F(Edit, WhatGoesBesideTheAtlasReplacesNoAtlas) {
  const std::string same = (folder_.path() / "." / "a.osa").string();
  ExpectRefused({"repair", input_, output_, "--journal", same, "-O"}, "never changed");
  ExpectRefused({"repair", input_, output_, "--journal", output_}, "is an output of this run already");
  ExpectRefused({"renumber", input_, output_, "--id-map", same, "-O"}, "never changed");
  ExpectRefused({"renumber", input_, output_, "--id-map", output_}, "is an output of this run already");
  ExpectRefused({"merge", other_, input_, "-o", output_, "--id-map", same, "-O"}, "never changed");
  ExpectRefused({"repair", input_, output_, "--journal", "-"}, "standard output");
  EXPECT_FALSE(std::filesystem::exists(output_));
}

// Both tables at once, in a store; and back to the same bytes.
TEST_F(Edit, TablesChangeAtlasesOfStoresAndAreTakenBack) {
  const std::string store = folder_ / "s.db", points = folder_ / "p.csv", poses = folder_ / "k.keyframes.csv";
  const std::string journal = folder_ / "edit.json";
  for (const std::string& output : {store + "#map", points, poses})
    ASSERT_EQ(RunSlamdb({"convert", input_, output}).exit_code, 0);
  std::string table = ReadWholeFile(poses);
  table.erase(table.rfind('\n', table.size() - 2) + 1);  // the last keyframe
  WriteWholeFile(poses, table);
  const std::vector<std::string> command = {"edit",        store + "#map", store + "#edited", "--points", points,
                                            "--keyframes", poses,          "--delete-missing"};
  const ProcessResult planned =
      RunSlamdb({"edit", store + "#map", "--keyframes", poses, "--delete-missing", "--dry-run"});
  EXPECT_EQ(planned.exit_code, 0);
  EXPECT_THAT(planned.out, HasSubstr("would edit"));
  EXPECT_THAT(planned.out, HasSubstr("1 deleted"));
  std::vector<std::string> kept = command;
  kept.insert(kept.end(), {"--journal", journal});
  ASSERT_EQ(RunSlamdb(kept).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"diff", store + "#map", store + "#edited"}).exit_code, 1);
  ASSERT_EQ(RunSlamdb({"repair", "--undo", journal, store + "#edited", output_}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(output_), bytes_);
}

// One that was cut in a number is a table, too.
TEST_F(Edit, TablesWithoutTheirLastLineEndAreWarnedOf) {
  const std::string points = folder_ / "p.csv", cut = folder_ / "cut.csv", ids = folder_ / "ids.csv";
  ASSERT_EQ(RunSlamdb({"convert", input_, points}).exit_code, 0);
  const std::string table = ReadWholeFile(points);
  WriteWholeFile(cut, table.substr(0, table.size() - 1));
  const std::string warning =
      "slamdb: warning: " + cut + ": the last line has no end of line: the file may be cut there";
  EXPECT_EQ(RunSlamdb({"edit", input_, output_, "--points", points}).err, "");
  EXPECT_THAT(RunSlamdb({"edit", input_, output_, "-O", "--points", cut}).err, HasSubstr(warning));
  ASSERT_EQ(RunSlamdb({"renumber", input_, output_, "-O", "--offset", "1", "--id-map", ids}).exit_code, 0);
  EXPECT_THAT(RunSlamdb({"renumber", cut, folder_ / "new.csv", "--apply", ids}).err, HasSubstr(warning));
}

// An id map ends with the counters.
TEST_F(Edit, IdMapsThatAreCutAtALineAreSaid) {
  const std::string ids = folder_ / "ids.csv", back = folder_ / "back.osa";
  ASSERT_EQ(RunSlamdb({"renumber", input_, output_, "--start", "5", "--id-map", ids}).exit_code, 0);
  const std::vector<std::string> undo = {"renumber", output_, back, "-O", "--undo", ids};
  EXPECT_EQ(RunSlamdb(undo).err, "");
  const std::string table = ReadWholeFile(ids);
  WriteWholeFile(ids, table.substr(0, table.find("next_camera")));
  WriteWholeFile(ids, ReadWholeFile(ids).substr(0, ReadWholeFile(ids).rfind('\n') + 1));
  ExpectRefused(undo, "and none next_camera; the counters stand together at its end: it may be cut there");
  WriteWholeFile(ids, table.substr(0, table.find("next_map")));
  WriteWholeFile(ids, ReadWholeFile(ids).substr(0, ReadWholeFile(ids).rfind('\n') + 1));
  EXPECT_THAT(RunSlamdb(undo).err, HasSubstr("slamdb: warning: " + ids + ": has no counters"));
}

// Each with what is wrong, and nothing written.
TEST_F(Edit, TablesThatDoNotFitAreRefused) {
  const std::string points = folder_ / "p.csv", cloud = folder_ / "p.ply";
  ASSERT_EQ(RunSlamdb({"convert", input_, points}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"convert", input_, cloud}).exit_code, 0);
  ExpectRefused({"edit", input_, output_}, "a table is missing; --points or --keyframes names one", 2);
  ExpectRefused({"edit", input_, output_, "--keyframes", points}, "line 1: a table of points");
  ExpectRefused({"edit", input_, output_, "--points", cloud},
                "not a table of points: this is a PLY point cloud; `slamdb convert` to a .csv file makes a table");
  ExpectRefused({"edit", input_, output_, "--points", input_}, "not a table of points: this is an atlas");
  ExpectRefused({"edit", other_, output_, "--points", points},
                "line 2: column reference_keyframe: keyframe 2 does not observe the point");
  ExpectRefused({"edit", cloud, output_, "--keyframes", points}, "line 1: a table of points");
  EXPECT_FALSE(std::filesystem::exists(output_));
}

// A cloud that was edited elsewhere comes back by way of a table.
TEST_F(Edit, PointsOfACloudComeBackByWayOfATable) {
  const std::string cloud = folder_ / "p.ply", points = folder_ / "p.csv";
  ASSERT_EQ(RunSlamdb({"convert", input_, cloud}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"convert", cloud, points}).exit_code, 0);
  const ProcessResult result = RunSlamdb({"edit", input_, output_, "--points", points});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr(": 0 moved, 0 changed otherwise"));
  EXPECT_EQ(ReadWholeFile(output_), bytes_);
}

// A point cloud is an atlas of points alone: what needs more says so.
TEST_F(Edit, PointCloudsAreRefusedWhereObservationsAreNeeded) {
  const std::string cloud = folder_ / "p.ply";
  ASSERT_EQ(RunSlamdb({"convert", input_, cloud}).exit_code, 0);
  for (const std::vector<std::string>& line :
       std::vector<std::vector<std::string>>{{"check"},
                                             {"repair", output_},
                                             {"optimize", output_},
                                             {"cull", output_},
                                             {"shrink", output_, "--target-keyframes", "3"},
                                             {"close-loops", output_},
                                             {"fragments", output_}}) {
    std::vector<std::string> words = line;
    words.insert(words.begin() + 1, cloud);
    ExpectRefused(words, "is a PLY point cloud; an atlas is needed");
  }
  EXPECT_EQ(RunSlamdb({"diff", input_, cloud}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"transform", cloud, folder_ / "big.ply", "--scale", "2"}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"diff", input_, folder_ / "big.ply"}).exit_code, 1);
}

TEST_F(Edit, SplitDoesNotReplaceItsInput) {
  const std::string map = folder_ / "map-0.osa";
  std::filesystem::copy_file(input_, map);
  const ProcessResult result = RunSlamdb({"split", map, (folder_ / "{}.osa"), "-O"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("never changed"));
  EXPECT_EQ(ReadWholeFile(map), bytes_);
}

TEST_F(Edit, SplitIntoAStoreWritesAllOrNothing) {
  ASSERT_EQ(RunSlamdb({"merge", input_, other_, "-o", output_}).exit_code, 0);
  const std::string store = folder_ / "s.db";
  ASSERT_EQ(RunSlamdb({"convert", input_, store + "#m-map-1"}).exit_code, 0);
  EXPECT_THAT(RunSlamdb({"split", output_, store + "#m"}).err, HasSubstr("m-map-1: is there already"));
  EXPECT_EQ(RunSlamdb({"convert", store + "#m-map-0", folder_ / "x.osa"}).exit_code, 1);
}

TEST_F(Edit, SplitKeepsCompoundSuffixes) {
  EXPECT_EQ(RunSlamdb({"split", input_, folder_ / "x.keyframes.csv"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "x-map-0.keyframes.csv"));
}

TEST_F(Edit, AnOutputThatIsThereIsRefusedBeforeTheWork) {
  ExpectRefused({"cull", folder_ / "missing.osa", input_}, "a.osa: is there already; -O/--overwrite replaces it");
}

TEST_F(Edit, OptionsThatMakeNoSenseAreUsageErrors) {
  ExpectRefused({"cull", input_}, "the output is missing", 2);
  ExpectRefused({"extract", input_, output_}, "say which part", 2);
  ExpectRefused({"shrink", input_, output_}, "say how small", 2);
  ExpectRefused({"shrink", input_, output_, "--target-keyframes", "0"}, "expected a number above 0, found '0'", 2);
  ExpectRefused({"renumber", input_, output_, "--start", "-1"}, "expected 0 or a number above it, found '-1'", 2);
  ExpectRefused({"merge", input_, other_, "-o", output_, "--join"}, "--join needs", 2);
}

TEST_F(Edit, TextStaysTextAndIsTakenBackToTheByte) {
  const std::string text = folder_ / "text.osa", back = folder_ / "back.osa";
  ASSERT_EQ(RunSlamdb({"convert", input_, text, "--text"}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"renumber", text, output_, "--start", "5", "--id-map", folder_ / "ids.csv"}).exit_code, 0);
  EXPECT_THAT(ReadWholeFile(output_), StartsWith("22 serialization::archive"));
  ASSERT_EQ(RunSlamdb({"renumber", output_, back, "--undo", folder_ / "ids.csv"}).exit_code, 0);
  EXPECT_TRUE(ReadWholeFile(back) == ReadWholeFile(text));
}

TEST_F(Edit, TablesWithIdsThatTheMapDoesNotHaveAreRefused) {
  const std::string ids = folder_ / "ids.csv", table = folder_ / "t.csv";
  ASSERT_EQ(
      RunSlamdb({"merge", input_, input_, "-o", output_, "--on-conflict", "keep-first", "--id-map", ids}).exit_code, 0);
  WriteWholeFile(table, "keyframe,x\n3,1\n");
  EXPECT_THAT(RunSlamdb({"renumber", table, folder_ / "u.csv", "--apply", ids, "--of", input_ + " (2)"}).err,
              HasSubstr("line 2: keyframe 3 is not in the result"));
  WriteWholeFile(table, "keyframe,x\n99,1\n");
  EXPECT_THAT(RunSlamdb({"renumber", table, folder_ / "u.csv", "--apply", ids, "--of", input_}).err,
              HasSubstr("keyframe 99 is not in the id map"));
}

// Whatever the verb: a result of which nothing is left is no success, and is not written.
TEST_F(Edit, NothingLeftIsNoSuccess) {
  Atlas atlas = ReadAtlas(input_);
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) keyframe.bad = true;
  const std::string all_bad = folder_ / "all_bad.osa";
  WriteAtlas(atlas, all_bad);
  const std::string lacks = "though the input has some; nothing was written";
  ExpectRefused({"repair", all_bad, output_}, "would hold no maps, " + lacks);
  ExpectRefused({"cull", input_, output_, "--unseen-since", "1e12"}, "would hold no points, " + lacks);
  ExpectRefused({"fragments", input_, output_, "--min-keyframes", "1000"}, "no map has 1000 keyframes");
  EXPECT_FALSE(std::filesystem::exists(output_));
  ExpectRefused({"convert", all_bad, folder_ / "x.keyframes.csv"}, "would hold no keyframes, " + lacks);
  ExpectRefused({"convert", input_, folder_ / "x.ply", "--box", "1e6,1e6,1e6:2e6,2e6,2e6"}, "has no points in the box");
  ExpectRefused({"convert", input_, folder_ / "x.tum", "--time", "1:2"},
                "has no keyframe from 1 s to 2 s; its keyframes are from ");
  EXPECT_EQ(RunSlamdb({"check", all_bad}).exit_code, 1);
  EXPECT_THAT(RunSlamdb({"check", all_bad, "--json"}).out, HasSubstr("atlas-not-empty"));
  // What had nothing to lose is told only.
  for (Map& map : atlas.maps) map.points.clear();
  WriteAtlas(atlas, all_bad, {.overwrite = true});
  const ProcessResult moved = RunSlamdb({"renumber", all_bad, output_, "--start", "5"});
  EXPECT_EQ(moved.exit_code, 0);
  EXPECT_THAT(moved.err, HasSubstr("holds no keyframes, and neither does the input"));
}

TEST_F(Edit, AFileWhoseNameNoAtlasMayHaveNamesNone) {
  for (const char* name : {"caf\xe9.osa", "a\x01z.osa"}) {
    const TemporaryFolder folder;
    std::filesystem::copy_file(SLAMDB_FIXTURES "/tiny/tiny.osa", folder / name);
    const ProcessResult result = RunSlamdb({"convert", folder / name, folder / "new.db"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(Store::Open(folder / "new.db").Names(), std::vector<std::string>{"atlas"});
  }
}

TEST_F(Edit, AStoreTakesTheNamesOfItsInputs) {
  const std::string store = folder_ / "m.db";
  EXPECT_THAT(RunSlamdb({"convert", input_, store}).out, HasSubstr("wrote " + store + "#a (store)"));
  EXPECT_THAT(RunSlamdb({"convert", other_, store}).out, HasSubstr("wrote " + store + "#b (store)"));
  EXPECT_EQ(RunSlamdb({"renumber", store + "#a", folder_ / "n.db", "--start", "5"}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"convert", folder_ / "n.db", folder_ / "o.db"}).exit_code, 0);
  EXPECT_THAT(RunSlamdb({"list", folder_ / "o.db"}).out, HasSubstr("\na "));
  EXPECT_THAT(RunSlamdb({"convert", input_, store}).err, HasSubstr("holds an atlas named 'a' already"));
  // Another name is another atlas, whatever -O replaces.
  const std::string single = folder_ / "single.db";
  ASSERT_EQ(RunSlamdb({"convert", input_, single + "#main"}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"convert", other_, single, "-O"}).exit_code, 0);
  EXPECT_THAT(RunSlamdb({"list", single}).out, AllOf(HasSubstr("\nb "), HasSubstr("\nmain ")));
  // Standard input has no name to give.
  const ProcessResult piped = RunSlamdb({"convert", "-", store, "--from", "orbslam3"}, bytes_);
  EXPECT_EQ(piped.exit_code, 1);
  EXPECT_THAT(piped.err, AllOf(HasSubstr("name the new one"), Not(HasSubstr("overwrite"))));
}

TEST_F(Edit, RecoverRepairsWhatCanBeReadButIsNotSound) {
  const ProcessResult result =
      RunSlamdb({"recover", SLAMDB_FIXTURES "/mono_small_twice/mono_small_twice.osa", output_});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.out, HasSubstr("not sound"));
  EXPECT_EQ(RunSlamdb({"check", output_}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"recover", input_, output_, "-O"}).exit_code, 0);
}

}  // namespace
}  // namespace slamdb::testing
