// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/markup.h"

#include <sha2.h>

#include <array>
#include <cstdint>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/visible.h"

namespace slamdb::detail {

std::string EscapedMarkup(std::string_view text) {
  std::string escaped;
  for (const char letter : Visible(text)) {
    switch (letter) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += letter;
    }
  }
  return escaped;
}

std::string Base64(Bytes bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  const auto* in = reinterpret_cast<const std::uint8_t*>(bytes.data());
  char* out = text.data();
  std::size_t left = bytes.size();
  for (; left >= 3; left -= 3, in += 3, out += 4) {
    const std::uint32_t three = std::uint32_t{in[0]} << 16 | std::uint32_t{in[1]} << 8 | in[2];
    out[0] = kDigits[three >> 18];
    out[1] = kDigits[three >> 12 & 63];
    out[2] = kDigits[three >> 6 & 63];
    out[3] = kDigits[three & 63];
  }
  if (left == 0) return text;
  const std::uint32_t rest = std::uint32_t{in[0]} << 16 | (left == 2 ? std::uint32_t{in[1]} << 8 : 0);
  out[0] = kDigits[rest >> 18];
  out[1] = kDigits[rest >> 12 & 63];
  if (left == 2) out[2] = kDigits[rest >> 6 & 63];
  return text;
}

std::string PolicySource(std::string_view inline_text) {
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest{};
  SHA2_CTX context;
  SHA256Init(&context);
  SHA256Update(&context, reinterpret_cast<const std::uint8_t*>(inline_text.data()), inline_text.size());
  SHA256Final(digest.data(), &context);
  return Concat("'sha256-", Base64(std::as_bytes(std::span(digest))), "'");
}

}  // namespace slamdb::detail
