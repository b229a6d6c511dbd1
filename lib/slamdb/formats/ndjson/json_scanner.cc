// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ndjson/detail/json_scanner.h"

#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kLongestName = 60, kLongestExcerpt = 24;

}  // namespace

bool JsonScanner::TakeWord(std::string_view word) {
  SkipBlanks();
  if (!std::string_view(at_, end_).starts_with(word)) return false;
  at_ += word.size();
  return true;
}

const char* JsonScanner::EndOfNumber(const char* begin) const {
  const auto belongs = [](char c) { return IsDigit(c) || c == '-' || c == '+' || c == '.' || c == 'e' || c == 'E'; };
  while (begin != end_ && belongs(*begin)) ++begin;
  return begin;
}

// What from_chars takes besides: `01`, `inf`.
const char* JsonScanner::Number() {
  SkipBlanks();
  const char* digits = at_ != end_ && *at_ == '-' ? at_ + 1 : at_;
  if (digits == end_ || !IsDigit(*digits)) Fail("expected a number");
  if (*digits == '0' && digits + 1 != end_ && IsDigit(digits[1])) Fail("expected a number without zeros in front");
  return at_;
}

template <class T>
T JsonScanner::Real() {
  SkipBlanks();
  if (at_ != end_ && *at_ == '"') return NamedReal<T>();
  const char* begin = Number();
  T value{};
  auto [next, error] = std::from_chars(begin, end_, value);
  if (error == std::errc::result_out_of_range) {
    double wide = 0;
    const auto read = std::from_chars(begin, end_, wide);
    const bool small = std::string_view(begin, next).find("e-") != std::string_view::npos ||
                       std::string_view(begin, next).find("E-") != std::string_view::npos;
    if (read.ec == std::errc() ? std::abs(wide) > 1 : !small)
      Fail(Concat("expected a number that ", sizeof(T) * 8, "-bit floats hold"));
    value = *begin == '-' ? T{-0.0} : T{0};
  } else if (error != std::errc() || !IsDigit(next[-1])) {
    Fail("expected a number");
  }
  at_ = next;
  return value;
}
template float JsonScanner::Real<float>();
template double JsonScanner::Real<double>();

template <class T>
T JsonScanner::NamedReal() {
  constexpr T kInfinity = std::numeric_limits<T>::infinity();
  if (TakeWord("\"NaN\"")) return std::numeric_limits<T>::quiet_NaN();
  if (TakeWord("\"Infinity\"")) return kInfinity;
  if (TakeWord("\"-Infinity\"")) return -kInfinity;
  Fail("expected a number");
}

std::string_view JsonScanner::RawString(std::string_view expected) {
  SkipBlanks();
  if (at_ == end_ || *at_ != '"') Fail(Concat("expected ", expected));
  const char* begin = at_ + 1;
  const char* end = begin;
  while (end != end_ && *end != '"') end += *end == '\\' && end + 1 != end_ ? 2 : 1;
  if (end == end_) Refuse("the line ends in a string");
  at_ = end + 1;
  return {begin, end};
}

std::string JsonScanner::Text() {
  const std::string_view raw = RawString("a string");
  const Json text = Json::parse(raw.data() - 1, raw.data() + raw.size() + 1, nullptr, /*allow_exceptions=*/false);
  if (!text.is_string()) Refuse("is no string of JSON: UTF-8, with escapes of control characters");
  return text.get<std::string>();
}

void JsonScanner::Skip() {
  std::size_t depth = 0;
  do {
    SkipBlanks();
    if (at_ == end_) Refuse("the line ends in a value");
    const char letter = *at_;
    if (letter == '"') {
      RawString("a string");
    } else {
      if (letter == '{' || letter == '[') ++depth;
      if ((letter == '}' || letter == ']' || letter == ',') && depth == 0) Fail("expected a value");
      if (letter == '}' || letter == ']') --depth;
      ++at_;
    }
    if (depth > 0 || letter == '"' || letter == '}' || letter == ']') continue;
    while (at_ != end_ && *at_ != ',' && *at_ != '}' && *at_ != ']') ++at_;  // a number or a word
  } while (depth > 0);
}

void JsonScanner::RequireEnd() {
  SkipBlanks();
  if (at_ != end_) Fail("expected the end of the line");
}

void JsonScanner::Fail(const std::string& problem) const {
  const std::string_view rest(at_, end_);
  Refuse(problem +
         (rest.empty() ? ", found the end of the line" : ", found " + Excerpt(rest.substr(0, kLongestExcerpt))));
}

void JsonScanner::Refuse(const std::string& problem) const {
  throw Error(ErrorKind::kDamaged, "", PathText(), problem);
}

std::string JsonScanner::PathText() const {
  std::string text;
  for (const Step& step : path_) {
    if (step.index != kNoIndex) {
      text += Concat("[", step.index, "]");
    } else {
      if (!text.empty()) text += '.';
      text += step.name.substr(0, kLongestName);
    }
  }
  return text;
}

}  // namespace slamdb::detail
