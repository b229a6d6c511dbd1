// SPDX-License-Identifier: BSD-3-Clause
// Which locations are servers, and what of them may be shown.
#include "slamdb/formats/detail/server.h"

#include <gmock/gmock.h>

namespace slamdb::detail {
namespace {

TEST(Server, IsToldByItsScheme) {
  for (const char* uri : {"postgresql://", "postgres://host/db", "postgresql:///maps", "postgresql://u@h:1,g:2/d?a=b"})
    EXPECT_TRUE(IsServer(uri)) << uri;
  for (const char* path : {"", "a.osa", "postgresql:/host/db", "postgres:maps", "POSTGRESQL://h", "./postgresql://h",
                           "host=localhost dbname=maps"})
    EXPECT_FALSE(IsServer(path)) << path;
}

TEST(Server, PasswordsGoAndNothingElse) {
  const auto shown = [](const char* uri, const char* expected) { EXPECT_EQ(WithoutPassword(uri), expected) << uri; };
  shown("postgresql://u:S3cret@h/db", "postgresql://u@h/db");
  shown("postgresql://u:S3%40cret@h1:1,[::1]:2/d%20b?sslmode=require",
        "postgresql://u@h1:1,[::1]:2/d%20b?sslmode=require");
  shown("postgres://:S3cret@/db", "postgres://@/db");
  shown("postgresql://u:@h/", "postgresql://u@h/");
  shown("postgresql://u@h/db?password=S3cret", "postgresql://u@h/db");
  shown("postgresql://u@h/db?a=b&password=S3cret&sslpassword=S3cret&c=d", "postgresql://u@h/db?a=b&c=d");
  shown("postgresql://u@h/db?sslpassword=S3cret&c=d", "postgresql://u@h/db?c=d");
  shown("postgresql://u@h?p%61ssw%6Frd=S3cret", "postgresql://u@h");
}

TEST(Server, WhatHasNoPasswordStaysAsItIs) {
  for (const char* uri :
       {"postgresql://", "postgresql://h", "postgresql://u@h/db", "postgresql://[::1]:5432/d@b", "postgresql://u@h/?",
        "postgresql:///d?host=/tmp&user=a", "postgresql://u@h?a&&b=%", "postgresql://u%3Ax@h/db?application_name=p:q@r",
        "postgresql://h/db?passfile=/etc/passwords", "u:S3cret@h", "map:s@home.osa"})
    EXPECT_EQ(WithoutPassword(uri), uri);
}

TEST(Server, PasswordsThatAreNotEncodedAsTheyShouldBeGoToo) {
  for (const char* uri : {"postgresql://u:S3cret@S3cret@h/db", "postgresql://u:S3cret/S3cret@h/db",
                          "postgresql://u:S3cret?S3cret@h/db", "postgresql://u:S3cret@h?password=S3cret@h",
                          "postgresql://h?password=S3cret@h", "postgresql://u:S3cret/@S3cret@h:5432/db"})
    EXPECT_THAT(WithoutPassword(uri), ::testing::Not(::testing::HasSubstr("S3cret"))) << uri;
}

}  // namespace
}  // namespace slamdb::detail
