// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/error.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <utility>

namespace slamdb {
namespace {

TEST(Error, ReadsAsPathPlaceProblem) {
  const Error error(ErrorKind::kDamaged, "a.osa", "byte 12, map 0", "is truncated");
  EXPECT_STREQ(error.what(), "a.osa: byte 12, map 0: is truncated");
  EXPECT_EQ(error.path(), "a.osa");
  EXPECT_EQ(error.place(), "byte 12, map 0");
  EXPECT_EQ(error.problem(), "is truncated");
}

TEST(Error, LeavesEmptyPartsOut) {
  EXPECT_STREQ(Error(ErrorKind::kDamaged, "is truncated").what(), "is truncated");
  EXPECT_STREQ(Error(ErrorKind::kDamaged, "a.osa", "", "is truncated").what(), "a.osa: is truncated");
  EXPECT_STREQ(Error(ErrorKind::kDamaged, "", "row 3", "is truncated").what(), "row 3: is truncated");
}

TEST(Error, HasAKind) {
  EXPECT_EQ(Error(ErrorKind::kLocked, "wait").kind(), ErrorKind::kLocked);
  EXPECT_EQ(Error(ErrorKind::kUsage, "a.osa", "", "what for?").kind(), ErrorKind::kUsage);
  EXPECT_EQ(ToString(ErrorKind::kNotFound), "not found");
  EXPECT_EQ(ToString(ErrorKind::kOutOfResources), "out of resources");
}

TEST(SystemError, TellsTheReasonOfTheSystem) {
  errno = ENOENT;
  EXPECT_STREQ(SystemError("a.osa", "cannot open").what(), "a.osa: cannot open: No such file or directory");
}

TEST(SystemError, HasTheKindOfTheReason) {
  const std::pair<int, ErrorKind> kinds[] = {
      {ENOENT, ErrorKind::kNotFound},        {ENOTDIR, ErrorKind::kNotFound},      {EEXIST, ErrorKind::kAlreadyExists},
      {EACCES, ErrorKind::kPermission},      {EPERM, ErrorKind::kPermission},      {EROFS, ErrorKind::kPermission},
      {EBUSY, ErrorKind::kLocked},           {EAGAIN, ErrorKind::kLocked},         {ENOSPC, ErrorKind::kOutOfResources},
      {EDQUOT, ErrorKind::kOutOfResources},  {ENOMEM, ErrorKind::kOutOfResources}, {EMFILE, ErrorKind::kOutOfResources},
      {EISDIR, ErrorKind::kUsage},           {ENAMETOOLONG, ErrorKind::kUsage},    {EIO, ErrorKind::kDamaged},
      {EOPNOTSUPP, ErrorKind::kNotPossible},
  };
  for (const auto& [code, kind] : kinds) {
    errno = code;
    EXPECT_EQ(SystemError("a.osa", "cannot").kind(), kind) << code;
  }
}

}  // namespace
}  // namespace slamdb
