// SPDX-License-Identifier: BSD-3-Clause
// Errors of a store by kind, as programs act on them.
#include <gmock/gmock.h>

#include <fstream>
#include <optional>

#include "slamdb/formats/sqlite/detail/database.h"
#include "tests/formats/store/atlases.h"
#include "tests/support/kind_of.h"

namespace slamdb::store_test {
namespace {

class StoreErrors : public ::testing::Test {
 protected:
  StoreErrors() { SaveIn(path_, SoundAtlas()); }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
};

TEST_F(StoreErrors, NotFound) {
  EXPECT_EQ(KindOf([&] { Store::Open(folder_ / "none.db"); }), ErrorKind::kNotFound);
  EXPECT_EQ(KindOf([&] { Store::OpenForWriting(folder_ / "no/folder/s.db"); }), ErrorKind::kNotFound);
  EXPECT_EQ(KindOf([&] { LoadFrom(path_, "other"); }), ErrorKind::kNotFound);
  EXPECT_EQ(KindOf([&] { Store::OpenForWriting(path_).Remove("other"); }), ErrorKind::kNotFound);
  Store::OpenForWriting(path_).Remove("a");
  EXPECT_EQ(KindOf([&] { Store::Open(path_).OnlyName(); }), ErrorKind::kNotFound);
}

TEST_F(StoreErrors, AlreadyExists) {
  EXPECT_EQ(KindOf([&] {
              std::ofstream(folder_ / "target.db") << "taken";
              Store::Open(path_).Backup(folder_ / "target.db");
            }),
            ErrorKind::kAlreadyExists);
}

TEST_F(StoreErrors, Permission) {
  sqlite::Database database(path_, sqlite::Access::kRead, 1);
  EXPECT_EQ(KindOf([&] { database.Execute("DELETE FROM atlas"); }), ErrorKind::kPermission);
}

TEST_F(StoreErrors, Damaged) {
  Sql(path_, "UPDATE map_point SET x = x + 1 WHERE id = 3");
  EXPECT_EQ(KindOf([&] { LoadFrom(path_); }), ErrorKind::kDamaged);
  Sql(path_, "UPDATE keyframe SET details = zeroblob(400)");
  EXPECT_EQ(KindOf([&] { LoadFrom(path_); }), ErrorKind::kDamaged);
  Sql(path_, "PRAGMA user_version = 0");
  EXPECT_EQ(KindOf([&] { LoadFrom(path_); }), ErrorKind::kDamaged);
  std::ofstream(folder_ / "text.db") << std::string(300, 'x');
  EXPECT_EQ(KindOf([&] { Store::Open(folder_ / "text.db"); }), ErrorKind::kDamaged);
}

TEST_F(StoreErrors, DamagedPage) {
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) / 2);
  EXPECT_EQ(KindOf([&] { LoadFrom(path_); }), ErrorKind::kDamaged);
}

TEST_F(StoreErrors, Unsupported) {
  Sql(folder_ / "other.db", "CREATE TABLE recipes (title)");
  EXPECT_EQ(KindOf([&] { Store::Open(folder_ / "other.db"); }), ErrorKind::kUnsupported);
  Sql(path_, "PRAGMA user_version = 1000");
  EXPECT_EQ(KindOf([&] { Store::Open(path_); }), ErrorKind::kUnsupported);
  Sql(path_, "PRAGMA user_version = 1");
  EXPECT_EQ(KindOf([&] { Store::Open(path_); }), ErrorKind::kUnsupported);
}

TEST_F(StoreErrors, Locked) {
  Store second = Store::OpenForWriting(path_, {.sync = false, .lock_timeout = 0.01});
  std::optional<ErrorKind> kind;
  SaveOptions options;
  options.progress = [&](std::string_view, double) { kind = KindOf([&] { second.Save("b", Atlas()); }); };
  Store::OpenForWriting(path_, {.sync = false}).Save("c", SoundAtlas(), options);
  EXPECT_EQ(kind, ErrorKind::kLocked);
}

TEST_F(StoreErrors, OutOfResources) {
  sqlite::Database database(path_, sqlite::Access::kWrite, 1);
  database.Execute("PRAGMA max_page_count = 1");
  EXPECT_EQ(KindOf([&] { database.Execute("CREATE TABLE large AS SELECT zeroblob(1000000)"); }),
            ErrorKind::kOutOfResources);
}

// SQLite says that the disk is full when the number of a page is beyond all bounds.
TEST_F(StoreErrors, DamageIsNotCalledAFullDisk) {
  constexpr std::size_t kPageBytes = 8192, kLastChildAt = 8;
  constexpr char kInteriorPage = 5;
  std::string bytes = FileBytes(path_);
  for (std::size_t page = kPageBytes; page < bytes.size(); page += kPageBytes)
    if (bytes[page] == kInteriorPage) bytes.replace(page + kLastChildAt, 4, 4, '\xff');
  std::ofstream(path_, std::ios::binary) << bytes;
  const auto expect_damaged = [](const auto& work) {
    EXPECT_EQ(KindOf(work), ErrorKind::kDamaged);
    EXPECT_THAT(ErrorOf(work), ::testing::HasSubstr("the database file is damaged"));
  };
  expect_damaged([&] { Store::OpenForWriting(path_).Vacuum(); });
  expect_damaged([&] { Store::Open(path_).Stats(); });
}

TEST_F(StoreErrors, Usage) {
  EXPECT_EQ(KindOf([] { Store::Open("-"); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { Store::Open(folder_.path()); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { Store::Open(path_).Save("a", Atlas()); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { Store::OpenForWriting(path_).Save("", Atlas()); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { Store::Open(path_).Backup(path_, true); }), ErrorKind::kUsage);
  SaveIn(path_, Atlas(), "b");
  EXPECT_EQ(KindOf([&] { Store::Open(path_).OnlyName(); }), ErrorKind::kUsage);
}

TEST_F(StoreErrors, NotPossible) {
  Atlas atlas = SoundAtlas();
  atlas.maps[0].points[0].found_count = 1;
  SaveIn(path_, atlas);
  EXPECT_EQ(KindOf([&] { MigrateBackTo(path_, 2); }), ErrorKind::kNotPossible);
}

// What a user reads does not name the command line.
TEST_F(StoreErrors, SpeakOfTheLibrary) {
  std::ofstream(folder_ / "target.db") << "taken";
  EXPECT_EQ(ErrorOf([&] { Store::Open(path_).Backup(folder_ / "target.db"); }),
            folder_ / "target.db" + ": exists already; `overwrite` of Store::Backup replaces it");
  Sql(path_, "PRAGMA user_version = 1");
  EXPECT_EQ(ErrorOf([&] { Store::Open(path_); }), path_ + ": store version 1, this program needs 7: migrate it first");
}

}  // namespace
}  // namespace slamdb::store_test
