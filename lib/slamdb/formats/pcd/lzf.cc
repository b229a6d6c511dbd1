// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/pcd/detail/lzf.h"

#include <algorithm>
#include <cstdint>

namespace slamdb::detail {
namespace {

constexpr std::size_t kLiterals = 32;   // a control byte below is a run of literals
constexpr std::size_t kLongLength = 7;  // of a reference: one more byte adds to it
constexpr std::size_t kMostOfThreeBytes = 7 + 255 + 2;

}  // namespace

std::optional<std::string> DecompressLzf(std::string_view compressed, std::size_t size) {
  if (size / kMostOfThreeBytes > compressed.size()) return std::nullopt;
  std::string out(size, '\0');
  std::size_t at = 0, end = 0;
  const auto next = [&] { return static_cast<std::uint8_t>(compressed[at++]); };
  while (at < compressed.size()) {
    const std::size_t control = next();
    if (control < kLiterals) {
      if (compressed.size() - at < control + 1 || size - end < control + 1) return std::nullopt;
      std::copy_n(compressed.data() + at, control + 1, out.data() + end);
      at += control + 1;
      end += control + 1;
      continue;
    }
    std::size_t length = control >> 5;
    if (compressed.size() - at < (length == kLongLength ? 2U : 1U)) return std::nullopt;
    if (length == kLongLength) length += next();
    length += 2;
    const std::size_t back = ((control & 31) << 8 | next()) + 1;
    if (back > end || size - end < length) return std::nullopt;
    for (; length > 0; --length, ++end) out[end] = out[end - back];  // may reach into itself
  }
  return end == size ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace slamdb::detail
