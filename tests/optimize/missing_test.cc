// SPDX-License-Identifier: BSD-3-Clause
// What is built without Ceres says so, and what to install.
#include <gmock/gmock.h>

#include "slamdb/optimize/optimize.h"
#include "tests/support/kind_of.h"
#include "tests/support/message_of.h"

namespace slamdb::testing {
namespace {

TEST(WithoutCeres, OptimisingSaysWhatToInstall) {
  EXPECT_FALSE(CanOptimize());
  Atlas atlas;
  for (const std::function<void()>& work :
       {std::function<void()>([&] { OptimizeMaps(atlas); }), std::function<void()>([&] { AdjustBundle(atlas, {}); }),
        std::function<void()>([&] { OptimizePoseGraph(atlas, {}, {}); })}) {
    EXPECT_EQ(KindOf(work), ErrorKind::kUnsupported);
    EXPECT_THAT(MessageOf(work), ::testing::HasSubstr("libceres-dev"));
  }
}

}  // namespace
}  // namespace slamdb::testing
