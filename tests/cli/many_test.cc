// SPDX-License-Identifier: BSD-3-Clause
// Verbs of many atlases: list, add, and check of folders and stores.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <sstream>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kFixtures = SLAMDB_FIXTURES;
const std::string kTiny = kFixtures + "/tiny/tiny.osa";

// maps/ with session_small_a.osa, mono_small_twice.osa, which is not sound, and tiny2.osa, tiny10.osa.
class Many : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(In("maps"));
    for (const char* name : {"tiny2.osa", "tiny10.osa"}) fs::copy_file(kTiny, In("maps/") + name);
    for (const char* name : {"session_small_a", "mono_small_twice"})
      fs::copy_file(kFixtures + "/" + name + "/" + name + ".osa", In("maps/") + name + ".osa");
  }

  std::string In(const std::string& name) const { return folder_ / name; }
  std::string Maps() const { return In("maps"); }

  static json Json(std::vector<std::string> words, const std::string& schema) {
    words.insert(words.begin() + 1, "--json");
    json report = json::parse(RunSlamdb(words).out);
    EXPECT_EQ(BreachOf(report, schema), "");
    return report;
  }
  static json List(std::vector<std::string> words) {
    words.insert(words.begin(), "list");
    return Json(words, "list.schema.json");
  }
  static std::vector<std::string> NamesOf(const json& report) {
    std::vector<std::string> names;
    for (const json& atlas : report.at("atlases")) names.push_back(atlas.at("name"));
    return names;
  }

  TemporaryFolder folder_;
};

TEST_F(Many, ListOfAFolder) {
  const ProcessResult text = RunSlamdb({"list", Maps()});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("SENSOR"), HasSubstr("stereo or RGB-D"), HasSubstr("5.253 m"),
                              HasSubstr("17.9 s"), HasSubstr("2014-06-24 19:02")));
  EXPECT_LT(text.out.find("tiny2.osa"), text.out.find("tiny10.osa"));
  const json report = List({Maps()});
  EXPECT_EQ(report.at("input"), Maps());
  EXPECT_THAT(NamesOf(report), ElementsAre("mono_small_twice", "session_small_a", "tiny2", "tiny10"));
  const json& small = report.at("atlases")[1];
  EXPECT_EQ(small.at("keyframes"), 14);
  EXPECT_EQ(small.at("points"), 3162);
  EXPECT_EQ(small.at("sensors"), json::array({"stereo-or-rgbd"}));
  EXPECT_NEAR(small.at("trajectory_length"), 5.253, 1e-3);
}

TEST_F(Many, ListWithoutANameIsOfThisFolder) {
  const ProcessResult here = RunProgram({"bash", "-c", "cd \"$0\" && \"$1\" list", Maps(), SLAMDB_COMMAND});
  EXPECT_EQ(here.exit_code, 0) << here.err;
  EXPECT_THAT(here.out, HasSubstr("session_small_a.osa"));
}

TEST_F(Many, ListIsSortedAndShowsWhatIsAskedFor) {
  EXPECT_EQ(NamesOf(List({Maps(), "--sort", "-keyframes,name"})).front(), "mono_small_twice");
  EXPECT_THAT(NamesOf(List({Maps(), "--sort", "points,-name"})),
              ElementsAre("tiny10", "tiny2", "mono_small_twice", "session_small_a"));
  EXPECT_EQ(RunSlamdb({"list", Maps() + "/tiny2.osa", "--columns", "name,keyframes,format"}).out,
            "NAME   KEYFRAMES  FORMAT\ntiny2          2  orbslam3\n");
  for (const char* option : {"--sort", "--columns"}) {
    const ProcessResult wrong = RunSlamdb({"list", Maps(), option, "sise"});
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.err, HasSubstr("'sise' is none of name, "));
  }
}

TEST_F(Many, ListOfWhatCannotBeReadIsALineAndAFailure) {
  WriteWholeFile(In("maps/broken.osa"), "");
  const ProcessResult text = RunSlamdb({"list", Maps()});
  EXPECT_EQ(text.exit_code, 1);
  EXPECT_THAT(text.out, AllOf(HasSubstr("PROBLEM"), HasSubstr("broken.osa"), HasSubstr("session_small_a")));
  EXPECT_THAT(text.err, HasSubstr("1 of 5 could not be read"));
  const json report = List({Maps(), "--sort", "size"});
  EXPECT_EQ(NamesOf(report).front(), "broken") << "its size is known";
  EXPECT_TRUE(report.at("atlases")[0].contains("failure"));
}

TEST_F(Many, ListFitsTheTerminal) {
  const auto list = [&](const std::string& columns, std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"env", "COLUMNS=" + columns, SLAMDB_COMMAND, "list", Maps()};
    words.insert(words.end(), more.begin(), more.end());
    return RunProgram(words).out;
  };
  const auto widest = [](const std::string& text) {
    std::size_t most = 0;
    std::istringstream lines(text.substr(0, text.find("left out")));
    for (std::string line; std::getline(lines, line);) most = std::max(most, line.size());
    return most;
  };
  const std::string whole = list("1000");
  EXPECT_THAT(whole, AllOf(HasSubstr("SPAN"), Not(HasSubstr("left out"))));
  const std::size_t width = widest(whole);
  EXPECT_EQ(list(std::to_string(width)), whole) << "it fits";
  const std::string narrower = list(std::to_string(width - 1));
  EXPECT_THAT(narrower, AllOf(Not(HasSubstr("SPAN")), HasSubstr("SENSOR"),
                              EndsWith("left out for want of room: span; --columns names what to show\n")));
  const std::string narrow = list("60");
  EXPECT_LE(widest(narrow), 60U) << narrow;
  EXPECT_THAT(narrow, AllOf(HasSubstr("KEYFRAMES"), HasSubstr("\n..."), HasSubstr("session_small_a.osa")));
  EXPECT_EQ(list("60", {"--columns", "input,span,sensor"}), list("1000", {"--columns", "input,span,sensor"}));
}

TEST_F(Many, ListCountsObservationsAsInfoDoes) {
  for (const char* sensor : {"stereo", "fisheye"}) {
    ASSERT_EQ(RunSlamdb({"synthesize", In("made.osa"), "--sensor", sensor, "-O", "-q"}).exit_code, 0);
    const json info = json::parse(RunSlamdb({"info", In("made.osa"), "--json"}).out);
    EXPECT_EQ(List({In("made.osa")}).at("atlases")[0].at("observations"), info.at("totals").at("observations"));
    EXPECT_GT(info.at("totals").at("observations"), 0);
  }
}

TEST_F(Many, ListChecks) {
  const ProcessResult text = RunSlamdb({"list", Maps(), "--check"});
  EXPECT_EQ(text.exit_code, 1);
  EXPECT_THAT(text.out, AllOf(HasSubstr("VERDICT"), HasSubstr("1 error, 876 notes: not sound")));
  const json report = List({Maps(), "--check"});
  EXPECT_EQ(report.at("atlases")[0].at("sound"), false);
  EXPECT_EQ(report.at("atlases")[0].at("severities").at("error"), 1);
  EXPECT_EQ(RunSlamdb({"list", Maps() + "/session_small_a.osa", "--check"}).exit_code, 0);
}

TEST_F(Many, ListTellsWhatCoversAPlaceOrATime) {
  ASSERT_EQ(RunSlamdb({"add", In("s.db"), Maps(), "-q"}).exit_code, 0);
  for (const std::string& where : {Maps(), In("s.db")}) {
    SCOPED_TRACE(where);
    const auto found = [&](const std::vector<std::string>& query) {
      std::vector<std::string> words = {where};
      words.insert(words.end(), query.begin(), query.end());
      return NamesOf(List(words));
    };
    EXPECT_THAT(found({"--time", "1403636595"}), ElementsAre("session_small_a"));
    EXPECT_THAT(found({"--time", "2014-06-24T19:03:15Z"}), ElementsAre("session_small_a"));
    EXPECT_THAT(found({"--time", "2014-06-24T19:03:15Z:2014-06-25"}), ElementsAre("session_small_a"));
    EXPECT_EQ(found({"--time", "2014-06-24"}).size(), 2U) << "a day is all of it";
    EXPECT_EQ(found({"--time", "2014-06-25:"}).size(), 0U);
    EXPECT_THAT(found({"--keyframes", "13..20", "--time", "1403636500:"}), ElementsAre("session_small_a"));
    EXPECT_THAT(found({"--near", "0,0,3,0.5", "--time", "1403636585:1403636586"}), ElementsAre("session_small_a"));
    EXPECT_THAT(found({"--near", "1000,0,3", "--time", "1403636585"}), ElementsAre());
    EXPECT_EQ(found({"--time", ":9e12"}).size(), 4U);
    EXPECT_THAT(found({"--time", "1403636595..2014-06-24"}), ElementsAre("session_small_a"));
    EXPECT_THAT(found({"--keyframes", "13:20", "--time", "1403636500:"}), ElementsAre("session_small_a"));
  }
  EXPECT_EQ(RunSlamdb({"list", In("s.db"), "--near", "1000,0,3"}).out, "no atlas covers that\n");
  const ProcessResult counted = RunSlamdb({"list", Maps(), "--time", "+0:+10"});
  EXPECT_EQ(counted.exit_code, 2);
  EXPECT_THAT(counted.err, HasSubstr("'+0:+10' counts from keyframes, which are others in each map; expected seconds"));
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{{"--time", "9:2"},
                                                                                     {"--time", "noon"},
                                                                                     {"--near", "1,2"},
                                                                                     {"--near", "1,2,3,-1"},
                                                                                     {"--near", "nan,0,0"},
                                                                                     {"--keyframes", "9..2"},
                                                                                     {"--keyframes", ".."}}) {
    SCOPED_TRACE(wrong[1]);
    EXPECT_EQ(RunSlamdb({"list", Maps(), wrong[0], wrong[1]}).exit_code, 2);
  }
}

TEST_F(Many, NamesThatSteerATerminalAreShownAsTheyAre) {
  fs::copy_file(kTiny, In("maps/e\x1b[31m\nx.osa"));
  const ProcessResult text = RunSlamdb({"list", Maps()});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("e\\e[31m\\nx.osa"), Not(HasSubstr("\x1b"))));
  EXPECT_THAT(RunSlamdb({"check", Maps()}).out, AllOf(HasSubstr("e\\e[31m\\nx.osa: sound"), Not(HasSubstr("\x1b"))));
}

TEST_F(Many, WhatFoldersHoldBesidesIsTold) {
  WriteWholeFile(In("maps/notes.txt"), "");
  WriteWholeFile(In("maps/.hidden"), "");
  fs::create_directory(In("maps/inner"));
  ASSERT_EQ(::mkfifo(In("maps/pipe.osa").c_str(), 0600), 0);
  EXPECT_THAT(RunSlamdb({"list", Maps()}).err,
              HasSubstr("left out 1 other file, 1 hidden, 1 that are no files, 1 folder (-r looks into them)"));
  EXPECT_EQ(RunSlamdb({"list", Maps(), "-q"}).err, "");
}

TEST_F(Many, AddKeepsAFolder) {
  const ProcessResult added = RunSlamdb({"add", In("s.db"), Maps()});
  EXPECT_EQ(added.exit_code, 0) << added.err;
  EXPECT_THAT(added.out, AllOf(HasSubstr("added      session_small_a   1 map, 14 keyframes, 3,162 points"),
                               HasSubstr("4 added; " + In("s.db") + " holds 4 atlases")));
  const ProcessResult again = RunSlamdb({"add", In("s.db"), Maps()});
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.out, HasSubstr("4 unchanged; "));
  for (const char* name : {"session_small_a", "tiny10"}) {
    ASSERT_EQ(RunSlamdb({"convert", In("s.db#") + name, In("back.osa"), "-O"}).exit_code, 0);
    EXPECT_EQ(ReadWholeFile(In("back.osa")), ReadWholeFile(In("maps/") + name + ".osa"));
  }
  EXPECT_THAT(RunSlamdb({"log", In("s.db#tiny2")}).out, HasSubstr("add "));
}

TEST_F(Many, AddReportsAsJson) {
  WriteWholeFile(In("maps/broken.osa"), "");
  const json dry = Json({"add", In("s.db"), Maps(), "--dry-run"}, "add.schema.json");
  EXPECT_EQ(dry.at("output"), nullptr);
  EXPECT_FALSE(fs::exists(In("s.db")));
  const json report = Json({"add", In("s.db"), Maps()}, "add.schema.json");
  EXPECT_EQ(report.at("output"), In("s.db"));
  EXPECT_EQ(report.at("added"), 4);
  EXPECT_EQ(report.at("failed"), 1);
  EXPECT_EQ(report.at("atlases"), 4);
  EXPECT_EQ(report.at("inputs")[0].at("result"), "failed");
}

TEST_F(Many, AddOfAnotherAtlasNeedsOverwrite) {
  ASSERT_EQ(RunSlamdb({"add", In("s.db"), kTiny, "--as", "session_small_a"}).exit_code, 0);
  const ProcessResult refused = RunSlamdb({"add", In("s.db"), Maps()});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("holds another atlas named 'session_small_a'"), HasSubstr("-O/--overwrite"),
                                 HasSubstr("--as")));
  EXPECT_THAT(refused.out, HasSubstr("3 added, 1 failed"));
  EXPECT_THAT(RunSlamdb({"add", In("s.db"), Maps(), "-O"}).out, HasSubstr("1 replaced, 3 unchanged"));
}

TEST_F(Many, AddRefusesWhatMakesNoSense) {
  EXPECT_EQ(RunSlamdb({"add", In("s.db")}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"add", In("s.db#name"), Maps()}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"add", In("s.db"), Maps(), "--as", "x", "--name-from", "path"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"add", In("s.db"), Maps(), "--as", "x"}).exit_code, 1);
  const std::string before = ReadWholeFile(kTiny);
  const ProcessResult swapped = RunSlamdb({"add", Maps() + "/tiny2.osa", Maps() + "/tiny10.osa"});
  EXPECT_EQ(swapped.exit_code, 1);
  EXPECT_THAT(swapped.err, HasSubstr("not a store"));
  EXPECT_EQ(ReadWholeFile(Maps() + "/tiny2.osa"), before);
  EXPECT_FALSE(fs::exists(In("s.db")));
}

// However it ends, the store holds whole atlases.
TEST_F(Many, AKilledAddLeavesAStoreOfWholeAtlases) {
  for (int i = 0; i < 8; ++i)
    fs::copy_file(Maps() + "/mono_small_twice.osa", In("maps/copy") + std::to_string(i) + ".osa");
  for (const char* signal : {"INT", "KILL"}) {
    SCOPED_TRACE(signal);
    RunProgram({"bash", "-c",
                "\"$0\" add \"$1\" \"$2\" & p=$!; until [ -s \"$1\" ]; do sleep 0.02; done; sleep 0.2; kill -s $3 $p; "
                "wait $p",
                SLAMDB_COMMAND, In("k.db"), Maps(), signal});
    const ProcessResult checked = RunSlamdb({"check", In("k.db"), "-q"});
    EXPECT_THAT(checked.out + checked.err, Not(HasSubstr("not readable")));
    const ProcessResult rest = RunSlamdb({"add", In("k.db"), Maps()});
    EXPECT_EQ(rest.exit_code, 0) << rest.err;
    EXPECT_EQ(NamesOf(List({In("k.db")})).size(), 12U);
    fs::remove(In("k.db"));
  }
}

TEST_F(Many, TwoAddsAtOnceToAStoreThatIsNotThere) {
  for (int round = 0; round < 5; ++round) {
    fs::remove(In("s.db"));
    const ProcessResult both = RunProgram(
        {"bash", "-c", "\"$0\" add -q \"$1\" \"$2\" & p=$!; \"$0\" add -q \"$1\" \"$2\"; a=$?; wait $p && exit $a",
         SLAMDB_COMMAND, In("s.db"), Maps()});
    EXPECT_EQ(both.exit_code, 0) << both.err;
    EXPECT_EQ(NamesOf(List({In("s.db")})).size(), 4U);
  }
}

TEST_F(Many, AnInterruptedAddSaysWhatItDid) {
  for (int i = 0; i < 40; ++i) fs::copy_file(kTiny, In("maps/a") + std::to_string(i) + ".osa");
  const ProcessResult stopped =
      RunProgram({"bash", "-c",
                  "\"$0\" add --json \"$1\" \"$2\" & p=$!; until [ -s \"$1\" ]; do sleep 0.01; done; kill -s TERM $p; "
                  "wait $p",
                  SLAMDB_COMMAND, In("k.db"), Maps()});
  if (stopped.exit_code == 0) GTEST_SKIP() << "it was faster";
  const json report = json::parse(stopped.out);
  EXPECT_EQ(BreachOf(report, "add.schema.json"), "");
  EXPECT_EQ(report.at("added").get<int>() + report.at("not_tried").get<int>(), 44);
  EXPECT_GT(report.at("not_tried"), 0);
}

TEST_F(Many, AFullDiskSaysWhatWasAdded) {
  const ProcessResult full = RunProgram(
      {"bash", "-c", "ulimit -f 3000; \"$0\" add \"$1\" \"$2\"/tiny2.osa \"$2\"", SLAMDB_COMMAND, In("k.db"), Maps()});
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_THAT(full.out, AllOf(HasSubstr("1 added, 1 failed, 3 not tried; " + In("k.db") + " holds 1 atlas")));
}

TEST_F(Many, ARowThatWasEditedIsAProblemOfTheList) {
  ASSERT_EQ(RunSlamdb({"add", In("s.db"), Maps(), "-q"}).exit_code, 0);
  if (RunProgram({"sqlite3", In("s.db"), "UPDATE atlas SET keyframes = 999999999, bytes = -1 WHERE name = 'tiny2'"})
          .exit_code == 127)
    GTEST_SKIP() << "no sqlite3";
  const ProcessResult list = RunSlamdb({"list", In("s.db")});
  EXPECT_EQ(list.exit_code, 1);
  EXPECT_THAT(list.out, AllOf(HasSubstr("tells of 999999999 keyframes where at most"), Not(HasSubstr("PB"))));
}

TEST_F(Many, MetresAndUnitsAreNotSummed) {
  ASSERT_EQ(RunSlamdb({"merge", Maps() + "/session_small_a.osa", Maps() + "/mono_small_twice.osa", "-o", In("both.osa"),
                       "-q"})
                .exit_code,
            0);
  EXPECT_THAT(RunSlamdb({"list", In("both.osa"), "--columns", "length"}).out, HasSubstr("mixed"));
}

TEST_F(Many, CheckOfAFolderAndAStore) {
  ASSERT_EQ(RunSlamdb({"add", In("s.db"), Maps(), "-q"}).exit_code, 0);
  for (const std::string& where : {Maps(), In("s.db")}) {
    SCOPED_TRACE(where);
    const ProcessResult text = RunSlamdb({"check", where});
    EXPECT_EQ(text.exit_code, 1);
    EXPECT_THAT(text.out, AllOf(HasSubstr("map-listed-once"), HasSubstr("4 atlases: 3 sound, 1 not sound")));
    const json report = json::parse(RunSlamdb({"check", where, "--json"}).out);
    EXPECT_EQ(report.at("inputs").size(), 4U);
    EXPECT_EQ(BreachOf(report, "check.schema.json"), "");
    EXPECT_THAT(RunSlamdb({"check", where, "--format", "junit"}).out, HasSubstr("session_small_a"));
  }
  EXPECT_EQ(RunSlamdb({"check", In("s.db#tiny*")}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"check", In("s.db#session_small_a")}).exit_code, 0);
  const ProcessResult none = RunSlamdb({"check", In("s.db#x*")});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("no atlas is named like 'x*'"));
}

TEST_F(Many, AKilledCheckGoesOnWithItsJournal) {
  for (int i = 0; i < 40; ++i) fs::copy_file(kTiny, In("maps/copy" + std::to_string(i) + ".osa"));
  const std::vector<std::string> check = {"check", Maps(), "--journal", In("j"), "--threads", "1"};
  const ProcessResult whole = RunSlamdb({"check", Maps()});
  EXPECT_EQ(whole.exit_code, 1) << "mono_small_twice is not sound";
  RunProgram({"bash", "-c",
              "\"$0\" check \"$1\" --journal \"$2\" --threads 1 >/dev/null & "
              "until [ \"$(wc -l < \"$2\" 2>/dev/null || echo 0)\" -ge 3 ]; do :; done; kill -9 $!; wait",
              SLAMDB_COMMAND, Maps(), In("j")});
  const ProcessResult rest = RunSlamdb(check);
  EXPECT_EQ(rest.out, whole.out);
  EXPECT_EQ(rest.exit_code, 1);
  EXPECT_THAT(rest.err, HasSubstr(" of 44 are as they were when they were checked, and were not read again: "));
  const ProcessResult again = RunSlamdb({"check", Maps(), "--journal", In("j"), "--json"});
  EXPECT_EQ(again.out, RunSlamdb({"check", Maps(), "--json"}).out) << "whatever the form of the report";
  EXPECT_THAT(again.err, HasSubstr("44 of 44 are as they were"));
  const ProcessResult strict = RunSlamdb({"check", Maps(), "--journal", In("j"), "--strict"});
  EXPECT_EQ(strict.exit_code, 1);
  EXPECT_THAT(strict.err, HasSubstr("is the journal of a check with other options"));
}

TEST_F(Many, ListFindsByWhatAStoreTells) {
  ASSERT_EQ(RunSlamdb({"add", In("s.db"), Maps(), "-q"}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"tag", In("s.db#tiny2"), "release"}).exit_code, 0);
  const auto found = [&](std::vector<std::string> words) {
    words.insert(words.begin(), In("s.db"));
    return NamesOf(List(words));
  };
  EXPECT_THAT(found({"--where", "keyframes=14:"}), ElementsAre("mono_small_twice", "session_small_a"));
  EXPECT_THAT(found({"--where", "keyframes=14"}), ElementsAre("session_small_a"));
  EXPECT_THAT(found({"--where", "keyframes=3..,length=:5"}), ElementsAre("mono_small_twice"));
  EXPECT_THAT(found({"--where", "size=1MB:", "--where", "span=15:20"}), ElementsAre("session_small_a"));
  EXPECT_THAT(found({"--tag", "release"}), ElementsAre("tiny2"));
  EXPECT_EQ(found({"--who", "*@*"}).size(), 4U);
  EXPECT_THAT(found({"--who", "nobody-of-this-name"}), ElementsAre());
  EXPECT_THAT(found({"--provenance", "session_small_a.osa"}), ElementsAre("session_small_a"));
  EXPECT_THAT(found({"--provenance", "add */tiny*.osa", "--keyframes", "0:"}), ElementsAre("tiny2", "tiny10"));
  EXPECT_THAT(NamesOf(List({Maps(), "--where", "keyframes=14"})), ElementsAre("session_small_a")) << "of files, too";
  EXPECT_THAT(NamesOf(List({Maps(), "--tag", "release"})), ElementsAre()) << "which have none";
  EXPECT_EQ(RunSlamdb({"list", In("s.db"), "--tag", "none"}).out, "no atlas is like that\n");
  for (const char* wrong : {"keyframes", "keyframes=", "keyframes=9:2", "keyframes=few", "name=3", "size=9XB", "=3"}) {
    const ProcessResult refused = RunSlamdb({"list", Maps(), "--where", wrong});
    EXPECT_EQ(refused.exit_code, 2) << wrong;
    EXPECT_THAT(refused.err, HasSubstr("expected one of maps, keyframes, points, observations, ")) << wrong;
  }
}

TEST_F(Many, AnOutputIsNoneOfTheInputsOfAFolder) {
  const std::string before = ReadWholeFile(kTiny);
  EXPECT_EQ(RunSlamdb({"check", Maps(), "-o", Maps() + "/tiny2.osa", "-O"}).exit_code, 1);
  EXPECT_EQ(ReadWholeFile(Maps() + "/tiny2.osa"), before);
}

TEST_F(Many, AFolderIsManyAtlases) {
  const ProcessResult info = RunSlamdb({"info", Maps()});
  EXPECT_EQ(info.exit_code, 1);
  EXPECT_THAT(info.err, AllOf(HasSubstr("is a directory"), HasSubstr("`slamdb list` and `slamdb check`")));
  fs::create_directory(In("empty"));
  for (const char* verb : {"list", "check", "info"}) {
    const ProcessResult result = RunSlamdb({verb, In("empty")});
    EXPECT_EQ(result.exit_code, 1) << verb;
    EXPECT_THAT(result.err, HasSubstr("empty: ")) << verb;
  }
}

// A list of a store reads the list alone, whatever is in it.
TEST_F(Many, ListOfManyAtlasesIsQuick) {
  ASSERT_EQ(RunSlamdb({"add", In("s.db"), kTiny, "-q"}).exit_code, 0);
  const std::string sql =
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 999) INSERT INTO atlas SELECT NULL, "
      "'n' || i, " +
      RunProgram({"sqlite3", In("s.db"),
                  "SELECT group_concat('atlas.' || name) FROM pragma_table_info('atlas') WHERE cid > 1"})
          .out +
      " FROM n, atlas";
  if (RunProgram({"sqlite3", In("s.db"), sql}).exit_code == 127) GTEST_SKIP() << "no sqlite3";
  const auto begin = std::chrono::steady_clock::now();
  const ProcessResult list = RunSlamdb({"list", In("s.db")});
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(std::ranges::count(list.out, '\n'), 1001);
  EXPECT_LT(list.out.find("\nn2 "), list.out.find("\nn10 "));
  EXPECT_LT(taken.count(), 2.0) << "0.02 s where nothing else runs";
}

}  // namespace
}  // namespace slamdb::testing
