// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/text.h"

#include <array>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

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

bool IsUtf16(std::string_view text) { return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"); }

std::string_view WithoutMark(std::string_view text) {
  if (IsUtf16(text)) throw Error(ErrorKind::kUnsupported, "is text in UTF-16, expected UTF-8; save it as that");
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

std::string Excerpt(std::string_view line) {
  constexpr std::size_t kLongest = 80;
  return Concat('`', line.substr(0, kLongest), '`');
}

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

}  // namespace slamdb::detail
