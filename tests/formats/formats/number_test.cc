// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/number.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>

namespace slamdb {
namespace {

template <class Number>
std::string Text(Number value) {
  std::string text = "=";
  AppendNumber(text, value);
  return text.substr(1);
}

std::string Seconds(double value) {
  std::string text;
  AppendSeconds(text, value);
  return text;
}

TEST(AppendNumber, IsShortest) {
  EXPECT_EQ(Text(0.1F), "0.1");
  EXPECT_EQ(Text(0.1), "0.1");
  EXPECT_EQ(Text(static_cast<double>(0.1F)), "0.10000000149011612");
  EXPECT_EQ(Text(-2.0F), "-2");
  EXPECT_EQ(Text(std::numeric_limits<std::uint64_t>::max()), "18446744073709551615");
  EXPECT_EQ(Text(std::numeric_limits<std::int32_t>::min()), "-2147483648");
}

TEST(AppendNumber, SpellsWhatIsNoNumber) {
  EXPECT_EQ(Text(std::nanf("")), "nan");
  EXPECT_EQ(Text(-std::nanf("")), "nan");
  EXPECT_EQ(Text(HUGE_VAL), "inf");
  EXPECT_EQ(Text(-HUGE_VALF), "-inf");
}

TEST(AppendNumber, ReadsBackToTheSameBits) {
  std::mt19937 random(7);
  for (int i = 0; i < 100'000; ++i) {
    const float value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (std::isnan(value)) continue;
    ASSERT_EQ(std::strtof(Text(value).c_str(), nullptr), value);
  }
}

TEST(AppendSeconds, HasNoExponent) {
  EXPECT_EQ(Seconds(1403636579.7635555), "1403636579.7635555");
  EXPECT_EQ(Seconds(1e-9), "0.000000001");
  EXPECT_EQ(Seconds(1e22), "10000000000000000000000");
  EXPECT_EQ(Seconds(std::numeric_limits<double>::max()).size(), 309U);
  EXPECT_EQ(std::strtod(Seconds(std::numeric_limits<double>::denorm_min()).c_str(), nullptr),
            std::numeric_limits<double>::denorm_min());
}

TEST(Thousands, GroupsDigits) {
  EXPECT_EQ(Thousands(0), "0");
  EXPECT_EQ(Thousands(999), "999");
  EXPECT_EQ(Thousands(8431), "8,431");
  EXPECT_EQ(Thousands(1234567), "1,234,567");
}

TEST(Counted, KnowsOneFromMany) {
  EXPECT_EQ(Counted(1, "keyframe"), "1 keyframe");
  EXPECT_EQ(Counted(8431, "keyframe"), "8,431 keyframes");
  EXPECT_EQ(Counted(0, "keyframe"), "0 keyframes");
}

}  // namespace
}  // namespace slamdb
