// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/text.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/open_end.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
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

TEST(ParseNumber, TakesTheWholeTextAndNothingElse) {
  EXPECT_EQ(ParseNumber<double>("-1.5e3"), -1500);
  EXPECT_EQ(ParseNumber<double>("+47.25"), 47.25);
  EXPECT_EQ(ParseNumber<int>("+7"), 7);
  EXPECT_EQ(ParseNumber<double>("-inf"), -HUGE_VAL);
  EXPECT_TRUE(std::isnan(ParseNumber<double>("nan").value()));
  for (const char* text : {"", "+", "-", "1x", " 1", "1 ", "+-1", "++1", "1,5", "0x10", "1e999", "one"})
    EXPECT_FALSE(ParseNumber<double>(text)) << text;
  for (const char* text : {"1.0", "1e3", "256", "-1", "+"}) EXPECT_FALSE(ParseNumber<std::uint8_t>(text)) << text;
}

TEST(ParseNumber, KeepsAllBitsOfIntegers) {
  EXPECT_EQ(ParseNumber<std::int64_t>("1700000000123456789"), 1700000000123456789);
  EXPECT_EQ(ParseNumber<std::uint64_t>("18446744073709551615"), std::numeric_limits<std::uint64_t>::max());
  EXPECT_FALSE(ParseNumber<std::uint64_t>("18446744073709551616"));
  EXPECT_EQ(ParseNumber<std::int64_t>("-9223372036854775808"), std::numeric_limits<std::int64_t>::min());
}

TEST(ParseNumber, ReadsBackTheSameBits) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 100'000; ++i) {
    const auto value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(ParseNumber<double>(Text(value)), value) << Text(value);
  }
}

TEST(TakeLine, EndsWithOrWithoutCarriageReturn) {
  std::string_view text = "a\r\n\nb\rc\nd\r";
  std::vector<std::string_view> lines;
  while (!text.empty()) lines.push_back(TakeLine(text));
  EXPECT_EQ(lines, (std::vector<std::string_view>{"a", "", "b\rc", "d"}));
}

TEST(TakeWord, StandsBetweenSeparators) {
  std::string_view text = "  one, two\t";
  EXPECT_EQ(TakeWord(text, " ,\t"), "one");
  EXPECT_EQ(TakeWord(text, " ,\t"), "two");
  EXPECT_EQ(TakeWord(text, " ,\t"), "");
  EXPECT_EQ(text, "");
}

TEST(Split, HasAPartMoreThanSeparators) {
  EXPECT_EQ(Split("", ','), (std::vector<std::string_view>{""}));
  EXPECT_EQ(Split("a,,b,", ','), (std::vector<std::string_view>{"a", "", "b", ""}));
}

TEST(Trimmed, LeavesBlanksInside) {
  EXPECT_EQ(Trimmed(" \ta b\t "), "a b");
  EXPECT_EQ(Trimmed(" \t "), "");
}

TEST(WithoutMark, KnowsUtf8AndUtf16) {
  EXPECT_EQ(WithoutMark("\xef\xbb\xbf"
                        "1 2"),
            "1 2");
  EXPECT_EQ(WithoutMark("1 2"), "1 2");
  EXPECT_EQ(WithoutMark("\xef\xbb"), "\xef\xbb");
  for (const char* mark : {"\xff\xfe", "\xfe\xff"}) {
    try {
      WithoutMark(mark);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUnsupported);
      EXPECT_NE(std::string(error.what()).find("UTF-16"), std::string::npos);
    }
  }
}

TEST(OpenEnd, IsOfALastLineThatHoldsSomething) {
  for (const char* whole : {"", "1 2\n", "1 2\r\n", "1 2\r", "1 2\n  ", "\n"}) EXPECT_FALSE(HasOpenEnd(whole)) << whole;
  for (const char* open : {"1", "1 2\n3", "1 2\r3 ", "# a comment"}) EXPECT_TRUE(HasOpenEnd(open)) << open;
}

TEST(Excerpt, IsNotLong) { EXPECT_EQ(Excerpt(std::string(200, 'x')).size(), 82U); }

}  // namespace
}  // namespace slamdb::detail
