// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/float_text.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <type_traits>

namespace slamdb::orbslam3 {
namespace {

template <class T>
using BitsOf = std::conditional_t<sizeof(T) == sizeof(float), std::uint32_t, std::uint64_t>;

template <class T>
std::string Written(T value) {
  std::array<char, 64> text{};
  return {text.data(), WriteScientific(text.data(), value)};
}
template <class T>
std::string Printed(T value) {
  std::array<char, 64> text{};
  return {text.data(),
          static_cast<std::size_t>(std::snprintf(text.data(), text.size(), std::is_same_v<T, float> ? "%.9e" : "%.17e",
                                                 static_cast<double>(value)))};
}

// Reading either gives the nearest number, or leaves it to others. Returns whether it was read.
template <class T>
bool ExpectReadAsNearest(const std::string& token) {
  const std::string text = token + std::string(kLongestScientific, ' ');
  T read = 42, nearest = 0;
  const char* const end = ReadScientific(text.data(), read);
  if (end == nullptr) {
    EXPECT_EQ(read, T{42}) << token;
    return false;
  }
  EXPECT_EQ(static_cast<std::size_t>(end - text.data()), token.size());
  std::from_chars(token.data(), token.data() + token.size(), nearest);
  EXPECT_EQ(std::bit_cast<BitsOf<T>>(read), std::bit_cast<BitsOf<T>>(nearest)) << token;
  return true;
}

template <class T>
void ExpectBothWays(BitsOf<T> bits) {
  const T value = std::bit_cast<T>(bits);
  const std::string written = Written(value);
  ASSERT_EQ(written, Printed(value)) << "bits " << bits;
  const bool read = ExpectReadAsNearest<T>(written);
  const bool usual = std::abs(value) > T(1e-9) && std::abs(value) < T(1e9);
  ASSERT_TRUE(read || !usual) << written;
}

template <class T>
class FloatText : public testing::Test {};
using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(FloatText, Types);

TYPED_TEST(FloatText, IsThatOfPrintfForEveryExponent) {
  using Bits = BitsOf<TypeParam>;
  constexpr int kFraction = std::is_same_v<TypeParam, float> ? 23 : 52;
  constexpr Bits kAll = (Bits{1} << kFraction) - 1;
  for (Bits exponent = 0; exponent <= std::bit_cast<Bits>(-TypeParam{0}) >> kFraction; ++exponent)
    for (const Bits mantissa : {Bits{0}, Bits{1}, Bits{2}, kAll / 3, kAll / 2 + 1, kAll / 3 * 2, kAll - 1, kAll})
      for (const Bits sign : {Bits{0}, std::bit_cast<Bits>(-TypeParam{0})})
        ExpectBothWays<TypeParam>(sign | exponent << kFraction | mantissa);
}

TYPED_TEST(FloatText, IsThatOfPrintfForRandomBits) {
  std::uint64_t state = 42;
  for (int i = 0; i < 400'000; ++i) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    // Of doubles few would be of the usual size.
    const std::uint64_t bits = i % 2 == 0 ? state ^ state >> 32 : (state >> 5) | std::uint64_t{0x3} << 60;
    if constexpr (std::is_same_v<TypeParam, float>)
      ExpectBothWays<float>(static_cast<std::uint32_t>(state >> 32));
    else
      ExpectBothWays<double>(bits);
  }
}

// Around powers of ten, where the number of digits changes.
TYPED_TEST(FloatText, IsThatOfPrintfAroundPowersOfTen) {
  for (TypeParam power = TypeParam(1e-20); power < TypeParam(1e20); power *= 10) {
    const auto bits = std::bit_cast<BitsOf<TypeParam>>(power);
    for (auto near = bits - 20; near != bits + 20; ++near) ExpectBothWays<TypeParam>(near);
  }
}

// Halves that must go to the even digit.
TYPED_TEST(FloatText, RoundsTiesToEven) {
  EXPECT_EQ(Written(TypeParam(1.0F / 1024 / 1024)), Printed(TypeParam(1.0F / 1024 / 1024)));
  for (int i = 1; i < 4096; ++i)
    ExpectBothWays<TypeParam>(std::bit_cast<BitsOf<TypeParam>>(static_cast<TypeParam>(i) / 4096));
}

TYPED_TEST(FloatText, IsReadAsTheNearestWhateverTheDigits) {
  std::uint64_t state = 42;
  std::array<char, 64> text{};
  for (int i = 0; i < 400'000; ++i) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    const int exponent = static_cast<int>(state >> 33) % 40 - 20;
    std::snprintf(text.data(), text.size(), "%d.%0*llue%+03d", static_cast<int>(state >> 60) % 10,
                  static_cast<int>(kDigitsBehindPoint<TypeParam>),
                  static_cast<unsigned long long>(std::is_same_v<TypeParam, float> ? state >> 20 & 0x1FFFFFFF
                                                                                   : state >> 8 & 0xFFFFFFFFFFFFFF),
                  exponent);
    ExpectReadAsNearest<TypeParam>(text.data());
  }
}

// Numbers in the middle of two floats, and the nearest beside them that so many digits tell apart.
TEST(FloatText, InTheMiddleOfTwoIsReadAsTheNearest) {
  std::array<char, 64> text{};
  for (std::uint64_t middle = (1U << 24) + 1; middle < 10'000'000'000; middle += middle / 50'000 * 2 + 2) {
    std::uint64_t low = 1;
    while (middle >> 25 >= low) low *= 2;
    for (const std::uint64_t digits : {middle / low * low - 1, middle / low * low, middle / low * low + 1}) {
      std::snprintf(text.data(), text.size(), "%.9e", static_cast<double>(digits));
      ExpectReadAsNearest<float>(text.data());
    }
  }
  // So near that their nearest double is the middle, which rounds the wrong way.
  for (const char* token : {"3.760474101e-05", "2.712892001e-05", "9.494139249e-06", "7.172583949e-08",
                            "6.486860471e-08", "6.143998732e-08", "6.025677457e-10", "6.370737618e-11"})
    ExpectReadAsNearest<float>(token);
}

TEST(FloatText, OfAnotherFormIsLeftToOthers) {
  for (const char* token : {"1",
                            "1.5",
                            "1.00500000e+02",
                            "1.0050000000e+02",
                            "1.005000000e2",
                            "1.005000000e+002",
                            "1.005000000E+02",
                            "1.005000000e 02",
                            "1.005000000e)02",
                            "1.005000000e/02",
                            "1,005000000e+02",
                            "+1.005000000e+02",
                            "--1.00500000e+02",
                            "1.00500000-e+02",
                            "1.00500000:e+02",
                            "x.005000000e+02",
                            "1.005000000e+2x",
                            "nan",
                            "-inf",
                            ""})
    EXPECT_FALSE(ExpectReadAsNearest<float>(token)) << token;
  EXPECT_TRUE(ExpectReadAsNearest<float>("1.005000000e+02"));
  EXPECT_TRUE(ExpectReadAsNearest<float>("-1.005000000e-02"));
}

}  // namespace
}  // namespace slamdb::orbslam3
