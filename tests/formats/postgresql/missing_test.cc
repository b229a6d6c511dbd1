// SPDX-License-Identifier: BSD-3-Clause
// What is built without libpq says so, and what to install.
#include <gmock/gmock.h>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "tests/support/error_of.h"

namespace slamdb::postgresql {
namespace {

TEST(WithoutLibpq, ConnectingSaysWhatToInstall) {
  const Error error = ErrorOf([] { Connection connection("postgresql://u:S3cret@host/maps"); });
  EXPECT_EQ(error.kind(), ErrorKind::kUnsupported);
  EXPECT_EQ(error.path(), "postgresql://u@host/maps");
  EXPECT_THAT(error.problem(), ::testing::HasSubstr("libpq-dev"));
}

}  // namespace
}  // namespace slamdb::postgresql
