// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cctype>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/layouts/layout.h"

namespace slamdb {
namespace {

using Kind = LayoutType::Kind;

constexpr std::array<std::string_view, 14> kNumbers{"u8",  "bool", "i16", "u16",  "i32",       "u32",  "u64",
                                                    "i64", "f32",  "f64", "long", "ulonglong", "size", "i8"};
struct Word {
  std::string_view text;
  Kind kind;
};
constexpr std::array<Word, 4> kPlain{
    {{"string", Kind::kString}, {"mat", Kind::kMatrix}, {"mat2", Kind::kMatrix2}, {"kps", Kind::kKeypoints}}};
constexpr std::array<Word, 5> kOfTypes{
    {{"arr", Kind::kArray}, {"vec", Kind::kVector}, {"set", Kind::kSet}, {"list", Kind::kList}, {"map", Kind::kMap}}};
constexpr std::array<Word, 3> kOfClass{{{"ptr", Kind::kPointer}, {"val", Kind::kValue}, {"raw", Kind::kRaw}}};

template <class Words>
const Word* FindWord(const Words& words, std::string_view text) {
  const auto found = std::find_if(words.begin(), words.end(), [&](const Word& word) { return word.text == text; });
  return found == words.end() ? nullptr : &*found;
}
template <class Words>
std::string_view WordOf(const Words& words, Kind kind) {
  const auto found = std::find_if(words.begin(), words.end(), [&](const Word& word) { return word.kind == kind; });
  return found == words.end() ? std::string_view() : found->text;
}

class TypeParser {
 public:
  explicit TypeParser(std::string_view text) : text_(text) {}

  LayoutType Parse() {
    constexpr std::size_t kLongest = 256;
    if (text_.size() > kLongest) Fail(detail::Concat("a type of ", text_.size(), " characters, at most ", kLongest));
    LayoutType type = Type(0);
    if (next_ != text_.size()) Fail("something stands behind the type");
    return type;
  }

 private:
  LayoutType Type(int depth) {
    constexpr int kDeepest = 8;
    if (depth > kDeepest) Fail(detail::Concat("types in types, more than ", kDeepest, " deep"));
    const std::string_view word = TakeName();
    LayoutType type;
    const auto number = std::find(kNumbers.begin(), kNumbers.end(), word);
    if (number != kNumbers.end()) {
      type.number = static_cast<LayoutType::Number>(number - kNumbers.begin());
    } else if (const Word* plain = FindWord(kPlain, word)) {
      type.kind = plain->kind;
    } else if (const Word* of_class = FindWord(kOfClass, word)) {
      type.kind = of_class->kind;
      Expect('<');
      type.name = TakeName();
      if (type.name.empty()) Fail("expected the name of a class");
      Expect('>');
    } else if (const Word* of_types = FindWord(kOfTypes, word)) {
      type.kind = of_types->kind;
      TakeElements(type, depth);
    } else {
      Fail(detail::Concat("no type is called '", word, "'"));
    }
    return type;
  }
  void TakeElements(LayoutType& type, int depth) {
    Expect('<');
    type.elements.push_back(Type(depth + 1));
    if (type.kind == Kind::kArray) {
      Expect(',');
      type.count = TakeCount();
    } else if (type.kind == Kind::kMap) {
      Expect(',');
      type.elements.push_back(Type(depth + 1));
    }
    Expect('>');
  }
  std::string_view TakeName() {
    const std::size_t begin = next_;
    const auto is_of_name = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == ':';
    };
    while (next_ < text_.size() && is_of_name(text_[next_])) ++next_;
    return text_.substr(begin, next_ - begin);
  }
  std::uint32_t TakeCount() {
    constexpr std::uint32_t kMost = 1U << 16;
    const std::string_view digits = TakeName();
    const auto count = detail::ParseNumber<std::uint32_t>(digits);
    if (!count || *count == 0 || *count > kMost)
      Fail(detail::Concat("'", digits, "' is no length, expected 1 to ", kMost));
    return *count;
  }
  void Expect(char c) {
    if (next_ >= text_.size() || text_[next_] != c) Fail(detail::Concat("expected '", c, "'"));
    ++next_;
    while (c == ',' && next_ < text_.size() && text_[next_] == ' ') ++next_;
  }
  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(ErrorKind::kUsage,
                detail::Concat("type '", text_.substr(0, 60), "', character ", next_ + 1, ": ", problem));
  }

  std::string_view text_;
  std::size_t next_ = 0;
};

}  // namespace

LayoutType ParseLayoutType(std::string_view text) { return TypeParser(text).Parse(); }

std::string ToString(const LayoutType& type) {
  switch (type.kind) {
    case Kind::kNumber:
      return std::string(kNumbers[static_cast<std::size_t>(type.number)]);
    case Kind::kString:
    case Kind::kMatrix:
    case Kind::kMatrix2:
    case Kind::kKeypoints:
      return std::string(WordOf(kPlain, type.kind));
    case Kind::kPointer:
    case Kind::kValue:
    case Kind::kRaw:
      return detail::Concat(WordOf(kOfClass, type.kind), "<", type.name, ">");
    default:
      break;
  }
  const std::string_view word = WordOf(kOfTypes, type.kind);
  const std::string element = ToString(type.elements.front());
  if (type.kind == Kind::kMap) return detail::Concat(word, "<", element, ",", ToString(type.elements.back()), ">");
  if (type.kind == Kind::kArray) return detail::Concat(word, "<", element, ",", type.count, ">");
  return detail::Concat(word, "<", element, ">");
}

}  // namespace slamdb
