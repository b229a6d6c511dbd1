// SPDX-License-Identifier: BSD-3-Clause
//
// Where an AtomicFile goes: links, special files, what may not be replaced, names that two want, and what killed
// programs left. file_test.cc has the rest, file_failures_test.cc what the system refuses.
#include "slamdb/base/atomic_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <functional>
#include <thread>

#include "slamdb/base/detail/file_calls.h"
#include "slamdb/base/detail/temporary_file.h"
#include "slamdb/base/error.h"
#include "tests/support/error_of.h"
#include "tests/support/kind_of.h"
#include "tests/support/needs_proc.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::UnorderedElementsAre;
namespace fs = std::filesystem;

void WriteInto(const std::string& path, const std::string& text, AtomicFileOptions options = {}) {
  AtomicFile file(path, std::move(options));
  file.Write(text);
  file.Commit();
}

class AtomicFiles : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return folder_ / name; }
  const TemporaryFolder folder_;
};

// ---- links

TEST_F(AtomicFiles, FollowLinksToWhatIsThereAndToWhatIsNot) {
  fs::create_directory(Path("other"));
  fs::create_symlink("other/new", Path("dangling"));
  fs::create_symlink(Path("dangling"), Path("twice"));
  WriteInto(Path("twice"), "one");
  EXPECT_EQ(ReadFile(Path("other/new")), "one");
  WriteInto(Path("twice"), "two", {.overwrite = true});
  EXPECT_EQ(ReadFile(Path("other/new")), "two");
  EXPECT_TRUE(fs::is_symlink(Path("twice")));
  EXPECT_TRUE(fs::is_symlink(Path("dangling")));
}

TEST_F(AtomicFiles, ReplaceNoLinkThatLeadsNowhere) {
  fs::create_symlink("missing/new", Path("astray"));
  fs::create_symlink("ring", Path("ring"));
  for (const char* name : {"astray", "ring"}) {
    EXPECT_EQ(KindOf([&] { WriteInto(Path(name), "x", {.overwrite = true}); }), ErrorKind::kNotFound);
    EXPECT_TRUE(fs::is_symlink(Path(name)));
  }
}

// ---- what is no regular file

TEST_F(AtomicFiles, GoIntoAPipeThatStays) {
  ASSERT_EQ(::mkfifo(Path("pipe").c_str(), 0600), 0);
  std::string got;
  std::thread reader([&] { got = ReadFile(Path("pipe")); });
  WriteInto(Path("pipe"), "bytes");
  reader.join();
  EXPECT_EQ(got, "bytes");
  EXPECT_TRUE(fs::is_fifo(Path("pipe")));
  EXPECT_TRUE(IsSpecialFile(Path("pipe")));
}

TEST_F(AtomicFiles, GoIntoDevicesByLinksToo) {
  fs::create_symlink("/dev/null", Path("null"));
  WriteInto(Path("null"), "bytes");
  EXPECT_TRUE(fs::is_symlink(Path("null")));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THAT(folder_.Names(), ElementsAre("null"));
}

// As `-o /dev/stdout` in a shell that has sent it to a file: what was written there before stays.
TEST_F(AtomicFiles, GoOnWhereAnOpenFileIs) {
  SLAMDB_NEEDS_PROC();
  const int open = ::open(Path("log").c_str(), O_WRONLY | O_CREAT, 0600);
  ASSERT_EQ(::write(open, "before ", 7), 7);
  WriteInto("/dev/fd/" + std::to_string(open), "now ");
  WriteInto("/proc/self/fd/" + std::to_string(open), "again");
  ::close(open);
  EXPECT_EQ(ReadFile(Path("log")), "before now again");
  EXPECT_THAT(folder_.Names(), ElementsAre("log"));
}

// ---- what may not be replaced

TEST_F(AtomicFiles, NeverReplaceADatabase) {
  const std::string database = folder_.Make("m.db", std::string("SQLite format 3\0and more", 24));
  EXPECT_EQ(KindOf([&] { WriteInto(database, "x", {.overwrite = true}); }), ErrorKind::kAlreadyExists);
  const std::string young = folder_.Make("young.db", "");
  folder_.Make("young.db-wal", "the first save");
  EXPECT_EQ(KindOf([&] { WriteInto(young, "x", {.overwrite = true}); }), ErrorKind::kAlreadyExists);
  EXPECT_EQ(ReadFile(young), "");
  EXPECT_THAT(folder_.Names(), ElementsAre("m.db", "young.db", "young.db-wal"));
}

TEST_F(AtomicFiles, NeverReplaceADatabaseThatWasMadeMeanwhile) {
  AtomicFile file(Path("a"), {.overwrite = true});
  folder_.Make("a", std::string("SQLite format 3\0and more", 24));
  EXPECT_EQ(KindOf([&] { file.Commit(); }), ErrorKind::kAlreadyExists);
}

// SQLite would play it into the new one, also where it came while that was written.
TEST_F(AtomicFiles, AreNoDatabaseWhereTheLogOfAnotherLies) {
  const std::string database("SQLite format 3\0and more", 24);
  for (const char* log : {"m.db-wal", "m.db-journal"}) {
    SCOPED_TRACE(log);
    const AtomicFileOptions options{.overwrite = std::string(log) == "m.db-wal"};
    folder_.Make(log, "changes of the old one");
    fs::create_symlink("m.db", Path("link"));
    EXPECT_EQ(KindOf([&] { WriteInto(Path("m.db"), database, options); }), ErrorKind::kAlreadyExists);
    EXPECT_EQ(KindOf([&] { WriteInto(Path("link"), database, options); }), ErrorKind::kAlreadyExists);
    EXPECT_EQ(std::string(ErrorOf([&] { WriteInto(Path("m.db"), database, options); }).what()),
              Path(log) + ": is the log of a database that is gone, which SQLite would play into " + Path("m.db") +
                  " when that is opened; remove it, or name another output");
    fs::remove(Path(log));
    AtomicFile file(Path("m.db"), options);
    file.Write(database);
    folder_.Make(log, "changes of the old one");
    EXPECT_EQ(KindOf([&] { file.Commit(); }), ErrorKind::kAlreadyExists);
    EXPECT_FALSE(fs::exists(Path("m.db")));
    fs::resize_file(Path(log), 0);
    WriteInto(Path("m.db"), database, options);
    for (const char* made : {"m.db", "link", log}) fs::remove(Path(made));
  }
  folder_.Make("notes-journal", "of something else");
  WriteInto(Path("notes"), "no database");
}

TEST_F(AtomicFiles, NeedAName) {
  EXPECT_EQ(KindOf([] { AtomicFile file(""); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { AtomicFile file(Path("a/")); }), ErrorKind::kUsage);
}

// ---- names that two want

void ExpectThatTheFirstWins(const TemporaryFolder& folder) {
  AtomicFile slower(folder / "a");
  slower.Write("slower");
  WriteInto(folder / "a", "faster");
  EXPECT_EQ(KindOf([&] { slower.Commit(); }), ErrorKind::kAlreadyExists);
  EXPECT_EQ(ReadFile(folder / "a"), "faster");
}

TEST_F(AtomicFiles, ClaimTheirName) {
  ExpectThatTheFirstWins(folder_);
  EXPECT_THAT(folder_.Names(), ElementsAre("a"));
}

// As file systems have it that cannot rename so.
TEST_F(AtomicFiles, ClaimTheirNameByALinkToo) {
  const detail::FileCalls kept = detail::CallsOfFiles();
  detail::CallsOfFiles().renameat2 = [](int, const char*, int, const char*, unsigned int) {
    errno = EINVAL;
    return -1;
  };
  ExpectThatTheFirstWins(folder_);
  EXPECT_THAT(folder_.Names(), ElementsAre("a"));
  detail::CallsOfFiles() = kept;
}

TEST_F(AtomicFiles, LetWhatMustBeEarlierComeFirst) {
  EXPECT_ANY_THROW(WriteInto(Path("a"), "x", {.before_commit = [] { throw std::runtime_error("no"); }}));
  EXPECT_THAT(folder_.Names(), IsEmpty());
  WriteInto(Path("a"), "x", {.before_commit = [&] { EXPECT_FALSE(fs::exists(Path("a"))); }});
  EXPECT_EQ(ReadFile(Path("a")), "x");
}

// ---- owner and mode

TEST_F(AtomicFiles, KeepOwnerGroupAndMode) {
  const std::string path = folder_.Make("a", "old");
  if (::chown(path.c_str(), 12345, 23456) != 0) GTEST_SKIP() << "only the superuser gives files away";
  fs::permissions(path, static_cast<fs::perms>(02640));
  WriteInto(path, "new", {.overwrite = true});
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_uid, 12345U);
  EXPECT_EQ(status.st_gid, 23456U);
  EXPECT_EQ(status.st_mode & 07777U, 02640U);
}

// ---- what a killed program left

// Of a file that is written to in a folder of its own.
std::string TemporaryNameFor(const std::string& name) {
  const TemporaryFolder folder;
  const AtomicFile file(folder / name);
  return folder.Names().front();
}

TEST_F(AtomicFiles, RemoveDeadTemporariesAndNothingElse) {
  const TemporaryFolder& folder = folder_;
  const std::string dead = TemporaryNameFor("map.osa"), alive_name = TemporaryNameFor("alive"),
                    dead_folder = TemporaryNameFor("folder"), link = TemporaryNameFor("link"),
                    twice = TemporaryNameFor("twice"), other = ".lab.slamdb-backup",
                    forged = "." + dead.substr(2);  // whose hash is not that of its name
  folder.Make(dead, "dead");
  folder.Make(dead.substr(1), "not hidden");
  for (const std::string& mine : {std::string(".notes"), other, forged}) folder.Make(mine, "mine");
  fs::create_directory(Path(dead_folder));
  fs::create_symlink(Path(".notes"), Path(link));
  fs::create_hard_link(Path(".notes"), Path(twice));
  const int alive = ::open(folder.Make(alive_name, "").c_str(), O_WRONLY);
  ASSERT_EQ(::flock(alive, LOCK_EX), 0);
  WriteInto(Path("new"), "x");
  EXPECT_THAT(folder.Names(),
              UnorderedElementsAre(alive_name, link, ".notes", other, forged, twice, dead.substr(1), "new"));
  ::close(alive);
}

TEST_F(AtomicFiles, AreLockedWhileTheyAreWritten) {
  AtomicFile file(Path("a"));
  ASSERT_EQ(folder_.Names().size(), 1U);
  const std::string temporary = folder_.Names().front();
  EXPECT_TRUE(temporary.starts_with(".a.slamdb-"));
  const int open = ::open(Path(temporary).c_str(), O_WRONLY);
  EXPECT_NE(::flock(open, LOCK_EX | LOCK_NB), 0);
  ::close(open);
}

TEST_F(AtomicFiles, HaveTemporariesForNamesOfAnyLength) {
  const std::string longest(NAME_MAX, 'x');
  WriteInto(Path(longest), "x");
  EXPECT_THAT(folder_.Names(), ElementsAre(longest));
}

TEST_F(AtomicFiles, AreForgottenByWhoEndsByASignal) {
  AtomicFile half(Path("a"));
  WriteInto(Path("b"), "x");
  detail::RemoveTemporaryFiles();
  EXPECT_THAT(folder_.Names(), ElementsAre("b"));
}

}  // namespace
}  // namespace slamdb
