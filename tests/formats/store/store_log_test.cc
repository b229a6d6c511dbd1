// SPDX-License-Identifier: BSD-3-Clause
// What a killed writer left in the log is part of the store, for every way of reading it, wherever the store lies.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <set>

#include "slamdb/base/file.h"
#include "slamdb/formats/sqlite/detail/image.h"
#include "slamdb/formats/sqlite/detail/salvage.h"
#include "slamdb/formats/store/detail/store_format.h"
#include "tests/formats/store/atlases.h"
#include "tests/support/kind_of.h"

namespace slamdb::store_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Saves, and ends before anything goes from the log to the file. There is one because another has the store open.
void SaveAndDie(const std::string& path) {
  Store store = Store::OpenForWriting(path, {.sync = false});
  const Store other = Store::OpenForWriting(path, {.sync = false});
  store.Save("lab", SoundAtlas());
  ::_exit(7);
}

int AsNobody(const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (::geteuid() == 0 && (::setegid(65534) != 0 || ::seteuid(65534) != 0)) ::_exit(2);
    const std::string error = ErrorOf(work);
    if (!error.empty()) static_cast<void>(::write(STDERR_FILENO, error.data(), error.size()));
    ::_exit(error.empty() ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WEXITSTATUS(status);
}

class StoreLog : public ::testing::Test {
 protected:
  // A store whose first save is in the log alone.
  StoreLog() { EXPECT_EQ(WEXITSTATUS(InChild(&SaveAndDie, path_)), 7); }

  void ExpectWhole(const std::string& path) const {
    EXPECT_THAT(LoadFrom(path, "lab"), EqualsAtlas(SoundAtlas()));
    const Salvage salvage = detail::SalvageStore(path, "", {});
    EXPECT_THAT(salvage.damage, IsEmpty());
    EXPECT_THAT(salvage.atlas, EqualsAtlas(SoundAtlas()));
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
};

TEST_F(StoreLog, AFirstSaveIsRecognised) {
  ASSERT_LT(std::filesystem::file_size(path_), std::filesystem::file_size(path_ + "-wal"));
  EXPECT_TRUE(detail::kStoreFormat.sniff(Probe::Of(path_)));
  ExpectWhole(path_);
  EXPECT_EQ(Store::Open(path_).Names(), std::vector<std::string>{"lab"});
}

TEST_F(StoreLog, AFileWithoutItsLogIsNoStore) {
  std::filesystem::remove(path_ + "-wal");
  EXPECT_FALSE(detail::kStoreFormat.sniff(Probe::Of(path_)));
  EXPECT_THAT(ErrorOf([&] { Store::Open(path_); }), HasSubstr("an empty database"));
}

// Up to the last commit that is whole, as SQLite itself reads it.
TEST_F(StoreLog, ATornLogEndsWhereItIsForSqlite) {
  const std::string log = FileBytes(path_ + "-wal"), copy = folder_ / "copy.db";
  const std::string count = "SELECT count(*) FROM sqlite_schema";
  std::set<std::string> counts;
  for (const double share : {1.0, 0.99, 0.5, 0.1, 0.01}) {
    std::filesystem::copy_file(path_, copy, std::filesystem::copy_options::overwrite_existing);
    std::string torn = log.substr(0, static_cast<std::size_t>(share * static_cast<double>(log.size())));
    folder_.Make("copy.db-wal", torn);
    const auto seen = sqlite::Database(copy, sqlite::Access::kSalvage, 0).Integer(count);
    const std::string expected = Sql(copy, count);
    EXPECT_EQ(std::to_string(seen), expected) << share;
    counts.insert(expected);
  }
  EXPECT_GT(counts.size(), 1U);
}

TEST_F(StoreLog, IsReadInAFolderThatCannotBeWritten) {
  std::filesystem::remove(path_ + "-shm");
  ::chmod(path_.c_str(), 0444);
  ::chmod((path_ + "-wal").c_str(), 0444);
  ::chmod(folder_.path().c_str(), 0555);
  EXPECT_EQ(AsNobody([&] { ExpectWhole(path_); }), 0);
  ::chmod(folder_.path().c_str(), 0755);
  EXPECT_THAT(folder_.Names(), ElementsAre("s.db", "s.db-wal"));
}

// SQLite would make an index of the log, and leave it.
TEST_F(StoreLog, ReadingLeavesNoIndexOfALogThatHadNone) {
  std::filesystem::remove(path_ + "-shm");
  const std::string log = FileBytes(path_ + "-wal");
  ExpectWhole(path_);
  EXPECT_EQ(Store::Open(path_).Names(), std::vector<std::string>{"lab"});
  EXPECT_THAT(folder_.Names(), ElementsAre("s.db", "s.db-wal"));
  EXPECT_TRUE(FileBytes(path_ + "-wal") == log);
}

// SQLite would lay an index beside the store with the rights of the store, which then keeps writers out.
TEST_F(StoreLog, ReadingLeavesNothingBesideAFileThatCannotBeWritten) {
  Store::OpenForWriting(path_, {.sync = false}).Remove("lab");
  SaveIn(path_, SoundAtlas(), "lab");
  ASSERT_THAT(folder_.Names(), ElementsAre("s.db"));
  ::chmod(folder_.path().c_str(), 0777);
  ::chmod(path_.c_str(), 0444);
  EXPECT_EQ(AsNobody([&] { ExpectWhole(path_); }), 0);
  EXPECT_THAT(folder_.Names(), ElementsAre("s.db"));
  ::chmod(path_.c_str(), 0666);
  EXPECT_EQ(AsNobody([&] { SaveIn(path_, Atlas(), "more"); }), 0);
}

TEST_F(StoreLog, SalvagingACutStoreMakesNoFiles) {
  { Store::OpenForWriting(path_, {.sync = false}).Vacuum(); }
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) * 3 / 4);
  ::chmod(path_.c_str(), 0444);
  ::chmod(folder_.path().c_str(), 0555);
  EXPECT_EQ(AsNobody([&] {
              if (detail::SalvageStore(path_, "lab", {}).damage.empty()) throw Error(ErrorKind::kInternal, "whole");
            }),
            0);
  ::chmod(folder_.path().c_str(), 0755);
  EXPECT_THAT(folder_.Names(), ElementsAre("s.db"));
}

TEST_F(StoreLog, AnImageSaysWhenItIsChanged) {
  sqlite::Database image(path_, sqlite::Access::kSalvage, 0);
  const sqlite::Image state(path_, sqlite::Missing::kIsZeros);
  EXPECT_FALSE(state.changed());
  SaveIn(path_, OddAtlas(), "more");  // and goes to the file at its end
  EXPECT_TRUE(state.changed());
  EXPECT_EQ(KindOf([&] { image.Integer("SELECT sum(x) FROM map_point"); }), ErrorKind::kLocked);
}

}  // namespace
}  // namespace slamdb::store_test
