// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/errors.h"

#include <gmock/gmock.h>

namespace slamdb::postgresql {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ServerError, KindsAndRemediesAreThoseOfTheState) {
  struct Case {
    const char* state;
    ErrorKind kind;
    bool is_worth_retrying;
    const char* says;
  };
  for (const Case& one :
       {Case{"28P01", ErrorKind::kPermission, false, ".pgpass, PGPASSWORD or a service file"},
        Case{"28000", ErrorKind::kPermission, false, ".pgpass"},
        Case{"3D000", ErrorKind::kNotFound, false, "no such database"},
        Case{"42501", ErrorKind::kPermission, false, "GRANT"},
        Case{"53100", ErrorKind::kOutOfResources, false, "disk is full"},
        Case{"53200", ErrorKind::kOutOfResources, false, "too little"},
        Case{"53300", ErrorKind::kOutOfResources, true, "connections"},
        Case{"54000", ErrorKind::kOutOfResources, false, "larger"},
        Case{"55P03", ErrorKind::kLocked, true, "try again"},
        Case{"40001", ErrorKind::kLocked, true, "try again"},
        Case{"40P01", ErrorKind::kLocked, true, "try again"},
        Case{"25006", ErrorKind::kPermission, false, "target_session_attrs=read-write"},
        Case{"57P01", ErrorKind::kLocked, true, "try again; what was being saved is there whole, or not at all"},
        Case{"57P02", ErrorKind::kLocked, true, "try again; what was being saved is there whole, or not at all"},
        Case{"57P03", ErrorKind::kLocked, true, "try again"},
        Case{"08006", ErrorKind::kLocked, true, "try again; what was being saved is there whole, or not at all"},
        Case{"08P01", ErrorKind::kLocked, true, "a pool in front of the server"},
        Case{"TLS00", ErrorKind::kPermission, false, "sslrootcert"},
        Case{"23505", ErrorKind::kDamaged, false, "message"},
        Case{"42P01", ErrorKind::kNotFound, false, "message"},
        Case{"42601", ErrorKind::kInternal, false, "message"},
        Case{"", ErrorKind::kNotPossible, false, "message"}}) {
    const ServerError error = ErrorOfState("postgresql://h/db", "table map", one.state, "message");
    EXPECT_EQ(error.kind(), one.kind) << one.state;
    EXPECT_EQ(error.state(), one.state);
    EXPECT_EQ(IsWorthRetrying(error), one.is_worth_retrying) << one.state;
    EXPECT_THAT(error.problem(), HasSubstr(one.says)) << one.state;
    EXPECT_THAT(error.what(), HasSubstr("postgresql://h/db: table map: "));
    EXPECT_THAT(error.problem(), HasSubstr("message"));
  }
  EXPECT_FALSE(IsWorthRetrying(Error(ErrorKind::kLocked, "of a file")));
}

TEST(ServerError, MessagesCannotSteerATerminal) {
  const std::string problem = ErrorOfState("p", "", "XX000", "\nfirst\n\tsecond \x1b[31m\xff\n").problem();
  EXPECT_EQ(problem, "first; second \\e[31m\\xff");
}

}  // namespace
}  // namespace slamdb::postgresql
