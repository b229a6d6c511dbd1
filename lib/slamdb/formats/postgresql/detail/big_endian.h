// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

namespace slamdb::postgresql {

// Integers as PostgreSQL's binary formats and protocol have them.
template <std::integral Integer>
Integer BigEndian(const std::byte* bytes) {
  std::make_unsigned_t<Integer> value = 0;
  for (std::size_t i = 0; i < sizeof(Integer); ++i)
    value = static_cast<std::make_unsigned_t<Integer>>(static_cast<std::uint64_t>(value) << 8U |
                                                       static_cast<std::uint8_t>(bytes[i]));
  return static_cast<Integer>(value);
}

template <std::integral Integer>
void AppendBigEndian(std::string& out, Integer value) {
  std::array<char, sizeof(Integer)> bytes;
  auto rest = static_cast<std::uint64_t>(value);
  for (std::size_t i = bytes.size(); i-- > 0; rest >>= 8U) bytes[i] = static_cast<char>(rest & 0xffU);
  out.append(bytes.data(), bytes.size());
}

}  // namespace slamdb::postgresql
