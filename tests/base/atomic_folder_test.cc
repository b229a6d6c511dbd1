// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/atomic_folder.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>

#include "slamdb/base/detail/file_calls.h"
#include "slamdb/base/detail/files_read.h"
#include "slamdb/base/detail/temporary_file.h"
#include "slamdb/base/detail/unfinished.h"
#include "slamdb/base/error.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class AtomicFolders : public ::testing::Test {
 protected:
  // Fills a folder with two files; commits unless told otherwise.
  void Fill(const std::string& path, bool commit = true, bool overwrite = false) {
    AtomicFolder target(path, {.overwrite = overwrite, .sync = false});
    Put(target, "cameras.bin", "new cameras");
    Put(target, "sparse/0/points.bin", "new points");
    if (commit) target.Commit();
  }
  static void Put(AtomicFolder& target, const std::string& name, const std::string& text) {
    const auto file = target.Make(name);
    file->Write(text);
    file->Commit();
  }
  std::string ProblemOf(const std::function<void()>& work) {
    try {
      work();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "model";
};

TEST_F(AtomicFolders, AppearWhole) {
  for (const char* slash : {"", "/", "//"}) {
    fs::remove_all(path_);
    Fill(path_ + slash);
    EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), "new cameras");
    EXPECT_EQ(ReadFile(path_ + "/sparse/0/points.bin"), "new points");
    EXPECT_THAT(folder_.Names(), ElementsAre("model"));
  }
}

TEST_F(AtomicFolders, LeaveNothingWithoutCommit) {
  Fill(path_, /*commit=*/false);
  EXPECT_THAT(folder_.Names(), IsEmpty());
}

TEST_F(AtomicFolders, TakeThePlaceOfAnEmptyFolder) {
  fs::create_directory(path_);
  Fill(path_);
  EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), "new cameras");
}

TEST_F(AtomicFolders, AreWrittenIntoAFullOneOnlyWhenTold) {
  fs::create_directories(path_ + "/sparse");
  folder_.Make("model/cameras.bin", "old cameras");
  folder_.Make("model/mine.txt", "mine");
  EXPECT_THAT(ProblemOf([&] { Fill(path_); }), HasSubstr("is there already and holds files"));
  EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), "old cameras");
  Fill(path_, true, /*overwrite=*/true);
  EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), "new cameras");
  EXPECT_EQ(ReadFile(path_ + "/sparse/0/points.bin"), "new points");
  EXPECT_EQ(ReadFile(path_ + "/mine.txt"), "mine");
  EXPECT_THAT(folder_.Names(), ElementsAre("model"));
}

// Whoever works there stays in it.
TEST_F(AtomicFolders, AppearInTheFolderThatOneWorksIn) {
  fs::create_directory(path_);
  const fs::path before = fs::current_path();
  fs::current_path(path_);
  const std::string problem = ProblemOf([&] { Fill("."); });
  const std::string cameras = ReadFile("cameras.bin");
  fs::current_path(before);
  EXPECT_EQ(problem, "");
  EXPECT_EQ(cameras, "new cameras");
  EXPECT_EQ(ReadFile(path_ + "/sparse/0/points.bin"), "new points");
  EXPECT_THAT(folder_.Names(), ElementsAre("model"));
}

TEST_F(AtomicFolders, AreNoFilesAndNoStreams) {
  folder_.Make("model", "a file");
  EXPECT_THAT(ProblemOf([&] { Fill(path_, true, true); }), HasSubstr("is a file, expected a folder"));
  EXPECT_EQ(ReadFile(path_), "a file");
  EXPECT_THAT(ProblemOf([&] { Fill("-"); }), HasSubstr("takes one file"));
  EXPECT_THAT(ProblemOf([&] { Fill(""); }), HasSubstr("is empty"));
  EXPECT_THAT(ProblemOf([&] { Fill(folder_ / "no/such/place"); }), HasSubstr("cannot create a temporary folder"));
}

TEST_F(AtomicFolders, StayWhatTheyWereWhenTheDiskFails) {
  detail::FileCalls& calls = detail::CallsOfFiles();
  const detail::FileCalls kept = calls;
  calls.rename = [](const char*, const char*) {
    errno = EIO;
    return -1;
  };
  const std::string problem = ProblemOf([&] { Fill(path_); });
  calls = kept;
  EXPECT_THAT(problem, HasSubstr("cannot rename"));
  EXPECT_THAT(folder_.Names(), IsEmpty());
}

// cameras.bin takes the place of another one, then points.bin cannot be moved.
TEST_F(AtomicFolders, AreTakenBackWhenAFileCannotBeMoved) {
  fs::create_directories(path_);
  folder_.Make("model/cameras.bin", "old cameras");
  folder_.Make("model/mine.txt", "mine");
  detail::FileCalls& calls = detail::CallsOfFiles();
  const detail::FileCalls kept = calls;
  calls.rename = [](const char*, const char*) {
    errno = EIO;
    return -1;
  };
  const std::string problem = ProblemOf([&] { Fill(path_, true, /*overwrite=*/true); });
  calls = kept;
  EXPECT_THAT(problem, HasSubstr("points.bin: cannot rename"));
  EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), "old cameras");
  EXPECT_FALSE(fs::exists(path_ + "/sparse/0/points.bin"));
  EXPECT_THAT(folder_.Names(), ElementsAre("model"));
}

TEST_F(AtomicFolders, ReplaceNoMapThatLiesInThem) {
  fs::create_directories(path_);
  const std::string archive = std::string("\x16\0\0\0\0\0\0\0serialization::archive\x12\0", 32);
  const std::string database("SQLite format 3\0 and the rest", 30);
  for (const std::string& map : {archive, database}) {
    folder_.Make("model/cameras.bin", map);
    EXPECT_THAT(ProblemOf([&] { Fill(path_, true, /*overwrite=*/true); }), HasSubstr("which nothing replaces"));
    EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), map);
    EXPECT_FALSE(fs::exists(path_ + "/sparse/0/points.bin"));
  }
}

// What may be the only one there is, as a picture that somebody took.
TEST_F(AtomicFolders, ReplaceByEqualOnesAloneWhatTheyAreToldSo) {
  const auto write = [&](const std::string& bytes) {
    AtomicFolder target(path_, {.overwrite = true, .sync = false});
    Put(target, "cameras.bin", "cameras of " + bytes);
    const auto picture = target.Make("images/a.png", Replaces::kEqual);
    picture->Write(bytes);
    picture->Commit();
    target.Commit();
  };
  EXPECT_EQ(ProblemOf([&] { write("mine"); }), "");
  EXPECT_EQ(ProblemOf([&] { write("mine"); }), "");
  for (const char* other : {"yours", "mind", "min", "mine too", ""})
    EXPECT_THAT(ProblemOf([&] { write(other); }), HasSubstr("images/a.png: is another file than")) << other;
  EXPECT_EQ(ReadFile(path_ + "/images/a.png"), "mine");
  EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), "cameras of mine");
}

// The same database is the one that a killed run had moved there; whoever has it open keeps it.
TEST_F(AtomicFolders, LeaveADatabaseOfTheSameBytesWhereItIs) {
  const std::string database("SQLite format 3\0 and the rest", 30), path = path_ + "/database.db";
  const auto write = [&](const std::string& bytes) {
    AtomicFolder target(path_, {.overwrite = true, .sync = false});
    Put(target, "cameras.bin", "cameras");
    Put(target, "database.db", bytes);
    target.Commit();
  };
  fs::create_directories(path_);
  folder_.Make("model/database.db", database);
  folder_.Make("model/.slamdb-unfinished", "slamdb was replacing\ncameras.bin\ndatabase.db\n");
  struct stat before {
  }, after{};
  ASSERT_EQ(::stat(path.c_str(), &before), 0);
  EXPECT_EQ(ProblemOf([&] { write(database); }), "");
  EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), "cameras");
  ASSERT_EQ(::stat(path.c_str(), &after), 0);
  EXPECT_EQ(before.st_ino, after.st_ino);
  EXPECT_FALSE(fs::exists(path_ + "/.slamdb-unfinished"));
  EXPECT_THAT(ProblemOf([&] { write(database + "more"); }), HasSubstr("which nothing replaces"));
  folder_.Make("model/database.db-wal", "what was written since");
  EXPECT_THAT(ProblemOf([&] { write(database); }), HasSubstr("which nothing replaces"));
  EXPECT_EQ(ReadFile(path), database);
}

// Of one that was removed: SQLite would play it into the new one.
TEST_F(AtomicFolders, HaveNoDatabaseWhereTheLogOfAnotherLies) {
  const auto write = [&] {
    AtomicFolder target(path_, {.overwrite = true, .sync = false});
    Put(target, "cameras.bin", "new cameras");
    Put(target, "database.db", std::string("SQLite format 3\0 and the rest", 30));
    target.Commit();
  };
  for (const char* log : {"model/database.db-wal", "model/database.db-journal"}) {
    fs::remove_all(path_);
    fs::create_directories(path_);
    folder_.Make("model/cameras.bin", "old cameras");
    folder_.Make(log, "changes of the old one");
    EXPECT_THAT(ProblemOf(write), HasSubstr("is the log of a database that is gone")) << log;
    EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), "old cameras");
    EXPECT_FALSE(fs::exists(path_ + "/database.db"));
    fs::resize_file(folder_ / log, 0);
    EXPECT_EQ(ProblemOf(write), "");
  }
}

TEST_F(AtomicFolders, GiveASinkTheirBytesAndWriteNothing) {
  std::string taken;
  const auto take = [&](Bytes bytes) { taken.append(reinterpret_cast<const char*>(bytes.data()), bytes.size()); };
  {
    AtomicFolder target(Target(take, path_));
    Put(target, "cameras.bin", "cameras");
    Put(target, "points.bin", " and points");
    target.Commit();
  }
  EXPECT_EQ(taken, "cameras and points");
  taken.clear();
  AtomicFiles files(Target(take, folder_ / "map.yaml"));
  const auto beside = files.Make("map.points"), header = files.MakeTarget();
  header->Write("header");
  header->Commit();
  beside->Write("points of the map");
  beside->Commit();
  files.Commit();
  EXPECT_EQ(taken, "header");
  EXPECT_THAT(folder_.Names(), IsEmpty());
}

// A call that fails where `fails` says so.
template <class Call>
class Failing {
 public:
  Failing(Call& call, Call replacement) : call_(call), kept_(call) { call_ = replacement; }
  ~Failing() { call_ = kept_; }
  Failing(const Failing&) = delete;
  Failing& operator=(const Failing&) = delete;

 private:
  Call &call_, kept_;
};

int left_exchanges = 0;
int ExchangeSome(int from_folder, const char* from, int to_folder, const char* to, unsigned int flags) {
  if (left_exchanges-- > 0) return ::renameat2(from_folder, from, to_folder, to, flags);
  errno = EINVAL;
  return -1;
}

TEST_F(AtomicFolders, AreExchangedAsAWholeWhereTheyHoldNothingElse) {
  Fill(path_);
  fs::permissions(path_, fs::perms::owner_all);
  const auto folder = [this] {
    struct stat status {};
    return ::stat(path_.c_str(), &status) == 0 ? status.st_ino : 0;
  };
  const ino_t before = folder();
  Fill(path_, true, /*overwrite=*/true);
  EXPECT_NE(folder(), before);  // the one in which the files were made
  EXPECT_EQ(fs::status(path_).permissions(), fs::perms::owner_all);
  EXPECT_THAT(folder_.Names(), ElementsAre("model"));
}

// An empty folder of somebody's is something else, too.
TEST_F(AtomicFolders, KeepFoldersOfOthers) {
  Fill(path_);
  fs::create_directories(path_ + "/sparse/mine");
  fs::permissions(path_ + "/sparse/0", fs::perms::owner_all);
  Fill(path_, true, /*overwrite=*/true);
  EXPECT_TRUE(fs::exists(path_ + "/sparse/mine"));
  fs::remove(path_ + "/sparse/mine");
  Fill(path_, true, /*overwrite=*/true);
  EXPECT_EQ(fs::status(path_ + "/sparse/0").permissions(), fs::perms::owner_all);
}

TEST_F(AtomicFolders, AreFilledOneByOneWhereTheSystemCannotExchange) {
  fs::create_directories(path_);
  for (const char* other : {"", "mine.txt"}) {
    folder_.Make("model/cameras.bin", "old cameras");
    if (*other != 0) folder_.Make("model/mine.txt", "mine");
    left_exchanges = 0;
    const Failing no_exchange(detail::CallsOfFiles().renameat2, &ExchangeSome);
    Fill(path_, true, /*overwrite=*/true);
    EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), "new cameras");
    EXPECT_FALSE(fs::exists(path_ + "/.slamdb-unfinished"));
    EXPECT_THAT(folder_.Names(), ElementsAre("model"));
  }
}

TEST_F(AtomicFolders, AreTakenBackAlsoWhereTheSystemCannotExchange) {
  fs::create_directories(path_);
  folder_.Make("model/cameras.bin", "old cameras");
  folder_.Make("model/mine.txt", "mine");
  static int renames;
  renames = 0;
  left_exchanges = 0;
  const Failing no_exchange(detail::CallsOfFiles().renameat2, &ExchangeSome);
  const Failing third_rename(
      detail::CallsOfFiles().rename,
      +[](const char* from, const char* to) { return ++renames == 3 ? (errno = EIO, -1) : std::rename(from, to); });
  EXPECT_THAT(ProblemOf([&] { Fill(path_, true, /*overwrite=*/true); }), HasSubstr("points.bin: cannot rename"));
  EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), "old cameras");
  EXPECT_FALSE(fs::exists(path_ + "/sparse"));
  EXPECT_FALSE(fs::exists(path_ + "/.slamdb-unfinished"));
}

TEST_F(AtomicFolders, AreNotReplacedByTwoAtOnce) {
  fs::create_directories(path_);
  folder_.Make("model/cameras.bin", "old cameras");
  folder_.Make("model/mine.txt", "mine");
  folder_.Make("model/.slamdb-unfinished", "");
  const int other = ::open((path_ + "/.slamdb-unfinished").c_str(), O_RDWR);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  EXPECT_THAT(ProblemOf([&] { Fill(path_, true, /*overwrite=*/true); }), HasSubstr("by another program"));
  EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), "old cameras");
  ::close(other);
  Fill(path_, true, /*overwrite=*/true);
  EXPECT_EQ(ReadFile(path_ + "/cameras.bin"), "new cameras");
  EXPECT_FALSE(fs::exists(path_ + "/.slamdb-unfinished"));
}

TEST_F(AtomicFolders, OfWhichAKilledProgramReplacedOtherFilesAreNotMixed) {
  fs::create_directories(path_);
  folder_.Make("model/frames.bin", "old or new");
  const std::string unfinished = folder_.Make("model/.slamdb-unfinished", "some words:\ncameras.bin\nframes.bin\n");
  EXPECT_THAT(ProblemOf([&] { detail::RefuseUnfinished(unfinished, path_); }), HasSubstr("was killed"));
  EXPECT_EQ(ProblemOf([&] { detail::RefuseUnfinished(unfinished, path_, "sparse/0/"); }), "");
  EXPECT_THAT(ProblemOf([&] { Fill(path_, true, /*overwrite=*/true); }), HasSubstr("and frames.bin, which is not"));
  EXPECT_TRUE(fs::exists(unfinished));
  fs::remove(path_ + "/frames.bin");
  Fill(path_, true, /*overwrite=*/true);
  EXPECT_FALSE(fs::exists(unfinished));
}

TEST_F(AtomicFolders, AreReadThoughNobodyCanRemoveTheClaim) {
  fs::create_directories(path_);
  folder_.Make("model/mine.txt", "mine");
  {
    const Failing no_unlink(
        detail::CallsOfFiles().unlink, +[](const char*) { return -1; });
    Fill(path_, true, /*overwrite=*/true);
  }
  ASSERT_TRUE(fs::exists(path_ + "/.slamdb-unfinished"));
  EXPECT_EQ(ProblemOf([&] { detail::RefuseUnfinished(path_ + "/.slamdb-unfinished", path_); }), "");
}

TEST_F(AtomicFolders, MendWhatWasLeftInFoldersBelow) {
  fs::create_directories(path_ + "/sparse/0");
  const std::string unfinished = folder_.Make("model/sparse/0/.slamdb-unfinished", "words:\npoints.bin\nframes.bin\n");
  folder_.Make("model/sparse/0/frames.bin", "old or new");
  EXPECT_THAT(ProblemOf([&] { Fill(path_, true, /*overwrite=*/true); }), HasSubstr("and sparse/0/frames.bin, which"));
  EXPECT_TRUE(detail::IsUnfinished(unfinished));
  fs::remove(path_ + "/sparse/0/frames.bin");
  const pid_t child = ::fork();
  if (child == 0) {
    const AtomicFolder target(path_ + "/sparse/0", {.overwrite = true, .sync = false});
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(child, nullptr, 0);
  Fill(path_, true, /*overwrite=*/true);
  EXPECT_FALSE(fs::exists(unfinished));
  EXPECT_EQ(std::distance(fs::directory_iterator(path_ + "/sparse"), fs::directory_iterator()), 1);
}

TEST_F(AtomicFolders, OfKilledProgramsKeepTheOldFilesUntilOthersAreThere) {
  fs::create_directories(path_);
  folder_.Make("model/cameras.bin", "old cameras");
  folder_.Make("model/mine.txt", "mine");
  const pid_t child = ::fork();
  if (child == 0) {
    detail::CallsOfFiles().rename = [](const char*, const char*) { return ::kill(::getpid(), SIGKILL); };
    Fill(path_, true, /*overwrite=*/true);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  Fill(path_, /*commit=*/false, /*overwrite=*/true);
  EXPECT_THAT(folder_.Names(), SizeIs(2));
  Fill(path_, true, /*overwrite=*/true);
  EXPECT_THAT(folder_.Names(), ElementsAre("model"));
}

TEST_F(AtomicFolders, AreNotReadWhileTheyAreReplacedAsAWhole) {
  Fill(path_);
  detail::FilesRead files;
  for (const char* name : {"/cameras.bin", "/sparse/0/points.bin", "/frames.bin"}) files.Note(path_ + name);
  EXPECT_EQ(ProblemOf([&] { files.RequireSame(); }), "");
  Fill(path_, true, /*overwrite=*/true);
  EXPECT_THAT(ProblemOf([&] { files.RequireSame(); }), HasSubstr("cameras.bin: was replaced while it was read"));
  detail::FilesRead missing;
  missing.Note(path_ + "/frames.bin");
  folder_.Make("model/frames.bin", "new");
  EXPECT_THAT(ProblemOf([&] { missing.RequireSame(); }), HasSubstr("frames.bin: was replaced"));
}

// Of whatever name their first file is, and through whatever link.
TEST_F(AtomicFolders, WithFilesOfOneStemAreOneClaim) {
  fs::create_directories(folder_ / "o");
  fs::create_symlink("o/map.yaml", folder_ / "link.yaml");
  const int other = ::open((folder_ / "o/.map.slamdb-unfinished").c_str(), O_RDWR | O_CREAT, 0666);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  const auto write = [&](const char* name) {
    AtomicFiles files(folder_ / name, {.overwrite = true, .sync = false});
    for (const std::string& made : {fs::path(files.target()).stem().string() + ".points", std::string()}) {
      const auto file = made.empty() ? files.MakeTarget() : files.Make(made);
      file->Write("new");
      file->Commit();
    }
    files.Commit();
  };
  for (const char* name : {"o/map.yaml", "o/map.osmap", "link.yaml"})
    EXPECT_THAT(ProblemOf([&] { write(name); }), HasSubstr("by another program")) << name;
  ::close(other);
  write("link.yaml");
  EXPECT_EQ(ReadFile(folder_ / "o/map.points"), "new");
  EXPECT_THAT(folder_.Names(), ElementsAre("link.yaml", "o"));
}

TEST_F(AtomicFolders, ReplaceNoFolderByAFile) {
  fs::create_directories(path_ + "/cameras.bin/mine");
  EXPECT_THAT(ProblemOf([&] { Fill(path_, true, /*overwrite=*/true); }), HasSubstr("is no file"));
  EXPECT_TRUE(fs::exists(path_ + "/cameras.bin/mine"));
}

TEST_F(AtomicFolders, WithFilesThatAreNotToBeReplacedStay) {
  folder_.Make("map.points", "old points");
  const auto write = [&](bool overwrite) {
    AtomicFiles files(folder_ / "map.yaml", {.overwrite = overwrite, .sync = false});
    for (const char* name : {"map.points", "map.yaml"}) {
      const auto file = files.Make(name);
      file->Write("new");
      file->Commit();
    }
    files.Commit();
  };
  EXPECT_THAT(ProblemOf([&] { write(false); }),
              HasSubstr("/map.yaml: map.points, which goes with it, is there already"));
  EXPECT_EQ(ReadFile(folder_ / "map.points"), "old points");
  EXPECT_THAT(folder_.Names(), ElementsAre("map.points"));
  write(true);
  EXPECT_EQ(ReadFile(folder_ / "map.points"), "new");
  EXPECT_THAT(folder_.Names(), ElementsAre("map.points", "map.yaml"));
}

TEST_F(AtomicFolders, OfKilledProgramsAreRemovedByTheNext) {
  const pid_t child = ::fork();
  if (child == 0) {
    AtomicFolder target(path_, {.sync = false});
    Put(target, "sparse/0/points.bin", "half");
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_THAT(folder_.Names(), SizeIs(1));
  Fill(path_);
  EXPECT_THAT(folder_.Names(), ElementsAre("model"));
}

TEST_F(AtomicFolders, AreRemovedByAHandlerOfSignals) {
  AtomicFolder target(path_, {.sync = false});
  for (int i = 0; i < 500; ++i) Put(target, "images/" + std::to_string(i) + ".png", "picture");
  detail::RemoveTemporaryFiles();
  EXPECT_THAT(folder_.Names(), IsEmpty());
}

}  // namespace
}  // namespace slamdb
