// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/detail/cpp_tokens.h"

#include <algorithm>
#include <string>

namespace slamdb::layouts {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }
bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool BeginsWord(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool IsOfWord(char c) { return BeginsWord(c) || IsDigit(c); }

class Tokenizer {
 public:
  explicit Tokenizer(std::string_view source) : source_(source) {}

  CppText Run() {
    while (at_ < source_.size()) {
      const char c = source_[at_];
      if (c == '\n')
        NextLine();
      else if (IsBlank(c))
        ++at_;
      else if (c == '#' && begins_line_)
        Directive();
      else if (!PassComment())
        Token();
    }
    CloseSkipped();
    return std::move(text_);
  }

 private:
  struct Condition {
    bool taken = true;      // this branch is looked at
    bool was_taken = true;  // this one or one before it
  };

  char Peek(std::size_t ahead = 0) const { return at_ + ahead < source_.size() ? source_[at_ + ahead] : '\0'; }
  bool Looks() const {
    return std::ranges::all_of(conditions_, [](const Condition& condition) { return condition.taken; });
  }
  void NextLine() {
    ++at_;
    ++line_;
    begins_line_ = true;
  }

  bool PassComment() {
    if (Peek() != '/' || (Peek(1) != '/' && Peek(1) != '*')) return false;
    if (Peek(1) == '/') {
      // A backslash at the end of the line continues the comment.
      for (; at_ < source_.size() && Peek() != '\n'; Pass(1))
        if (Peek() == '\\' && Peek(1) == '\n') Pass(1);
      return true;
    }
    const std::size_t end = source_.find("*/", at_ + 2);
    Pass((end == std::string_view::npos ? source_.size() : end + 2) - at_);
    return true;
  }
  // Moves over bytes, counting lines.
  void Pass(std::size_t bytes) {
    const std::string_view passed = source_.substr(at_, bytes);
    line_ += static_cast<std::uint32_t>(std::ranges::count(passed, '\n'));
    at_ += passed.size();
  }

  // A preprocessor line with those that continue it.
  std::string_view Line() {
    const std::size_t begin = at_;
    while (at_ < source_.size() && Peek() != '\n') Pass(Peek() == '\\' ? 1 + (Peek(1) == '\r' ? 1U : 0U) + 1U : 1U);
    return source_.substr(begin, at_ - begin);
  }

  void Directive() {
    std::string_view line = Line();
    line.remove_prefix(1);
    const auto trim = [&] {
      while (!line.empty() && IsBlank(line.front())) line.remove_prefix(1);
    };
    trim();
    const auto end = std::ranges::find_if_not(line, IsOfWord);
    const std::string_view name = line.substr(0, static_cast<std::size_t>(end - line.begin()));
    line.remove_prefix(name.size());
    trim();
    if (name == "if" || name == "ifdef" || name == "ifndef")
      Begin(name != "if" || !IsFalse(line));
    else if (name == "else" || name == "elif")
      Else(name == "else" || !IsFalse(line));
    else if (name == "endif" && !conditions_.empty())
      conditions_.pop_back();
    if (Looks()) CloseSkipped();
  }
  static bool IsFalse(std::string_view condition) {
    return condition.starts_with("0") && (condition.size() == 1 || !IsOfWord(condition[1]));
  }
  void Begin(bool taken) {
    if (conditions_.size() < kMostConditions) conditions_.push_back({taken, taken});
  }
  void Else(bool taken) {
    if (conditions_.empty()) return;
    Condition& condition = conditions_.back();
    // Code that somebody may compile is left out: that is worth a question. `#if 0` is not.
    if (condition.was_taken && skipped_from_ == 0) skipped_from_ = line_;
    condition.taken = !condition.was_taken && taken;
    condition.was_taken = condition.was_taken || taken;
  }
  void CloseSkipped() {
    if (skipped_from_ > 0) text_.skipped.emplace_back(skipped_from_, line_);
    skipped_from_ = 0;
  }

  void Token() {
    begins_line_ = false;
    const std::size_t begin = at_;
    const std::uint32_t line = line_;
    const char c = Peek();
    CppToken::Kind kind = CppToken::Kind::kSign;
    std::string_view text;
    if (c == 'R' && Peek(1) == '"') {
      kind = CppToken::Kind::kText;
      text = RawText();
    } else if (c == '"' || c == '\'') {
      kind = CppToken::Kind::kText;
      text = Text(c);
    } else if (BeginsWord(c) || IsDigit(c)) {
      kind = IsDigit(c) ? CppToken::Kind::kNumber : CppToken::Kind::kWord;
      while (IsOfWord(Peek()) || (kind == CppToken::Kind::kNumber && Peek() == '.')) ++at_;
      text = source_.substr(begin, at_ - begin);
    } else {
      at_ += c == ':' && Peek(1) == ':' ? 2 : 1;
      text = source_.substr(begin, at_ - begin);
    }
    if (Looks()) text_.tokens.push_back({kind, text, line});
  }
  std::string_view Text(char quote) {
    const std::size_t begin = ++at_;
    while (at_ < source_.size() && Peek() != quote && Peek() != '\n') Pass(Peek() == '\\' ? 2 : 1);
    const std::string_view text = source_.substr(begin, std::min(at_, source_.size()) - begin);
    if (Peek() == quote) ++at_;
    return text;
  }
  std::string_view RawText() {
    constexpr std::size_t kLongestMark = 16;
    const std::size_t open = source_.find('(', at_);
    if (open == std::string_view::npos || open - at_ > kLongestMark + 2) {
      at_ += 2;
      return {};
    }
    std::string end = ")";
    end.append(source_.substr(at_ + 2, open - at_ - 2)).append("\"");
    const std::size_t close = std::min(source_.find(end, open), source_.size());
    const std::string_view text = source_.substr(open + 1, close - std::min(close, open + 1));
    Pass(close + end.size() - at_);
    return text;
  }

  static constexpr std::size_t kMostConditions = 64;

  const std::string_view source_;
  std::size_t at_ = 0;
  std::uint32_t line_ = 1, skipped_from_ = 0;
  bool begins_line_ = true;
  std::vector<Condition> conditions_;
  CppText text_;
};

}  // namespace

CppText TokensOf(std::string_view source) { return Tokenizer(source).Run(); }

}  // namespace slamdb::layouts
