// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/error.h"

#include <gtest/gtest.h>

#include <cerrno>

namespace slamdb {
namespace {

TEST(Error, ReadsAsPathPlaceProblem) {
  const Error error("a.osa", "byte 12, map 0", "is truncated");
  EXPECT_STREQ(error.what(), "a.osa: byte 12, map 0: is truncated");
  EXPECT_EQ(error.path(), "a.osa");
  EXPECT_EQ(error.place(), "byte 12, map 0");
  EXPECT_EQ(error.problem(), "is truncated");
}

TEST(Error, LeavesEmptyPartsOut) {
  EXPECT_STREQ(Error("is truncated").what(), "is truncated");
  EXPECT_STREQ(Error("a.osa", "", "is truncated").what(), "a.osa: is truncated");
  EXPECT_STREQ(Error("", "row 3", "is truncated").what(), "row 3: is truncated");
}

TEST(SystemError, TellsTheReasonOfTheSystem) {
  errno = ENOENT;
  EXPECT_STREQ(SystemError("a.osa", "cannot open").what(), "a.osa: cannot open: No such file or directory");
}

}  // namespace
}  // namespace slamdb
