// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <utility>

// Pages are put together by one class, in which text from files cannot become markup.
namespace slamdb::report {

// A text that stands in the program itself: the compiler refuses any other.
struct Literal {
  consteval Literal(const char* literal) : text(literal) {}  // NOLINT(google-explicit-constructor)
  std::string_view text;
};

class Html {
 public:
  // Markup: literals alone.
  Html& operator<<(Literal markup) {
    text_ += markup.text;
    return *this;
  }
  // Text, from wherever: escaped.
  template <std::same_as<std::string> Text>
  Html& operator<<(const Text& text) {
    return Escaped(text);
  }
  // What a library drew or this one encoded, which holds nothing of a file but escaped: a whole <svg> element, or the
  // base64 of a picture.
  Html& Drawn(std::string_view bytes);

  std::string Take() && { return std::move(text_); }

 private:
  Html& Escaped(const std::string& text);

  std::string text_;
};

// A whole page with its policy, which allows its own style and the script that is given, and nothing from elsewhere.
// `script` empty: none.
std::string Page(const std::string& title, const std::string& body, std::string_view script);

// The style of all pages, and the script of the index. Files of this folder.
extern const std::string_view kStyle, kIndexScript;

}  // namespace slamdb::report
