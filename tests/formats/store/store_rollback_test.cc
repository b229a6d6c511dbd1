// SPDX-License-Identifier: BSD-3-Clause
// What a transaction that did not end has changed is taken back, from the journal beside the store.
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "slamdb/formats/sqlite/detail/image.h"
#include "slamdb/formats/sqlite/detail/salvage.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

// With so small a cache, pages go to the file long before the end.
void ChangeAndDie(const std::string& path) {
  sqlite::Database database(path, sqlite::Access::kWrite, 1);
  database.Execute(
      "PRAGMA journal_mode=DELETE; PRAGMA cache_size=2; BEGIN; DELETE FROM map_point WHERE row % 2 = 0; "
      "DELETE FROM keyframe WHERE id > 2; CREATE TABLE longer AS SELECT zeroblob(1000000)");
  ::_exit(0);
}

class StoreRollback : public ::testing::Test {
 protected:
  StoreRollback() {
    SaveIn(path_, SoundAtlas());
    bytes_ = FileBytes(path_).size();
    EXPECT_EQ(InChild(&ChangeAndDie, path_), 0);
    EXPECT_GT(FileBytes(path_).size(), bytes_);
    journal_ = FileBytes(path_ + "-journal");
  }
  void Lay(const std::string& journal) const { std::ofstream(path_ + "-journal", std::ios::binary) << journal; }
  Salvage Salvaged() const { return detail::SalvageStore(path_, "a", {}); }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db", journal_;
  std::size_t bytes_ = 0;
};

TEST_F(StoreRollback, IsDoneBySalvage) {
  const std::string file = FileBytes(path_);
  const Salvage salvage = Salvaged();
  EXPECT_THAT(salvage.damage, IsEmpty());
  EXPECT_THAT(salvage.atlas, EqualsAtlas(SoundAtlas()));
  EXPECT_EQ(sqlite::Image(path_, sqlite::Missing::kIsZeros).size(), bytes_);
  EXPECT_EQ(FileBytes(path_), file);
  EXPECT_EQ(FileBytes(path_ + "-journal"), journal_);
}

// As SQLite does it.
TEST_F(StoreRollback, IsDoneByReading) { EXPECT_THAT(LoadFrom(path_), EqualsAtlas(SoundAtlas())); }

TEST_F(StoreRollback, ADamagedJournalIsNamed) {
  std::string differs = journal_;
  const std::size_t page_bytes = 8192, first_page = 512 + 4;
  differs[first_page + page_bytes - 200] ^= 1;
  for (const std::string& bad : {differs, journal_.substr(0, 5000), journal_ + journal_.substr(0, 8)}) {
    Lay(bad);
    const Salvage salvage = Salvaged();
    ASSERT_FALSE(salvage.damage.empty());
    EXPECT_THAT(salvage.damage[0], HasSubstr("s.db-journal), which is damaged itself"));
  }
}

// Never a crash, and no page that was not checked.
TEST_F(StoreRollback, OfAnyJournal) {
  for (std::size_t at = 0; at < 28; ++at)
    for (const char value : {'\1', '\xff'}) {
      std::string bad = journal_;
      bad[at] = value;
      Lay(bad);
      ErrorOf([&] { Salvaged(); });
    }
  for (std::size_t bytes = 0; bytes < 2000; bytes += 53) {
    Lay(journal_.substr(0, bytes));
    ErrorOf([&] { Salvaged(); });
  }
}

// SQLite overwrites the header, or cuts the file, where the next transaction uses the same journal.
TEST_F(StoreRollback, AJournalThatIsDoneIsNone) {
  const std::string path = folder_ / "whole.db";
  SaveIn(path, SoundAtlas());
  Sql(path, "PRAGMA journal_mode=PERSIST; UPDATE atlas SET revision = revision + 0");
  ASSERT_GT(std::filesystem::file_size(path + "-journal"), 0U);
  const Salvage salvage = detail::SalvageStore(path, "a", {});
  EXPECT_THAT(salvage.damage, IsEmpty());
  EXPECT_THAT(salvage.atlas, EqualsAtlas(SoundAtlas()));
}

}  // namespace
}  // namespace slamdb::store_test
