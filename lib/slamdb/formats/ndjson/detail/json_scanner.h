// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <concepts>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/detail/concat.h"

namespace slamdb::detail {

// Reads one JSON text of which it is known what stands where, value after value, in one pass and without a tree: as
// fast as the numbers in it. Refers to the text, which must outlive it.
//
// All throw Error (kDamaged) with the place, `features.keypoints.x[3]`, and what was expected.
class JsonScanner {
 public:
  explicit JsonScanner(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  // An object; read(name) reads the value of each member.
  template <class Read>
  void Object(const Read& read) {
    Require('{', "an object");
    if (Take('}')) return;
    do {
      const std::string_view name = RawString("the name of a member");
      Require(':', "`:`");
      path_.push_back({name, kNoIndex});
      read(name);
      path_.pop_back();
    } while (Take(','));
    Require('}', "`,` or `}`");
  }
  // An array; read() reads each element.
  template <class Read>
  void Array(const Read& read) {
    Require('[', "an array");
    if (Take(']')) return;
    path_.push_back({{}, 0});
    do {
      read();
      ++path_.back().index;
    } while (Take(','));
    path_.pop_back();
    Require(']', "`,` or `]`");
  }

  // The strings "NaN", "Infinity" and "-Infinity" are numbers too; what is too small for the type is 0.
  float Float() { return Real<float>(); }
  double Double() { return Real<double>(); }
  template <std::integral Integer>
  Integer Whole() {
    const char* begin = Number();
    Integer value{};
    const auto [next, error] = std::from_chars(begin, end_, value);
    if (error != std::errc() || next != EndOfNumber(begin))
      Fail(Concat("expected a whole number from ", std::numeric_limits<Integer>::min(), " to ",
                  std::numeric_limits<Integer>::max()));
    at_ = next;
    return value;
  }
  bool AtString() {
    SkipBlanks();
    return at_ != end_ && *at_ == '"';
  }
  bool TakeNull() { return TakeWord("null"); }
  // Whether a word that it is stands here; false when neither does.
  bool TakeFlag(bool& value) {
    if (TakeWord("true")) return value = true;
    if (!TakeWord("false")) return false;
    value = false;
    return true;
  }
  std::string Text();  // with its escapes resolved
  // A string as it stands between the quotes, for those that need no escapes.
  std::string_view RawString(std::string_view expected);
  // Goes past a value, whatever it is and how deep.
  void Skip();
  // Nothing but blanks may be left.
  void RequireEnd();

  // With the place of the value that is read, and what is found instead.
  [[noreturn]] void Fail(const std::string& problem) const;
  // With that place alone.
  [[noreturn]] void Refuse(const std::string& problem) const;

 private:
  static constexpr std::size_t kNoIndex = static_cast<std::size_t>(-1);
  struct Step {
    std::string_view name;
    std::size_t index;
  };

  static bool IsDigit(char letter) { return letter >= '0' && letter <= '9'; }
  void SkipBlanks() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r' || *at_ == '\n')) ++at_;
  }
  bool Take(char letter) {
    SkipBlanks();
    if (at_ == end_ || *at_ != letter) return false;
    ++at_;
    return true;
  }
  void Require(char letter, std::string_view expected) {
    if (!Take(letter)) Fail(Concat("expected ", expected));
  }
  bool TakeWord(std::string_view word);
  const char* Number();  // where it begins, after checking that it is one of JSON's
  const char* EndOfNumber(const char* begin) const;
  template <class T>
  T Real();
  template <class T>
  T NamedReal();
  std::string PathText() const;

  const char *at_, *end_;
  std::vector<Step> path_;
};

}  // namespace slamdb::detail
