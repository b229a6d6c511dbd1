// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/number.h"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>

namespace slamdb {
namespace {

static_assert(std::endian::native == std::endian::little, "AppendRaw writes memory as it is");

template <class Number>
void AppendDigits(std::string& out, Number value) {
  std::array<char, 32> digits;  // the longest: -2.2250738585072014e-308
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  out.append(digits.data(), result.ptr);
}

// to_chars writes `-nan` when the sign bit is set, which few readers take.
template <class Real>
void AppendReal(std::string& out, Real value) {
  if (std::isnan(value))
    out += "nan";
  else
    AppendDigits(out, value);
}

}  // namespace

void AppendNumber(std::string& out, float value) { AppendReal(out, value); }
void AppendNumber(std::string& out, double value) { AppendReal(out, value); }
void AppendNumber(std::string& out, std::uint64_t value) { AppendDigits(out, value); }
void AppendNumber(std::string& out, std::int64_t value) { AppendDigits(out, value); }

void AppendSeconds(std::string& out, double seconds) {
  if (!std::isfinite(seconds)) return AppendNumber(out, seconds);
  std::array<char, 1100> digits;  // the smallest doubles have 1074 digits behind the point
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), seconds, std::chars_format::fixed);
  out.append(digits.data(), result.ptr);
}

std::string Thousands(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, 1, ',');
  return text;
}

std::string Counted(std::uint64_t count, std::string_view noun) {
  return Thousands(count) + ' ' + std::string(noun) + (count == 1 ? "" : "s");
}

}  // namespace slamdb
