// SPDX-License-Identifier: BSD-3-Clause
// Many processes write to and read from one store at once: every save that returned is there, and every read is whole.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <thread>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/sqlite/detail/database.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

constexpr int kWriters = 4, kReaders = 4, kSaves = 6;

pid_t Child(const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  const std::string error = ErrorOf(work);
  if (!error.empty()) static_cast<void>(::write(STDERR_FILENO, (error + "\n").data(), error.size() + 1));
  ::_exit(error.empty() ? 0 : 1);
}

TEST(StoreCrowd, AStoreThatIsBeingMadeIsWaitedFor) {
  TemporaryFolder folder;
  const std::string path = folder / "s.db";
  sqlite::Database maker(path, sqlite::Access::kCreate, 5);
  maker.UseLog();
  maker.Execute("SELECT count(*) FROM sqlite_schema");  // opens the log
  const auto moment = std::chrono::milliseconds(300);
  std::thread later([&] {
    std::this_thread::sleep_for(moment);
    Store::OpenForWriting(path, {.sync = false});
  });
  EXPECT_EQ(ErrorOf([&] { Store::Open(path, 60); }), "");
  later.join();
}

TEST(StoreCrowd, WritersAndReaders) {
  TemporaryFolder folder;
  const std::string path = folder / "s.db";
  const Atlas odd = OddAtlas(), sound = SoundAtlas();
  SaveIn(path, sound, "shared");
  std::vector<pid_t> children;
  for (int writer = 0; writer < kWriters; ++writer)
    children.push_back(Child([&] {
      for (int i = 0; i < kSaves; ++i) {
        Store store = Store::OpenForWriting(path, {.sync = false, .lock_timeout = 600});
        store.Save(detail::Concat(writer, "-", i), odd, {.overwrite = false, .threads = 1});
        store.Save("shared", i % 2 == 0 ? odd : sound, {.threads = 1});
      }
    }));
  for (int reader = 0; reader < kReaders; ++reader)
    children.push_back(Child([&] {
      while (Store::Open(path, 600).Names().size() < 1 + kWriters * kSaves) {
        const Atlas atlas = Store::Open(path, 600).Load("shared", {.threads = 2});
        if (!FirstDifference(atlas, odd).empty() && !FirstDifference(atlas, sound).empty())
          throw Error(ErrorKind::kInternal, "read a mixture");
      }
    }));
  for (const pid_t child : children) {
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
  Store store = Store::Open(path);
  EXPECT_EQ(store.Names().size(), 1U + kWriters * kSaves);
  EXPECT_EQ(store.Log().size(), 1U + 2 * kWriters * kSaves);
  for (const std::string& name : store.Names()) {
    if (name != "shared") {
      EXPECT_EQ(FirstDifference(store.Load(name), odd), "") << name;
    }
  }
  EXPECT_EQ(Sql(path, "PRAGMA integrity_check"), "ok");
}

// Whoever fails takes away the store that was made for it, and nothing from those who come to it meanwhile.
TEST(StoreCrowd, SaversThatFailHurtNobody) {
  const Atlas sound = SoundAtlas();
  for (int round = 0; round < 20; ++round) {
    TemporaryFolder folder;
    const std::string path = folder / "s.db";
    std::vector<pid_t> innocent, failing;
    for (int i = 0; i < kWriters; ++i) {
      failing.push_back(Child([&] {
        SaveOptions options;
        options.before_commit = [] { throw Error(ErrorKind::kInternal, "fails"); };
        ErrorOf(
            [&] { Store::OpenForWriting(path, {.sync = false, .lock_timeout = 600}).Save("bad", Atlas(), options); });
      }));
      innocent.push_back(Child(
          [&] { Store::OpenForWriting(path, {.sync = false, .lock_timeout = 600}).Save(detail::Concat(i), sound); }));
    }
    for (const pid_t child : failing) ::waitpid(child, nullptr, 0);
    for (const pid_t child : innocent) {
      int status = 0;
      ::waitpid(child, &status, 0);
      EXPECT_EQ(status, 0);
    }
    EXPECT_EQ(Store::Open(path).Names().size(), std::size_t{kWriters});
  }
}

}  // namespace
}  // namespace slamdb::store_test
