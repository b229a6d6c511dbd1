// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/float_text.h"

#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "slamdb/formats/orbslam3/detail/digits.h"

namespace slamdb::orbslam3 {
namespace {

using Wide = unsigned __int128;

constexpr std::size_t kMostPower = 27;  // 5^27 < 2^63
constexpr std::array<std::uint64_t, kMostPower + 1> kPowersOfFive = [] {
  std::array<std::uint64_t, kMostPower + 1> powers{1};
  for (std::size_t i = 1; i < powers.size(); ++i) powers[i] = powers[i - 1] * 5;
  return powers;
}();

constexpr std::uint64_t PowerOfTen(int power) { return kPowersOfFive[static_cast<std::size_t>(power)] << power; }

// ---- writing
//
// A value is m * 2^e with an integer m. Times 10^n, where n moves all digits that are printed in front of the point, it
// is m * M / 2^64 with M = 5^n * 2^(64 + e + n). In the range of the table M is an integer below 2^64 once m is shifted
// left by kShift, so that one multiplication gives the digits and their fraction exactly.

template <class T>
struct Format;
template <>
struct Format<float> {
  using Bits = std::uint32_t;
  static constexpr int kMantissaBits = 24, kShift = 11;
  static constexpr int kLeast = -79, kCount = 89;  // exponents e in the table
};
template <>
struct Format<double> {
  using Bits = std::uint64_t;
  static constexpr int kMantissaBits = 53, kShift = 8;
  static constexpr int kLeast = -83, kCount = 90;
};

// Of the numbers between two powers of ten that have one binary exponent.
struct Decade {
  std::uint64_t multiplier = 0;
  std::uint32_t exponent = 0;  // as text: `e-03`
};
// Of the numbers of one binary exponent: those below and from a power of ten.
struct Binade {
  std::uint64_t power_of_ten = ~std::uint64_t{0};  // the least mantissa that is not below it
  Decade below, from;
};

// m * multiplier / 2^64, half to even.
template <class T>
constexpr std::uint64_t Scaled(std::uint64_t mantissa, std::uint64_t multiplier) {
  const Wide product = Wide{mantissa << Format<T>::kShift} * multiplier;
  const auto whole = static_cast<std::uint64_t>(product >> 64), rest = static_cast<std::uint64_t>(product);
  constexpr std::uint64_t kHalf = std::uint64_t{1} << 63;
  return whole + (rest >= kHalf + (~whole & 1) ? 1 : 0);
}

template <class T>
constexpr Decade MakeDecade(int exponent, int exponent10) {
  const int power = static_cast<int>(kDigitsBehindPoint<T>) - exponent10;
  const int magnitude = exponent10 < 0 ? -exponent10 : exponent10;
  return {kPowersOfFive.at(static_cast<std::size_t>(power)) << (64 - Format<T>::kShift + exponent + power),
          static_cast<std::uint32_t>('e' | (exponent10 < 0 ? '-' : '+') << 8 | ('0' + magnitude / 10) << 16 |
                                     ('0' + magnitude % 10) << 24)};
}

template <class T>
constexpr std::array<Binade, Format<T>::kCount> kBinades = [] {
  std::array<Binade, Format<T>::kCount> binades{};
  for (int i = 0; i < Format<T>::kCount; ++i) {
    Binade& binade = binades[static_cast<std::size_t>(i)];
    const int exponent = Format<T>::kLeast + i;
    const int exponent10 = ((exponent + Format<T>::kMantissaBits - 1) * 1233) >> 12;  // floor(log10) of the least value
    binade.below = MakeDecade<T>(exponent, exponent10);
    std::uint64_t low = std::uint64_t{1} << (Format<T>::kMantissaBits - 1), end = 2 * low, high = end;
    while (low < high) {
      const std::uint64_t middle = low + (high - low) / 2;
      if (Scaled<T>(middle, binade.below.multiplier) < PowerOfTen(kDigitsBehindPoint<T> + 1))
        low = middle + 1;
      else
        high = middle;
    }
    if (low == end) continue;
    binade.power_of_ten = low;
    binade.from = MakeDecade<T>(exponent, exponent10 + 1);
  }
  return binades;
}();

constexpr std::uint32_t kHundredMillion = 100'000'000;

char* PutEight(char* to, std::uint64_t digits) {
  const std::uint64_t text = SplitDigits(static_cast<std::uint32_t>(digits));
  std::memcpy(to, &text, sizeof(text));
  return to + sizeof(text);
}

// `d.d`
char* PutFirstTwo(char* to, std::uint64_t digits) {
  const std::uint64_t tens = digits / 10;
  to[0] = static_cast<char>('0' + tens);
  to[1] = '.';
  to[2] = static_cast<char>('0' + (digits - 10 * tens));
  return to + 3;
}

}  // namespace

template <class T>
char* WriteScientific(char* to, T value) {
  using F = Format<T>;
  const auto bits = std::bit_cast<typename F::Bits>(value);
  constexpr int kBias = std::numeric_limits<T>::max_exponent + F::kMantissaBits - 2;
  constexpr typename F::Bits kFraction = (typename F::Bits{1} << (F::kMantissaBits - 1)) - 1;
  const typename F::Bits magnitude = bits & std::numeric_limits<typename F::Bits>::max() >> 1;
  const std::uint64_t row = (magnitude >> (F::kMantissaBits - 1)) - static_cast<std::uint64_t>(F::kLeast + kBias);
  if (row >= F::kCount)
    return std::to_chars(to, to + kLongestScientific, value, std::chars_format::scientific, kDigitsBehindPoint<T>).ptr;
  const std::uint64_t mantissa = (bits & kFraction) | (kFraction + 1);
  const Binade& binade = kBinades<T>[row];
  const Decade& decade = mantissa < binade.power_of_ten ? binade.below : binade.from;
  std::uint64_t digits = Scaled<T>(mantissa, decade.multiplier);
  *to = '-';
  if (bits != magnitude) ++to;
  if constexpr (std::is_same_v<T, float>) {
    to = PutFirstTwo(to, digits / kHundredMillion);
  } else {
    constexpr std::uint64_t kLower = std::uint64_t{kHundredMillion} * kHundredMillion;
    to = PutFirstTwo(to, digits / kLower);
    digits %= kLower;
    to = PutEight(to, digits / kHundredMillion);
  }
  to = PutEight(to, digits % kHundredMillion);
  std::memcpy(to, &decade.exponent, sizeof(decade.exponent));
  return to + sizeof(decade.exponent);
}

template char* WriteScientific(char* to, float value);
template char* WriteScientific(char* to, double value);

// ---- reading

namespace {

constexpr std::array<double, 23> kPowersOfTen = [] {  // all that a double holds exactly
  std::array<double, 23> powers{1};
  for (std::size_t i = 1; i < powers.size(); ++i) powers[i] = powers[i - 1] * 10;
  return powers;
}();

// digits / 10^power as the nearest T. False where this way does not know it.
bool Divide(std::uint64_t digits, std::size_t power, float& value) {
  if (power >= kPowersOfTen.size()) return false;
  // Of exact numbers, so the nearest double. It is on the same side of the middle of two floats as the quotient itself,
  // unless it is that middle.
  const double nearest = static_cast<double>(static_cast<std::int64_t>(digits)) / kPowersOfTen[power];
  constexpr std::uint64_t kBelowFloat = (std::uint64_t{1} << 29) - 1, kMiddle = std::uint64_t{1} << 28;
  if ((std::bit_cast<std::uint64_t>(nearest) & kBelowFloat) == kMiddle) return false;
  value = static_cast<float>(nearest);
  return true;
}
// The quotient as an integer of 62 or 63 bits, odd where there is a remainder: rounding it to 53 bits rounds the
// quotient.
bool Divide(std::uint64_t digits, std::size_t power, double& value) {
  if (digits == 0 || power >= kPowersOfFive.size()) return false;
  const int digits_shift = std::countl_zero(digits), power_shift = std::countl_zero(kPowersOfFive[power]);
  const std::uint64_t divisor = kPowersOfFive[power] << power_shift;
  const Wide dividend = Wide{digits << digits_shift} << 62;
  const auto quotient = static_cast<std::uint64_t>(dividend / divisor);
  const bool exact = Wide{quotient} * divisor == dividend;
  const int exponent = power_shift - digits_shift - 62 - static_cast<int>(power);
  const double scale = std::bit_cast<double>(static_cast<std::uint64_t>(1023 + exponent) << 52);
  value = static_cast<double>(static_cast<std::int64_t>(quotient | (exact ? 0 : 1))) * scale;
  return true;
}

// The end of a number, in a word: its last three digits, the exponent, and the space behind it.
constexpr std::uint64_t kTail = 0x2030302B65303030, kOtherSign = std::uint64_t{'+' ^ '-'} << 32;
// Xor with that leaves bytes 0 to 9 for digits and 0 for all else: what lifts greater ones to the high bit.
constexpr std::uint64_t kLiftTail = 0x7F76767F7F767676;

}  // namespace

template <class T>
const char* ReadScientific(const char* text, T& value) {
  constexpr std::size_t kDigits = kDigitsBehindPoint<T>;
  const bool minus = *text == '-';
  if (minus) ++text;
  const auto first = static_cast<std::uint8_t>(text[0] - '0');
  std::uint64_t tail = LoadWord(text + kDigits - 1) ^ kTail;
  const bool below_one = text[kDigits + 3] == '-';
  if (below_one) tail ^= kOtherSign;
  std::uint64_t wrong = ((tail + kLiftTail) | tail) & 0x8080808080808080;
  std::uint64_t digits = first;
  for (std::size_t i = 0; i + 8 < kDigits; i += 8) {
    const std::uint64_t eight = LoadWord(text + 2 + i) ^ kZeroDigits;
    wrong |= MarkAboveNine(eight);
    digits = digits * 100'000'000 + JoinDigits(eight);
  }
  if (wrong != 0 || first > 9 || text[1] != '.') return nullptr;
  digits = digits * 10 + (tail >> 16 & 0xFF);
  const std::size_t exponent = (tail >> 40 & 0xFF) * 10 + (tail >> 48 & 0xFF);
  if (!Divide(digits, below_one ? kDigits + exponent : kDigits - exponent, value)) return nullptr;
  if (minus) value = -value;
  return text + kDigits + 6;
}

template const char* ReadScientific(const char* text, float& value);
template const char* ReadScientific(const char* text, double& value);

}  // namespace slamdb::orbslam3
