// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace slamdb::orbslam3 {

// Writes a float as printf's `%.9e` does, correctly rounded, at `to`, and returns the end: at most 16 characters
// (`-1.005000000e+02`). Most of a text archive is such numbers; this is several times faster than std::to_chars, to
// which it leaves zeros, subnormals, infinities, NaN and magnitudes outside 1e-17 to 1e9.
char* WriteScientific(char* to, float value);

}  // namespace slamdb::orbslam3
