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
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t place) {
      return place < bytes.size() ? std::to_integer<std::uint32_t>(bytes[place]) : 0U;
    };
    const std::uint32_t group = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (const int shift : {18, 12, 6, 0}) text += kDigits[group >> shift & 63];
  }
  for (std::size_t missing = (3 - bytes.size() % 3) % 3, place = text.size() - missing; place < text.size(); ++place)
    text[place] = '=';
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
