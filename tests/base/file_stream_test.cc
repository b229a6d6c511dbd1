// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/file_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "slamdb/base/error.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using testing::HasSubstr;

constexpr std::size_t kBlock = std::size_t{2} << 20;

// Bytes each of which depends on its place.
std::string Content(std::size_t bytes) {
  std::string content(bytes, '\0');
  for (std::size_t i = 0; i < bytes; ++i) content[i] = static_cast<char>(i * 2654435761U >> 13);
  return content;
}

// A file of them.
class StreamFile {
 public:
  explicit StreamFile(std::size_t bytes) : content_(Content(bytes)), path_(folder_.Make("stream", content_)) {}
  const std::string& path() const { return path_; }
  const std::string& content() const { return content_; }

 private:
  const TemporaryFolder folder_;
  const std::string content_, path_;
};

TEST(FileStream, ShowsTheWholeFile) {
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{1}, kBlock - 1, kBlock, kBlock + 1, 3 * kBlock + 77}) {
    const StreamFile file(bytes);
    detail::FileStream stream(file.path());
    EXPECT_EQ(stream.size(), bytes);
    EXPECT_EQ(stream.filled(), 0U);
    stream.FillTo(bytes);
    EXPECT_EQ(stream.filled(), bytes);
    EXPECT_TRUE(std::string_view(stream.data(), stream.size()) == file.content());
  }
}

TEST(FileStream, FillsLittleMoreThanAsked) {
  const StreamFile file(5 * kBlock);
  detail::FileStream stream(file.path());
  stream.FillTo(1);
  EXPECT_GE(stream.filled(), 1U);
  EXPECT_LT(stream.filled(), kBlock / 8);
  stream.FillTo(kBlock + 1);
  EXPECT_GE(stream.filled(), kBlock + 1);
  EXPECT_LT(stream.filled(), kBlock + kBlock / 8);
  stream.FillTo(100 * kBlock);
  EXPECT_EQ(stream.filled(), 5 * kBlock);
}

// Holes of many sizes, some of whole blocks, copied with some of what is filled around them, before and after releases.
TEST(FileStream, CopiesWhatIsLeftOut) {
  const StreamFile file(9 * kBlock + 12345);
  detail::FileStream stream(file.path());
  std::size_t end = 0;
  for (const std::size_t hole : {std::size_t{1}, kBlock / 3, kBlock - 1, 2 * kBlock + 5, kBlock, 100 * kBlock}) {
    const std::size_t begin = end;
    stream.FillTo(begin + 1000);
    const std::size_t filled = std::min(stream.filled(), file.content().size());
    stream.LeaveOut(filled + hole);
    end = stream.filled();
    EXPECT_EQ(end, std::min(filled + hole, file.content().size()));
    std::string copied(end - begin, '\0');
    stream.Copy(begin, copied.size(), copied.data());
    EXPECT_TRUE(copied == file.content().substr(begin, end - begin)) << "from byte " << begin;
    EXPECT_TRUE(std::string_view(stream.data() + begin, filled - begin) ==
                std::string_view(file.content()).substr(begin, filled - begin));
    stream.Release(end);
  }
  EXPECT_EQ(end, file.content().size());
}

TEST(FileStream, CopiesOfMemoryAreOfThat) {
  const std::string content = Content(5000);
  detail::FileStream stream({std::as_bytes(std::span(content)), "name"});
  stream.LeaveOut(4000);
  std::string copied(3000, '\0');
  stream.Copy(1000, copied.size(), copied.data());
  EXPECT_EQ(copied, content.substr(1000, 3000));
}

TEST(FileStream, AHoleInAFileThatBecameShorterIsAnError) {
  const StreamFile file(4 * kBlock);
  detail::FileStream stream(file.path());
  stream.LeaveOut(3 * kBlock);
  std::filesystem::resize_file(file.path(), kBlock + 10);
  std::string copied(3 * kBlock, '\0');
  try {
    stream.Copy(0, copied.size(), copied.data());
    FAIL() << "bytes that are not there were copied";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("byte 2097162"));
    EXPECT_THAT(error.what(), HasSubstr("became shorter"));
  }
}

// Released memory is used again further on, at other addresses, and must then show what is there.
TEST(FileStream, ShowsEveryBlockWhileItMovesAlong) {
  const StreamFile file(9 * kBlock + 12345);
  detail::FileStream stream(file.path());
  for (std::size_t begin = 0; begin < stream.size(); begin += kBlock / 2) {
    const std::size_t end = std::min(stream.size(), begin + kBlock / 2);
    stream.FillTo(end);
    EXPECT_TRUE(std::string_view(stream.data() + begin, end - begin) ==
                std::string_view(file.content()).substr(begin, end - begin))
        << "from byte " << begin;
    stream.Release(end);
  }
}

TEST(FileStream, AFileThatBecomesShorterIsAnError) {
  const StreamFile file(4 * kBlock);
  detail::FileStream stream(file.path());
  stream.FillTo(1);
  std::filesystem::resize_file(file.path(), kBlock + 10);
  try {
    stream.FillTo(4 * kBlock);
    FAIL() << "bytes that are not there were read";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("became shorter"));
    EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
  }
}

TEST(FileStream, ShowsMemoryWhereItIs) {
  const std::string content = Content(3 * kBlock + 77);
  detail::FileStream stream({std::as_bytes(std::span(content)), "name"});
  EXPECT_EQ(stream.path(), "name");
  EXPECT_EQ(stream.data(), content.data());
  EXPECT_EQ(stream.size(), content.size());
  EXPECT_EQ(stream.filled(), content.size());
  stream.FillTo(kBlock);
  stream.Release(2 * kBlock);
  EXPECT_TRUE(std::string_view(stream.data(), stream.size()) == Content(3 * kBlock + 77));
}

TEST(FileStream, RefusesWhatIsNeitherFileNorStream) {
  EXPECT_THROW(detail::FileStream("/nowhere/atlas.osa"), Error);
  EXPECT_THROW(detail::FileStream{testing::TempDir()}, Error);
  EXPECT_EQ(detail::FileStream("/dev/null").size(), 0U);
}

}  // namespace
}  // namespace slamdb
