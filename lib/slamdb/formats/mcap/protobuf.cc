// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/mcap/detail/protobuf.h"

namespace slamdb::detail {

void ProtoAppender::AppendVarint(std::string& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out += static_cast<char>(value | 0x80);
  out += static_cast<char>(value);
}

}  // namespace slamdb::detail
