// SPDX-License-Identifier: BSD-3-Clause
// What AtomicFile does when the system refuses a call: every refusal is told, and what was there stays.
#include <gmock/gmock.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/file_calls.h"
#include "slamdb/base/error.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Which of the calls that are replaced fails next, and how.
int calls_until_failure = 0;
int failure = 0;

bool Fails() {
  if (--calls_until_failure != 0) return false;
  errno = failure;
  return true;
}

class FileFailure : public ::testing::Test {
 protected:
  FileFailure() : path_(folder_.Make("a", "old")), kept_(detail::CallsOfFiles()) {}
  ~FileFailure() override { detail::CallsOfFiles() = kept_; }

  detail::FileCalls& calls() { return detail::CallsOfFiles(); }

  // Writes over the file; the `nth` of the replaced calls fails with `code`. What that throws.
  Error Overwrite(int nth, int code, bool sync = true) {
    calls_until_failure = nth;
    failure = code;
    try {
      AtomicFile file(path_, {.overwrite = true, .sync = sync});
      file.Write("new");
      file.Commit();
    } catch (const Error& error) {
      return error;
    }
    return {ErrorKind::kInternal, "written"};
  }
  void ExpectUntouched() {
    EXPECT_EQ(ReadFile(path_), "old");
    EXPECT_THAT(folder_.Names(), ElementsAre("a"));
  }

  const TemporaryFolder folder_;
  const std::string path_;
  const detail::FileCalls kept_;
};

TEST_F(FileFailure, OfWriting) {
  calls().write = [](int file, const void* bytes, std::size_t size) -> ssize_t {
    return Fails() ? -1 : ::write(file, bytes, size);
  };
  const Error error = Overwrite(1, ENOSPC);
  EXPECT_EQ(error.kind(), ErrorKind::kOutOfResources);
  EXPECT_EQ(error.path(), path_);
  EXPECT_THAT(error.what(), HasSubstr("cannot write: No space left"));
  ExpectUntouched();
}

TEST_F(FileFailure, OfWritingIsNoneWhenItWasOnlyInterrupted) {
  calls().write = [](int file, const void* bytes, std::size_t size) -> ssize_t {
    return Fails() ? -1 : ::write(file, bytes, size < 2 ? size : 2);  // and only a part at a time
  };
  EXPECT_EQ(Overwrite(1, EINTR).problem(), "written");
  EXPECT_EQ(ReadFile(path_), "new");
}

TEST_F(FileFailure, OfSyncingTheFile) {
  calls().fsync = [](int file) { return Fails() ? -1 : ::fsync(file); };
  const Error error = Overwrite(1, EIO);
  EXPECT_THAT(error.what(), HasSubstr("cannot be synced to disk: Input/output error"));
  ExpectUntouched();
}

TEST_F(FileFailure, OfSyncingTheFolder) {
  calls().fsync = [](int file) { return Fails() ? -1 : ::fsync(file); };
  const Error error = Overwrite(2, EIO);
  EXPECT_EQ(error.path(), path_);
  EXPECT_THAT(error.what(), HasSubstr("its folder " + folder_.path().string() + " cannot be synced to disk"));
  EXPECT_THAT(error.what(), HasSubstr("Input/output error"));
  EXPECT_EQ(ReadFile(path_), "new") << "the file is in place all the same";
  EXPECT_THAT(folder_.Names(), ElementsAre("a"));
}

TEST_F(FileFailure, OfSyncingAFolderIsNoneWhereTheFileSystemHasNoWay) {
  calls().fsync = [](int file) { return Fails() ? -1 : ::fsync(file); };
  EXPECT_EQ(Overwrite(2, EINVAL).problem(), "written");
}

TEST_F(FileFailure, OfSyncingIsNoneWhenNobodyAskedForIt) {
  calls().fsync = [](int) { return -1; };
  EXPECT_EQ(Overwrite(0, 0, /*sync=*/false).problem(), "written");
  EXPECT_EQ(ReadFile(path_), "new");
}

// As networks do that write late.
TEST_F(FileFailure, OfClosing) {
  calls().close = [](int file) {
    const int closed = ::close(file);
    return Fails() ? -1 : closed;
  };
  const Error error = Overwrite(1, EDQUOT);
  EXPECT_EQ(error.kind(), ErrorKind::kOutOfResources);
  EXPECT_THAT(error.what(), HasSubstr("cannot finish the file: Disk quota exceeded"));
  ExpectUntouched();
}

TEST_F(FileFailure, OfRenaming) {
  calls().rename = [](const char* from, const char* to) { return Fails() ? -1 : std::rename(from, to); };
  const Error error = Overwrite(1, EACCES);
  EXPECT_EQ(error.kind(), ErrorKind::kPermission);
  EXPECT_THAT(error.what(), HasSubstr("cannot rename the finished file into place"));
  ExpectUntouched();
}

}  // namespace
}  // namespace slamdb
