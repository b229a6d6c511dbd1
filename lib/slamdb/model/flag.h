// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>

namespace slamdb {

// A bool as a file holds it: one byte, which uninitialised memory can make something else than 0 and 1.
// Anything but 0 counts as true.
// The byte itself is kept so that a file can be written back as it was.
struct Flag {
  std::uint8_t recorded = 0;

  constexpr Flag() = default;
  constexpr Flag(bool value) : recorded(value ? 1 : 0) {}    // NOLINT(google-explicit-constructor): it is a bool
  constexpr operator bool() const { return recorded != 0; }  // NOLINT(google-explicit-constructor)

  friend constexpr bool operator==(const Flag&, const Flag&) = default;
};

}  // namespace slamdb
