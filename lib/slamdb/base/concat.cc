// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/concat.h"

#include <array>
#include <charconv>
#include <cmath>

namespace slamdb::detail {
namespace {

std::string Format(double value, std::chars_format format, int precision) {
  if (std::isnan(value)) return "nan";  // whatever its sign
  std::array<char, 400> text;           // the largest double has 309 digits in front of the point
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, format, precision).ptr;
  return {text.data(), end};
}

}  // namespace

std::string Digits(double value, int significant) { return Format(value, std::chars_format::general, significant); }
std::string Fixed(double value, int decimals) { return Format(value, std::chars_format::fixed, decimals); }

std::string Thousands(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, 1, ',');
  return text;
}

std::string Counted(std::uint64_t count, std::string_view noun) {
  return Concat(Thousands(count), ' ', noun, count == 1 ? "" : "s");
}

}  // namespace slamdb::detail
