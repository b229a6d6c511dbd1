// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace slamdb::postgresql {

// The types of columns that slamdb has. Bytes of each as PostgreSQL's send functions make them.
enum class Type : std::uint8_t {
  kBool,
  kInt2,
  kInt4,
  kInt8,
  kFloat4,
  kFloat8,
  kText,
  kBytea,
  kUuid,  // 16 bytes
  kBits,  // of a length that is a multiple of 8
  kInt4Array,
  kInt8Array,
};

// The numbers under which PostgreSQL knows types, in the binary form of arrays and of parameters; fixed for ever
// (pg_type.dat).
namespace oid {
constexpr std::uint32_t kBool = 16, kBytea = 17, kInt8 = 20, kInt4 = 23, kText = 25, kFloat8 = 701, kUuid = 2950;
constexpr std::uint32_t kBit = 1560;
constexpr std::uint32_t kByteaArray = 1001, kInt4Array = 1007, kTextArray = 1009, kInt8Array = 1016, kUuidArray = 2951;
}  // namespace oid

}  // namespace slamdb::postgresql
