// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iostream>
#include <thread>

#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using ::testing::HasSubstr;

class StoreLocking : public ::testing::Test {
 protected:
  std::vector<std::string> Listing() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      names.push_back(entry.path().filename());
    return names;
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
};

TEST_F(StoreLocking, ReadersSeeTheOldStateWhileAWriterSaves) {
  SaveIn(path_, OddAtlas());
  Store writer = Store::OpenForWriting(path_, {.sync = false});
  Store reader = Store::Open(path_);
  int reads = 0;
  SaveOptions options;
  options.progress = [&](std::string_view, double) {
    EXPECT_EQ(FirstDifference(reader.Load("a"), OddAtlas()), "");
    EXPECT_EQ(FirstDifference(LoadFrom(path_), OddAtlas()), "");
    ++reads;
  };
  writer.Save("a", SoundAtlas(), options);
  EXPECT_GT(reads, 0);
  EXPECT_EQ(FirstDifference(reader.Load("a"), SoundAtlas()), "");
}

// A reader with several connections sees one moment in all of them, however often somebody saves.
TEST_F(StoreLocking, ReadersFindAMomentBetweenTheSavesOfABusyWriter) {
  SaveIn(path_, SoundAtlas());
  std::jthread writer([this](const std::stop_token& stop) {
    Store store = Store::OpenForWriting(path_, {.sync = false});
    for (bool odd = true; !stop.stop_requested(); odd = !odd) store.Save("a", odd ? OddAtlas() : SoundAtlas());
  });
  for (int i = 0; i < 20; ++i) {
    const Atlas atlas = LoadFrom(path_, "a", {.threads = 4});
    EXPECT_TRUE(FirstDifference(atlas, OddAtlas()).empty() || FirstDifference(atlas, SoundAtlas()).empty());
  }
}

TEST_F(StoreLocking, SecondWriterIsToldWhoHoldsTheLockAfterTheWait) {
  SaveIn(path_, OddAtlas());
  Store writer = Store::OpenForWriting(path_, {.sync = false});
  Store second = Store::OpenForWriting(path_, {.sync = false, .lock_timeout = 0.2});
  std::string error;
  double waited = 0;
  SaveOptions options;
  options.progress = [&](std::string_view, double) {
    if (!error.empty()) return;
    const auto begin = std::chrono::steady_clock::now();
    error = ErrorOf([&] { second.Save("b", Atlas()); });
    waited = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  writer.Save("a", SoundAtlas(), options);
  EXPECT_THAT(error, HasSubstr(path_ + ": locked by slamdb "));
  EXPECT_THAT(error, HasSubstr("process " + std::to_string(::getpid()) + " on host "));
  EXPECT_THAT(error, HasSubstr("waited 0.2 s"));
  EXPECT_GE(waited, 0.15);
  second.Save("b", Atlas());  // free again
  EXPECT_EQ(second.List().size(), 2U);
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM writer"), "0");
}

TEST_F(StoreLocking, LockOfAnotherProgram) {
  SaveIn(path_, OddAtlas());
  Store store = Store::OpenForWriting(path_, {.sync = false, .lock_timeout = 0});
  Store other = Store::OpenForWriting(path_, {.sync = false});
  SaveOptions options;
  options.progress = [&](std::string_view, double) {
    EXPECT_THAT(ErrorOf([&] { store.Remove("a"); }), HasSubstr("locked by"));
  };
  other.Save("a", SoundAtlas(), options);
}

TEST_F(StoreLocking, WritersTakeTurns) {
  SaveIn(path_, Atlas(), "start");
  std::vector<std::jthread> writers;
  for (int i = 0; i < 4; ++i) {
    writers.emplace_back([this, i] {
      Store store = Store::OpenForWriting(path_, {.sync = false, .lock_timeout = 60});
      store.Save("atlas " + std::to_string(i), OddAtlas());
    });
  }
  writers.clear();
  EXPECT_EQ(Store::Open(path_).List().size(), 5U);
}

TEST_F(StoreLocking, CreatedTwiceAtOnce) {
  std::vector<std::jthread> writers;
  for (int i = 0; i < 4; ++i) {
    writers.emplace_back([this, i] { SaveIn(path_, OddAtlas(), std::to_string(i)); });
  }
  writers.clear();
  EXPECT_EQ(Store::Open(path_).List().size(), 4U);
}

TEST_F(StoreLocking, ReadingLeavesTheFolderAsItWas) {
  SaveIn(path_, SoundAtlas());
  const std::string before = FileBytes(path_);
  const auto time = std::filesystem::last_write_time(path_);
  EXPECT_THAT(Listing(), ::testing::ElementsAre("s.db"));
  {
    Store store = Store::Open(path_);
    store.List();
    store.Log();
    store.Stats();
    store.Load("a");
  }
  EXPECT_THAT(Listing(), ::testing::ElementsAre("s.db"));
  EXPECT_EQ(FileBytes(path_), before);
  EXPECT_EQ(std::filesystem::last_write_time(path_), time);
}

TEST_F(StoreLocking, WritingThroughAReaderIsRefused) {
  SaveIn(path_, OddAtlas());
  Store store = Store::Open(path_);
  EXPECT_THAT(ErrorOf([&] { store.Save("a", Atlas()); }), HasSubstr("opened for reading"));
  EXPECT_THAT(ErrorOf([&] { store.Remove("a"); }), HasSubstr("opened for reading"));
  EXPECT_THAT(ErrorOf([&] { store.Vacuum(); }), HasSubstr("opened for reading"));
}

// As a user without rights, since root may write everywhere.
void LoadAsNobody(const std::string& path) {
  if (::geteuid() == 0 && (::setegid(65534) != 0 || ::seteuid(65534) != 0)) ::_exit(2);
  const std::string error = ErrorOf([&] {
    if (!FirstDifference(LoadFrom(path), SoundAtlas()).empty()) throw Error(ErrorKind::kDamaged, "differs");
  });
  const std::string write_error = ErrorOf([&] { SaveIn(path, Atlas()); });
  if (!error.empty()) std::cerr << error << "\n";
  ::_exit(error.empty() && write_error.find("cannot") != std::string::npos ? 0 : 1);
}

TEST_F(StoreLocking, ReadOnlyFileInAReadOnlyFolder) {
  SaveIn(path_, SoundAtlas());  // in WAL mode, as its header says
  ASSERT_EQ(Sql(path_, "PRAGMA journal_mode"), "wal");
  ::chmod(path_.c_str(), 0444);
  ::chmod(folder_.path().c_str(), 0555);
  EXPECT_EQ(InChild(&LoadAsNobody, path_), 0);
  ::chmod(folder_.path().c_str(), 0755);
  EXPECT_THAT(Listing(), ::testing::ElementsAre("s.db"));
}

TEST_F(StoreLocking, WritableFileInAReadOnlyFolder) {
  SaveIn(path_, SoundAtlas());
  ::chmod(path_.c_str(), 0666);
  ::chmod(folder_.path().c_str(), 0555);
  EXPECT_EQ(InChild(&LoadAsNobody, path_), 0);
  ::chmod(folder_.path().c_str(), 0755);
}

}  // namespace
}  // namespace slamdb::store_test
