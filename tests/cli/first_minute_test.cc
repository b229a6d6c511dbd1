// SPDX-License-Identifier: BSD-3-Clause
//
// What people type first: other tools' words, an atlas alone, -o, and what a terminal shows of it.
#include <gmock/gmock.h>

#include <sstream>

#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";
const std::string kSmall = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";
const std::string kTwice = SLAMDB_FIXTURES "/mono_small_twice/mono_small_twice.osa";

TEST(FirstWord, AnAtlasAloneIsShown) {
  const TemporaryFolder folder;
  EXPECT_EQ(RunSlamdb({kTiny}).out, RunSlamdb({"info", kTiny}).out);
  EXPECT_EQ(RunSlamdb({kTiny, "--json"}).out, RunSlamdb({"info", kTiny, "--json"}).out);
  ASSERT_EQ(RunSlamdb({"convert", kTiny, folder / "maps.db#lab"}).exit_code, 0);
  EXPECT_THAT(RunSlamdb({folder / "maps.db#lab"}).out, StartsWith(folder / "maps.db#lab"));
  const ProcessResult missing = RunSlamdb({folder / "none.osa"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, HasSubstr("none.osa: there is no such file, and no such verb"));
}

TEST(FirstWord, OfOtherToolsIsAnswered) {
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"validate", "a.osa"}, "slamdb check a.osa"},
      {{"undo", "a.osa"}, "slamdb repair a.osa undone.osa --undo journal.json"},
      {{"import", "a.msg"}, "slamdb convert a.msg map.osa"},
      {{"verify", "a.osa"}, "slamdb check a.osa"},
      {{"doctor", "my map.osa"}, "slamdb check 'my map.osa'"},
      {{"fix", "a.osa"}, "slamdb repair a.osa fixed.osa"},
      {{"fix", "a.osa", "b.osa"}, "slamdb repair a.osa b.osa"},
      {{"ls", "lab.db"}, "slamdb list lab.db"},
      {{"cat", "a.osa"}, "slamdb dump a.osa"},
      {{"stat", "a.osa"}, "slamdb info a.osa"},
      {{"cp", "a.osa", "b.osa"}, "slamdb convert a.osa b.osa"},
      {{"export", "a.osa"}, "slamdb convert a.osa points.ply"},
      {{"trajectory", "a.osa"}, "slamdb convert a.osa poses.tum"},
      {{"save", "a.osa"}, "slamdb add maps.db a.osa"},
      {{"save", "lab.db", "a.osa", "b.osa"}, "slamdb add lab.db a.osa b.osa"},
      {{"save", "a.osa", "lab.db"}, "slamdb add lab.db a.osa"},
      {{"save", "a.osa", "b.osa"}, "slamdb add maps.db a.osa b.osa"},
      {{"rm", "lab.db#old"}, "slamdb remove lab.db#old"},
      {{"join", "a.osa", "b.osa"}, "slamdb merge a.osa b.osa -o joined.osa --align"},
      {{"crop", "a.osa"}, "slamdb extract a.osa part.osa --box X,Y,Z:X,Y,Z"},
      {{"compare", "a.osa", "b.osa"}, "slamdb diff a.osa b.osa"},
      {{"salvage", "a.osa"}, "slamdb recover a.osa saved.osa"},
      {{"upgrade", "lab.db"}, "slamdb migrate lab.db"},
      {{"ate", "a.osa", "b.tum"}, "slamdb evaluate a.osa b.tum"},
      {{"downgrade", "a.osa"}, "slamdb convert a.osa older.osa --boost-version ubuntu20.04"},
      {{"serve", "a.osa"}, "slamdb view a.osa --serve"},
      {{"fsck", "a.osa"}, "slamdb check a.osa"},
      {{"push", "lab.db"}, "slamdb sync lab.db copy.db"},
      {{"pull", "postgresql://u@h/maps", "lab.db"}, "slamdb sync postgresql://u@h/maps lab.db"},
      {{"prune", "a.osa"}, "slamdb cull a.osa thin.osa"},
      {{"prune", "lab.db"}, "slamdb gc lab.db --keep 10"},
      {{"squash", "lab.db"}, "slamdb gc lab.db --keep 10"},
      {{"find", "lab.db"}, "slamdb list lab.db"},
      {{"find", "lab.db", "a.jpg"}, "slamdb locate lab.db a.jpg"},
      {{"search", "lab.db", "a.png"}, "slamdb locate lab.db a.png"},
      {{"recognize", "lab.db"}, "slamdb locate lab.db picture.jpg"},
      {{"where", "lab.db", "a.jpg"}, "slamdb locate lab.db a.jpg"},
      {{"put", "a.osa"}, "slamdb convert a.osa maps.db#NAME"},
      {{"store", "lab.db", "a.osa"}, "slamdb convert a.osa lab.db#NAME"},
      {{"commit", "a.osa", "lab.db#a"}, "slamdb convert a.osa lab.db#a"},
      {{"init", "lab.db"}, "slamdb convert FILE lab.db#NAME"},
      {{"clone", "lab.db#a", "b"}, "slamdb branch lab.db#a b"},
      {{"clone", "lab.db"}, "slamdb sync lab.db copy.db"},
      {{"undo", "lab.db#a"}, "slamdb restore lab.db#a@-1"},
      {{"reset", "lab.db#a@3"}, "slamdb restore lab.db#a@3"},
      {{"drop", "lab.db#a"}, "slamdb remove lab.db#a"},
      {{"conflicts", "a.osa", "b.osa"}, "slamdb merge --json a.osa b.osa --base base.osa -o both.osa"},
      {{"conflicts"}, "slamdb merge --help"},
      {{"validate"}, "slamdb check --help"},
      {{"inof", "a.osa"}, "slamdb info a.osa"},
      {{"chekc", "-v", "a.osa"}, "slamdb check -v a.osa"},
      {{"frobnicate"}, "slamdb --help"},
  };
  for (const auto& [words, next] : cases) {
    const ProcessResult result = RunSlamdb(words);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, StartsWith("slamdb: error: unknown verb '" + words.front() + "'"));
    EXPECT_THAT(result.err, EndsWith("\nTry: " + next + "\n"));
  }
}

TEST(FirstWord, OfTwoMeaningsIsAnsweredWithBoth) {
  const std::pair<const char*, const char*> cases[] = {
      {"prune", "here it is 'cull', and of the revisions of a store 'gc'"},
      {"find", "here it is 'list', and of a picture 'locate'"},
      {"undo", "here it is 'repair', and of the last save in a store 'restore'"},
      {"clone", "here it is 'branch', and of a whole store 'sync'"},
      {"conflicts", "here it is 'merge --json', and shown in place 'view --findings'"},
  };
  for (const auto& [word, says] : cases) EXPECT_THAT(RunSlamdb({word}).err, HasSubstr(says));
}

// A name or a number that stands by itself, as other tools have it, belongs behind the store.
TEST(SecondWord, OfAnAtlasInAStoreIsAnswered) {
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"restore", "lab.db#a", "1"}, "slamdb restore lab.db#a@1"},
      {{"restore", "lab.db#a", "-1"}, "slamdb restore lab.db#a@-1"},
      {{"restore", "lab.db#a", "release", "--json"}, "slamdb restore lab.db#a@release --json"},
      {{"convert", "a.osa", "lab.db", "a"}, "slamdb convert a.osa lab.db#a"},
      {{"convert", "a.osa", "lab.db", "--name", "a"}, "slamdb convert a.osa lab.db#a"},
      {{"convert", "a.osa", "--name", "a", "lab.db", "-O"}, "slamdb convert a.osa lab.db#a -O"},
      {{"convert", "--name=a", "a.osa", "lab.db"}, "slamdb convert a.osa lab.db#a"},
  };
  for (const auto& [words, next] : cases) {
    const ProcessResult result = RunSlamdb(words);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr(" named lab.db#a"));
    EXPECT_THAT(result.err, EndsWith("\nTry: " + next + "\n"));
  }
  EXPECT_THAT(RunSlamdb({"convert", "a.osa", "b.osa", "c"}).err, HasSubstr("unexpected argument 'c'\n"));
  EXPECT_THAT(RunSlamdb({"restore", "lab.db#a@1", "2"}).err, HasSubstr("unexpected argument '2'\n"));
}

TEST(FirstWord, VersionIsAskedForByALetter) { EXPECT_EQ(RunSlamdb({"-V"}).out, RunSlamdb({"--version"}).out); }

TEST(OutputOption, WritesWhatThePositionalWrites) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"convert", kTiny, folder / "a.osa"}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"convert", "-o", folder / "b.osa", kTiny}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(folder / "a.osa"), ReadWholeFile(folder / "b.osa"));
  EXPECT_EQ(RunSlamdb({"extract", kTiny, "-o", folder / "c.osa", "--map", "0"}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"synthesize", "-o", folder / "s.osa", "--keyframes", "4", "--points", "100"}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"convert", kTiny, "-o", folder / "m.db"}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"backup", folder / "m.db", "-o", folder / "copy.db"}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"info", folder / "copy.db#tiny"}).exit_code, 0) << "named as by the positional";
}

TEST(Split, IntoAFolder) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"synthesize", folder / "a.osa", "--maps", "2", "--keyframes", "4", "--points", "100"}).exit_code,
            0);
  ASSERT_EQ(RunSlamdb({"split", folder / "a.osa", folder / "new/parts/"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "new/parts/map-0.osa"));
  EXPECT_TRUE(std::filesystem::exists(folder / "new/parts/map-1.osa"));
  ASSERT_EQ(RunSlamdb({"split", folder / "a.osa", folder / "new", "--to", "ply"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "new/map-1.ply"));
  const ProcessResult named = RunSlamdb({"split", folder / "a.osa", folder / "folder"});
  EXPECT_EQ(named.exit_code, 0) << named.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "folder/map-0.osa")) << "a name without suffix is a folder";
}

const std::vector<std::string> kTerminal = {"env", "-u", "NO_COLOR", "-u", "COLUMNS", "TERM=xterm", "LC_ALL=C.UTF-8"};

std::vector<std::string> On(std::vector<std::string> settings, const std::vector<std::string>& words) {
  settings.emplace_back(SLAMDB_COMMAND);
  settings.insert(settings.end(), words.begin(), words.end());
  return settings;
}

std::vector<std::string> With(std::vector<std::string> settings, const std::string& setting) {
  settings.push_back(setting);
  return settings;
}

TEST(Colour, IsOnTerminalsAloneUnlessToldOtherwise) {
  EXPECT_THAT(RunSlamdb({"check", kTwice}).out, Not(HasSubstr("\033")));
  EXPECT_THAT(RunSlamdb({"check", kTwice, "--color", "always"}).out,
              HasSubstr("  \033[1;31merror map-listed-once\033[0m\n"));
  EXPECT_THAT(RunSlamdb({"check", kTwice, "--color", "always", "--json"}).out, Not(HasSubstr("\033")));
  EXPECT_THAT(RunSlamdb({"info", "none.osa", "--color", "always"}).err, HasSubstr("\033[1;31merror:\033[0m"));
  const auto shown = RunOnTerminal(On(kTerminal, {"check", kTwice}));
  if (!shown) GTEST_SKIP() << "there are no pseudo-terminals (/dev/pts)";
  EXPECT_THAT(shown->out, HasSubstr("\033[1;31merror map-listed-once\033[0m"));
  for (const char* setting : {"NO_COLOR=1", "TERM=dumb"})
    EXPECT_THAT(RunOnTerminal(On(With(kTerminal, setting), {"check", kTwice}))->out, Not(HasSubstr("\033"))) << setting;
  EXPECT_THAT(RunOnTerminal(On(kTerminal, {"check", kTwice, "--color", "never"}))->out, Not(HasSubstr("\033")));
  EXPECT_THAT(RunOnTerminal(On(kTerminal, {"info", kSmall}))->out, HasSubstr("\033[1mmap 0\033[0m  stereo"));
}

// A name that tries to steer is escaped before anything is coloured.
TEST(Colour, ComesFromSlamdbAlone) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "a\033[31m.osa", ReadWholeFile(kTwice));
  const std::string out = RunSlamdb({"check", folder / "a\033[31m.osa", "--color", "always"}).out;
  EXPECT_THAT(out, HasSubstr("a\\e[31m.osa"));
  EXPECT_THAT(out, Not(HasSubstr("a\033")));
}

TEST(Plan, IsDrawnWhereATerminalShowsIt) {
  const std::string braille = "\xE2\xA0";  // of U+2800 to U+283F
  EXPECT_THAT(RunSlamdb({"info", kSmall}).out, Not(HasSubstr("seen from above")));
  const ProcessResult drawn = RunSlamdb({"info", kSmall, "--plot"});
  EXPECT_THAT(drawn.out, HasSubstr(braille));
  EXPECT_THAT(drawn.out, HasSubstr("  seen from above, "));
  EXPECT_THAT(drawn.out, HasSubstr(" m; right x, up z\n"));
  EXPECT_THAT(RunSlamdb({"info", kSmall, "--plot", "--json"}).out, Not(HasSubstr(braille)));
  const auto shown = RunOnTerminal(On(kTerminal, {"info", kSmall}));
  if (!shown) GTEST_SKIP() << "there are no pseudo-terminals (/dev/pts)";
  EXPECT_THAT(shown->out, HasSubstr("seen from above"));
  for (const char* setting : {"LC_ALL=C", "TERM=dumb"})
    EXPECT_THAT(RunOnTerminal(On(With(kTerminal, setting), {"info", kSmall}))->out, Not(HasSubstr("seen from above")));
  EXPECT_THAT(RunOnTerminal(On(kTerminal, {"info", kSmall, "--no-plot"}))->out, Not(HasSubstr("seen from above")));
}

TEST(Terminal, TellsItsWidth) {
  const auto help = RunOnTerminal(On(kTerminal, {"check", "--help"}), 60);
  if (!help) GTEST_SKIP() << "there are no pseudo-terminals (/dev/pts)";
  std::istringstream lines(help->out);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("  $ ") != std::string::npos) continue;
    EXPECT_LE(line.size(), 70U) << line;
  }
}

}  // namespace
}  // namespace slamdb::testing
