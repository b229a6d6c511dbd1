// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace slamdb::sqlite {

// A number as SQLite's files have it.
template <class Byte>
constexpr std::uint32_t BigEndian32(const Byte* bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

}  // namespace slamdb::sqlite
