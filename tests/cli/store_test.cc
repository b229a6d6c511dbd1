// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";

class StoreVerbs : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(RunSlamdb({"convert", kTiny, At("a")}).exit_code, 0);
    ASSERT_EQ(RunSlamdb({"convert", kTiny, At("b")}).exit_code, 0);
  }

  std::string At(const std::string& name) const { return store_ + "#" + name; }
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    const json report = json::parse(RunSlamdb({"list", "--json", store_}).out);
    for (const json& atlas : report.at("atlases")) names.push_back(atlas.at("name"));
    return names;
  }

  TemporaryFolder folder_;
  std::string store_ = folder_ / "lab.db";
};

TEST_F(StoreVerbs, ListsByName) {
  EXPECT_EQ(Names(), (std::vector<std::string>{"a", "b"}));
  const ProcessResult text = RunSlamdb({"list", store_});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_THAT(text.out, HasSubstr("KEYFRAMES"));
  EXPECT_EQ(BreachOf(json::parse(RunSlamdb({"list", "--json", store_}).out), "list.schema.json"), "");
}

TEST_F(StoreVerbs, LogTellsWhatWasDone) {
  const json log = json::parse(RunSlamdb({"log", "--json", store_}).out);
  EXPECT_EQ(BreachOf(log, "log.schema.json"), "");
  EXPECT_EQ(log.at("entries").size(), 2U);
  EXPECT_THAT(log["entries"][0]["provenance"].get<std::string>(), HasSubstr("tiny.osa"));
  const json of_b = json::parse(RunSlamdb({"log", "--json", At("b")}).out);
  ASSERT_EQ(of_b.at("entries").size(), 1U);
  EXPECT_EQ(of_b["entries"][0]["name"], "b");
  EXPECT_THAT(RunSlamdb({"log", store_}).out, HasSubstr("a@1    +2"));
}

TEST_F(StoreVerbs, SavingAgainNeedsOverwriteAndChangesNothing) {
  EXPECT_EQ(RunSlamdb({"convert", kTiny, At("a")}).exit_code, 1);
  ASSERT_EQ(RunSlamdb({"convert", kTiny, At("a"), "-O"}).exit_code, 0);
  const json log = json::parse(RunSlamdb({"log", "--json", At("a")}).out);
  const json& last = log.at("entries").back();
  EXPECT_EQ(last["rows"]["inserted"], 0);
  EXPECT_EQ(last["rows"]["deleted"], 0);
}

TEST_F(StoreVerbs, RemovesOne) {
  ASSERT_EQ(RunSlamdb({"remove", At("a")}).exit_code, 0);
  EXPECT_EQ(Names(), (std::vector<std::string>{"b"}));
  const ProcessResult again = RunSlamdb({"remove", At("a")});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, HasSubstr("a"));
  EXPECT_EQ(RunSlamdb({"remove", store_}).exit_code, 2);
}

TEST_F(StoreVerbs, StatsAndVacuum) {
  const json stats = json::parse(RunSlamdb({"stats", "--json", store_}).out);
  EXPECT_EQ(BreachOf(stats, "stats.schema.json"), "");
  EXPECT_THAT(RunSlamdb({"stats", store_}).out, HasSubstr("schema version"));
  const ProcessResult vacuum = RunSlamdb({"vacuum", store_});
  EXPECT_EQ(vacuum.exit_code, 0) << vacuum.err;
  EXPECT_EQ(Names().size(), 2U);
}

TEST_F(StoreVerbs, BackupIsWhole) {
  const std::string copy = folder_ / "copy.db";
  ASSERT_EQ(RunSlamdb({"backup", store_, copy}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"backup", store_, copy}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"backup", store_, copy, "-O"}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"convert", copy + "#b", folder_ / "b.osa"}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(folder_ / "b.osa"), ReadWholeFile(kTiny));
}

TEST_F(StoreVerbs, MigrateOfAnUpToDateStoreDoesNothing) {
  const ProcessResult result = RunSlamdb({"migrate", store_, "--dry-run"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("already"));
}

TEST_F(StoreVerbs, MigrateBackLosesNothing) {
  const std::string before = RunSlamdb({"list", "--json", store_}).out;
  EXPECT_EQ(RunSlamdb({"migrate", store_, "--back", "--dry-run"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(store_ + ".v7.bak")) << "nothing was changed, so nothing is kept";
  EXPECT_EQ(RunSlamdb({"migrate", store_, "--back", "--quiet"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(store_ + ".v7.bak"));
  EXPECT_EQ(RunSlamdb({"list", store_}).exit_code, 1) << "version 6 now";
  EXPECT_EQ(RunSlamdb({"migrate", store_, "--quiet"}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"list", "--json", store_}).out, before) << "what the list tells is worked out anew";
}

TEST_F(StoreVerbs, RowsEditedInSqlAreNamedAndTakenWhenToldTo) {
  const std::string sql =
      "UPDATE keyframe SET timestamp = timestamp + 1 WHERE row = (SELECT min(row) FROM keyframe);"
      "UPDATE map_point SET x = x + 0.5 WHERE row = (SELECT min(row) FROM map_point)";
  if (RunProgram({"sqlite3", store_, sql}).exit_code == 127) GTEST_SKIP() << "no sqlite3";
  const ProcessResult check = RunSlamdb({"check", At("a")});
  EXPECT_EQ(check.exit_code, 1);
  EXPECT_THAT(check.out + check.err, HasSubstr("edited outside slamdb"));
  EXPECT_THAT(check.out + check.err, HasSubstr("keyframe "));
  EXPECT_THAT(check.out + check.err, HasSubstr("map_point "));
  EXPECT_THAT(check.out + check.err, HasSubstr("`slamdb recover --accept-edits`"));
  const ProcessResult dropped = RunSlamdb({"recover", At("a"), At("without")});
  EXPECT_EQ(dropped.exit_code, 3) << dropped.err;
  const ProcessResult accepted = RunSlamdb({"recover", At("a"), At("edited"), "--accept-edits"});
  EXPECT_EQ(accepted.exit_code, 0) << accepted.out << accepted.err;
  EXPECT_THAT(accepted.out, HasSubstr("accepted as they are, edited outside slamdb\n  keyframe "));
  EXPECT_EQ(RunSlamdb({"check", At("edited")}).exit_code, 0);
  EXPECT_THAT(RunSlamdb({"log", At("edited"), "--json"}).out, HasSubstr("(2 rows edited outside slamdb)"));
  const json report = json::parse(RunSlamdb({"recover", At("a"), "--dry-run", "--json", "--accept-edits"}).out);
  EXPECT_EQ(BreachOf(report, "recover.schema.json"), "");
  EXPECT_EQ(report.at("accepted").size(), 2U);
}

TEST_F(StoreVerbs, NamesThatCouldNotBeGivenAgainAreRefused) {
  const ProcessResult refused = RunSlamdb({"convert", kTiny, At("a\x1b[31m")});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("1 to 255 bytes of UTF-8"));
  const ProcessResult empty = RunSlamdb({"convert", kTiny, "", "--to", "store"});
  EXPECT_NE(empty.exit_code, 0);
}

TEST_F(StoreVerbs, NameIsNeededWhereThereAreSeveral) {
  const ProcessResult result = RunSlamdb({"info", store_});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("a"));
  EXPECT_EQ(RunSlamdb({"info", At("a")}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"info", At("nobody")}).exit_code, 1);
}

// The store's own verbs.
std::vector<std::vector<std::string>> CommandsOnStore(const std::string& store, const std::string& copy) {
  return {{"list", store},
          {"log", store},
          {"stats", store},
          {"vacuum", store},
          {"migrate", store},
          {"remove", store + "#a"},
          {"backup", store, copy},
          {"restore", store + "#a@1"},
          {"tag", store + "#a"},
          {"tag", store + "#a", "release"},
          {"branch", store + "#a", "b"},
          {"gc", store, "--keep", "1"}};
}

TEST(StoreErrors, ReadingVerbsNeverMakeAStore) {
  const TemporaryFolder folder;
  const std::string missing = folder / "missing.db";
  for (const std::vector<std::string>& command : CommandsOnStore(missing, folder / "copy.db")) {
    SCOPED_TRACE(command.front());
    const ProcessResult result = RunSlamdb(command);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr("missing.db"));
    EXPECT_FALSE(std::filesystem::exists(missing));
  }
}

TEST(StoreErrors, FileThatIsNoStore) {
  for (const char* verb : {"log", "stats", "vacuum", "migrate"}) {
    const ProcessResult result = RunSlamdb({verb, kTiny});
    EXPECT_EQ(result.exit_code, 1) << verb;
    EXPECT_THAT(result.err, HasSubstr("tiny.osa"));
  }
}

// As every other verb says it.
TEST(StoreErrors, FilesThatAreKnownAreNamed) {
  const TemporaryFolder folder;
  const std::string pointer = folder / "lfs.db", page = folder / "page.db", packed = folder / "packed.db";
  WriteWholeFile(pointer,
                 "version https://git-lfs.github.com/spec/v1\noid sha256:" + std::string(64, '0') + "\nsize 1000\n");
  WriteWholeFile(page, "<!DOCTYPE html>\n<html><body>Sign in</body></html>\n");
  WriteWholeFile(packed, std::string("PK\x03\x04\x14\0\0\0", 8) + std::string(600, 'x'));
  const std::pair<std::string, const char*> files[] = {
      {pointer, "Git LFS"}, {page, "web page"}, {packed, "zip"}, {kTiny, "an atlas of ORB-SLAM3"}};
  for (const auto& [file, what] : files)
    for (const std::vector<std::string>& command : CommandsOnStore(file, folder / "copy.db")) {
      if (command[0] == "list" && file == kTiny) continue;  // which lists files, too
      SCOPED_TRACE(command[0] + " " + file);
      const ProcessResult result = RunSlamdb(command);
      EXPECT_EQ(result.exit_code, 1);
      EXPECT_THAT(result.err, AllOf(HasSubstr("not a store: this is"), HasSubstr(what)));
    }
}

TEST_F(StoreVerbs, NamesThatNoneCanHaveSayWhy) {
  for (const std::string name : {"a/b", "a#b"}) {
    const ProcessResult refused = RunSlamdb({"convert", kTiny, At(name)});
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err, HasSubstr("the name of an atlas holds no `#` and no `/`"));
  }
}

TEST(StoreErrors, BadWaitIsAUsageError) { EXPECT_EQ(RunSlamdb({"list", "x.db", "--wait", "-3"}).exit_code, 2); }

}  // namespace
}  // namespace slamdb::testing
