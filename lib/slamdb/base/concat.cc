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

}  // namespace slamdb::detail
