// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

#include "slamdb/export.h"

// How sentences are built everywhere in slamdb. Nothing here depends on a locale.
namespace slamdb::detail {

// A number with at most so many significant digits and without trailing zeros: `0.125`, `1.5e+09`, `nan`.
SLAMDB_EXPORT std::string Digits(double value, int significant = 6);
// A number with exactly so many decimals: `12.50`.
SLAMDB_EXPORT std::string Fixed(double value, int decimals);
// 8431 as `8,431`.
SLAMDB_EXPORT std::string Thousands(std::uint64_t value);
// `1 keyframe`, `8,431 keyframes`.
SLAMDB_EXPORT std::string Counted(std::uint64_t count, std::string_view noun);

inline void AppendPart(std::string& text, std::string_view part) { text += part; }
inline void AppendPart(std::string& text, char part) { text += part; }
inline void AppendPart(std::string& text, double value) { text += Digits(value); }
template <std::integral Integer>
void AppendPart(std::string& text, Integer value) {
  text += std::to_string(value);
}
// Whatever has a ToString of its own, as ids have: `kf 12`.
template <class Named>
requires requires(const Named& named) { ToString(named); }
void AppendPart(std::string& text, const Named& named) { text += ToString(named); }

// The parts one behind the other: text, integers, doubles in six significant digits, and what has a ToString.
template <class... Parts>
std::string Concat(const Parts&... parts) {
  std::string text;
  (AppendPart(text, parts), ...);
  return text;
}

}  // namespace slamdb::detail
