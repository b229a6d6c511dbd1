// SPDX-License-Identifier: BSD-3-Clause
// What no MRPT wrote: cut, flipped, foreign and hostile files.
#include <gmock/gmock.h>

#include "slamdb/base/error.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/mrpt/detail/gzip.h"
#include "slamdb/formats/mrpt/detail/mrpt.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kRealMap = SLAMDB_FIXTURES "/mrpt/landmarks.bin";

// What reading says of bytes that it refuses; "read" when it does not.
std::string Refusal(const std::string& bytes) {
  return RefusalOf([&] { Decoded(detail::kMrptFormat, bytes); });
}

std::string MapHeader(std::uint32_t count) {
  std::string bytes("\x99mrpt::maps::CLandmarksMap\0", 27);
  detail::AppendRaw(bytes, count);
  return bytes;
}

TEST(MrptDamage, EveryCutIsAnErrorWithItsPlace) {
  const std::string whole = ReadFile(kRealMap);
  for (std::size_t size = 1; size < whole.size(); ++size)
    EXPECT_THAT(Refusal(whole.substr(0, size)), AllOf(HasSubstr("byte "), HasSubstr("the file is truncated"))) << size;
  EXPECT_THAT(Refusal(whole.substr(0, 1000)), HasSubstr("landmark 1"));
}

TEST(MrptDamage, AnyFlipIsReadOrRefused) {
  const std::string whole = ReadFile(kRealMap);
  for (std::size_t at = 0; at < whole.size(); at += 3) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x81);
    Refusal(flipped);
  }
}

TEST(MrptDamage, CountsAreComparedWithTheBytesLeft) {
  EXPECT_THAT(Refusal(MapHeader(0xffffffff) + std::string(200, '\0')), HasSubstr("4294967295 landmarks does not fit"));
  std::string bytes = ReadFile(kRealMap);
  bytes.replace(0x5f, 4, "\xff\xff\xff\x7f");  // features of the first landmark
  EXPECT_THAT(Refusal(bytes), HasSubstr("landmark 0"));
  bytes = ReadFile(kRealMap);
  bytes.replace(0x1e9, 4, "\xff\xff\xff\xff");  // bytes of its descriptor
  EXPECT_THAT(Refusal(bytes), HasSubstr("a descriptor of 4294967295 bytes does not fit"));
}

TEST(MrptDamage, OtherObjectsAreNamed) {
  EXPECT_THAT(Refusal("\x96mrpt::maps::CSimpleMap\x01\x01"), HasSubstr("found a mrpt::maps::CSimpleMap of version 1"));
  EXPECT_THAT(Refusal(std::string("\x8d"
                                  "CLandmarksMap\0",
                                  15)),
              HasSubstr("found a CLandmarksMap of version 0"));
  EXPECT_THAT(Refusal(std::string("\x0d\0\0\0CLandmarksMap", 17)), HasSubstr("MRPT before 0.5.5"));
  std::string bytes = ReadFile(kRealMap);
  bytes[0x35] = 3;  // version of the first landmark
  EXPECT_THAT(Refusal(bytes), HasSubstr("mrpt::maps::CLandmark of version 3"));
  bytes = ReadFile(kRealMap);
  bytes[0xb1] = 1;  // it has a patch, which does not end anywhere
  EXPECT_THAT(Refusal(bytes), HasSubstr("cannot find the end of an image patch"));
}

TEST(MrptDamage, CompressedFilesAreCheckedToo) {
  const TemporaryFolder folder;
  Notices notices;
  const Atlas atlas = detail::kMrptFormat.read({kRealMap, ""}, {}, notices);
  detail::kMrptFormat.write(atlas, {folder.Path("a.gz"), ""}, {}, notices);
  const std::string whole = ReadFile(folder.Path("a.gz"));
  EXPECT_EQ(Refusal(whole), "read");
  EXPECT_THAT(Refusal(whole.substr(0, whole.size() / 2)), HasSubstr("truncated or damaged"));
  std::string flipped = whole;
  flipped[flipped.size() - 6] = static_cast<char>(~flipped[flipped.size() - 6]);  // its checksum
  EXPECT_THAT(Refusal(flipped), HasSubstr("truncated or damaged"));
  EXPECT_THAT(Refusal(whole + "tail"), HasSubstr("truncated or damaged"));
  EXPECT_EQ(Refusal(whole + whole), "read");
}

TEST(MrptDamage, FilesMadeToFillTheMemoryAreRefused) {
  std::string bomb;
  mrpt::Compressor compressor([&](std::string_view bytes) { bomb += bytes; });
  for (int megabyte = 0; megabyte < 64; ++megabyte) compressor.Add(std::string(std::size_t{1} << 20, '\0'));
  compressor.Finish();
  std::string several;  // gzip files one behind the other are one
  for (int i = 0; i < 5; ++i) several += bomb;
  EXPECT_THAT(Refusal(several), AllOf(HasSubstr("swells to more than 268435456 bytes"), HasSubstr("gunzip")));
  EXPECT_THAT(Refusal(bomb), HasSubstr("byte 1")) << "what is allowed is read";
}

}  // namespace
}  // namespace slamdb
