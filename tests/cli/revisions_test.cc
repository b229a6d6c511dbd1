// SPDX-License-Identifier: BSD-3-Clause
// Revisions at the command line: log, restore, tag, branch, gc, and every verb that reads one.
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Revisions : public ::testing::Test {
 protected:
  Revisions() {
    EXPECT_EQ(RunSlamdb({"synthesize", osa_, "--keyframes", "8", "--points", "200", "--seed", "3"}).exit_code, 0);
    EXPECT_EQ(RunSlamdb({"convert", osa_, At("lab")}).exit_code, 0);
    EXPECT_EQ(RunSlamdb({"transform", At("lab@1"), At("lab"), "--by", "1 0 0 0 0 0 1", "--overwrite"}).exit_code, 0);
  }
  std::string At(const std::string& name) const { return store_ + "#" + name; }
  json Log(const std::string& name) { return json::parse(RunSlamdb({"log", At(name), "--json"}).out).at("entries"); }

  TemporaryFolder folder_;
  std::string osa_ = folder_ / "map.osa", store_ = folder_ / "s.db", out_ = folder_ / "out.osa";
};

TEST_F(Revisions, EveryVerbReadsThem) {
  ASSERT_EQ(RunSlamdb({"convert", At("lab@1"), out_}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"diff", osa_, out_}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"diff", At("lab@1"), At("lab@2")}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"diff", At("lab@-1"), At("lab@1")}).exit_code, 0);
  for (const char* verb : {"info", "check", "dump"}) {
    const ProcessResult result = RunSlamdb({verb, At("lab@1")});
    EXPECT_EQ(result.exit_code, 0) << verb << result.err;
  }
  const ProcessResult missing = RunSlamdb({"info", At("lab@9")});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.err, HasSubstr("no revision '9' of 'lab'; it has 1, 2"));
  const ProcessResult over = RunSlamdb({"convert", osa_, At("lab@1"), "--overwrite"});
  EXPECT_EQ(over.exit_code, 1);
  EXPECT_THAT(over.err, HasSubstr("stands for a revision of 'lab'"));
}

TEST_F(Revisions, TheLogTellsWhatTheyChanged) {
  const ProcessResult text = RunSlamdb({"log", At("lab")});
  EXPECT_THAT(text.out, HasSubstr("lab@1"));
  EXPECT_THAT(text.out, HasSubstr("~8"));
  const ProcessResult result = RunSlamdb({"log", store_, "--json"});
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "log.schema.json"), "");
  const json second = Log("lab").at(1);
  EXPECT_EQ(second.at("revision"), 2);
  EXPECT_EQ(second.at("changes").at("keyframes"), json({{"added", 0}, {"removed", 0}, {"moved", 8}}));
  EXPECT_THAT(second.at("provenance"), HasSubstr("transform"));
}

TEST_F(Revisions, TagRestoreAndGiveUp) {
  EXPECT_THAT(RunSlamdb({"tag", At("lab@1"), "release"}).out, HasSubstr("#lab@release is lab@1"));
  EXPECT_THAT(RunSlamdb({"tag", At("lab")}).out, HasSubstr("release  lab@1"));
  const json tags = json::parse(RunSlamdb({"tag", At("lab"), "--json"}).out);
  EXPECT_EQ(BreachOf(tags, "tag.schema.json"), "");
  EXPECT_EQ(tags.at("tags").at(0).at("revision"), 1);
  EXPECT_EQ(RunSlamdb({"tag", At("lab"), "7"}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"tag", At("lab"), "--remove"}).exit_code, 2);
  EXPECT_EQ(json::parse(RunSlamdb({"tag", At("lab"), "x", "--json"}).out).at("tags").at(1).at("tag"), "x");
  EXPECT_EQ(json::parse(RunSlamdb({"tag", At("lab"), "x", "--remove", "--json"}).out).at("tags").size(), 1U);
  EXPECT_EQ(RunSlamdb({"tag", store_, "x"}).exit_code, 2);

  EXPECT_THAT(RunSlamdb({"restore", At("lab@release")}).out, HasSubstr("is lab@1 again"));
  EXPECT_EQ(RunSlamdb({"diff", At("lab"), osa_}).exit_code, 0);

  const ProcessResult unsaid = RunSlamdb({"gc", store_});
  EXPECT_EQ(unsaid.exit_code, 2);
  EXPECT_THAT(unsaid.err, HasSubstr("say what to keep"));
  EXPECT_EQ(RunSlamdb({"gc", store_, "--keep", "0"}).exit_code, 2);
  const ProcessResult dry = RunSlamdb({"gc", store_, "--keep-tags", "--dry-run", "--json"});
  const json planned = json::parse(dry.out);
  EXPECT_EQ(BreachOf(planned, "gc.schema.json"), "");
  EXPECT_EQ(planned.at("atlases").at(0).at("given_up").at(0), 2);
  EXPECT_EQ(RunSlamdb({"info", At("lab@2")}).exit_code, 0);
  EXPECT_THAT(RunSlamdb({"gc", store_, "--keep-tags"}).out, HasSubstr("given up, 2 kept"));
  EXPECT_EQ(RunSlamdb({"info", At("lab@2")}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"diff", At("lab@release"), osa_}).exit_code, 0);
  EXPECT_THAT(RunSlamdb({"gc", store_, "--keep", "5"}).out, HasSubstr("nothing to give up: 2 revisions kept"));
  EXPECT_EQ(RunSlamdb({"tag", At("lab"), "release", "--remove"}).exit_code, 0);
}

TEST_F(Revisions, CheckHoldsTheRulesAgainstEach) {
  ASSERT_EQ(RunSlamdb({"branch", At("lab@1"), "robot7"}).exit_code, 0);
  const auto inputs = [&](const std::vector<std::string>& more, int exit_code = 0) {
    std::vector<std::string> words = {"check", "--revisions", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const ProcessResult result = RunSlamdb(words);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    std::vector<std::string> names;
    const json report = json::parse(result.out);
    for (const json& input : report.at("inputs"))
      names.push_back(input.at("input").get<std::string>() + (input.contains("failure") ? " failed" : ""));
    return names;
  };
  const std::vector<std::string> all = {At("lab@1"), At("lab@2"), At("robot7@1")};
  EXPECT_EQ(inputs({store_}), all);
  EXPECT_EQ(inputs({At("lab")}), (std::vector<std::string>{At("lab@1"), At("lab@2")}));
  EXPECT_EQ(inputs({At("rob*")}), (std::vector<std::string>{At("robot7@1")}));
  EXPECT_EQ(inputs({At("lab@2")}), (std::vector<std::string>{At("lab@2")}));
  EXPECT_EQ(inputs({osa_}), (std::vector<std::string>{osa_}));
  const std::string journal = folder_ / "journal";
  EXPECT_EQ(inputs({store_, "--journal", journal}), all);
  EXPECT_THAT(RunSlamdb({"check", "--revisions", store_, "--journal", journal}).err,
              HasSubstr("3 of 3 are as they were"));

  // What was changed of an earlier one is found with it alone.
  const ProcessResult edited =
      RunProgram({"sqlite3", store_, "UPDATE past SET rows = zeroblob(length(rows)) WHERE part = 5"});
  if (edited.exit_code == 127) GTEST_SKIP() << "no sqlite3";
  EXPECT_EQ(RunSlamdb({"check", store_}).exit_code, 0);
  EXPECT_EQ(inputs({store_}, 1), (std::vector<std::string>{At("lab@1") + " failed", At("lab@2"), At("robot7@1")}));
}

// What a damaged store has lost is told, not left out.
TEST_F(Revisions, CheckTellsOfRevisionsThatTheLogOrTheStoreHasLost) {
  ASSERT_EQ(RunSlamdb({"tag", At("lab@1"), "release"}).exit_code, 0);
  const auto edit = [&](const std::string& sql) { return RunProgram({"sqlite3", store_, sql}).exit_code; };
  const auto failures = [&] {
    const ProcessResult result = RunSlamdb({"check", "--revisions", store_, "--json"});
    EXPECT_EQ(result.exit_code, 1) << result.err;
    const json report = json::parse(result.out);
    std::vector<std::string> told;
    for (const json& input : report.at("inputs"))
      told.push_back(input.contains("failure") ? input.at("failure").get<std::string>() : "");
    return told;
  };
  if (edit("DELETE FROM history WHERE revision = 1") == 127) GTEST_SKIP() << "no sqlite3";
  EXPECT_THAT(failures(), ElementsAre(HasSubstr("lab@1: table history has lost"), ""));
  EXPECT_EQ(RunSlamdb({"diff", At("lab@1"), osa_}).exit_code, 0) << "it can be read all the same";
  ASSERT_EQ(edit("DELETE FROM history WHERE revision = 2"), 0);
  EXPECT_THAT(failures(), ElementsAre(HasSubstr("lab@1"), "")) << "the atlas knows what its newest is";

  ASSERT_EQ(edit("UPDATE tag SET number = 99"), 0);
  EXPECT_THAT(failures(), ElementsAre(HasSubstr("lab@1"), "", HasSubstr("tag 'release' is of revision 99")));
  ASSERT_EQ(edit("UPDATE tag SET number = 1; DELETE FROM revision WHERE number = 1"), 0);
  EXPECT_THAT(failures(), ElementsAre("", HasSubstr("lab@release: tag 'release' is of revision 1, which is gone")));
}

// What they did, for scripts.
TEST_F(Revisions, VerbsTellInJson) {
  const auto told = [](const std::vector<std::string>& words, const std::string& schema, int exit_code = 0) {
    const ProcessResult result = RunSlamdb(words);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    const json report = json::parse(result.out);
    EXPECT_EQ(BreachOf(report, schema + ".schema.json"), "");
    return report;
  };
  const json branch = told({"branch", At("lab@1"), "robot7", "--json"}, "branch");
  EXPECT_EQ(branch.at("output"), At("robot7"));
  EXPECT_EQ(branch.at("from").at("revision"), 1);
  EXPECT_EQ(branch.at("from").at("hash"), Log("lab").at(0).at("hash"));

  const json restore = told({"restore", At("lab@1"), "--json"}, "restore");
  EXPECT_EQ(restore.at("revision"), 3);
  EXPECT_FALSE(restore.at("unchanged"));
  EXPECT_TRUE(told({"restore", At("lab@1"), "--json"}, "restore").at("unchanged"));

  const json remove = told({"remove", At("robot7"), At("nobody"), At("lab"), "--json"}, "remove", 1);
  EXPECT_EQ(remove.at("inputs"), json({{{"input", At("robot7")}}})) << "what is gone although the next failed";
  EXPECT_EQ(RunSlamdb({"info", At("lab")}).exit_code, 0);

  const json migrate = told({"migrate", store_, "--json"}, "migrate");
  EXPECT_EQ(migrate.at("output"), nullptr) << "it is up to date";
  EXPECT_EQ(migrate.at("before"), migrate.at("after"));
  const std::string other = folder_ / "other.db";
  ASSERT_EQ(RunSlamdb({"convert", osa_, other + "#lab"}).exit_code, 0);
  EXPECT_EQ(told({"migrate", other, "--back", "--dry-run", "--json"}, "migrate").at("output"), nullptr);
  const json back = told({"migrate", other, "--back", "--json"}, "migrate");
  EXPECT_EQ(back.at("output"), other);
  EXPECT_TRUE(std::filesystem::exists(back.at("backup").get<std::string>()));
}

// What a merge cannot know it does not guess.
TEST_F(Revisions, MergeRefusesWhatWouldLoseKeyframes) {
  ASSERT_EQ(RunSlamdb({"branch", At("lab"), "robot7"}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"extract", At("lab@2"), At("lab"), "--keyframe", "0,1,2,3", "--overwrite"}).exit_code, 0);
  const ProcessResult doubtful = RunSlamdb({"merge", At("lab"), At("robot7")});
  EXPECT_EQ(doubtful.exit_code, 1);
  EXPECT_THAT(doubtful.err, HasSubstr("lab@3 lacks 4 of the 8 keyframes of lab@2"));
  EXPECT_EQ(RunSlamdb({"merge", At("lab"), At("robot7"), "--base", At("lab@2")}).exit_code, 0) << "when told so";

  const ProcessResult older = RunSlamdb({"merge", At("lab@2"), At("robot7")});
  EXPECT_EQ(older.exit_code, 2);
  EXPECT_THAT(older.err, HasSubstr("lab@2 is not the newest revision of lab"));
  ASSERT_EQ(RunSlamdb({"convert", osa_, At("copy")}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"merge", At("robot7"), At("copy")}).exit_code, 2) << "a copy of which no history tells";
  ASSERT_EQ(RunSlamdb({"synthesize", At("stranger"), "--keyframes", "8", "--points", "200", "--seed", "4"}).exit_code,
            0);
  const ProcessResult baseless = RunSlamdb({"merge", At("lab"), At("stranger")});
  EXPECT_EQ(baseless.exit_code, 2);
  EXPECT_THAT(baseless.err, HasSubstr("knows nothing that lab and stranger both come from"));
}

TEST_F(Revisions, TheLogIsOfNamesThatAreKnown) {
  const ProcessResult one = RunSlamdb({"log", At("lab@1")});
  EXPECT_THAT(one.out, HasSubstr("lab@1"));
  EXPECT_THAT(one.out, ::testing::Not(HasSubstr("lab@2")));
  EXPECT_EQ(RunSlamdb({"log", At("nobody")}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"log", At("lab@9")}).exit_code, 1);
  ASSERT_EQ(RunSlamdb({"remove", At("lab")}).exit_code, 0);
  EXPECT_THAT(RunSlamdb({"log", At("lab")}).out, HasSubstr("remove"));
}

TEST_F(Revisions, WhatChangesNothingMakesNone) {
  const ProcessResult again = RunSlamdb({"convert", At("lab@2"), At("lab"), "--overwrite"});
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.err, HasSubstr("is there as it is: no new revision"));
  EXPECT_EQ(RunSlamdb({"info", At("lab@3")}).exit_code, 1);
}

TEST_F(Revisions, BranchesBeginAsRevisions) {
  EXPECT_THAT(RunSlamdb({"branch", At("lab@1"), "robot7"}).out, HasSubstr("#robot7 begins as lab@1"));
  EXPECT_EQ(RunSlamdb({"diff", At("robot7"), osa_}).exit_code, 0);
  EXPECT_EQ(Log("robot7").at(0).at("from").at("revision"), 1);
  EXPECT_EQ(RunSlamdb({"branch", At("lab"), "robot7"}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"branch", At("lab"), "ro#bot"}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"branch", At("nobody"), "b"}).exit_code, 1);
  EXPECT_THAT(RunSlamdb({"branch", At("lab"), At("robot8")}).out, HasSubstr("s.db#robot8 begins as lab@2"));
  const ProcessResult elsewhere = RunSlamdb({"branch", At("lab"), folder_ / "other.db#robot9"});
  EXPECT_EQ(elsewhere.exit_code, 2);
  EXPECT_THAT(elsewhere.err, HasSubstr("s.db; write 'robot9'"));
}

// What the robot did and what was done here, each a little: the merge has both, and knows what it was made of.
TEST_F(Revisions, MergeFindsWhatBranchesComeFrom) {
  ASSERT_EQ(RunSlamdb({"branch", At("lab"), "robot7"}).exit_code, 0);
  for (const auto& [atlas, observations] : {std::pair("lab@2", "3"), {"robot7@1", "4"}}) {
    const std::string name(atlas, std::string_view(atlas).find('@'));
    ASSERT_EQ(RunSlamdb({"cull", At(atlas), At(name), "--min-observations", observations, "--overwrite"}).exit_code, 0);
  }
  const ProcessResult merged = RunSlamdb({"merge", At("lab"), At("robot7")});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_THAT(merged.err, HasSubstr("lab and robot7 both come from lab@2: merged three ways"));
  EXPECT_EQ(Log("lab").back().at("from"),
            json({{"name", "robot7"}, {"revision", 2}, {"hash", Log("robot7").back().at("hash")}}));
  const ProcessResult again = RunSlamdb({"merge", At("lab"), At("robot7")});
  EXPECT_THAT(again.err, HasSubstr("both come from robot7@2"));
  EXPECT_THAT(again.err, HasSubstr("no new revision"));

  const ProcessResult beside = RunSlamdb({"merge", At("lab"), At("robot7"), "-o", out_, "--no-base", "--json"});
  EXPECT_EQ(beside.exit_code, 0) << beside.err;
  EXPECT_EQ(json::parse(RunSlamdb({"info", out_, "--json"}).out).at("maps").size(), 2U);
  const ProcessResult stray = RunSlamdb({"merge", osa_, osa_, "-o", out_, "--prefer", "theirs", "--overwrite"});
  EXPECT_EQ(stray.exit_code, 2);
  EXPECT_THAT(stray.err, HasSubstr("--prefer needs --base"));
}

TEST_F(Revisions, SyncOfTwoStores) {
  const std::string other = folder_ / "other.db";
  const json planned = json::parse(RunSlamdb({"sync", store_, other, "--dry-run", "--json"}).out);
  EXPECT_EQ(BreachOf(planned, "sync.schema.json"), "");
  EXPECT_EQ(planned.at("atlases").at(0).at("revisions"), json({1, 2}));
  EXPECT_FALSE(std::filesystem::exists(other));
  const ProcessResult copied = RunSlamdb({"sync", store_, other});
  EXPECT_EQ(copied.exit_code, 0) << copied.err;
  EXPECT_THAT(copied.out, HasSubstr("lab: 2 revisions to " + other));
  EXPECT_THAT(copied.out, HasSubstr("1 copied"));
  const json log = json::parse(RunSlamdb({"log", other + "#lab", "--json"}).out).at("entries");
  for (const char* name : {"at", "who", "tool", "provenance", "hash", "revision"})
    EXPECT_EQ(log.at(1).at(name), Log("lab").at(1).at(name)) << name;
  EXPECT_EQ(RunSlamdb({"sync", store_, other}).out, "1 same\n");

  // Each goes on with its own.
  const auto move = [&](const std::string& atlas, const char* by) {
    EXPECT_EQ(RunSlamdb({"transform", atlas + "@2", atlas, "--by", by, "--overwrite"}).exit_code, 0);
  };
  move(At("lab"), "2 0 0 0 0 0 1");
  move(other + "#lab", "3 0 0 0 0 0 1");
  const ProcessResult diverged = RunSlamdb({"sync", store_, other});
  EXPECT_EQ(diverged.exit_code, 3);
  EXPECT_THAT(diverged.err, HasSubstr("--diverged branch brings"));
  const ProcessResult branched = RunSlamdb({"sync", store_, other, "--diverged", "branch", "--json"});
  EXPECT_EQ(branched.exit_code, 0);
  const json report = json::parse(branched.out);
  EXPECT_EQ(BreachOf(report, "sync.schema.json"), "");
  const std::string branch = report.at("atlases").at(0).at("branch");
  EXPECT_THAT(branched.err, HasSubstr("slamdb merge " + other + "#lab " + other + "#" + branch));
  EXPECT_EQ(RunSlamdb({"merge", other + "#lab", other + "#" + branch}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"sync", store_, other}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"diff", At("lab"), other + "#lab"}).exit_code, 0);

  // Tags of two revisions.
  RunSlamdb({"tag", At("lab@1"), "release"});
  RunSlamdb({"tag", other + "#lab@2", "release"});
  const ProcessResult conflict = RunSlamdb({"sync", store_, other});
  EXPECT_EQ(conflict.exit_code, 3);
  EXPECT_THAT(conflict.err, HasSubstr("the tag 'release' of 'lab' is revision 1 in "));

  EXPECT_EQ(RunSlamdb({"sync", store_, store_}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"sync", At("lab"), other}).exit_code, 2);
  const ProcessResult unknown = RunSlamdb({"sync", store_, other, "--name", "nobody"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("has an atlas named 'nobody'"));
}

TEST_F(Revisions, SyncTellsWhatStaysInOneStoreAlone) {
  const std::string other = folder_ / "other.db";
  RunSlamdb({"tag", At("lab@1"), "first"});
  ASSERT_EQ(RunSlamdb({"add", other, store_}).exit_code, 0);
  const ProcessResult told = RunSlamdb({"sync", store_, other});
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.out, "1 same\n");
  EXPECT_THAT(told.err, HasSubstr("'lab' has 1 earlier revision, with the tag 'first', in " + store_ + " alone"));
  const json report = json::parse(RunSlamdb({"sync", store_, other, "--json"}).out);
  EXPECT_EQ(BreachOf(report, "sync.schema.json"), "");
  EXPECT_EQ(report.at("same"), 1);
  EXPECT_EQ(report.at("atlases").at(0).at("alone"),
            json::parse(R"([{"in": "first", "revisions": [1], "tags": ["first"]}])"));
  // Without what the other has by itself, all of it comes.
  RunSlamdb({"remove", other + "#lab"});
  EXPECT_EQ(RunSlamdb({"sync", store_, other}).err, "");
  EXPECT_EQ(RunSlamdb({"sync", store_, other}).out, "1 same\n");
  EXPECT_EQ(json::parse(RunSlamdb({"log", other + "#lab", "--json"}).out).at("entries").back().at("revision"), 2);
}

}  // namespace
}  // namespace slamdb::testing
