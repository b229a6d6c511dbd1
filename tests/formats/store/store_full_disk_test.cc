// SPDX-License-Identifier: BSD-3-Clause
// A server whose disk is full, of its data or of its write-ahead log: what is stored stays, and the error says so.
#include <gmock/gmock.h>
#include <sys/mount.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/store/atlases.h"
#include "tests/formats/store/server_sql.h"
#include "tests/support/postgresql_server.h"
#include "tests/support/server_process.h"

namespace slamdb::store_test {
namespace {

namespace fs = std::filesystem;
using detail::Concat;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

// A disk of the server's that holds a few megabytes, in memory. To mount one takes root.
class SmallDisk {
 public:
  explicit SmallDisk(int megabytes) : folder_(MakeServerFolder()) {
    is_mounted_ = ::mount("tmpfs", folder_.c_str(), "tmpfs", 0, Concat("size=", megabytes, "m").c_str()) == 0;
    GiveToServer(folder_);
  }
  ~SmallDisk() {
    if (is_mounted_) ::umount2(folder_.c_str(), MNT_DETACH);
    std::error_code ignored;
    fs::remove(folder_, ignored);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool is_mounted() const { return is_mounted_; }
  const fs::path& folder() const { return folder_; }
  // Somebody fills it, but for some bytes.
  void Fill(std::uintmax_t left) const {
    const std::uintmax_t free = fs::space(folder_).available;
    std::ofstream(folder_ / "filler") << std::string(free > left ? free - left : 0, 'x');
  }
  void MakeRoom() const { fs::remove(folder_ / "filler"); }

 private:
  fs::path folder_;
  bool is_mounted_;
};

// Some 5 MB on a server.
Atlas LargeAtlas(std::uint64_t seed) {
  return SynthesizeAtlas({.keyframes = 40, .points = 2000, .features = 1000, .seed = seed});
}

class StoreFullDisk : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
    if (!disk_.is_mounted()) GTEST_SKIP() << "this user may not mount a small disk";
    server_ = std::make_unique<PostgresqlServer>("max_wal_size = 1GB\nmin_wal_size = 32MB");
  }

  SmallDisk disk_{64};
  std::unique_ptr<PostgresqlServer> server_;  // ends before its disk
  const Atlas first_ = SoundAtlas(), second_ = LargeAtlas(1);
};

TEST_F(StoreFullDisk, ASaveThatDoesNotFitLeavesTheRevisionBefore) {
  SqlOn(server_->Uri("postgres"), Concat("CREATE TABLESPACE small LOCATION '", disk_.folder().string(), "'"));
  ASSERT_EQ(SqlOn(server_->Uri("postgres"), "CREATE DATABASE maps TABLESPACE small"), "");
  const std::string uri = server_->Uri("maps");
  Store::OpenForWriting(uri).Save("a", first_);
  for (const std::uintmax_t left : {0, 300'000, 2'000'000}) {
    disk_.Fill(left);
    const std::string error = ErrorOf([&] { Store::OpenForWriting(uri).Save("a", second_); });
    EXPECT_THAT(error, HasSubstr("the server's disk is full"));
    EXPECT_THAT(error, HasSubstr("what is stored is as it was before this change: try again when there is room"));
    EXPECT_EQ(FirstDifference(Store::Open(uri).Load("a"), first_), "");
    EXPECT_EQ(Store::Open(uri).FindRevision("a").number, 1U);
    disk_.MakeRoom();
  }
  EXPECT_EQ(Store::OpenForWriting(uri).Save("a", second_).revision, 2U);
  EXPECT_EQ(FirstDifference(Store::Open(uri).Load("a"), second_), "");
  EXPECT_EQ(FirstDifference(Store::Open(uri).Load("a@1"), first_), "");
}

// PostgreSQL ends all its processes then, and recovers as soon as there is room.
TEST_F(StoreFullDisk, OfTheWriteAheadLogLikewise) {
  const std::string uri = server_->Uri(server_->MakeDatabase());
  Store::OpenForWriting(uri).Save("a", first_);
  server_->Stop();
  const fs::path log = fs::path(server_->folder()) / "data/pg_wal";
  fs::copy(log, disk_.folder() / "pg_wal", fs::copy_options::recursive);
  for (const auto& entry : fs::recursive_directory_iterator(disk_.folder())) GiveToServer(entry);
  fs::remove_all(log);
  fs::create_symlink(disk_.folder() / "pg_wal", log);
  server_->Start();
  disk_.Fill(0);
  std::string error;
  std::uint64_t saved = 1;
  for (std::uint64_t seed = 1; error.empty() && seed < 20; ++seed) {
    error = ErrorOf([&] { Store::OpenForWriting(uri).Save("a", LargeAtlas(seed)); });
    if (error.empty()) saved = seed + 1;
  }
  EXPECT_THAT(error, HasSubstr("try again")) << "a save was to fill it";
  disk_.MakeRoom();
  server_->Restart();
  EXPECT_EQ(Store::Open(uri).FindRevision("a").number, saved);
  EXPECT_EQ(FirstDifference(Store::Open(uri).Load("a"), saved == 1 ? first_ : LargeAtlas(saved - 1)), "");
  EXPECT_EQ(FirstDifference(Store::Open(uri).Load("a@1"), first_), "");
  EXPECT_EQ(Store::OpenForWriting(uri).Save("a", second_, {.verify = true}).revision, saved + (saved == 2 ? 0 : 1));
  EXPECT_EQ(FirstDifference(Store::Open(uri).Load("a"), second_), "");
}

}  // namespace
}  // namespace slamdb::store_test
