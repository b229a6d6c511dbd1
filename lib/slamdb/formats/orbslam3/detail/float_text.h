// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

// The floating point numbers of text archives: one digit, a point and the digits behind it, and an exponent of two
// digits (`-1.005000000e+02`). Most of a text archive is such numbers. Both ways give the same bits and bytes as the
// standard library, several times faster; what they leave to it is said below.
namespace slamdb::orbslam3 {

template <class T>
inline constexpr std::size_t kDigitsBehindPoint = sizeof(T) == sizeof(float) ? 9 : 17;

// What ReadScientific may look at, and no number of WriteScientific is longer.
inline constexpr std::size_t kLongestScientific = 32;

// Writes a float or double as printf's `%.9e` and `%.17e` do, correctly rounded, and returns the end. Zeros,
// subnormals, infinities, NaN and magnitudes outside 1e-17 to 1e10 (double: 1e-9 to 1e17) take std::to_chars.
template <class T>
char* WriteScientific(char* to, T value);

// Reads such a number with a space behind it, correctly rounded, and returns its end. Null for every other token, and
// for the few numbers that this way cannot round: `value` is left as it is, and std::from_chars shall read them.
template <class T>
const char* ReadScientific(const char* text, T& value);

}  // namespace slamdb::orbslam3
