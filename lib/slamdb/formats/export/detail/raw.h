// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstring>
#include <string>
#include <type_traits>

namespace slamdb::detail {

static_assert(std::endian::native == std::endian::little, "AppendRaw writes memory as it is");

// The bytes of a number as they are in memory, which is little endian.
template <class Number>
requires std::is_arithmetic_v<Number>
void AppendRaw(std::string& out, Number value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

}  // namespace slamdb::detail
