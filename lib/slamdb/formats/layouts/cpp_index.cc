// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/detail/cpp_index.h"

#include <algorithm>
#include <array>
#include <span>

namespace slamdb::layouts {
namespace {

using Tokens = std::span<const CppToken>;

bool IsOpening(const CppToken& token) { return token.Is("(") || token.Is("{") || token.Is("["); }
bool IsClosing(const CppToken& token) { return token.Is(")") || token.Is("}") || token.Is("]"); }

bool Has(Tokens tokens, std::string_view text) {
  return std::ranges::any_of(tokens, [&](const CppToken& token) { return token.Is(text); });
}

std::size_t IndexOf(Tokens tokens, std::string_view text) {
  return static_cast<std::size_t>(std::ranges::find_if(tokens, [&](const CppToken& token) { return token.Is(text); }) -
                                  tokens.begin());
}

// Words in front of a declaration that say nothing about its type.
bool IsSpecifier(const CppToken& token) {
  static constexpr std::array<std::string_view, 14> kSpecifiers = {
      "static",   "const",  "mutable",  "inline", "constexpr", "volatile", "virtual",
      "explicit", "friend", "typename", "struct", "class",     "extern",   "register"};
  return token.is_word() && std::ranges::find(kSpecifiers, token.text) != kSpecifiers.end();
}

// Walks through one file and keeps what it declares. No recursion: scopes are on a stack.
class Walk {
 public:
  Walk(CppIndex& index, const std::string& file, const CppText& text)
      : index_(index), file_(file), text_(text), tokens_(text.tokens) {}

  void Run() {
    while (at_ < tokens_.size()) Step();
  }

 private:
  struct Scope {
    std::string class_name;  // empty: a namespace
    std::string space;
  };

  // One declaration, or what opens or closes a scope.
  void Step() {
    const CppToken& token = tokens_[at_];
    if (token.Is("}")) {
      if (!scopes_.empty()) scopes_.pop_back();
      ++at_;
    } else if (token.Is(";")) {
      ++at_;
    } else if (IsAccess()) {
      at_ += 2;
    } else {
      Declaration();
    }
  }
  bool IsAccess() const {
    return at_ + 1 < tokens_.size() && tokens_[at_ + 1].Is(":") &&
           (tokens_[at_].Is("public") || tokens_[at_].Is("protected") || tokens_[at_].Is("private"));
  }

  // Up to its `;`, or to the `{` of its body.
  void Declaration() {
    if (tokens_[at_].Is("template")) PassTemplate();
    const std::size_t begin = at_;
    while (at_ < tokens_.size()) {
      const CppToken& token = tokens_[at_];
      if (token.Is(";") || token.Is("{") || token.Is("}")) break;
      if (token.Is("(") || token.Is("["))
        PassBraces();
      else
        ++at_;
      if (IsMacroLine(begin)) return Macro(tokens_.subspan(begin, at_ - begin));
    }
    const Tokens head = tokens_.subspan(begin, at_ - begin);
    if (at_ >= tokens_.size() || tokens_[at_].Is("}")) return;
    if (tokens_[at_].Is(";")) return Statement(head);
    Block(head);
  }

  // Behind `template <...>`.
  void PassTemplate() {
    ++at_;
    if (at_ >= tokens_.size() || !tokens_[at_].Is("<")) return;
    for (int depth = 0; at_ < tokens_.size(); ++at_) {
      if (tokens_[at_].Is("<")) ++depth;
      if (tokens_[at_].Is(">") && --depth == 0) {
        ++at_;
        return;
      }
      if (tokens_[at_].Is(";") || tokens_[at_].Is("{")) return;
    }
  }

  // From an opening sign to behind the one that closes it.
  void PassBraces() {
    for (std::size_t depth = 0; at_ < tokens_.size(); ++at_) {
      if (IsOpening(tokens_[at_])) ++depth;
      if (IsClosing(tokens_[at_]) && --depth == 0) {
        ++at_;
        return;
      }
    }
  }

  // A macro in capitals that stands for itself, on a line with nothing but its arguments.
  bool IsMacroLine(std::size_t begin) const {
    const std::string_view name = tokens_[begin].text;
    if (!tokens_[begin].is_word() || name.size() < 4 || at_ == begin) return false;
    const bool capitals = std::ranges::all_of(name, [](char c) { return (c >= 'A' && c <= 'Z') || c == '_'; });
    if (!capitals) return false;
    const std::size_t behind = at_ - 1;
    const bool ends = at_ >= tokens_.size() || tokens_[at_].line > tokens_[behind].line || tokens_[at_].Is(";");
    return ends && (behind == begin || (tokens_[begin + 1].Is("(") && tokens_[behind].Is(")")));
  }
  void Macro(Tokens call) {
    if (call.size() < 4) return;
    const std::string_view name = call[0].text;
    const Tokens arguments = call.subspan(2, call.size() - 3);
    const std::size_t comma = IndexOf(arguments, ",");
    const Tokens type = arguments.first(comma);
    if (type.empty()) return;
    const std::string class_name(type.back().text);
    if (name == "BOOST_CLASS_EXPORT_GUID" || name == "BOOST_CLASS_EXPORT_KEY2") {
      if (comma + 1 < arguments.size()) index_.export_keys[class_name] = arguments[comma + 1].text;
    } else if (name == "BOOST_CLASS_EXPORT" || name == "BOOST_CLASS_EXPORT_KEY") {
      std::string key;
      for (const CppToken& token : type) key += token.text;
      index_.export_keys[class_name] = key;
    } else if (name == "BOOST_CLASS_VERSION") {
      index_.versions[class_name] = {file_, call[0].line};
    }
  }

  // ---- What ends with a semicolon

  void Statement(Tokens head) {
    ++at_;
    if (head.empty()) return;
    if (head.front().Is("typedef") || head.front().Is("using")) return Alias(head);
    if (head.front().Is("friend") || head.front().Is("enum")) return;
    if (IndexOf(head, "(") < IndexOf(head, "=")) return Function(head);
    if (!scopes_.empty() && !scopes_.back().class_name.empty()) Members(head);
  }
  void Alias(Tokens head) {
    std::map<std::string, CppTokens, std::less<>>& aliases =
        current_class() != nullptr ? current_class()->aliases : index_.aliases;
    if (head.front().Is("typedef") && head.size() > 2)
      aliases[std::string(head.back().text)] = {head.begin() + 1, head.end() - 1};
    else if (head.size() > 3 && head[2].Is("="))
      aliases[std::string(head[1].text)] = {head.begin() + 3, head.end()};
  }
  void Function(Tokens head) {
    const bool pure = head.size() > 2 && head[head.size() - 2].Is("=") && head.back().Is("0");
    if (pure && current_class() != nullptr) current_class()->abstract = true;
  }

  // `static const long unsigned int a, b[3] = {...};`
  void Members(Tokens head) { MembersOf(head, current_class()->members); }

 public:
  // Adds the variables of a declaration; nothing where it is none.
  static void MembersOf(Tokens head, std::map<std::string, CppMember, std::less<>>& members) {
    while (!head.empty() && IsSpecifier(head.front())) head = head.subspan(1);
    CppTokens type;
    std::size_t at = 0;
    int depth = 0;
    // The type goes on as long as a word follows, or signs of templates, pointers and references.
    for (; at < head.size(); ++at) {
      if (head[at].Is("<")) ++depth;
      if (head[at].Is(">")) --depth;
      const bool declares = depth == 0 && head[at].is_word() && !type.empty() && EndsDeclarator(head, at + 1);
      if (declares) break;
      type.push_back(head[at]);
    }
    if (at >= head.size() || type.empty()) return;
    while (at < head.size()) {
      CppMember member{.type = type, .sizes = {}};
      const std::string name(head[at++].text);
      for (; at + 2 < head.size() && head[at].Is("["); at += 3) member.sizes.emplace_back(head[at + 1].text);
      members.try_emplace(name, std::move(member));
      while (!type.empty() && (type.back().Is("*") || type.back().Is("&"))) type.pop_back();
      at += IndexOf(head.subspan(at), ",");
      for (++at; at < head.size() && !head[at].is_word(); ++at) type.push_back(head[at]);
      if (type.empty()) return;
    }
  }

 private:
  static bool EndsDeclarator(Tokens head, std::size_t at) {
    return at == head.size() || head[at].Is(",") || head[at].Is("=") || head[at].Is("[") || head[at].Is("{") ||
           head[at].Is("(");
  }

  // ---- What has a body

  void Block(Tokens head) {
    const std::size_t parenthesis = IndexOf(head, "("), assigned = IndexOf(head, "=");
    if (Has(head, "enum") && parenthesis == head.size()) return Enumeration(head);
    if (parenthesis == head.size() && Has(head, "namespace")) return Open({{}, std::string(head.back().text)});
    if (parenthesis == head.size() && Has(head, "extern") && head.size() <= 2) return Open({});
    if (parenthesis == head.size() && assigned == head.size() && IsClassHead(head)) return OpenClass(head);
    if (parenthesis < head.size() && parenthesis < assigned) return FunctionBody(head, parenthesis);
    PassBraces();  // an initialiser: `int a{3};`
    if (at_ < tokens_.size() && tokens_[at_].Is(";") && current_class() != nullptr) Members(head);
  }
  static bool IsClassHead(Tokens head) {
    return !head.empty() && (head.front().Is("class") || head.front().Is("struct") || head.front().Is("union") ||
                             head.front().Is("typedef"));
  }
  void Open(Scope scope) {
    ++at_;
    scopes_.push_back(std::move(scope));
  }
  // `GlobalPosition::Calib` in a namespace of a namespace, where IMU's Calib is called so too.
  std::string Qualified(const std::string& name) const {
    const bool nested = scopes_.size() > 1 && scopes_.back().class_name.empty() && !scopes_.front().space.empty();
    return nested && scopes_.back().space != "IMU" ? scopes_.back().space + "::" + name : name;
  }
  void OpenClass(Tokens head) {
    const std::size_t bases = IndexOf(head, ":");
    std::string name;
    for (const CppToken& token : head.first(bases))
      if (token.is_word() && !token.Is("final") && !IsSpecifier(token) && !token.Is("typedef")) name = token.text;
    name = name.empty() ? "(anonymous)" : Qualified(name);
    CppClass& found = index_.classes[name];
    if (found.place.file.empty()) found.place = {file_, head.front().line};
    Open({name, {}});
  }
  void Enumeration(Tokens head) {
    std::string name;
    for (const CppToken& token : head.first(IndexOf(head, ":")))
      if (token.is_word() && !token.Is("enum") && !IsSpecifier(token)) name = token.text;
    static constexpr CppToken kInt{CppToken::Kind::kWord, "int", 0};
    if (!name.empty()) (current_class() != nullptr ? current_class()->aliases : index_.aliases)[name] = {kInt};
    PassBraces();
  }

  void FunctionBody(Tokens head, std::size_t parenthesis) {
    const std::size_t begin = at_;
    PassBraces();
    // `: a{1}, b(2) {`: the body is the last block.
    std::size_t body = begin;
    while (at_ < tokens_.size() && (tokens_[at_].Is(",") || tokens_[at_].Is("{"))) {
      while (at_ < tokens_.size() && !IsOpening(tokens_[at_]) && !tokens_[at_].Is(";")) ++at_;
      body = at_;
      if (at_ < tokens_.size() && IsOpening(tokens_[at_]))
        PassBraces();
      else
        break;
    }
    if (parenthesis == 0 || !head[parenthesis - 1].is_word()) return;
    Keep(head, parenthesis, tokens_.subspan(body, at_ - body));
  }
  // Of functions that name an archive.
  void Keep(Tokens head, std::size_t parenthesis, Tokens body) {
    CppFunction function;
    function.place = {file_, head[parenthesis - 1].line};
    function.name = head[parenthesis - 1].text;
    const bool archives = function.name.starts_with("serialize") || function.name == "save" ||
                          function.name == "load" || Has(body, "binary_oarchive") || Has(body, "text_oarchive");
    if (!archives || body.size() < 2) return;
    if (parenthesis >= 3 && head[parenthesis - 2].Is("::"))
      function.owner = head[parenthesis - 3].Is(">") ? "" : std::string(head[parenthesis - 3].text);
    else if (!scopes_.empty())
      function.owner = scopes_.back().class_name;
    std::size_t depth = 0, end = parenthesis;
    for (; end < head.size(); ++end) {
      if (IsOpening(head[end])) ++depth;
      if (IsClosing(head[end]) && --depth == 0) break;
    }
    function.parameters.assign(head.begin() + static_cast<std::ptrdiff_t>(parenthesis) + 1,
                               head.begin() + static_cast<std::ptrdiff_t>(end));
    function.body.assign(body.begin() + 1, body.end() - 1);
    function.skips_lines = std::ranges::any_of(text_.skipped, [&](const auto& lines) {
      return lines.first >= body.front().line && lines.second <= body.back().line;
    });
    index_.functions.push_back(std::move(function));
  }

  CppClass* current_class() {
    return scopes_.empty() || scopes_.back().class_name.empty() ? nullptr : &index_.classes[scopes_.back().class_name];
  }

  CppIndex& index_;
  const std::string& file_;
  const CppText& text_;
  const Tokens tokens_;
  std::size_t at_ = 0;
  std::vector<Scope> scopes_;
};

}  // namespace

void CppIndex::Add(const std::string& file, std::string text) {
  const std::string& kept = texts.emplace_back(std::move(text));
  const CppText tokens = TokensOf(kept);
  Walk(*this, file, tokens).Run();
}

std::vector<const CppFunction*> CppIndex::Find(std::string_view owner, std::string_view name) const {
  std::vector<const CppFunction*> found;
  for (const CppFunction& function : functions)
    if (function.owner == owner && function.name == name) found.push_back(&function);
  return found;
}

void MembersOfDeclaration(std::span<const CppToken> declaration,
                          std::map<std::string, CppMember, std::less<>>& members) {
  Walk::MembersOf(declaration, members);
}

}  // namespace slamdb::layouts
