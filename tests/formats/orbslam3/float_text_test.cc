// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/float_text.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <string>

namespace slamdb::orbslam3 {
namespace {

std::string Written(float value) {
  std::array<char, 32> text{};
  return {text.data(), WriteScientific(text.data(), value)};
}
std::string Printed(float value) {
  std::array<char, 32> text{};
  return {text.data(),
          static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.9e", static_cast<double>(value)))};
}
void ExpectAsPrinted(std::uint32_t bits) {
  const float value = std::bit_cast<float>(bits);
  ASSERT_EQ(Written(value), Printed(value)) << "bits " << bits;
}

TEST(WriteScientific, EqualsPrintfForEveryExponent) {
  for (std::uint32_t exponent = 0; exponent < 256; ++exponent)
    for (const std::uint32_t mantissa : {0U, 1U, 2U, 0x2AAAAAU, 0x400000U, 0x555555U, 0x7FFFFEU, 0x7FFFFFU})
      for (const std::uint32_t sign : {0U, 1U}) ExpectAsPrinted(sign << 31 | exponent << 23 | mantissa);
}

TEST(WriteScientific, EqualsPrintfForRandomBits) {
  std::uint64_t state = 42;
  for (int i = 0; i < 400'000; ++i) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    ExpectAsPrinted(static_cast<std::uint32_t>(state >> 32));
  }
}

// Around powers of ten, where the number of digits changes.
TEST(WriteScientific, EqualsPrintfAroundPowersOfTen) {
  for (float power = 1e-20F; power < 1e12F; power *= 10) {
    const auto bits = std::bit_cast<std::uint32_t>(power);
    for (std::uint32_t near = bits - 20; near != bits + 20; ++near) ExpectAsPrinted(near);
  }
}

// Halves that must go to the even digit.
TEST(WriteScientific, RoundsTiesToEven) {
  EXPECT_EQ(Written(1.0F / 1024 / 1024), Printed(1.0F / 1024 / 1024));
  for (int i = 1; i < 4096; ++i) ExpectAsPrinted(std::bit_cast<std::uint32_t>(static_cast<float>(i) / 4096.0F));
}

}  // namespace
}  // namespace slamdb::orbslam3
