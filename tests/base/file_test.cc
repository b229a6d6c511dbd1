// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/error.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class Files : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return folder_.Path(name); }
  std::string Put(const std::string& name, const std::string& text) const { return folder_.Make(name, text); }
  std::size_t CountFiles() const { return folder_.Names().size(); }

  const TemporaryFolder folder_;
};

template <class Work>
std::string MessageOf(Work work) {
  return ErrorOf(work).what();
}

std::string TextOf(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

TEST_F(Files, ReadsAWholeFile) {
  const WholeFile file(Put("a", std::string("text\0text", 9)));
  EXPECT_EQ(TextOf(file.bytes()), std::string("text\0text", 9));
  EXPECT_EQ(file.path(), Path("a"));
}

TEST_F(Files, ReadsAnEmptyFile) { EXPECT_TRUE(WholeFile(Put("empty", "")).bytes().empty()); }

TEST_F(Files, TakesMemoryWithoutCopyingIt) {
  const std::string text = "in memory";
  WholeFile file(Source(std::as_bytes(std::span(text)), "name"));
  EXPECT_EQ(file.text().data(), text.data());
  EXPECT_EQ(file.text(), text);
  EXPECT_EQ(file.path(), "name");
  file = WholeFile(Put("a", "of a file"));
  EXPECT_EQ(file.text(), "of a file");
}

TEST_F(Files, MovesWhatWasRead) {
  WholeFile first(Put("a", "one"));
  WholeFile second(Put("b", "two"));
  second = std::move(first);
  const WholeFile third(std::move(second));
  EXPECT_EQ(TextOf(third.bytes()), "one");
}

TEST_F(Files, SaysWhatCannotBeRead) {
  const Error missing = ErrorOf([&] { WholeFile(Path("missing")); });
  EXPECT_THAT(missing.what(), HasSubstr("missing: cannot open: No such file"));
  EXPECT_EQ(missing.kind(), ErrorKind::kNotFound);
  const Error folder = ErrorOf([&] { WholeFile(folder_.path().string()); });
  EXPECT_THAT(folder.what(), HasSubstr("is a directory"));
  EXPECT_EQ(folder.kind(), ErrorKind::kUsage);
}

TEST_F(Files, AppearWholeWhenCommitted) {
  AtomicFile file(Path("new"));
  file.Write("one ");
  file.Write("two");
  EXPECT_EQ(file.size(), 7U);
  EXPECT_FALSE(fs::exists(Path("new")));
  file.Commit();
  EXPECT_EQ(ReadFile(Path("new")), "one two");
  EXPECT_EQ(CountFiles(), 1U);
}

TEST_F(Files, DoNotAppearWithoutCommit) {
  { AtomicFile(Path("new")).Write("half"); }
  EXPECT_EQ(CountFiles(), 0U);
}

TEST_F(Files, AreNotOverwrittenUnasked) {
  const std::string path = Put("old", "precious");
  const Error refusal = ErrorOf([&] { AtomicFile file(path); });
  EXPECT_THAT(refusal.what(), HasSubstr("is there already; WriteOptions::overwrite replaces it"));
  EXPECT_EQ(refusal.kind(), ErrorKind::kAlreadyExists);
  EXPECT_EQ(ReadFile(path), "precious");
  {
    AtomicFile file(path, {.overwrite = true});
    file.Write("never finished");
  }
  EXPECT_EQ(ReadFile(path), "precious");
  AtomicFile file(path, {.overwrite = true, .sync = false});
  file.Write("replaced");
  file.Commit();
  EXPECT_EQ(ReadFile(path), "replaced");
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
  EXPECT_EQ(ReadFile(path), "two");
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
  EXPECT_THAT(MessageOf([&] { AtomicFile file(folder_.path().string()); }), HasSubstr("is a directory"));
  const Error missing = ErrorOf([&] { AtomicFile file(Path("missing/new")); });
  EXPECT_THAT(missing.what(), HasSubstr("cannot create a temporary file in"));
  EXPECT_EQ(missing.kind(), ErrorKind::kNotFound);
}

TEST_F(Files, GoToASinkPieceByPiece) {
  std::vector<std::string> pieces;
  AtomicFile file(Target([&](Bytes bytes) { pieces.push_back(TextOf(bytes)); }, "sink"));
  file.Write("one ");
  file.Write("two");
  file.Commit();
  EXPECT_EQ(file.size(), 7U);
  EXPECT_THAT(pieces, ::testing::ElementsAre("one ", "two"));
}

TEST_F(Files, AreProbedByTheirFirstBytes) {
  const Probe small = Probe::Of(Put("small", "abc"));
  EXPECT_EQ(small.head, "abc");
  EXPECT_EQ(small.size, 3U);
  EXPECT_FALSE(small.is_directory);
  const Probe large = Probe::Of(Put("large", std::string(100000, 'x')));
  EXPECT_EQ(large.head, std::string(65536, 'x'));
  EXPECT_EQ(large.size, 100000U);
  EXPECT_TRUE(Probe::Of(folder_.path().string()).is_directory);
  EXPECT_TRUE(Probe::Of("-").head.empty());
  const std::string text(70000, 'y');
  const Probe memory = Probe::Of({std::as_bytes(std::span(text)), "name"});
  EXPECT_EQ(memory.path, "name");
  EXPECT_EQ(memory.head, std::string(65536, 'y'));
  EXPECT_EQ(memory.size, 70000U);
  EXPECT_THAT(MessageOf([&] { Probe::Of(Path("missing")); }), HasSubstr("cannot open"));
}

}  // namespace
}  // namespace slamdb
