// SPDX-License-Identifier: BSD-3-Clause
// Names and files that mean something else to SQLite than to people, and stores that were made to do harm.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <cmath>
#include <limits>

#include "slamdb/formats/sqlite/detail/database.h"
#include "tests/formats/store/atlases.h"
#include "tests/support/kind_of.h"

namespace slamdb::store_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class StoreStrangers : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
};

// Only a relative path can be mistaken, so the test works in the folder.
TEST_F(StoreStrangers, PathsAreFiles) {
  const auto here = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  for (const std::string path : {":memory:", "file:lost?mode=memory&x=.db", "file:x.db", "a?b#c%20.db"}) {
    SaveIn(path, SoundAtlas());
    EXPECT_GT(std::filesystem::file_size(folder_.path() / path), 0U) << path;
    EXPECT_THAT(LoadFrom(path), EqualsAtlas(SoundAtlas())) << path;
    Store::Open(path).Backup(path + ".copy");
    EXPECT_THAT(LoadFrom(path + ".copy"), EqualsAtlas(SoundAtlas())) << path;
  }
  std::filesystem::current_path(here);
}

TEST_F(StoreStrangers, AStoreIsARegularFile) {
  EXPECT_EQ(KindOf([] { Store::OpenForWriting(""); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([] { Store::Open(""); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([] { Store::OpenForWriting("/dev/null"); }), ErrorKind::kUsage);
  ASSERT_EQ(::mkfifo((folder_ / "pipe.db").c_str(), 0600), 0);
  EXPECT_EQ(KindOf([&] { Store::Open(folder_ / "pipe.db"); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { Store::OpenForWriting(folder_ / "pipe.db"); }), ErrorKind::kUsage);
}

TEST_F(StoreStrangers, NamesOfAtlases) {
  Store store = Store::OpenForWriting(path_, {.sync = false});
  for (const std::string& name : {std::string(), std::string("a#b"), std::string("a/b"), std::string("\x1b[31m"),
                                  std::string("a\0b", 3), std::string("a\nb"), std::string(256, 'a')})
    EXPECT_EQ(KindOf([&] { store.Save(name, Atlas()); }), ErrorKind::kUsage) << name;
  Store other = Store::OpenForWriting(folder_ / "t.db", {.sync = false});
  for (const std::string& name : {std::string("Halle 3, Süd"), std::string("地図"), std::string(255, 'a')})
    EXPECT_EQ(KindOf([&] { other.Save(name, Atlas()); }), std::nullopt) << name;
}

TEST_F(StoreStrangers, AStoreThatWasMadeForASaveThatFailedIsGone) {
  EXPECT_EQ(KindOf([&] { SaveIn(path_, Atlas(), "a/b"); }), ErrorKind::kUsage);
  EXPECT_THAT(folder_.Names(), IsEmpty());
  SaveOptions cancelled;
  cancelled.progress = [](std::string_view, double) { throw Error(ErrorKind::kUsage, "cancelled"); };
  EXPECT_EQ(ErrorOf([&] { Store::OpenForWriting(path_).Save("a", SoundAtlas(), cancelled); }), "cancelled");
  EXPECT_THAT(folder_.Names(), IsEmpty());
  SaveIn(path_, Atlas());
  EXPECT_NE(ErrorOf([&] { Store::OpenForWriting(path_).Save("a", SoundAtlas(), cancelled); }), "");
  EXPECT_EQ(Store::Open(path_).Names().size(), 1U);
}

// Another writer who has the new store open keeps it there.
TEST_F(StoreStrangers, AStoreThatAnotherHasOpenStays) {
  Store failing = Store::OpenForWriting(path_, {.sync = false});
  Store other = Store::OpenForWriting(path_, {.sync = false});
  EXPECT_NE(ErrorOf([&] { failing.Save("a/b", Atlas()); }), "");
  other.Save("b", SoundAtlas());
  EXPECT_THAT(LoadFrom(path_, "b"), EqualsAtlas(SoundAtlas()));
}

TEST_F(StoreStrangers, NothingIsSavedToAFileThatIsGone) {
  Store store = Store::OpenForWriting(path_, {.sync = false});
  store.Save("a", Atlas());
  std::filesystem::rename(path_, folder_ / "moved.db");
  EXPECT_EQ(KindOf([&] { store.Save("a", Atlas()); }), ErrorKind::kLocked);
}

// Whoever made it may have taken it away again; a new one takes its place.
TEST_F(StoreStrangers, WhereTheStoreWasEmptyItIsMadeAnew) {
  Store store = Store::OpenForWriting(path_, {.sync = false});
  for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(path_ + suffix);
  store.Save("a", SoundAtlas());
  EXPECT_THAT(LoadFrom(path_), EqualsAtlas(SoundAtlas()));
}

TEST_F(StoreStrangers, TriggersNeverRun) {
  SaveIn(path_, SoundAtlas());
  Sql(path_, "CREATE TABLE trap (x)");
  for (const char* table : {"atlas", "writer", "history", "map_point", "keyframe"})
    for (const char* when : {"INSERT", "UPDATE", "DELETE"})
      Sql(path_, std::string("CREATE TRIGGER t_") + table + when + " AFTER " + when + " ON " + table +
                     " BEGIN INSERT INTO trap VALUES (1); END");
  SaveIn(path_, OddAtlas());
  SaveIn(path_, SoundAtlas(), "b");
  Store::OpenForWriting(path_).Remove("b");
  EXPECT_THAT(LoadFrom(path_), EqualsAtlas(OddAtlas()));
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM trap"), "0");
}

TEST_F(StoreStrangers, TablesAreTables) {
  for (const char* harm : {
           "ALTER TABLE history RENAME TO h; CREATE VIEW history AS SELECT * FROM h",
           "ALTER TABLE writer RENAME TO w; CREATE VIRTUAL TABLE writer USING rtree (row, process, host)",
           "ALTER TABLE atlas ADD COLUMN trap BLOB AS (zeroblob(1000000000))",
           "DROP TABLE map_point_box; CREATE VIRTUAL TABLE map_point_box USING fts5 (row)",
       }) {
    std::filesystem::remove(path_);
    SaveIn(path_, SoundAtlas());
    Sql(path_, harm);
    EXPECT_EQ(KindOf([&] { Store::Open(path_); }), ErrorKind::kDamaged) << harm;
    EXPECT_EQ(KindOf([&] { Store::OpenForWriting(path_); }), ErrorKind::kDamaged) << harm;
  }
}

// Any number of seconds means what it says.
TEST_F(StoreStrangers, Waiting) {
  for (const double seconds : {3e6, 1e300, std::numeric_limits<double>::infinity()}) {
    int calls = 0;
    sqlite::Waiting waiting(seconds, [&](std::string_view, double) { ++calls; });
    EXPECT_TRUE(waiting.Pause(0));
    EXPECT_TRUE(waiting.Pause(1));
    EXPECT_EQ(calls, 2);
  }
  for (const double seconds : {0.0, -1.0, std::nan("")}) EXPECT_FALSE(sqlite::Waiting(seconds).Pause(0));
  sqlite::Waiting stopped(1e9, [](std::string_view, double) { throw Error(ErrorKind::kUsage, "stop"); });
  EXPECT_FALSE(stopped.Pause(0));
  EXPECT_EQ(ErrorOf([&] { stopped.Rethrow(); }), "stop");
}

TEST_F(StoreStrangers, WaitingForALockCanBeEnded) {
  SaveIn(path_, SoundAtlas());
  Store writer = Store::OpenForWriting(path_, {.sync = false});
  Store second =
      Store::OpenForWriting(path_, {.sync = false, .lock_timeout = 3e6, .progress = [](std::string_view stage, double) {
                                      if (stage.starts_with("waiting")) throw Error(ErrorKind::kUsage, "Ctrl-C");
                                    }});
  SaveOptions options;
  std::string error;
  options.progress = [&](std::string_view, double) { error = ErrorOf([&] { second.Save("b", Atlas()); }); };
  writer.Save("a", OddAtlas(), options);
  EXPECT_EQ(error, "Ctrl-C");
}

}  // namespace
}  // namespace slamdb::store_test
