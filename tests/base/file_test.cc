// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "slamdb/base/error.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

// A folder of its own for each test.
class Files : public ::testing::Test {
 protected:
  Files() {
    std::string name = (fs::temp_directory_path() / "slamdb_file_XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~Files() override { fs::remove_all(folder_); }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  std::string Put(const std::string& name, const std::string& text) const {
    std::ofstream(Path(name), std::ios::binary) << text;
    return Path(name);
  }

  static std::string Get(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::size_t CountFiles() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

template <class Work>
std::string MessageOf(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

std::string TextOf(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

TEST_F(Files, MapsAFileForReading) {
  const MappedFile file(Put("a", std::string("text\0text", 9)));
  EXPECT_EQ(TextOf(file.bytes()), std::string("text\0text", 9));
  EXPECT_EQ(file.path(), Path("a"));
}

TEST_F(Files, MapsAnEmptyFile) { EXPECT_TRUE(MappedFile(Put("empty", "")).bytes().empty()); }

TEST_F(Files, MovesAMapping) {
  MappedFile first(Put("a", "one"));
  MappedFile second(Put("b", "two"));
  second = std::move(first);
  const MappedFile third(std::move(second));
  EXPECT_EQ(TextOf(third.bytes()), "one");
}

TEST_F(Files, SaysWhatCannotBeMapped) {
  EXPECT_THAT(MessageOf([&] { MappedFile(Path("missing")); }), HasSubstr("missing: cannot open: No such file"));
  EXPECT_THAT(MessageOf([&] { MappedFile(folder_.string()); }), HasSubstr("is a directory"));
  EXPECT_THAT(MessageOf([] { MappedFile("/dev/null"); }), HasSubstr("is not a regular file"));
}

TEST_F(Files, AppearWholeWhenCommitted) {
  AtomicFile file(Path("new"));
  file.Write("one ");
  file.Write("two");
  EXPECT_EQ(file.size(), 7U);
  EXPECT_FALSE(fs::exists(Path("new")));
  file.Commit();
  EXPECT_EQ(Get(Path("new")), "one two");
  EXPECT_EQ(CountFiles(), 1U);
}

TEST_F(Files, DoNotAppearWithoutCommit) {
  { AtomicFile(Path("new")).Write("half"); }
  EXPECT_EQ(CountFiles(), 0U);
}

TEST_F(Files, AreNotOverwrittenUnasked) {
  const std::string path = Put("old", "precious");
  EXPECT_THAT(MessageOf([&] { AtomicFile file(path); }), HasSubstr("WriteOptions::overwrite replaces it"));
  EXPECT_EQ(Get(path), "precious");
  {
    AtomicFile file(path, {.overwrite = true});
    file.Write("never finished");
  }
  EXPECT_EQ(Get(path), "precious");
  AtomicFile file(path, {.overwrite = true, .sync = false});
  file.Write("replaced");
  file.Commit();
  EXPECT_EQ(Get(path), "replaced");
  EXPECT_EQ(CountFiles(), 1U);
}

TEST_F(Files, KeepTheirModeAndTheirLinkWhenReplaced) {
  const std::string path = Put("old", "one");
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink(path, Path("link"));
  AtomicFile file(Path("link"), {.overwrite = true});
  file.Write("two");
  file.Commit();
  EXPECT_TRUE(fs::is_symlink(Path("link")));
  EXPECT_EQ(Get(path), "two");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(Files, FollowTheUmaskWhenNew) {
  const mode_t before = ::umask(027);
  AtomicFile file(Path("new"));
  file.Commit();
  ::umask(before);
  EXPECT_EQ(fs::status(Path("new")).permissions(), static_cast<fs::perms>(0640));
}

TEST_F(Files, SayWhyTheyCannotBeWritten) {
  EXPECT_THAT(MessageOf([&] { AtomicFile file(folder_.string()); }), HasSubstr("is a directory"));
  EXPECT_THAT(MessageOf([&] { AtomicFile file(Path("missing/new")); }), HasSubstr("cannot create a temporary file in"));
}

TEST_F(Files, AreProbedByTheirFirstBytes) {
  const Probe small = Probe::Of(Put("small", "abc"));
  EXPECT_EQ(small.head, "abc");
  EXPECT_EQ(small.size, 3U);
  EXPECT_FALSE(small.is_directory);
  const Probe large = Probe::Of(Put("large", std::string(10000, 'x')));
  EXPECT_EQ(large.head, std::string(4096, 'x'));
  EXPECT_EQ(large.size, 10000U);
  EXPECT_TRUE(Probe::Of(folder_.string()).is_directory);
  EXPECT_TRUE(Probe::Of("-").head.empty());
  EXPECT_THAT(MessageOf([&] { Probe::Of(Path("missing")); }), HasSubstr("cannot open"));
}

}  // namespace
}  // namespace slamdb
