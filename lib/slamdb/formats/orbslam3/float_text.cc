// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/float_text.h"

#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>

// The value is m * 2^e with an integer m below 2^24. Times 10^n, where n moves ten digits in front of the point, it is
// (m * 5^n) * 2^(e + n): for n up to 27 the product fits into 87 bits, so the ten digits come out of one exact
// multiplication and one shift, rounded half to even.
namespace slamdb::orbslam3 {
namespace {

using Wide = unsigned __int128;
constexpr int kMostPower = 27;  // 5^27 < 2^63
constexpr std::uint64_t kTenDigits = 10'000'000'000, kNineDigits = 1'000'000'000;

constexpr std::array<std::uint64_t, kMostPower + 1> kPowersOfFive = [] {
  std::array<std::uint64_t, kMostPower + 1> powers{1};
  for (std::size_t i = 1; i < powers.size(); ++i) powers[i] = powers[i - 1] * 5;
  return powers;
}();

constexpr std::array<char, 200> kPairs = [] {
  std::array<char, 200> pairs{};
  for (std::size_t i = 0; i < 100; ++i) {
    pairs[2 * i] = static_cast<char>('0' + i / 10);
    pairs[2 * i + 1] = static_cast<char>('0' + i % 10);
  }
  return pairs;
}();

char* PutPair(char* to, std::uint64_t value) {
  std::memcpy(to, &kPairs[2 * value], 2);
  return to + 2;
}

// round(mantissa * 2^exponent * 10^power), half to even.
std::uint64_t Scaled(std::uint64_t mantissa, int exponent, int power) {
  const Wide product = Wide{mantissa} * kPowersOfFive[static_cast<std::size_t>(power)];
  const int shift = exponent + power;
  if (shift >= 0) return static_cast<std::uint64_t>(product << shift);
  const Wide whole = product >> -shift, rest = product - (whole << -shift), half = Wide{1} << (-shift - 1);
  return static_cast<std::uint64_t>(whole) + (rest > half || (rest == half && (whole & 1) != 0) ? 1 : 0);
}

char* WriteDigits(char* to, std::uint64_t digits, int exponent10) {
  const std::uint64_t first = digits / kNineDigits, rest = digits % kNineDigits;
  *to++ = static_cast<char>('0' + first);
  *to++ = '.';
  *to++ = static_cast<char>('0' + rest / 100'000'000);
  to = PutPair(to, rest / 1'000'000 % 100);
  to = PutPair(to, rest / 10'000 % 100);
  to = PutPair(to, rest / 100 % 100);
  to = PutPair(to, rest % 100);
  *to++ = 'e';
  *to++ = exponent10 < 0 ? '-' : '+';
  return PutPair(to, static_cast<std::uint64_t>(exponent10 < 0 ? -exponent10 : exponent10));
}

}  // namespace

char* WriteScientific(char* to, float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const auto biased = static_cast<int>(bits >> 23 & 0xFF);
  const int exponent = biased - 150;
  // floor(log10) of the power of two, which may be one too small for the value.
  int exponent10 = ((exponent + 23) * 1233) >> 12;
  if (biased == 0 || exponent10 < -17 || exponent10 > 8)
    return std::to_chars(to, to + 25, value, std::chars_format::scientific, 9).ptr;
  const std::uint64_t mantissa = (bits & 0x7FFFFF) | 0x800000;
  std::uint64_t digits = Scaled(mantissa, exponent, 9 - exponent10);
  if (digits >= kTenDigits) {
    ++exponent10;
    digits = Scaled(mantissa, exponent, 9 - exponent10);
  }
  if (bits >> 31 != 0) *to++ = '-';
  return WriteDigits(to, digits, exponent10);
}

}  // namespace slamdb::orbslam3
