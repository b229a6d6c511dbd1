// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

// Decimal digits, eight at a time: a 64-bit word holds eight characters, the first in its lowest byte. Arithmetic on
// the word is arithmetic on all of them, without a loop or a branch.
namespace slamdb::orbslam3 {

static_assert(std::endian::native == std::endian::little, "words of characters have the first one in the lowest byte");

inline constexpr std::uint64_t kZeroDigits = 0x3030303030303030;

inline std::uint64_t LoadWord(const char* text) {
  std::uint64_t word;
  std::memcpy(&word, text, sizeof(word));
  return word;
}

// The high bit of each byte above 9. Exact up to and with the lowest such byte: what it carries is above it.
constexpr std::uint64_t MarkAboveNine(std::uint64_t bytes) {
  return ((bytes + 0x7676767676767676) | bytes) & 0x8080808080808080;
}

// The number of eight digits, given as bytes 0 to 9: pairs, then fours, then all.
constexpr std::uint32_t JoinDigits(std::uint64_t digits) {
  digits = digits * 10 + (digits >> 8);  // pairs are in the bytes 0, 2, 4, 6
  constexpr std::uint64_t kPairs = 0x000000FF000000FF, kFirst = 100 + (std::uint64_t{1'000'000} << 32),
                          kSecond = 1 + (std::uint64_t{10'000} << 32);
  return static_cast<std::uint32_t>(((digits & kPairs) * kFirst + ((digits >> 16) & kPairs) * kSecond) >> 32);
}

// The reverse: the characters of a number below 10^8, with zeros in front. Multiplying and shifting divides by 100 and
// by 10, exactly for what four and two digits hold.
constexpr std::uint64_t SplitDigits(std::uint32_t number) {
  std::uint64_t digits = number / 10'000 | std::uint64_t{number % 10'000} << 32;
  const std::uint64_t hundreds = (digits * 10'486 >> 20) & 0x0000007F0000007F;
  digits = hundreds | (digits - 100 * hundreds) << 16;
  const std::uint64_t tens = (digits * 103 >> 10) & 0x000F000F000F000F;
  return (tens | (digits - 10 * tens) << 8) + kZeroDigits;
}

}  // namespace slamdb::orbslam3
