// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

// C++ sources as words and signs, as far as finding serialize functions asks for it.
namespace slamdb::layouts {

struct CppToken {
  enum class Kind : std::uint8_t { kWord, kNumber, kText, kSign } kind = Kind::kSign;
  std::string_view text;  // of a string literal what stands between the quotes; a sign is one character, or `::`
  std::uint32_t line = 0;

  bool Is(std::string_view other) const { return text == other && kind != Kind::kText; }
  bool is_word() const { return kind == Kind::kWord; }
};
using CppTokens = std::vector<CppToken>;

struct CppText {
  CppTokens tokens;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> skipped;  // lines of branches (#else) that were not looked at
};

// Without comments and preprocessor lines. Of `#if 0` the other branch counts, of every other condition the first one.
// The tokens refer to the text.
CppText TokensOf(std::string_view source);

}  // namespace slamdb::layouts
