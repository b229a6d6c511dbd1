// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/transfer.h"

#include <gmock/gmock.h>

#include <random>

namespace slamdb::orbslam3 {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string AnyBytes(std::size_t count) {
  std::mt19937 random(7);
  std::string bytes = "\n\r\n";
  while (bytes.size() < count) bytes += static_cast<char>(random());
  return bytes;
}

TEST(FindTransfers, FindsNoneInBytesOfAllKinds) {
  const Transfers transfers = FindTransfers(AnyBytes(3'000'000));
  EXPECT_THAT(transfers.undone, IsEmpty());
  EXPECT_THAT(transfers.left, IsEmpty());
}

// The first bytes alone look like those of a file that nothing happened to.
TEST(FindTransfers, LooksAsFarAsATransferMayShow) {
  std::string file = AnyBytes(70'000);
  for (int i = 0; i < 5'000'000; ++i) file += "\xc3\xa9";
  EXPECT_THAT(FindTransfers(file).undone, HasSubstr("UTF-8"));
}

TEST(FindTransfers, SeesCarriageReturnsBeforeAllLineFeedsAndNotBeforeAllButTheLast) {
  std::string file;
  for (const char byte : AnyBytes(1'000'000)) {
    if (byte == '\n') file += '\r';
    file += byte;
  }
  EXPECT_THAT(FindTransfers(file).undone, HasSubstr("carriage return"));
  EXPECT_THAT(FindTransfers(file + "x\n").undone, IsEmpty());
}

}  // namespace
}  // namespace slamdb::orbslam3
