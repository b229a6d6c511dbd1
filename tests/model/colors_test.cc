// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/colors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slamdb {
namespace {

TEST(Colors, OfMapsRepeatAfterTen) {
  EXPECT_EQ(ColorOfMap(MapId(0)), (Color{63, 144, 218}));
  EXPECT_EQ(ColorOfMap(MapId(12)), ColorOfMap(MapId(2)));
  for (std::uint64_t a = 0; a < 10; ++a)
    for (std::uint64_t b = 0; b < a; ++b) EXPECT_NE(ColorOfMap(MapId(a)), ColorOfMap(MapId(b)));
}

TEST(Colors, OfSharesGoFromVioletToYellow) {
  EXPECT_EQ(ColorOfShare(0), (Color{68, 1, 84}));
  EXPECT_EQ(ColorOfShare(-1), ColorOfShare(0));
  EXPECT_EQ(ColorOfShare(1), (Color{253, 231, 37}));
  EXPECT_EQ(ColorOfShare(std::numeric_limits<double>::infinity()), ColorOfShare(1));
  EXPECT_EQ(ColorOfShare(std::nan("")), kNoColor);
  // Entry 127 of the 256 of viridis, between those of 119 and 136.
  const Color middle = ColorOfShare(127 / 255.0);
  EXPECT_NEAR(middle[0], 33, 2);
  EXPECT_NEAR(middle[1], 144, 2);
  EXPECT_NEAR(middle[2], 141, 2);
}

// That is how every eye reads them: the larger, the lighter.
TEST(Colors, OfSharesGrowLighter) {
  const auto light = [](const Color& color) { return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2]; };
  for (int step = 1; step <= 255; ++step)
    EXPECT_GT(light(ColorOfShare(step / 255.0)), light(ColorOfShare((step - 1) / 255.0)) - 0.8) << step;
}

}  // namespace
}  // namespace slamdb
