// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/amounts.h"

#include <gtest/gtest.h>

#include <limits>

namespace slamdb::detail {
namespace {

TEST(LengthText, HasNoExponentWhereOneIsNotNeeded) {
  EXPECT_EQ(LengthText(0.01234, "m"), "0.01234 m");
  EXPECT_EQ(LengthText(30.2345, "m"), "30.23 m");
  EXPECT_EQ(LengthText(9999.4, "m"), "9999 m");
  EXPECT_EQ(LengthText(9999.5, "m"), "10,000 m");
  EXPECT_EQ(LengthText(12345.67, "units"), "12,346 units");
  EXPECT_EQ(LengthText(4.5e9, "m"), "4,500,000,000 m");
  EXPECT_EQ(LengthText(1e18, "m"), "1e+18 m");
  EXPECT_EQ(LengthText(-0.0, "m"), "0 m");
  EXPECT_EQ(Rounded(-12345), "-12,345");
  EXPECT_EQ(Rounded(std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(DurationText, IsInSecondsMinutesOrHours) {
  EXPECT_EQ(DurationText(0), "0 s");
  EXPECT_EQ(DurationText(-0.0), "0 s");
  EXPECT_EQ(DurationText(17.86), "17.9 s");
  EXPECT_EQ(DurationText(75.2), "1 min 15 s");
  EXPECT_EQ(DurationText(112), "1 min 52 s");
  EXPECT_EQ(DurationText(39'971), "11 h 6 min");
  EXPECT_EQ(DurationText(3600 * 30), "30 h 0 min");
  EXPECT_EQ(DurationText(3600 * 1234), "1,234 h 0 min");
}

// Never `60 s`, `2 min 60 s` or `0 h 60 min`.
TEST(DurationText, RoundsBeforeItSplits) {
  EXPECT_EQ(DurationText(59.94), "59.9 s");
  EXPECT_EQ(DurationText(59.96), "1 min 0 s");
  EXPECT_EQ(DurationText(179.7), "3 min 0 s");
  EXPECT_EQ(DurationText(3599.4), "59 min 59 s");
  EXPECT_EQ(DurationText(3599.7), "1 h 0 min");
}

TEST(DurationText, TakesWhatIsNoDuration) {
  EXPECT_EQ(DurationText(std::numeric_limits<double>::quiet_NaN()), "nan s");
  EXPECT_EQ(DurationText(-3), "-3 s");
  EXPECT_EQ(DurationText(std::numeric_limits<double>::infinity()), "277,777,777,777 h 46 min");
}

TEST(HumanBytes, HasTwoOrThreeDigitsAndNoExponent) {
  EXPECT_EQ(HumanBytes(0), "0 B");
  EXPECT_EQ(HumanBytes(999), "999 B");
  EXPECT_EQ(HumanBytes(1000), "1.0 kB");
  EXPECT_EQ(HumanBytes(99'949), "99.9 kB");
  EXPECT_EQ(HumanBytes(99'950), "100 kB");
  EXPECT_EQ(HumanBytes(999'499), "999 kB");
  EXPECT_EQ(HumanBytes(999'540), "1.0 MB");
  EXPECT_EQ(HumanBytes(999'999), "1.0 MB");
  EXPECT_EQ(HumanBytes(33'424'706), "33.4 MB");
  EXPECT_EQ(HumanBytes(200'000'000), "200 MB");
  EXPECT_EQ(HumanBytes(std::numeric_limits<std::uint64_t>::max()), "18447 PB");
}

TEST(DateText, IsOfRecordingsOfCameras) {
  EXPECT_EQ(DateText(1403636579.76), "2014-06-24 19:02:59 UTC");
  EXPECT_EQ(DateText(951827696), "2000-02-29 12:34:56 UTC");
  EXPECT_EQ(DateText(12.5), "") << "counts from elsewhere";
  EXPECT_EQ(DateText(4102444800), "");
  EXPECT_EQ(DateText(std::numeric_limits<double>::quiet_NaN()), "");
}

TEST(SecondsText, HasAllDigits) { EXPECT_EQ(SecondsText(1403636579.7635555), "1403636579.7635555"); }

}  // namespace
}  // namespace slamdb::detail
