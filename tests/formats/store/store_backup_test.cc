// SPDX-License-Identifier: BSD-3-Clause
// Backups: of private stores, over links, and onto stores in which others work.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/inotify.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <thread>

#include "tests/formats/store/atlases.h"
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

// Whatever is in the way is told, with what to do about it, and stays.
TEST_F(StoreBackup, SaysWhyATargetCannotBeReplaced) {
  const std::string good = FileBytes(target_);
  for (const std::string& bad :
       {good.substr(0, good.size() / 2), std::string(good.size(), '\0'), std::string("text")}) {
    const std::string path = folder_.Make("bad.db", bad);
    EXPECT_THAT(ErrorOf([&] { Store::Open(path_).Backup(path, true); }), HasSubstr("move it away with its `-wal`"));
    EXPECT_EQ(FileBytes(path), bad);
  }
  Sql(target_, "PRAGMA journal_mode=DELETE; PRAGMA page_size=4096; VACUUM; PRAGMA journal_mode=WAL");
  EXPECT_THAT(ErrorOf([&] { Store::Open(path_).Backup(target_, true); }), HasSubstr("has pages of 4096 bytes"));
  EXPECT_THAT(Restored(), ElementsAre("today"));
}

TEST_F(StoreBackup, GoesToRegularFilesAlone) {
  for (const char* target : {"/dev/null", "-"})
    EXPECT_EQ(KindOf([&] { Store::Open(path_).Backup(target); }), ErrorKind::kUsage) << target;
  EXPECT_FALSE(std::filesystem::exists("-"));
}

// A program may be killed at any moment of it: nobody removes a journal that it has left.
TEST_F(StoreBackup, LaysNoJournalBesideTheCopy) {
  const int watch = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  ASSERT_GE(::inotify_add_watch(watch, folder_.path().c_str(), IN_CREATE), 0);
  Store::Open(path_).Backup(folder_ / "copy.db");
  alignas(inotify_event) std::array<char, 65536> events{};
  const ssize_t bytes = ::read(watch, events.data(), events.size());
  ::close(watch);
  ASSERT_GT(bytes, 0);
  for (const char* at = events.data(); at < events.data() + bytes;) {
    const auto* event = reinterpret_cast<const inotify_event*>(at);
    EXPECT_FALSE(std::string_view(event->name).ends_with("-journal")) << event->name;
    at += sizeof(inotify_event) + event->len;
  }
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
