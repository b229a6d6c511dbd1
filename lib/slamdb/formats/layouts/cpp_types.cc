// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/detail/cpp_types.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/formats/layouts/layout.h"

namespace slamdb::layouts {
namespace {

using Tokens = std::span<const CppToken>;

constexpr int kDeepest = 16;

struct Named {
  std::string_view name, word;
};
constexpr std::array kScalars = {
    // the last three are DBoW2's
    Named{"bool", "bool"},     Named{"float", "f32"},          Named{"double", "f64"},  Named{"string", "string"},
    Named{"size_t", "size"},   Named{"int8_t", "i8"},          Named{"uint8_t", "u8"},  Named{"uchar", "u8"},
    Named{"int16_t", "i16"},   Named{"uint16_t", "u16"},       Named{"int32_t", "i32"}, Named{"uint32_t", "u32"},
    Named{"int64_t", "i64"},   Named{"uint64_t", "ulonglong"}, Named{"Mat", "mat"},     Named{"WordId", "u32"},
    Named{"WordValue", "f64"}, Named{"NodeId", "u32"},         Named{"ushort", "u16"},
};
// Eigen's and Sophus' types of fixed size, without their last letter.
struct Fixed {
  std::string_view name;
  std::size_t count;
};
constexpr std::array kFixed = {
    Fixed{"Vector2", 2}, Fixed{"Vector3", 3},  Fixed{"Vector4", 4},    Fixed{"Matrix2", 4},
    Fixed{"Matrix3", 9}, Fixed{"Matrix4", 16}, Fixed{"Quaternion", 4}, Fixed{"RowVector3", 3},
    Fixed{"SE3", 7},     Fixed{"Sim3", 7},     Fixed{"SO3", 4},        Fixed{"AngleAxis", 4},
};

std::string ScalarOfLetter(char letter) {
  if (letter == 'f') return "f32";
  if (letter == 'd') return "f64";
  return letter == 'i' ? "i32" : "";
}

bool IsIntegerWord(std::string_view word) {
  return word == "unsigned" || word == "signed" || word == "long" || word == "short" || word == "int" || word == "char";
}

// `long unsigned int`, in any order.
std::string Integer(Tokens type) {
  const auto count = [&](std::string_view word) {
    return std::ranges::count_if(type, [&](const CppToken& token) { return token.Is(word); });
  };
  if (type.empty() || !std::ranges::all_of(type, [](const CppToken& token) { return IsIntegerWord(token.text); }))
    return "";
  const std::string sign = count("unsigned") > 0 ? "u" : "i";
  if (count("char") > 0) return sign + "8";
  if (count("short") > 0) return sign + "16";
  if (count("long") == 0) return sign + "32";
  if (count("long") == 1) return sign == "u" ? "u64" : "long";
  return sign == "u" ? "ulonglong" : "i64";
}

// The arguments between `<` and `>`, split at commas.
std::vector<Tokens> Arguments(Tokens list) {
  std::vector<Tokens> arguments;
  int depth = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].Is("<") || list[i].Is("(")) ++depth;
    if (list[i].Is(">") || list[i].Is(")")) --depth;
    if (depth > 0 || !list[i].Is(",")) continue;
    arguments.push_back(list.subspan(begin, i - begin));
    begin = i + 1;
  }
  if (begin < list.size()) arguments.push_back(list.subspan(begin));
  return arguments;
}

// Where `<` of the outermost template stands; size when there is none.
std::size_t TemplateBegin(Tokens type) {
  return static_cast<std::size_t>(std::ranges::find_if(type, [](const CppToken& token) { return token.Is("<"); }) -
                                  type.begin());
}

// 0 when it is no number, or too large a one.
std::size_t Number(Tokens tokens) {
  std::size_t number = 0;
  if (tokens.size() != 1) return 0;
  const std::string_view text = tokens[0].text;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number > 1U << 20U ? 0 : number;
}

}  // namespace

namespace {

Tokens WithoutSpecifiers(Tokens type) {
  while (!type.empty() && (type.front().Is("const") || type.front().Is("typename") || type.front().Is("struct") ||
                           type.front().Is("class") || type.front().Is("static") || type.front().Is("::")))
    type = type.subspan(1);
  while (!type.empty() && (type.back().Is("&") || type.back().Is("const"))) type = type.first(type.size() - 1);
  return type;
}

// `GlobalPosition::Calib` of `ORB_SLAM3::GlobalPosition::Calib`; empty when there are no namespaces.
std::string LastTwoNames(Tokens type) {
  type = WithoutSpecifiers(type);
  while (!type.empty() && type.back().Is("*")) type = type.first(type.size() - 1);
  const std::size_t size = type.size();
  if (size < 3 || !type[size - 1].is_word() || !type[size - 2].Is("::") || !type[size - 3].is_word()) return "";
  return std::string(type[size - 3].text) + "::" + std::string(type[size - 1].text);
}

}  // namespace

Tokens WithoutQualifiers(Tokens type) {
  type = WithoutSpecifiers(type);
  // Namespaces and outer classes: `a::b::` in front of the last name.
  while (type.size() > 2 && type[0].is_word() && type[1].Is("::") && type[2].is_word()) type = type.subspan(2);
  return type;
}

std::string CppTypes::NameOf(Tokens type) {
  type = WithoutQualifiers(type);
  return type.empty() || !type.front().is_word() ? "" : std::string(type.front().text);
}

Tokens CppTypes::Resolved(Tokens type, std::string_view in_class) const {
  for (int depth = 0; depth < kDeepest; ++depth) {
    type = WithoutQualifiers(type);
    if (type.size() != 1) break;
    const auto owner = index_.classes.find(in_class);
    const CppTokens* alias = nullptr;
    if (owner != index_.classes.end())
      if (const auto found = owner->second.aliases.find(type[0].text); found != owner->second.aliases.end())
        alias = &found->second;
    if (alias == nullptr)
      if (const auto found = index_.aliases.find(type[0].text); found != index_.aliases.end()) alias = &found->second;
    if (alias == nullptr) break;
    type = *alias;
  }
  return type;
}

// What no layout can say, such as types too deep in each other, is not known either.
std::string CppTypes::WordOf(Tokens type, std::string_view in_class) const {
  std::string word = WordOf(type, in_class, 0);
  try {
    if (word != kUnknownType) (void)ParseLayoutType(word);
  } catch (const Error&) {
    return std::string(kUnknownType);
  }
  return word;
}

std::string CppTypes::WordOf(Tokens type, std::string_view in_class, int depth) const {
  const std::string unknown(kUnknownType);
  if (const std::string qualified = LastTwoNames(type); index_.classes.contains(qualified))
    return (type.back().Is("*") ? "ptr<" : "val<") + qualified + ">";
  type = Resolved(type, in_class);
  if (type.empty() || depth > kDeepest) return unknown;
  if (type.back().Is("*")) {
    const std::string name = NameOf(Resolved(type.first(type.size() - 1), in_class));
    return name.empty() ? unknown : "ptr<" + name + ">";
  }
  if (const std::string integer = Integer(type); !integer.empty()) return integer;
  const std::size_t begin = TemplateBegin(type);
  if (begin < type.size() && type.back().Is(">"))
    return Template(type.front().text, type.subspan(begin + 1, type.size() - begin - 2), in_class, depth);
  if (type.size() != 1) return unknown;
  for (const Named& scalar : kScalars)
    if (scalar.name == type[0].text) return std::string(scalar.word);
  // DBoW2 may be a library that stands elsewhere.
  const bool of_dbow2 = type[0].text == "BowVector" || type[0].text == "FeatureVector";
  if (of_dbow2 || index_.classes.contains(type[0].text)) return "val<" + std::string(type[0].text) + ">";
  return unknown;
}

std::string CppTypes::Template(std::string_view name, Tokens list, std::string_view in_class, int depth) const {
  static constexpr std::array kContainers = {Named{"vector", "vec"}, Named{"set", "set"}, Named{"list", "list"},
                                             Named{"deque", "vec"}, Named{"map", "map"}};
  const std::string unknown(kUnknownType);
  const auto container = std::ranges::find(kContainers, name, &Named::name);
  const std::vector<Tokens> arguments = Arguments(list);
  const std::size_t wanted = name == "map" ? 2 : 1;
  if (container == kContainers.end() || arguments.size() < wanted) return unknown;
  std::string word(container->word);
  for (std::size_t i = 0; i < wanted; ++i) {
    const std::string argument = WordOf(arguments[i], in_class, depth + 1);
    if (argument == unknown) return unknown;
    word += (i == 0 ? "<" : ",") + argument;
  }
  return word + ">";
}

CppTypes::Array CppTypes::ArrayOf(Tokens type, std::string_view in_class) const {
  type = Resolved(type, in_class);
  if (type.empty()) return {};
  const std::string_view name = type.front().text;
  const std::size_t begin = TemplateBegin(type);
  if (begin < type.size()) {
    const std::vector<Tokens> arguments = Arguments(type.subspan(begin + 1, type.size() - begin - 2));
    if (arguments.empty()) return {};
    Array array{.scalar = WordOf(arguments[0], in_class)};
    for (const Fixed& fixed : kFixed)
      if (name == fixed.name) array.count = fixed.count;
    const std::size_t rows = arguments.size() > 1 ? Number(arguments[1]) : 0;
    const std::size_t columns = arguments.size() > 2 ? Number(arguments[2]) : 0;
    if (name == "Matrix" || name == "Array") array.count = rows * columns;
    if (name == "DiagonalMatrix" || name == "array" || name == "Vector") array.count = rows;
    return array.count > 0 ? array : Array{};
  }
  if (type.size() != 1 || name.empty()) return {};
  for (const Fixed& fixed : kFixed)
    if (name.substr(0, name.size() - 1) == fixed.name && !ScalarOfLetter(name.back()).empty())
      return {ScalarOfLetter(name.back()), fixed.count};
  return {};
}

}  // namespace slamdb::layouts
