// SPDX-License-Identifier: BSD-3-Clause
// Backups: of private stores, over links, and onto stores in which others work.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "tests/formats/sqlite/atlases.h"
#include "tests/support/kind_of.h"

namespace slamdb::store_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class StoreBackup : public ::testing::Test {
 protected:
  StoreBackup() {
    SaveIn(path_, OddAtlas(), "yesterday");
    SaveIn(target_, SoundAtlas(), "today");
  }
  static unsigned ModeOf(const std::string& path) {
    struct stat status {};
    ::stat(path.c_str(), &status);
    return status.st_mode & 07777;
  }
  std::vector<std::string> Restored() const { return Store::Open(target_).Names(); }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db", target_ = folder_ / "t.db";
};

TEST_F(StoreBackup, BecomesTheContentOfTheStoreThatIsThere) {
  Store reader = Store::Open(target_);
  Store::Open(path_).Backup(target_, true);
  EXPECT_THAT(reader.Load("yesterday"), EqualsAtlas(OddAtlas()));
  EXPECT_EQ(Sql(target_, "PRAGMA integrity_check"), "ok");
  EXPECT_EQ(Sql(target_, "PRAGMA journal_mode"), "wal");
  SaveIn(target_, SoundAtlas(), "today");
}

// Whoever asked for the replacement did not know of what is being saved at that moment.
TEST_F(StoreBackup, NothingThatIsBeingSavedThereIsLost) {
  Store source = Store::Open(path_, 60);
  std::string error;
  std::jthread restoring;
  SaveOptions options;
  options.before_commit = [&] {
    restoring = std::jthread([&] { error = ErrorOf([&] { source.Backup(target_, true); }); });
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // it waits for the lock by now
  };
  Store::OpenForWriting(target_, {.sync = false}).Save("new", OddAtlas(), options);
  restoring.join();
  EXPECT_THAT(error, HasSubstr("another program saved to it just now"));
  EXPECT_THAT(Restored(), ElementsAre("new", "today"));
  EXPECT_THAT(LoadFrom(target_, "new"), EqualsAtlas(OddAtlas()));
}

TEST_F(StoreBackup, WaitsForAWriterNoLongerThanItIsTold) {
  SaveOptions options;
  std::optional<ErrorKind> kind;
  options.before_commit = [&] { kind = KindOf([&] { Store::Open(path_, 0.05).Backup(target_, true); }); };
  Store::OpenForWriting(target_, {.sync = false}).Save("new", OddAtlas(), options);
  EXPECT_EQ(kind, ErrorKind::kLocked);
}

void SaveAndDie(const std::string& path) {
  Store store = Store::OpenForWriting(path, {.sync = false});
  store.Save("late", SoundAtlas());
  ::_exit(0);
}

void RestoreOnAFullDisk(const std::string& folder) {
  ::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{100000, RLIM_INFINITY};
  ::setrlimit(RLIMIT_FSIZE, &limit);
  ::_exit(ErrorOf([&] { Store::Open(folder + "/s.db").Backup(folder + "/t.db", true); }).empty() ? 1 : 0);
}

// What stands in the log of the old store is a part of it.
TEST_F(StoreBackup, AStepThatFailsLeavesTheOldStoreAndItsLog) {
  InChild(&SaveAndDie, target_);
  ASSERT_GT(std::filesystem::file_size(target_ + "-wal"), 0U);
  EXPECT_EQ(InChild(&RestoreOnAFullDisk, folder_.path().string()), 0);
  EXPECT_THAT(Restored(), ElementsAre("late", "today"));
  EXPECT_THAT(LoadFrom(target_, "late"), EqualsAtlas(SoundAtlas()));
  EXPECT_EQ(Sql(target_, "PRAGMA integrity_check"), "ok");
}

TEST_F(StoreBackup, FollowsLinks) {
  const std::string link = folder_ / "link.db";
  std::filesystem::create_symlink("t.db", link);
  Store::Open(path_).Backup(link, true);
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_THAT(Restored(), ElementsAre("yesterday"));
  const std::string dangling = folder_ / "dangling.db";
  std::filesystem::create_symlink("new.db", dangling);
  Store::Open(path_).Backup(dangling, true);
  EXPECT_TRUE(std::filesystem::is_symlink(dangling));
  EXPECT_THAT(LoadFrom(folder_ / "new.db", "yesterday"), EqualsAtlas(OddAtlas()));
}

TEST_F(StoreBackup, ReplacesStoresAlone) {
  Sql(folder_ / "other.db", "CREATE TABLE recipes (title)");
  const std::string text = folder_.Make("text.db", std::string(300, 'x'));
  EXPECT_EQ(KindOf([&] { Store::Open(path_).Backup(folder_ / "other.db", true); }), ErrorKind::kUnsupported);
  EXPECT_EQ(KindOf([&] { Store::Open(path_).Backup(text, true); }), ErrorKind::kDamaged);
  EXPECT_EQ(KindOf([&] { Store::Open(path_).Backup("/dev/null", true); }), ErrorKind::kUsage);
  EXPECT_EQ(FileBytes(text), std::string(300, 'x'));
  Store::Open(path_).Backup(folder_.Make("empty.db", ""), true);
  EXPECT_THAT(LoadFrom(folder_ / "empty.db", "yesterday"), EqualsAtlas(OddAtlas()));
}

TEST_F(StoreBackup, CopiesOfAPrivateStoreArePrivate) {
  ::chmod(path_.c_str(), 0600);
  Store::Open(path_).Backup(folder_ / "copy.db");
  EXPECT_EQ(ModeOf(folder_ / "copy.db"), 0600U);
  EXPECT_EQ(ModeOf(MigrateStore(target_, {.back = true}).backup), ModeOf(target_));
  Store::Open(path_).Backup(folder_ / "copy.db", true);
  EXPECT_EQ(ModeOf(folder_ / "copy.db"), 0600U);
}

TEST_F(StoreBackup, AFailedCopyLeavesNothing) {
  ::chmod(path_.c_str(), 0600);
  EXPECT_NE(ErrorOf([&] { Store::Open(path_).Backup(folder_ / "no/such.db"); }), "");
  EXPECT_THAT(folder_.Names(), ElementsAre("s.db", "t.db"));
}

}  // namespace
}  // namespace slamdb::store_test
