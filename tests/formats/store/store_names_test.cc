// SPDX-License-Identifier: BSD-3-Clause
// Stores whose file has a second name, beside which SQLite would keep a log of its own.
#include <gmock/gmock.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/formats/store/atlases.h"
#include "tests/support/kind_of.h"

namespace slamdb::store_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class StoreNames : public ::testing::Test {
 protected:
  StoreNames() { SaveIn(path_, SoundAtlas()); }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db", second_ = folder_ / "second.db";
};

TEST_F(StoreNames, WithTwoOfThemNothingIsSaved) {
  std::filesystem::create_hard_link(path_, second_);
  for (const std::string& path : {path_, second_})
    EXPECT_THAT(ErrorOf([&] { Store::OpenForWriting(path); }), HasSubstr("has 2 names (hard links)"));
  SaveIn(folder_ / "other.db", OddAtlas());
  EXPECT_EQ(KindOf([&] { Store::Open(folder_ / "other.db").Backup(second_, true); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { MigrateStore(second_, {.back = true}); }), ErrorKind::kUsage);
  EXPECT_THAT(LoadFrom(second_), EqualsAtlas(SoundAtlas()));
  std::filesystem::remove(path_);
  SaveIn(second_, OddAtlas(), "b");
  EXPECT_THAT(Store::Open(second_).Names(), ElementsAre("a", "b"));
}

TEST_F(StoreNames, SymbolicLinksAreNoNames) {
  std::filesystem::create_symlink("s.db", second_);
  SaveIn(second_, OddAtlas(), "b");
  EXPECT_THAT(Store::Open(path_).Names(), ElementsAre("a", "b"));
}

// The store was given its second name while somebody wrote to it.
TEST_F(StoreNames, ALogBesideTheOtherOneIsNotOverlooked) {
  Store writer = Store::OpenForWriting(path_, {.sync = false});
  writer.Save("b", OddAtlas());
  std::filesystem::create_hard_link(path_, second_);
  EXPECT_THAT(ErrorOf([&] { Store::Open(second_); }), HasSubstr("read it by that name"));
  EXPECT_THAT(Store::Open(path_).Names(), ElementsAre("a", "b"));
}

void WriteThroughAMount(const std::string& folder) {
  const std::string mounted = folder + "/mounted.db";
  if (::unshare(CLONE_NEWNS) != 0 || ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      ::mount((folder + "/s.db").c_str(), mounted.c_str(), nullptr, MS_BIND, nullptr) != 0)
    ::_exit(2);
  const std::string error = ErrorOf([&] { SaveIn(mounted, OddAtlas(), "b"); });
  const bool is_readable = ErrorOf([&] { LoadFrom(mounted); }).empty();
  ::_exit(error.find("mount its folder") != std::string::npos && is_readable ? 0 : 1);
}

TEST_F(StoreNames, AFileThatIsMountedByItselfIsNotWritten) {
  folder_.Make("mounted.db", "");
  const int status = InChild(&WriteThroughAMount, folder_.path().string());
  if (WEXITSTATUS(status) == 2) GTEST_SKIP() << "may not mount";
  EXPECT_EQ(status, 0);
  EXPECT_THAT(folder_.Names(), ElementsAre("mounted.db", "s.db"));
}

}  // namespace
}  // namespace slamdb::store_test
