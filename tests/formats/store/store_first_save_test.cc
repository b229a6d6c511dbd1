// SPDX-License-Identifier: BSD-3-Clause
// The first save of a store writes no log, and leaves one for those that follow.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>

#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::uintmax_t SizeOf(const std::string& path) {
  return std::filesystem::exists(path) ? std::filesystem::file_size(path) : 0;
}

class StoreFirstSave : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
};

TEST_F(StoreFirstSave, GoesToTheFile) {
  Store store = Store::OpenForWriting(path_, {.sync = false});
  store.Save("a", SoundAtlas());
  EXPECT_LT(SizeOf(path_ + "-wal"), SizeOf(path_) / 8);
  EXPECT_FALSE(std::filesystem::exists(path_ + "-journal"));
  EXPECT_EQ(Sql(path_, "PRAGMA journal_mode"), "wal");
  EXPECT_THAT(LoadFrom(path_, "a"), EqualsAtlas(SoundAtlas()));
  store.Save("b", SoundAtlas());
  EXPECT_GT(SizeOf(path_ + "-wal"), SizeOf(path_) / 8);
}

TEST_F(StoreFirstSave, GoesToTheLogWhereAnotherHasTheStoreOpen) {
  Store store = Store::OpenForWriting(path_, {.sync = false});
  Store other = Store::OpenForWriting(path_, {.sync = false});
  store.Save("a", SoundAtlas());
  EXPECT_GT(SizeOf(path_ + "-wal"), SizeOf(path_));
  EXPECT_THAT(other.Names(), ElementsAre("a"));
}

TEST_F(StoreFirstSave, ReadersSeeWhatWasBefore) {
  SaveOptions options;
  options.before_commit = [&] { EXPECT_THAT(Store::Open(path_, 0).Names(), IsEmpty()); };
  Store store = Store::OpenForWriting(path_, {.sync = false});
  store.Save("a", SoundAtlas(), options);
  EXPECT_THAT(Store::Open(path_, 0).Names(), ElementsAre("a"));
}

void SaveAndDieBeforeTheEnd(const std::string& path) {
  SaveOptions options;
  options.before_commit = [] { ::_exit(0); };
  Store::OpenForWriting(path, {.sync = false}).Save("a", SoundAtlas(), options);
}

TEST_F(StoreFirstSave, ThatIsKilledLeavesAnEmptyStore) {
  ASSERT_EQ(InChild(&SaveAndDieBeforeTheEnd, path_), 0);
  EXPECT_THAT(Store::Open(path_).Names(), IsEmpty());
  SaveIn(path_, SoundAtlas(), "b");
  EXPECT_THAT(LoadFrom(path_, "b"), EqualsAtlas(SoundAtlas()));
  EXPECT_EQ(Sql(path_, "PRAGMA integrity_check"), "ok");
  EXPECT_THAT(folder_.Names(), ElementsAre("s.db"));
}

}  // namespace
}  // namespace slamdb::store_test
