// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "slamdb/base/file.h"

namespace slamdb::detail {

// XXH3-64: tells whether two records are the same, at memory speed. Not against an adversary.
std::uint64_t HashBytes(Bytes bytes, std::uint64_t seed = 0);

// XXH3-128: two records of one collection that have it in common are the same. Not against an adversary.
std::array<std::byte, 16> Hash128(Bytes bytes);

// MD5 as 32 lower-case hex digits: how ORB-SLAM3 identifies a vocabulary file.
std::string Md5(Bytes bytes);

// 16 lower-case hex digits.
std::string Hex(std::uint64_t value);

}  // namespace slamdb::detail
