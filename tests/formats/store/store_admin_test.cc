// SPDX-License-Identifier: BSD-3-Clause
// List, log, remove, vacuum, stats, backup, migrate.
#include <gmock/gmock.h>

#include <fstream>

#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/model/digest.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using ::testing::HasSubstr;

class StoreAdmin : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
};

TEST_F(StoreAdmin, ListTellsWhatIsThere) {
  const Atlas atlas = SoundAtlas();
  SaveIn(path_, atlas, "zebra");
  SaveIn(path_, OddAtlas(), "ant");
  SaveIn(path_, OddAtlas(), "zebra");
  SaveIn(path_, atlas, "zebra");
  SaveIn(path_, atlas, "zebra");  // which changes nothing
  const std::vector<StoredAtlas> list = Store::Open(path_).List();
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].name, "ant");
  EXPECT_EQ(list[0].maps, 3U);
  EXPECT_EQ(list[0].keyframes, 7U);
  EXPECT_EQ(list[1].name, "zebra");
  EXPECT_EQ(list[1].revision, 3U);
  EXPECT_EQ(list[1].hash, HashOf(atlas));
  EXPECT_GT(list[1].bytes, 50000U);
  EXPECT_THAT(list[1].saved_at, ::testing::MatchesRegex("20..-..-..T..:..:..Z"));
}

TEST_F(StoreAdmin, HistoryKeepsEverything) {
  SaveIn(path_, OddAtlas(), "x");
  SaveIn(path_, OddAtlas(), "x");
  SaveIn(path_, Atlas(), "y");
  Store::OpenForWriting(path_).Remove("x");
  Store store = Store::Open(path_);
  const std::vector<HistoryEntry> log = store.Log();
  ASSERT_EQ(log.size(), 4U);
  EXPECT_EQ(log[0].action, "save");
  EXPECT_EQ(log[0].provenance, "test");
  EXPECT_EQ(log[0].keyframes, 7U);
  EXPECT_GT(log[0].inserted, 20U);
  EXPECT_THAT(log[0].tool, HasSubstr("slamdb "));
  EXPECT_EQ(log[1].updated, 0U);
  EXPECT_GT(log[1].unchanged, 20U);
  EXPECT_EQ(log[1].hash, log[0].hash);
  EXPECT_EQ(log[3].action, "remove");
  EXPECT_GT(log[3].deleted, 20U);
  EXPECT_EQ(store.Log("y").size(), 1U);
}

TEST_F(StoreAdmin, RemoveTakesEverythingOfThatAtlasOnly) {
  SaveIn(path_, SoundAtlas(), "keep");
  SaveIn(path_, OddAtlas(), "drop");
  Store store = Store::OpenForWriting(path_);
  store.Remove("drop");
  EXPECT_THAT(ErrorOf([&] { store.Remove("drop"); }), HasSubstr("no atlas named 'drop'; it holds keep"));
  EXPECT_EQ(FirstDifference(store.Load("keep"), SoundAtlas()), "");
  store.Remove("keep");
  for (const char* table :
       {"atlas", "camera", "map", "map_origin", "repeated_entry", "keyframe", "keyframe_features", "keyframe_link",
        "keyframe_words", "map_point", "map_point_box", "landmark", "observation"}) {
    EXPECT_EQ(Sql(path_, std::string("SELECT count(*) FROM ") + table), "0") << table;
  }
}

TEST_F(StoreAdmin, VacuumGivesSpaceBack) {
  SaveIn(path_, SoundAtlas(), "a");
  SaveIn(path_, SoundAtlas(), "b");
  Store store = Store::OpenForWriting(path_);
  store.Remove("b");
  const StoreStats before = store.Stats();
  EXPECT_GT(before.free_pages, 0U);
  store.Vacuum();
  const StoreStats after = store.Stats();
  EXPECT_EQ(after.free_pages, 0U);
  EXPECT_LT(after.pages, before.pages);
  EXPECT_LT(after.file_bytes, before.page_bytes * before.pages);
  EXPECT_EQ(FirstDifference(store.Load("a"), SoundAtlas()), "");
}

TEST_F(StoreAdmin, StatsAddUp) {
  SaveIn(path_, SoundAtlas());
  const StoreStats stats = Store::Open(path_).Stats();
  EXPECT_EQ(stats.version, sqlite::NewestVersion());
  EXPECT_EQ(stats.file_bytes, stats.page_bytes * stats.pages);
  EXPECT_EQ(stats.log_bytes, 0U);
  std::uint64_t sum = 0;
  for (const PartSize& table : stats.tables) sum += table.bytes;
  EXPECT_EQ(sum + stats.free_pages * stats.page_bytes, stats.file_bytes);
  EXPECT_EQ(stats.tables[0].part, "picture");
}

TEST_F(StoreAdmin, BackupIsTheStore) {
  SaveIn(path_, OddAtlas());
  const std::string target = folder_ / "backup.db";
  Store::Open(path_).Backup(target);
  EXPECT_EQ(FirstDifference(LoadFrom(target), OddAtlas()), "");
  EXPECT_EQ(Sql(target, "PRAGMA integrity_check"), "ok");
  EXPECT_THAT(ErrorOf([&] { Store::Open(path_).Backup(target); }), HasSubstr("exists"));
  EXPECT_NO_THROW(Store::Open(path_).Backup(target, true));
  EXPECT_THAT(ErrorOf([&] { Store::Open(path_).Backup(path_, true); }), HasSubstr("is the store itself"));
  EXPECT_NE(ErrorOf([&] { Store::Open(path_).Backup(folder_ / "no/such/folder.db"); }), "");
}

TEST_F(StoreAdmin, BackupWhileAnotherSaves) {
  SaveIn(path_, OddAtlas());
  Store writer = Store::OpenForWriting(path_, {.sync = false});
  SaveOptions options;
  options.progress = [&](std::string_view, double) { Store::Open(path_).Backup(folder_ / "backup.db", true); };
  writer.Save("a", SoundAtlas(), options);
  EXPECT_EQ(FirstDifference(LoadFrom(folder_ / "backup.db"), OddAtlas()), "");
}

TEST_F(StoreAdmin, MigratingTheNewestDoesNothing) {
  SaveIn(path_, OddAtlas());
  const std::string before = FileBytes(path_);
  const MigrateReport report = MigrateStore(path_);
  EXPECT_EQ(report.from, report.to);
  EXPECT_TRUE(report.steps.empty() && report.backup.empty());
  EXPECT_EQ(FileBytes(path_), before);
}

class StoreMigration : public StoreAdmin {
 protected:
  StoreMigration() {
    SaveIn(path_, OddAtlas());
    migrations_.assign(sqlite::Migrations().begin(), sqlite::Migrations().end());
    const int next = migrations_.back().number + 1;
    migrations_.push_back({next, "0008_notes", "CREATE TABLE note (text TEXT) STRICT"});
    migrations_.push_back({next + 1, "0009_more", "ALTER TABLE note ADD COLUMN author TEXT"});
  }
  std::vector<sqlite::Migration> migrations_;
};

// A new store is made at once, and not step by step.
TEST_F(StoreMigration, MakeWhatANewStoreHas) {
  SaveIn(path_, Atlas());
  sqlite::Database migrated = sqlite::Database::InMemory("migrated");
  sqlite::RunMigrations(migrated, sqlite::Migrations());
  sqlite::Statement select(migrated,
                           "SELECT group_concat(sql, ';') FROM (SELECT sql FROM sqlite_schema ORDER BY rowid)");
  ASSERT_TRUE(select.Step());
  EXPECT_EQ(Sql(path_, "SELECT group_concat(sql, ';') FROM (SELECT sql FROM sqlite_schema ORDER BY rowid)"),
            select.Text(0));
  EXPECT_EQ(migrated.Integer("PRAGMA user_version"), sqlite::NewestVersion());
}

TEST_F(StoreMigration, DryRunListsTheStepsAndChangesNothing) {
  const std::string before = FileBytes(path_);
  const MigrateReport report = sqlite::Migrate(path_, {.dry_run = true}, migrations_);
  EXPECT_EQ(report.from, 7);
  EXPECT_EQ(report.to, 9);
  EXPECT_THAT(report.steps, ::testing::ElementsAre("0008_notes", "0009_more"));
  EXPECT_EQ(report.backup, "");
  EXPECT_EQ(FileBytes(path_), before);
}

TEST_F(StoreMigration, RunsWithABackupBeside) {
  std::ofstream(path_ + ".v7.bak") << "taken";
  const MigrateReport report = sqlite::Migrate(path_, {}, migrations_);
  EXPECT_EQ(Sql(path_, "PRAGMA user_version"), "9");
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM note WHERE author = 'x'"), "0");
  EXPECT_EQ(Sql(path_, "SELECT action, provenance FROM history ORDER BY row DESC LIMIT 1"), "migrate|version 7 to 9");
  EXPECT_EQ(report.backup, path_ + ".v7.bak.2");
  EXPECT_EQ(FirstDifference(LoadFrom(report.backup), OddAtlas()), "");
}

TEST_F(StoreMigration, FailedStepLeavesTheStoreAsItWas) {
  migrations_.back().sql = "ALTER TABLE nonsense ADD COLUMN x";
  EXPECT_THAT(ErrorOf([&] { sqlite::Migrate(path_, {.backup = false}, migrations_); }), HasSubstr("nonsense"));
  EXPECT_EQ(Sql(path_, "PRAGMA user_version"), "7");
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM sqlite_schema WHERE name = 'note'"), "0");
  EXPECT_EQ(FirstDifference(LoadFrom(path_), OddAtlas()), "");
}

TEST_F(StoreMigration, OlderStoreIsToBeMigrated) {
  sqlite::Migrate(path_, {}, migrations_);
  EXPECT_THAT(ErrorOf([&] { Store::Open(path_); }), HasSubstr("store version 9, newest known to this program is 7"));
}

}  // namespace
}  // namespace slamdb::store_test
