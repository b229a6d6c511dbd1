// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace slamdb {

// Numbers as text, appended to a buffer. Never depends on a locale. Reading the digits back gives the same bits, with
// the fewest digits that do; not-a-number is `nan` whatever its sign and payload, infinities are `inf` and `-inf`.
void AppendNumber(std::string& out, float value);
void AppendNumber(std::string& out, double value);
void AppendNumber(std::string& out, std::uint64_t value);
void AppendNumber(std::string& out, std::int64_t value);
template <std::integral Integer>
void AppendNumber(std::string& out, Integer value) {
  using Wide = std::conditional_t<std::is_signed_v<Integer>, std::int64_t, std::uint64_t>;
  AppendNumber(out, static_cast<Wide>(value));
}

// Seconds: as AppendNumber, but never with an exponent, because readers of trajectories expect none.
void AppendSeconds(std::string& out, double seconds);

// The bytes of a number as they are in memory, which is little endian.
template <class Number>
requires std::is_arithmetic_v<Number>
void AppendRaw(std::string& out, Number value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

// For people: 8431 as `8,431`.
std::string Thousands(std::uint64_t value);

// `1 keyframe`, `8,431 keyframes`.
std::string Counted(std::uint64_t count, std::string_view noun);

}  // namespace slamdb
