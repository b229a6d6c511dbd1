// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/atomic_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <filesystem>

#include "slamdb/base/detail/file_calls.h"
#include "slamdb/base/detail/temporary_file.h"
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
