// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <charconv>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/layouts/detail/source_layout.h"

namespace slamdb::layouts {
namespace {

using Tokens = std::span<const CppToken>;

bool Has(Tokens tokens, std::string_view text) {
  return std::ranges::any_of(tokens, [&](const CppToken& token) { return token.Is(text); });
}

// As it was written, for people.
std::string TextOf(Tokens tokens) {
  constexpr std::size_t kLongest = 60;
  std::string text;
  for (std::size_t i = 0; i < tokens.size() && text.size() < kLongest; ++i) {
    const bool apart = i > 0 && tokens[i].is_word() && tokens[i - 1].is_word();
    text.append(apart ? " " : "").append(tokens[i].text);
  }
  return text;
}

// Where the template arguments that open at `from` end: behind `>`.
std::size_t EndOfTemplate(Tokens tokens, std::size_t from) {
  int depth = 0;
  for (std::size_t i = from; i < tokens.size(); ++i) {
    if (tokens[i].Is("<")) ++depth;
    if (tokens[i].Is(">") && --depth == 0) return i + 1;
  }
  return tokens.size();
}

std::size_t EndOf(Tokens tokens, std::size_t from) {
  std::size_t depth = 0;
  for (std::size_t i = from; i < tokens.size(); ++i) {
    if (tokens[i].Is("(") || tokens[i].Is("[") || tokens[i].Is("{")) ++depth;
    if ((tokens[i].Is(")") || tokens[i].Is("]") || tokens[i].Is("}")) && --depth == 0) return i + 1;
  }
  return tokens.size();
}

// Cuts at signs of one kind that stand in no braces and no template arguments.
std::vector<Tokens> Split(Tokens tokens, std::string_view sign, bool doubled = false) {
  std::vector<Tokens> parts;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < tokens.size();) {
    const bool is_sign = tokens[i].Is(sign) && (!doubled || (i + 1 < tokens.size() && tokens[i + 1].Is(sign)));
    if (is_sign) {
      parts.push_back(tokens.subspan(begin, i - begin));
      i += doubled ? 2 : 1;
      begin = i;
    } else if (tokens[i].Is("(") || tokens[i].Is("[")) {
      i = EndOf(tokens, i);
    } else if (tokens[i].Is("<") && i > 0 && tokens[i - 1].is_word() &&
               !(i + 1 < tokens.size() && tokens[i + 1].Is("<"))) {
      i = EndOfTemplate(tokens, i);
    } else {
      ++i;
    }
  }
  parts.push_back(tokens.subspan(begin));
  return parts;
}

Tokens WithoutParentheses(Tokens tokens) {
  while (tokens.size() > 2 && tokens.front().Is("(") && EndOf(tokens, 0) == tokens.size())
    tokens = tokens.subspan(1, tokens.size() - 2);
  return tokens;
}

// What helper functions of ORB-SLAM3's sources write; empty: it depends on the member.
struct HelperWord {
  std::string_view name, word;
};
constexpr std::array kHelpers = {HelperWord{"serializeMatrix", ""},
                                 HelperWord{"serializeVectorKeyPoints", "kps"},
                                 HelperWord{"serializeSophusSE3", "arr"},
                                 HelperWord{"serializeDiagonalMatrix", "arr"},
                                 HelperWord{"serializeEigenMatrix", "arr"},
                                 HelperWord{"serializeEigenVector", "arr"},
                                 HelperWord{"serializeEigenQuaternion", "arr"}};

// Members of OpenCV's key points, which no source of the fork declares.
std::string MemberOfKeyPoint(std::string_view name) {
  if (name == "class_id" || name == "octave") return "i32";
  for (const std::string_view number : {"angle", "response", "size", "x", "y"})
    if (name == number) return "f32";
  return "";
}

}  // namespace

std::string FirstParameter(std::span<const CppToken> parameters) {
  std::string name = "ar";
  for (const CppToken& token : parameters) {
    if (token.Is(",")) break;
    if (token.is_word()) name = token.text;
  }
  return name;
}

SerializeBody::SerializeBody(const CppIndex& index, const CppFunction& function, std::vector<SourceQuestion>& questions)
    : index_(index), function_(function), questions_(questions), types_(index), body_(function.body) {
  for (const Tokens parameter : Split(function.parameters, ",")) MembersOfDeclaration(parameter, locals_);
}

void SerializeBody::Read(std::string_view archive, bool all_branches) {
  archive_ = archive;
  all_branches_ = all_branches;
  while (at_ < body_.size()) Step();
  if (function_.skips_lines)
    Ask(body_, "code behind #else was not looked at; check that what stands before it is what was compiled");
}

// ---- Statements

void SerializeBody::Step() {
  const CppToken& token = body_[at_];
  if (token.Is("{") || token.Is("}") || token.Is(";")) {
    ++at_;
    return;
  }
  if (token.Is("if")) return If();
  const std::size_t end = EndOfStatement(at_);
  const Tokens statement = body_.subspan(at_, end - at_);
  if (token.Is("else")) {
    ++at_;
    if (was_loading_ || all_branches_ || (at_ < body_.size() && body_[at_].Is("if"))) return;
    at_ = end;
    if (Archives(statement)) AskMember(statement, "(condition)", "a condition decides what is archived");
  } else if (token.Is("for") || token.Is("while") || token.Is("do") || token.Is("switch") || token.Is("try")) {
    if (token.Is("try") || all_branches_) {
      ++at_;
      return;
    }
    at_ = end;
    if (Archives(statement)) AskMember(statement, "(loop)", "a loop archives an unknown number of values");
  } else {
    at_ = end;
    Simple(statement);
  }
}

void SerializeBody::If() {
  const std::size_t open = at_ + 1;
  const std::size_t close = open < body_.size() ? EndOf(body_, open) : body_.size();
  const Tokens condition = body_.subspan(std::min(open, close), close - std::min(open, close));
  const std::size_t end = EndOfStatement(close);
  const Tokens branch = body_.subspan(close, end - close);
  const bool negated = Has(condition, "!");
  was_loading_ = Has(condition, negated ? "is_saving" : "is_loading");
  const bool saving = Has(condition, negated ? "is_loading" : "is_saving");
  at_ = close;
  if (saving || all_branches_) return;
  at_ = end;
  if (!was_loading_ && Archives(branch))
    AskMember(branch, "(condition)", detail::Concat("a condition decides what is archived: ", TextOf(condition)));
}

// Behind its `;` or its block.
std::size_t SerializeBody::EndOfStatement(std::size_t from) const {
  for (std::size_t i = from; i < body_.size();) {
    if (body_[i].Is(";")) return i + 1;
    if (body_[i].Is("{")) return EndOf(body_, i);
    i = body_[i].Is("(") || body_[i].Is("[") ? EndOf(body_, i) : i + 1;
  }
  return body_.size();
}

bool SerializeBody::Archives(Tokens tokens) const { return Has(tokens, archive_); }

void SerializeBody::Simple(Tokens statement) {
  if (!statement.empty() && statement.back().Is(";")) statement = statement.first(statement.size() - 1);
  if (statement.empty()) return;
  const bool makes_it = statement.size() > 1 && statement[statement.size() - 1].Is(")") &&
                        (Has(statement, "binary_oarchive") || Has(statement, "text_oarchive"));
  if (!Archives(statement) || makes_it) return MembersOfDeclaration(statement, locals_);
  const bool begins = statement.front().Is(archive_) && statement.size() > 2;
  if (begins && (statement[1].Is("&") || (statement[1].Is("<") && statement[2].Is("<")))) return Operands(statement);
  if (begins && statement[1].Is(">") && statement[2].Is(">")) return;  // of loading
  if (begins && statement[1].Is(".")) return Method(statement);
  if (!Helper(statement)) AskMember(statement, "(statement)", detail::Concat("not understood: ", TextOf(statement)));
}

// `ar & a & b`, `ar << a << b`.
void SerializeBody::Operands(Tokens list) {
  const bool shifts = list[1].Is("<");
  const std::vector<Tokens> operands = Split(list, shifts ? "<" : "&", shifts);
  for (std::size_t i = 1; i < operands.size(); ++i) Operand(operands[i]);
}

// `ar.template register_type<Pinhole>()`, `ar.register_type(static_cast<Pinhole*>(NULL))`.
void SerializeBody::Method(Tokens call) {
  if (!Has(call, "register_type")) return AskMember(call, "(call)", detail::Concat("not understood: ", TextOf(call)));
  std::string name;
  for (std::size_t i = 0; i < call.size(); ++i)
    if (call[i].Is("<")) {
      Tokens type = call.subspan(i + 1, EndOfTemplate(call, i) - i - 2);
      while (!type.empty() && type.back().Is("*")) type = type.first(type.size() - 1);
      name = CppTypes::NameOf(type);
      break;
    }
  if (name.empty()) return Ask(call, detail::Concat("a class is registered that was not recognised: ", TextOf(call)));
  registers.push_back(name);
}

// `serializeMatrix<Archive>(ar, mDescriptors, version)`.
bool SerializeBody::Helper(Tokens call) {
  const auto open = static_cast<std::size_t>(
      std::ranges::find_if(call, [](const CppToken& token) { return token.Is("("); }) - call.begin());
  if (open == 0 || open == call.size()) return false;
  std::string_view name;
  for (std::size_t i = 0; i < open; ++i) {
    if (call[i].is_word()) name = call[i].text;
    if (call[i].Is("<")) break;
  }
  const std::vector<Tokens> arguments = Split(call.subspan(open + 1, EndOf(call, open) - open - 2), ",");
  if (arguments.size() < 2 || arguments[0].size() != 1 || !arguments[0][0].Is(archive_)) return false;
  if (name == "split_member" || name == "split_free") return true;  // the caller reads `save`
  return HelperOf(name, arguments[1]);
}

bool SerializeBody::HelperOf(std::string_view helper, Tokens argument) {
  const auto known = std::ranges::find(kHelpers, helper, &HelperWord::name);
  const Variable variable = Find(argument);
  if (known == kHelpers.end()) return OwnHelper(helper, variable);
  const CppTypes::Array array = types_.ArrayOf(variable.member.type, variable.in_class);
  if (known->word == "kps" || (known->word.empty() && array.count == 0)) {
    members.push_back({variable.name, known->word.empty() ? "mat" : "kps"});
    return true;
  }
  if (array.count > 0) {
    AddArray(variable.name, array);
    return true;
  }
  AskMember(argument, variable.name, detail::Concat("the type of ", TextOf(argument), " is not known"));
  return true;
}

// A function of the sources' own: what it archives belongs to the member.
bool SerializeBody::OwnHelper(std::string_view helper, const Variable& variable) {
  const std::vector<const CppFunction*> functions = index_.Find("", helper);
  if (functions.empty() || depth_ >= kDeepestHelper) return false;
  CppFunction function = *functions.front();
  function.owner = CppTypes::NameOf(variable.member.type);
  SerializeBody body(index_, function, questions_);
  body.depth_ = depth_ + 1;
  body.Read(FirstParameter(function.parameters), /*all_branches=*/false);
  for (SourceMember& member : body.members) members.push_back({variable.name + "." + member.name, member.type});
  return true;
}

// ---- Operands

void SerializeBody::Operand(Tokens expression) {
  expression = WithoutParentheses(expression);
  if (expression.empty()) return Ask(body_, "an operand is missing");
  // `(float&)x`: a cast.
  if (expression.front().Is("(")) {
    const std::size_t close = EndOf(expression, 0);
    Variable variable = Find(expression.subspan(close));
    const Tokens type = expression.subspan(1, close - 2);
    variable.member = {{type.begin(), type.end()}, {}};
    variable.known = true;
    return Add(variable, expression);
  }
  // A call: `const_cast<T&>(x)`, `boost::serialization::make_array(x.data(), 3)`.
  std::string_view name;
  std::size_t i = 0;
  for (; i < expression.size() && (expression[i].is_word() || expression[i].Is("::")); ++i)
    if (expression[i].is_word()) name = expression[i].text;
  Tokens type;
  if (i < expression.size() && expression[i].Is("<")) {
    const std::size_t end = EndOfTemplate(expression, i);
    type = expression.subspan(i + 1, end - i - 2);
    i = end;
  }
  if (i < expression.size() && expression[i].Is("(") && EndOf(expression, i) == expression.size())
    return Call(name, type, expression.subspan(i + 1, expression.size() - i - 2), expression);
  Add(Find(expression), expression);
}

void SerializeBody::Call(std::string_view name, Tokens type, Tokens arguments, Tokens expression) {
  if (name == "const_cast" || name == "static_cast" || name == "reinterpret_cast") {
    Variable variable = Find(arguments);
    variable.member = {{type.begin(), type.end()}, {}};
    variable.known = true;
    return Add(variable, expression);
  }
  if (name == "base_object") {
    const std::string word = types_.WordOf(type, function_.owner);
    if (word == kUnknownType)
      return AskMember(expression, "base", detail::Concat("the base class ", TextOf(type), " is not known"));
    const bool whole = arguments.empty() || Has(arguments, "this");
    members.push_back({whole ? "base" : Find(arguments).name, word});
    return;
  }
  if (name == "make_nvp") {
    const std::vector<Tokens> parts = Split(arguments, ",");
    return Operand(parts.back());
  }
  if (name == "BOOST_SERIALIZATION_NVP") return Operand(arguments);
  if (name == "BOOST_SERIALIZATION_BASE_OBJECT_NVP") return Call("base_object", arguments, {}, expression);
  if (name == "make_array") return MakeArray(arguments, expression);
  AskMember(expression, "(call)", detail::Concat("not understood: ", TextOf(expression)));
}

// `make_array(dR.data(), dR.size())`, `make_array(values, 3)`, `make_array(&values[0], 3)`.
void SerializeBody::MakeArray(Tokens arguments, Tokens expression) {
  const std::vector<Tokens> parts = Split(arguments, ",");
  const auto unknown = [&] {
    AskMember(expression, "(array)", detail::Concat("an array of unknown length: ", TextOf(expression)));
  };
  if (parts.size() != 2 || parts[0].empty() || parts[1].empty()) return unknown();
  Tokens data = parts[0];
  while (!data.empty() && data.front().Is("&")) data = data.subspan(1);
  for (const std::string_view method : {"data", "diagonal", "ptr", "coeffs"})
    if (data.size() > 4 && data[data.size() - 2].Is("(") && data[data.size() - 3].Is(method))
      data = data.first(data.size() - 4);
  const Variable variable = Find(data);
  CppTypes::Array array = types_.ArrayOf(variable.member.type, variable.in_class);
  std::size_t count = 0;
  const std::string_view size = parts[1].front().text;
  std::from_chars(size.data(), size.data() + size.size(), count);
  if (array.count > 0 && parts[1].size() == 1 && count > 0) array.count = count;
  if (array.count == 0 && parts[1].size() == 1 && count > 0)
    array = {types_.WordOf(variable.member.type, variable.in_class), count};
  if (array.count == 0 || array.scalar.empty() || array.scalar == kUnknownType) return unknown();
  AddArray(variable.name, array);
}

void SerializeBody::AddArray(const std::string& name, const CppTypes::Array& array) {
  members.push_back({name, detail::Concat("arr<", array.scalar, ",", array.count, ">")});
}

// A variable as it is; a C array has its length in front.
void SerializeBody::Add(const Variable& variable, Tokens expression) {
  std::string word = types_.WordOf(variable.member.type, variable.in_class);
  if (variable.known && !variable.member.sizes.empty() && word != kUnknownType) {
    std::size_t count = 1;
    for (const std::string& size : variable.member.sizes) {
      std::size_t length = 0;
      std::from_chars(size.data(), size.data() + size.size(), length);
      count *= length;
    }
    if (count == 0 || variable.member.sizes.size() > 1)
      return AskMember(expression, variable.name, detail::Concat("an array of unknown length: ", TextOf(expression)));
    members.push_back({variable.name + ".count", "size"});
    return AddArray(variable.name, {word, count});
  }
  if (word == kUnknownType) {
    if (const std::string scalar = MemberOfKeyPoint(variable.name); !variable.known && !scalar.empty()) word = scalar;
  }
  if (word == kUnknownType)
    return AskMember(expression, variable.name, detail::Concat("the type of ", TextOf(expression), " is not known"));
  members.push_back({variable.name, word});
}

// What `a.b->c`, `X::a` and `this->a` refer to; a name at least.
SerializeBody::Variable SerializeBody::Find(Tokens expression) const {
  Variable found;
  found.in_class = function_.owner;
  found.name = TextOf(expression);
  std::string owner = function_.owner;
  bool first = true;
  for (std::size_t i = 0; i < expression.size(); ++i) {
    const CppToken& token = expression[i];
    if (token.Is("[")) {
      i = EndOf(expression, i) - 1;
      if (!found.member.sizes.empty()) found.member.sizes.erase(found.member.sizes.begin());
      continue;
    }
    if (!token.is_word() || token.Is("this")) continue;
    if (i + 1 < expression.size() && expression[i + 1].Is("::")) {
      owner = token.text;
      found.name = std::string(token.text) + "::";
      continue;
    }
    const std::string qualified = found.name.ends_with("::") ? found.name : "";
    found.name = qualified + std::string(token.text);
    found.known = false;
    if (const auto local = locals_.find(token.text); first && local != locals_.end()) {
      found.member = local->second;
      found.known = true;
    } else if (const auto of = index_.classes.find(owner); of != index_.classes.end()) {
      if (const auto member = of->second.members.find(token.text); member != of->second.members.end()) {
        found.member = member->second;
        found.known = true;
        found.in_class = owner;
      }
    }
    if (!found.known) found.member = {};
    owner = CppTypes::NameOf(types_.Resolved(found.member.type, found.in_class));
    first = false;
  }
  return found;
}

// ---- Questions

void SerializeBody::Ask(Tokens where, std::string text) {
  const std::uint32_t line = where.empty() ? function_.place.line : where.front().line;
  questions_.push_back({{function_.place.file, line}, std::move(text)});
}

void SerializeBody::AskMember(Tokens where, std::string name, std::string text) {
  Ask(where, std::move(text));
  members.push_back({std::move(name), std::string(kUnknownType)});
}

}  // namespace slamdb::layouts
