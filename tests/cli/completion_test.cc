// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/support/cli.h"
#include "tests/support/needs_proc.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// What bash offers for these words, of which the last is being typed; one candidate per line.
std::string BashOffers(const std::string& words, int count) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "script", RunSlamdb({"completion", "bash"}).out);
  // From a folder without files whose names could be offered too.
  std::filesystem::create_directory(folder / "empty");
  const std::string program = "cd '" + (folder / "empty") + "'; compopt() { :; }; source '" + (folder / "script") +
                              "'; COMP_WORDS=(" + words + "); COMP_CWORD=" + std::to_string(count - 1) +
                              "; _slamdb; printf '%s\\n' \"${COMPREPLY[@]}\"";
  const ProcessResult result = RunProgram({"bash", "-c", program});
  EXPECT_EQ(result.err, "");
  return result.out;
}

TEST(Completion, BashScriptParses) {
  const ProcessResult script = RunSlamdb({"completion", "bash"});
  ASSERT_EQ(script.exit_code, 0);
  const ProcessResult parsed = RunProgram({"bash", "-n"}, script.out);
  EXPECT_EQ(parsed.exit_code, 0) << parsed.err;
}

TEST(Completion, BashOffersVerbs) {
  SLAMDB_NEEDS_PROC();
  EXPECT_THAT(BashOffers("slamdb ''", 2), HasSubstr("info\n"));
  EXPECT_EQ(BashOffers("slamdb conv", 2), "convert\n");
  EXPECT_EQ(BashOffers("slamdb vocabulary ver", 3), "verify\n");
}

TEST(Completion, BashOffersOptionsOfTheVerb) {
  SLAMDB_NEEDS_PROC();
  const std::string offers = BashOffers("slamdb convert --", 3);
  EXPECT_THAT(offers, HasSubstr("--sanitize\n"));
  EXPECT_THAT(offers, HasSubstr("--overwrite\n"));
  EXPECT_THAT(offers, Not(HasSubstr("--gate")));
  EXPECT_THAT(BashOffers("slamdb vocabulary set --", 4), HasSubstr("--overwrite\n"));
}

TEST(Completion, BashOffersValuesOfAnOption) {
  SLAMDB_NEEDS_PROC();
  EXPECT_EQ(BashOffers("slamdb convert --to orbslam3-", 4), "orbslam3-text\n");
  EXPECT_EQ(BashOffers("slamdb convert --to = orbslam3-", 5), "orbslam3-text\n");
  EXPECT_EQ(BashOffers("slamdb completion f", 3), "fish\n");
  EXPECT_EQ(BashOffers("slamdb list --sort poi", 4), "points\n");
  EXPECT_EQ(BashOffers("slamdb list --columns ver", 4), "verdict\n");
  EXPECT_EQ(BashOffers("slamdb convert --color he", 4), "height\n");
  EXPECT_EQ(BashOffers("slamdb convert --boost-version ubuntu20", 4), "ubuntu20.04\n");
  EXPECT_EQ(BashOffers("slamdb renumber --order ''", 4), "as-is\nid\ntime\n");
}

TEST(Completion, BashOffersFilesWithBlanks) {
  SLAMDB_NEEDS_PROC();
  const TemporaryFolder folder;
  WriteWholeFile(folder / "my map.osa", "");
  EXPECT_EQ(BashOffers("slamdb info '" + (folder / "my") + "'", 3), (folder / "my map.osa") + "\n");
}

TEST(Completion, BashOffersFilesOnlyWhereAnOptionNamesThem) {
  SLAMDB_NEEDS_PROC();
  const TemporaryFolder folder;
  WriteWholeFile(folder / "1GB", "");
  EXPECT_EQ(BashOffers("slamdb info --memory '" + (folder / "1") + "'", 4), "\n");
  EXPECT_EQ(BashOffers("slamdb info --spill '" + (folder / "1") + "'", 4), (folder / "1GB") + "\n");
  EXPECT_EQ(BashOffers("slamdb transform a.osa --by '" + (folder / "1") + "'", 5), (folder / "1GB") + "\n");
}

TEST(Completion, BashOffersNoFilesWhereWordsAreAll) {
  EXPECT_THAT(RunSlamdb({"completion", "bash"}).out, HasSubstr("words='bash zsh fish'\n      ;;"));
  EXPECT_THAT(RunSlamdb({"completion", "bash"}).out, HasSubstr("files=1\n      ;;"));
}

TEST(Completion, BashOffersRules) {
  SLAMDB_NEEDS_PROC();
  EXPECT_EQ(BashOffers("slamdb check --ignore map-listed", 4), "map-listed-once\n");
  EXPECT_EQ(BashOffers("slamdb repair --rule map-listed", 4), "map-listed-once\n");
  EXPECT_EQ(BashOffers("slamdb help vac", 3), "vacuum\n");
}

// Names out of files are offered as they are, and nothing in them is expanded.
TEST(Completion, BashOffersAtlasesOfAStore) {
  SLAMDB_NEEDS_PROC();
  const TemporaryFolder folder;
  const std::string tiny = SLAMDB_FIXTURES "/tiny/tiny.osa", store = folder / "lab.db";
  for (const char* name : {"monday", "morning", "tuesday", "$(touch x)"})
    ASSERT_EQ(RunSlamdb({"convert", tiny, store + "#" + name}).exit_code, 0);
  EXPECT_EQ(BashOffers("'" SLAMDB_COMMAND "' info '" + store + "#mo'", 3), store + "#monday\n" + store + "#morning\n");
  EXPECT_EQ(BashOffers("'" SLAMDB_COMMAND "' info '" + store + "#$'", 3), store + "#\\$\\(touch\\ x\\)\n");
  EXPECT_EQ(RunSlamdb({"complete", store + "#tu"}).out, store + "#tuesday\n");
}

TEST(Completion, BashOffersEntities) {
  SLAMDB_NEEDS_PROC();
  const std::string tiny = SLAMDB_FIXTURES "/tiny/tiny.osa", show = "'" SLAMDB_COMMAND "' show '" + tiny + "' ";
  EXPECT_EQ(BashOffers(show + "''", 4), "atlas\ncamera/\nmap/\nkf/\nmp/\nlandmark/\n");
  EXPECT_EQ(RunSlamdb({"complete", tiny, "zzz"}).out, "");
  EXPECT_EQ(RunSlamdb({"complete", tiny, "ma"}).out, "map/\n");
  EXPECT_EQ(BashOffers(show + "kf/", 4), "kf/0\nkf/1\n");
  EXPECT_EQ(BashOffers(show + "kf/1", 4), "kf/1\n");
  EXPECT_EQ(BashOffers(show + "atlas map/", 5), "map/0\n");
  EXPECT_EQ(RunSlamdb({"complete", "none.osa", "kf/"}).exit_code, 1);
}

TEST(Completion, OtherShellsAskForNamesToo) {
  for (const char* shell : {"zsh", "fish"}) {
    const std::string script = RunSlamdb({"completion", shell}).out;
    EXPECT_THAT(script, HasSubstr("slamdb complete ")) << shell;
    EXPECT_THAT(script, HasSubstr("map-listed-once")) << shell;
    EXPECT_THAT(script, HasSubstr("_slamdb_entities")) << shell;
  }
}

TEST(Completion, ZshScriptParses) {
  const ProcessResult script = RunSlamdb({"completion", "zsh"});
  ASSERT_EQ(script.exit_code, 0);
  EXPECT_THAT(script.out, HasSubstr("#compdef slamdb"));
  const TemporaryFolder folder;
  WriteWholeFile(folder / "script", script.out);
  const ProcessResult parsed = RunProgram({"zsh", "-n", folder / "script"});
  if (parsed.exit_code == 127) GTEST_SKIP() << "zsh is not installed";
  EXPECT_EQ(parsed.exit_code, 0) << parsed.err;
}

TEST(Completion, FishScriptParses) {
  const ProcessResult script = RunSlamdb({"completion", "fish"});
  ASSERT_EQ(script.exit_code, 0);
  EXPECT_THAT(script.out, HasSubstr("complete -c slamdb"));
  const TemporaryFolder folder;
  WriteWholeFile(folder / "script", script.out);
  const ProcessResult parsed = RunProgram({"fish", "--no-execute", folder / "script"});
  if (parsed.exit_code == 127) GTEST_SKIP() << "fish is not installed";
  EXPECT_EQ(parsed.exit_code, 0) << parsed.err;
}

TEST(Completion, WantsAShellItKnows) {
  EXPECT_EQ(RunSlamdb({"completion"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"completion", "tcsh"}).exit_code, 2);
}

}  // namespace
}  // namespace slamdb::testing
