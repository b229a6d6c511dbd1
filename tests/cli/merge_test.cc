// SPDX-License-Identifier: BSD-3-Clause
//
// The verbs that bring atlases together and change their ids.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "slamdb/view/page.h"
#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class Merge : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* seed : {"1", "2"}) {
      const ProcessResult made = RunSlamdb({"synthesize", Input(seed), "--sensor", "rgbd", "--keyframes", "10",
                                            "--points", "200", "--features", "200", "--seed", seed});
      ASSERT_EQ(made.exit_code, 0) << made.err;
    }
  }

  std::string Input(const std::string& seed) const { return folder_ / (seed + ".osa"); }
  std::string At(const std::string& name) const { return folder_ / name; }
  json Info(const std::string& path) const { return json::parse(RunSlamdb({"info", "--json", path}).out); }

  // Failed as it should: that exit code and message, and nothing written.
  void ExpectRefusal(const std::vector<std::string>& arguments, const std::string& message, int exit_code = 1) {
    SCOPED_TRACE(message);
    const ProcessResult result = RunSlamdb(arguments);
    EXPECT_EQ(result.exit_code, exit_code);
    EXPECT_THAT(result.err, StartsWith("slamdb: error: "));
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(At("out.osa")));
    EXPECT_FALSE(std::filesystem::exists(At("ids.csv")));
  }

  TemporaryFolder folder_;
};

TEST_F(Merge, UnionOfTwoFiles) {
  const ProcessResult result =
      RunSlamdb({"merge", Input("1"), Input("2"), "-o", At("out.osa"), "--id-map", At("ids.csv")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("nothing was lost"));
  EXPECT_THAT(result.out, HasSubstr("wrote " + At("out.osa")));
  EXPECT_EQ(Info(At("out.osa")).at("maps").size(), 2U);
  EXPECT_EQ(RunSlamdb({"check", "--strict", At("out.osa")}).exit_code, 0);
  EXPECT_THAT(ReadWholeFile(At("ids.csv")), StartsWith("input,kind,old,new\n" + Input("1") + ",map,0,0\n"));
  EXPECT_THAT(ReadWholeFile(At("ids.csv")), HasSubstr("\n" + Input("2") + ",keyframe,0,10\n"));
}

TEST_F(Merge, JsonFollowsTheSchema) {
  const ProcessResult result = RunSlamdb({"merge", "--json", Input("1"), Input("2"), "-o", At("out.osa"), "--join",
                                          "--transform", "0 0 0 0 0 0 1", "--fuse", "--id-map", At("ids.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "merge.schema.json"), "");
  EXPECT_EQ(report.at("result").at("keyframes"), 20);
  EXPECT_EQ(report.at("join").at("keyframes"), 10);
  EXPECT_EQ(BreachOf(json::parse(ReadWholeFile(At("ids.json"))), "id_map.schema.json"), "");
  EXPECT_EQ(Info(At("out.osa")).at("maps").size(), 1U);
}

TEST_F(Merge, IntoAStoreWithHistory) {
  const std::string store = At("lab.db");
  ASSERT_EQ(RunSlamdb({"convert", Input("1"), store + "#one"}).exit_code, 0);
  const ProcessResult merged = RunSlamdb({"merge", store + "#one", Input("2"), "-o", store + "#both"});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_THAT(RunSlamdb({"log", store + "#both"}).out, HasSubstr("merge " + store + "#one " + Input("2")));
}

TEST_F(Merge, AnchorsFromATable) {
  ASSERT_EQ(RunSlamdb({"renumber", Input("1"), At("moved.osa"), "--start", "50"}).exit_code, 0);
  WriteWholeFile(At("anchors.csv"), "first,second\n0,50\n3,53\n6,56\n9,59\n");
  const ProcessResult result =
      RunSlamdb({"merge", Input("1"), At("moved.osa"), "-o", At("out.osa"), "--join", "--anchors", At("anchors.csv")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("4 were used"));
  EXPECT_THAT(result.err, HasSubstr("--on-conflict keep-first"));
  EXPECT_EQ(RunSlamdb({"check", At("out.osa")}).exit_code, 0);
}

TEST_F(Merge, RefusesWhatDoesNotFit) {
  const std::vector<std::string> merge = {"merge",       Input("1"), Input("2"),   "-o",
                                          At("out.osa"), "--id-map", At("ids.csv")};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), merge.begin(), merge.end());
    return more;
  };
  ExpectRefusal(with({"--join"}), "--join needs --transform or --anchors", 2);
  ExpectRefusal(with({"--join", "--transform", "1 2 3"}), "not 3");
  ExpectRefusal(with({"--join", "--transform", "0 0 0 0 0 0 1 0"}), "scale");
  ExpectRefusal(with({"--join", "--anchors", "0:0,1:1"}), "at least 3 pairs");
  ExpectRefusal(with({"--join", "--anchors", "0:0,1:1,2:700"}), "is not in map");
  ExpectRefusal(with({"--join", "--transform", "0 0 0 0 0 0 1", "--maps", "7:"}), "has no map 7 to join");
  ExpectRefusal(with({"--transform", "0 0 0 0 0 0 1"}), "--join", 2);
  ExpectRefusal({"merge", Input("1"), Input("1"), "-o", At("out.osa"), "--on-conflict", "error"}, "again");
  ExpectRefusal({"merge", Input("1"), Input("2")}, "the output is missing", 2);
  EXPECT_THAT(RunSlamdb({"merge", Input("1"), Input("2"), "-o", Input("1"), "-O"}).err, HasSubstr("is the input"));
}

TEST_F(Merge, VocabulariesMustAgree) {
  ASSERT_EQ(RunSlamdb({"vocabulary", "set", Input("2"), At("other.osa"), "--name", "other.txt", "--checksum",
                       "0123456789abcdef0123456789abcdef"})
                .exit_code,
            0);
  ExpectRefusal({"merge", Input("1"), At("other.osa"), "-o", At("out.osa")}, "vocabulary");
  const ProcessResult insisted =
      RunSlamdb({"merge", Input("1"), At("other.osa"), "-o", At("out.osa"), "--ignore-vocabulary"});
  EXPECT_EQ(insisted.exit_code, 0) << insisted.err;
  EXPECT_THAT(insisted.err, HasSubstr("compute them anew"));
}

TEST_F(Merge, DryRunWritesNothing) {
  const ProcessResult result = RunSlamdb({"merge", Input("1"), Input("2"), "--dry-run", "--id-map", At("ids.csv")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, Not(HasSubstr("wrote")));
  EXPECT_FALSE(std::filesystem::exists(At("ids.csv")));
}

TEST_F(Merge, RenumberAndUndoGiveTheSameBytes) {
  for (const char* table : {"ids.csv", "ids.json"}) {
    const ProcessResult there = RunSlamdb({"renumber", Input("1"), At("moved.osa"), "-O", "--kinds", "all", "--start",
                                           "7", "--order", "time", "--id-map", At(table), "--json"});
    ASSERT_EQ(there.exit_code, 0) << there.err;
    EXPECT_EQ(BreachOf(json::parse(there.out), "renumber.schema.json"), "");
    EXPECT_EQ(RunSlamdb({"check", "--strict", At("moved.osa")}).exit_code, 0);
    ASSERT_EQ(RunSlamdb({"renumber", At("moved.osa"), At("back.osa"), "-O", "--undo", At(table)}).exit_code, 0);
    EXPECT_TRUE(ReadWholeFile(At("back.osa")) == ReadWholeFile(Input("1")));
  }
}

TEST_F(Merge, IdMapsApplyToTables) {
  ASSERT_EQ(RunSlamdb({"merge", Input("1"), Input("2"), "-o", At("out.osa"), "--id-map", At("ids.csv")}).exit_code, 0);
  RunSlamdb({"convert", Input("2"), At("2.keyframes.csv")});
  const std::vector<std::string> apply = {"renumber", At("2.keyframes.csv"), At("moved.csv"), "--apply", At("ids.csv")};
  EXPECT_THAT(RunSlamdb(apply).err, HasSubstr("--of"));
  auto with_input = apply;
  with_input.insert(with_input.end(), {"--of", Input("2")});
  ASSERT_EQ(RunSlamdb(with_input).exit_code, 0);
  EXPECT_THAT(ReadWholeFile(At("moved.csv")), HasSubstr("\n1,10,"));
}

TEST_F(Merge, RenumberRefusesForeignTables) {
  WriteWholeFile(At("t.csv"), "kind,old,new\nkeyframe,0,1\nkeyframe,1,1\n");
  ExpectRefusal({"renumber", Input("1"), At("out.osa"), "--apply", At("t.csv")}, "twice");
  WriteWholeFile(At("t.csv"), "kind,old,new\nkeyframe,0,1\n");
  ExpectRefusal({"renumber", Input("1"), At("out.osa"), "--apply", At("t.csv")}, "does not name keyframe 1");
  WriteWholeFile(At("t.csv"), "kind,old,new\nkeyframe,0\n");
  ExpectRefusal({"renumber", Input("1"), At("out.osa"), "--undo", At("t.csv")}, "line 2");
  WriteWholeFile(At("t.json"), "{}");
  ExpectRefusal({"renumber", Input("1"), At("out.osa"), "--undo", At("t.json")}, "is no id map");
  ExpectRefusal({"renumber", Input("1"), At("out.osa"), "--offset", "-5"}, "negative");
  ExpectRefusal({"renumber", Input("1"), At("out.osa"), "--kinds", "fish"}, "fish", 2);
}

TEST_F(Merge, ReassignOrigin) {
  const ProcessResult result = RunSlamdb({"reassign-origin", Input("1"), At("out.osa"), "--map", "0=3", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "reassign-origin.schema.json"), "");
  EXPECT_EQ(report.at("after"), json::parse(R"([{"map": 3, "keyframes": 10, "points": 0}])"));
  EXPECT_EQ(report.at("next_ids").at("map"), 4);
  EXPECT_EQ(Info(At("out.osa")).at("maps").at(0).at("origins").at(0).at("map"), 3);
  std::filesystem::remove(At("out.osa"));
  ExpectRefusal({"reassign-origin", Input("1"), At("out.osa"), "--map", "8=0"},
                "no keyframe or point has origin map 8");
  ExpectRefusal({"reassign-origin", Input("1"), At("out.osa")}, "nothing to do", 2);
  ExpectRefusal({"reassign-origin", Input("1"), At("out.osa"), "--map", "8"}, "FROM=TO", 2);
}

// Two continuations of the first keyframes of one atlas.
class MergeContinuations : public Merge {
 protected:
  void SetUp() override {
    Merge::SetUp();
    for (const auto& [name, keyframes] : {std::pair("base", "0,1,2,3,4,5"), std::pair("ours", "0,1,2,3,4,5,6,7"),
                                          std::pair("theirs", "0,1,2,4,5,8,9")}) {
      const ProcessResult made =
          RunSlamdb({"extract", Input("1"), At(name + std::string(".osa")), "--keyframe", keyframes});
      ASSERT_EQ(made.exit_code, 0) << made.err;
    }
  }
  std::vector<std::string> Words(std::vector<std::string> more = {}) const {
    std::vector<std::string> words = {"merge",          "--base", At("base.osa"), At("ours.osa"),
                                      At("theirs.osa"), "-o",     At("out.osa")};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

TEST_F(MergeContinuations, BecomeOneMap) {
  const ProcessResult result = RunSlamdb(Words({"--id-map", At("ids.csv")}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("nothing was lost"));
  const json map = Info(At("out.osa")).at("maps").at(0);
  EXPECT_EQ(map.at("keyframes"), 9);  // without the one that theirs has culled
  EXPECT_EQ(RunSlamdb({"check", At("out.osa")}).exit_code, 0);
  const std::string ids = ReadWholeFile(At("ids.csv"));
  EXPECT_THAT(ids, HasSubstr("\n" + At("ours.osa") + ",keyframe,3,\n"));
  EXPECT_THAT(ids, HasSubstr("\n" + At("theirs.osa") + ",keyframe,9,9\n"));
}

TEST_F(MergeContinuations, JsonFollowsTheSchema) {
  const ProcessResult result = RunSlamdb(Words({"--json", "--geometry", "ours", "--prefer", "theirs"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "merge.schema.json"), "");
  EXPECT_EQ(report.at("branches").at("geometry"), "ours");
  EXPECT_EQ(report.at("branches").at("ledgers").at("keyframes").at("deleted_by_theirs"), 1);
  EXPECT_EQ(report.at("result").at("keyframes"), 9);
}

TEST_F(MergeContinuations, ConflictsAreShownInPlace) {
  if (!HasViewPage()) GTEST_SKIP() << "built without esbuild";
  for (const auto& [name, keyframes] :
       {std::pair("base", "0,1,2,3,4,5,6,7"), std::pair("ours", "0,1,2,3,4,5,6,7,8,9,10"),
        std::pair("theirs", "0,1,2,3,5,6,7,11,12,13")}) {
    const ProcessResult made = RunSlamdb({"extract", SLAMDB_FIXTURES "/session_small_a/session_small_a.osa",
                                          At(name + std::string(".osa")), "--keyframe", keyframes, "-O"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  const ProcessResult merged = RunSlamdb(Words({"--json"}));
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  const std::size_t conflicts = json::parse(merged.out).at("branches").at("conflicts").size();
  ASSERT_GT(conflicts, 0U);
  WriteWholeFile(At("merge.json"), merged.out);
  const auto view = [&](const std::string& atlas, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"view", At(atlas),    "--findings", At("merge.json"),
                                      "-o",   At("x.html"), "-O",         "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return RunSlamdb(words);
  };
  const ProcessResult shown = view("out.osa");
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_EQ(json::parse(shown.out).at("findings"), conflicts);
  EXPECT_EQ(shown.err, "");
  std::filesystem::copy_file(SLAMDB_FIXTURES "/tiny/tiny.osa", At("tiny.osa"));
  EXPECT_THAT(view("tiny.osa").err, HasSubstr("is the report of another atlas?"));
  EXPECT_EQ(view("out.osa", {At("2.osa")}).exit_code, 2);
  EXPECT_EQ(view("out.osa", {"--no-check"}).exit_code, 2);
  WriteWholeFile(At("merge.json"), "{}");
  const ProcessResult none = view("out.osa");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("merge.json: is not a report of a check or a merge"));
}

TEST_F(MergeContinuations, AnUntouchedSideLeavesTheOtherToTheByte) {
  ASSERT_EQ(
      RunSlamdb({"merge", "--base", At("base.osa"), At("ours.osa"), At("base.osa"), "-o", At("out.osa")}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(At("out.osa")), ReadWholeFile(At("ours.osa")));
  ASSERT_EQ(RunSlamdb(Words({"-O"})).exit_code, 0);
  const ProcessResult again =
      RunSlamdb({"merge", "--base", At("base.osa"), At("out.osa"), At("theirs.osa"), "-o", At("again.osa")});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("as after a merge: the result is"));
  EXPECT_EQ(ReadWholeFile(At("again.osa")), ReadWholeFile(At("out.osa")));
}

TEST_F(MergeContinuations, RefusesWhatDoesNotGoTogether) {
  ExpectRefusal(Words({"--join"}), "--join and --base exclude each other", 2);
  ExpectRefusal(Words({"--align"}), "--align and --base exclude each other", 2);
  ExpectRefusal(Words({"--on-conflict", "error"}), "--on-conflict and --base exclude each other", 2);
  ExpectRefusal({"merge", Input("1"), Input("2"), "-o", At("out.osa"), "--geometry", "ours"}, "--base", 2);
  ExpectRefusal({"merge", Input("1"), Input("2"), "-o", At("out.osa"), "--no-fuse"}, "--no-fuse needs", 2);
  ExpectRefusal({"merge", "--base", At("base.osa"), At("ours.osa"), "-o", At("out.osa")}, "two inputs", 2);
  ExpectRefusal({"merge", "--base", Input("2"), At("ours.osa"), At("theirs.osa"), "-o", At("out.osa")},
                "`slamdb merge --align`");
  EXPECT_THAT(
      RunSlamdb({"merge", "--base", At("base.osa"), At("ours.osa"), At("theirs.osa"), "-o", At("base.osa"), "-O"}).err,
      HasSubstr("is the input"));
}

}  // namespace
}  // namespace slamdb::testing
