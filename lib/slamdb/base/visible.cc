// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/visible.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace slamdb::detail {
namespace {

struct CodePoint {
  char32_t value = 0;
  std::size_t bytes = 0;  // 0: no UTF-8 begins here
};

// The code point that a text begins with; overlong forms, surrogates and what is beyond Unicode are none.
CodePoint FirstOf(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
  char32_t value = lead & (0x7fU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return {};
    value = value << 6U | (byte(i) & 0x3fU);
  }
  constexpr std::array<char32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  if (value < kLeast[bytes] || value > 0x10ffff || (value >= 0xd800 && value < 0xe000)) return {};
  return {value, bytes};
}

// What cannot be seen, or moves what stands beside it. Ranges, both ends included, ascending.
bool IsHidden(char32_t value) {
  struct Range {
    char32_t first, last;
  };
  static constexpr std::array kHidden = {
      Range{0x00, 0x1f},       Range{0x7f, 0x9f},       Range{0xad, 0xad},     Range{0x34f, 0x34f},
      Range{0x61c, 0x61c},     Range{0x115f, 0x1160},   Range{0x17b4, 0x17b5}, Range{0x180b, 0x180f},
      Range{0x200b, 0x200f},   Range{0x2028, 0x202e},   Range{0x2060, 0x206f}, Range{0x3164, 0x3164},
      Range{0xfe00, 0xfe0f},   Range{0xfeff, 0xfeff},   Range{0xffa0, 0xffa0}, Range{0xfff0, 0xfffb},
      Range{0x1d173, 0x1d17a}, Range{0xe0000, 0xe0fff},
  };
  return std::any_of(kHidden.begin(), kHidden.end(),
                     [value](const Range& range) { return value >= range.first && value <= range.last; });
}

void AppendHex(std::string& out, std::string_view mark, std::uint32_t value, int digits) {
  out += mark;
  for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) out += "0123456789abcdef"[value >> shift & 0xfU];
}

void AppendEscaped(std::string& out, char32_t value) {
  if (value == '\n')
    out += "\\n";
  else if (value == '\r')
    out += "\\r";
  else if (value == '\t')
    out += "\\t";
  else if (value == 0x1b)
    out += "\\e";
  else if (value < 0x80)
    AppendHex(out, "\\x", value, 2);
  else
    AppendHex(out, value > 0xffff ? "\\U" : "\\u", value, value > 0xffff ? 8 : 4);
}

// How many letters a text begins with of which nothing can be hidden: those of ASCII that can be seen.
std::size_t PlainLetters(std::string_view text) {
  const auto* end = std::ranges::find_if(text, [](char letter) { return !(letter >= ' ' && letter < 0x7f); });
  return static_cast<std::size_t>(end - text.begin());
}

std::string Escaped(std::string_view text, std::string_view kept) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    if (const std::size_t plain = PlainLetters(text); plain > 0) {
      out += text.substr(0, plain);
      text.remove_prefix(plain);
      continue;
    }
    const CodePoint first = FirstOf(text);
    const std::size_t bytes = std::max<std::size_t>(first.bytes, 1);
    if (first.bytes == 0)
      AppendHex(out, "\\x", static_cast<unsigned char>(text[0]), 2);
    else if (IsHidden(first.value) && (first.value >= 0x80 || kept.find(text[0]) == std::string_view::npos))
      AppendEscaped(out, first.value);
    else
      out += text.substr(0, bytes);
    text.remove_prefix(bytes);
  }
  return out;
}

}  // namespace

std::string Visible(std::string_view text) { return Escaped(text, {}); }
std::string VisibleText(std::string_view text) { return Escaped(text, "\n\t"); }

std::string_view ProblemOfName(std::string_view name) {
  constexpr std::size_t kLongest = 255;
  if (name.empty()) return "is empty";
  if (name.size() > kLongest) return "has more than 255 bytes";
  if (Visible(name) != name) return "has control characters, or others that cannot be seen, or is no UTF-8";
  return {};
}

}  // namespace slamdb::detail
