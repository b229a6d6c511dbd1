// SPDX-License-Identifier: BSD-3-Clause
// What is built without Cairo says so, and what to install.
#include <gmock/gmock.h>

#include "slamdb/base/error.h"
#include "slamdb/plot/plot.h"
#include "tests/support/kind_of.h"
#include "tests/support/message_of.h"

namespace slamdb::testing {
namespace {

TEST(WithoutCairo, APlotSaysWhatToInstall) {
  EXPECT_FALSE(CanPlot());
  const auto draw = [] { static_cast<void>(DrawPlot({})); };
  EXPECT_EQ(KindOf(draw), ErrorKind::kUnsupported);
  EXPECT_THAT(MessageOf(draw), ::testing::HasSubstr("libcairo2-dev"));
}

}  // namespace
}  // namespace slamdb::testing
