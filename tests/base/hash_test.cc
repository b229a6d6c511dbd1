// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/hash.h"

#include <gtest/gtest.h>

#include <string_view>

namespace slamdb {
namespace {

Bytes BytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

// The test suite of RFC 1321.
TEST(Md5, IsTheMd5OfTheRfc) {
  EXPECT_EQ(detail::Md5({}), "d41d8cd98f00b204e9800998ecf8427e");
  EXPECT_EQ(detail::Md5(BytesOf("abc")), "900150983cd24fb0d6963f7d28e17f72");
  EXPECT_EQ(detail::Md5(BytesOf("message digest")), "f96b697d7cb7938d525a2f31aaf161d0");
}

TEST(HashBytes, IsXxh3AndKnowsContentAndSeed) {
  EXPECT_EQ(detail::Hex(detail::HashBytes({})), "2d06800538d394c2");  // XXH3's published value for no input
  EXPECT_EQ(detail::HashBytes(BytesOf("abc")), detail::HashBytes(BytesOf("abc")));
  EXPECT_NE(detail::HashBytes(BytesOf("abc")), detail::HashBytes(BytesOf("abd")));
  EXPECT_NE(detail::HashBytes(BytesOf("abc")), detail::HashBytes(BytesOf("abc"), 1));
}

TEST(Hex, HasSixteenDigits) {
  EXPECT_EQ(detail::Hex(0), "0000000000000000");
  EXPECT_EQ(detail::Hex(0xFEDCBA9876543210), "fedcba9876543210");
}

}  // namespace
}  // namespace slamdb
