// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "slamdb/pictures/pictures.h"
#include "tests/support/message_of.h"

namespace slamdb {
namespace {

TEST(Pictures, AreRefusedWithTheNameOfThePackage) {
  EXPECT_THAT(MessageOf([] { (void)ReadPicture("a.png"); }), ::testing::HasSubstr("libopencv-features2d-dev"));
}

}  // namespace
}  // namespace slamdb
