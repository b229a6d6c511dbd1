// SPDX-License-Identifier: BSD-3-Clause
//
// Inputs whose bytes come once, and those that are no files.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <thread>

#include "slamdb/base/detail/file_stream.h"
#include "slamdb/base/error.h"
#include "slamdb/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/needs_proc.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

class Streams : public ::testing::Test {
 protected:
  std::string Fifo() const {
    const std::string path = folder_.Path("fifo");
    ::mkfifo(path.c_str(), 0600);
    return path;
  }
  // Writes into a FIFO, as another program does.
  static std::thread Writer(const std::string& path, const std::string& content, int after_ms = 0) {
    return std::thread([=] {
      std::this_thread::sleep_for(std::chrono::milliseconds(after_ms));
      const int descriptor = ::open(path.c_str(), O_WRONLY);
      for (std::size_t at = 0; at < content.size();) {
        const ssize_t written = ::write(descriptor, content.data() + at, content.size() - at);
        if (written <= 0) break;
        at += static_cast<std::size_t>(written);
      }
      ::close(descriptor);
    });
  }

  const TemporaryFolder folder_;
};

std::string Content(std::size_t bytes) {
  std::string content(bytes, '\0');
  for (std::size_t i = 0; i < bytes; ++i) content[i] = static_cast<char>(i * 2654435761U >> 13);
  return content;
}

TEST_F(Streams, ReadAFifoToItsEnd) {
  const std::string content = Content((std::size_t{5} << 20) + 17), path = Fifo();
  std::thread writer = Writer(path, content);
  EXPECT_TRUE(WholeFile(path).text() == content);
  writer.join();
  writer = Writer(path, content, 200);
  detail::FileStream stream(path);
  EXPECT_TRUE(std::string_view(stream.data(), stream.size()) == content);
  writer.join();
}

TEST_F(Streams, AFifoWithoutAWriterIsAnError) {
  const Error error = ErrorOf([&] { WholeFile{Fifo()}; });
  EXPECT_EQ(error.kind(), ErrorKind::kNotPossible);
  EXPECT_THAT(error.what(), HasSubstr("is a FIFO that nothing writes into"));
}

TEST_F(Streams, AWriterThatSaysNothingLeavesNothing) {
  const std::string path = Fifo();
  std::thread writer = Writer(path, "");
  EXPECT_TRUE(WholeFile(path).bytes().empty());
  writer.join();
}

TEST_F(Streams, ReadDevices) {
  EXPECT_TRUE(WholeFile("/dev/null").bytes().empty());
  EXPECT_EQ(Probe::Of("/dev/null").size, 0U);
}

TEST_F(Streams, EndlessOnesEndAtTheLimit) {
  const Error error = ErrorOf([] { WholeFile("/dev/zero"); });
  EXPECT_EQ(error.kind(), ErrorKind::kOutOfResources);
  EXPECT_THAT(error.what(), HasSubstr("is a stream of more than 2 GiB, of which slamdb reads no more"));
}

TEST_F(Streams, AreRefusedByTheirBeginning) {
  std::size_t seen = 0;
  const auto refuse = [&](const Probe& probe) {
    seen = probe.head.size();
    throw Error(ErrorKind::kUnsupported, "zeros");
  };
  EXPECT_THAT(ErrorOf([&] { HeldSource(Source("/dev/zero"), refuse); }).what(), HasSubstr("zeros"));
  EXPECT_EQ(seen, std::size_t{64} << 10);
}

TEST_F(Streams, StayAtHandWhenHeld) {
  const std::string path = Fifo();
  std::thread writer = Writer(path, "content");
  const HeldSource held{Source(path)};
  writer.join();
  for (int twice = 0; twice < 2; ++twice) {
    EXPECT_EQ(Probe::Of(held.source()).head, "content");
    EXPECT_EQ(WholeFile(held.source()).text(), "content");
  }
  const std::string file = folder_.Make("file", "content");
  EXPECT_FALSE(HeldSource(Source(file)).source().memory);
}

TEST_F(Streams, SocketsAreRefusedByName) {
  const std::string path = folder_.Path("socket");
  const int descriptor = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(path.size(), sizeof address.sun_path);
  std::strcpy(address.sun_path, path.c_str());
  ASSERT_EQ(::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const Error error = ErrorOf([&] { WholeFile{path}; });
  EXPECT_EQ(error.kind(), ErrorKind::kUsage);
  EXPECT_THAT(error.what(), HasSubstr("is a socket, expected a file"));
  ::close(descriptor);
}

TEST_F(Streams, BlockDevicesAreRefusedByName) {
  const std::string path = folder_.Path("disk");
  if (::mknod(path.c_str(), S_IFBLK | 0600, makedev(7, 250)) != 0) GTEST_SKIP() << "no device can be made here";
  EXPECT_THAT(ErrorOf([&] { WholeFile{path}; }).what(), HasSubstr("is a block device, expected a file"));
}

TEST_F(Streams, AFileWithoutASizeIsReadToItsEnd) {
  SLAMDB_NEEDS_PROC();
  EXPECT_FALSE(WholeFile("/proc/self/status").bytes().empty());
}

TEST_F(Streams, AFileThatBecomesShorterIsNoCrash) {
  const std::string path = folder_.Make("file", Content(std::size_t{3} << 20));
  std::atomic<bool> done = false;
  std::thread shortener([&] {
    while (!done) {
      ::truncate(path.c_str(), 10);
      ::truncate(path.c_str(), 3 << 20);
    }
  });
  for (int i = 0; i < 200; ++i) {
    try {
      EXPECT_GE(WholeFile(path).bytes().size(), 10U);
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("the file became shorter while it was read"));
    }
  }
  done = true;
  shortener.join();
}

}  // namespace
}  // namespace slamdb
