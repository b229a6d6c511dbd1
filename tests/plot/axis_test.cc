// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/detail/axis.h"

#include <gmock/gmock.h>

#include <cmath>

namespace slamdb::plot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> Labels(const Range& range, double step) {
  std::vector<std::string> labels;
  for (const Tick& tick : TicksOf(range, step)) labels.push_back(tick.label);
  return labels;
}

TEST(NiceStep, IsOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_DOUBLE_EQ(NiceStep(1), 1);
  EXPECT_DOUBLE_EQ(NiceStep(1.1), 2);
  EXPECT_DOUBLE_EQ(NiceStep(2.5), 5);
  EXPECT_DOUBLE_EQ(NiceStep(5.1), 10);
  EXPECT_NEAR(NiceStep(0.03), 0.05, 1e-15);
  EXPECT_DOUBLE_EQ(NiceStep(0), 1);
  EXPECT_DOUBLE_EQ(NiceStep(NAN), 1);
  EXPECT_DOUBLE_EQ(NiceStep(INFINITY), 1);
}

TEST(Ticks, AreTheMultiplesInsideTheRange) {
  EXPECT_THAT(Labels({-1, 1.2}, 0.5), ElementsAre("\u22121.0", "\u22120.5", "0", "0.5", "1.0"));
  EXPECT_THAT(Labels({0, 20000}, 10000), ElementsAre("0", "10,000", "20,000"));
}

TEST(Ticks, AreNoneWhereThereIsNoRangeOrTooManyWouldBe) {
  EXPECT_THAT(Labels({1, 1}, 1), IsEmpty());
  EXPECT_THAT(Labels({NAN, 1}, 1), IsEmpty());
  EXPECT_THAT(Labels({0, 1e30}, 1), IsEmpty());
}

TEST(Amounts, HaveThirtyTwoSteps) {
  EXPECT_DOUBLE_EQ(StepOfAmount(0), 0.5 / 32);
  EXPECT_DOUBLE_EQ(StepOfAmount(0.5), 16.5 / 32);
  EXPECT_DOUBLE_EQ(StepOfAmount(7), 31.5 / 32);
  EXPECT_DOUBLE_EQ(StepOfAmount(NAN), 0);
}

TEST(Colors, AmountsGoFromDarkBlueToYellow) {
  EXPECT_NEAR(ColorOfAmount(0).blue, 0x54 / 255.0, 1e-9);
  EXPECT_NEAR(ColorOfAmount(1).red, 0xfd / 255.0, 1e-9);
  EXPECT_NE(ColorOfMap(MapId(0), false), ColorOfMap(MapId(0), true));
}

}  // namespace
}  // namespace slamdb::plot
