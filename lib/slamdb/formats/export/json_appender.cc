// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/json_appender.h"

#include <cmath>

#include "slamdb/base/detail/text.h"

namespace slamdb::detail {
namespace {

constexpr std::string_view kHexDigits = "0123456789abcdef";

// The length of the UTF-8 sequence that begins at `at`, or 0 when there is none. Table 3-7 of the Unicode standard.
std::size_t Utf8Length(std::string_view text, std::size_t at) {
  const auto byte = [text](std::size_t i) -> unsigned {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const auto tail = [byte](std::size_t i) { return byte(i) >= 0x80 && byte(i) <= 0xbf; };
  const unsigned first = byte(at), second = byte(at + 1);
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf) return tail(at + 1) ? 2 : 0;
  if (first >= 0xe0 && first <= 0xef) {
    const bool fits = second >= (first == 0xe0 ? 0xa0U : 0x80U) && second <= (first == 0xed ? 0x9fU : 0xbfU);
    return fits && tail(at + 2) ? 3 : 0;
  }
  if (first >= 0xf0 && first <= 0xf4) {
    const bool fits = second >= (first == 0xf0 ? 0x90U : 0x80U) && second <= (first == 0xf4 ? 0x8fU : 0xbfU);
    return fits && tail(at + 2) && tail(at + 3) ? 4 : 0;
  }
  return 0;
}

void AppendEscaped(std::string& out, unsigned char byte) {
  out += "\\u00";
  out += kHexDigits[byte >> 4];
  out += kHexDigits[byte & 15];
}

}  // namespace

bool IsUtf8(std::string_view text) {
  for (std::size_t at = 0, length = 0; at < text.size(); at += length) {
    length = Utf8Length(text, at);
    if (length == 0) return false;
  }
  return true;
}

template <class Real>
void JsonAppender::RealValue(Real value) {
  Separate();
  if (std::isfinite(value))
    AppendNumber(out_, value);
  else
    out_ += std::isnan(value) ? "\"NaN\"" : value > 0 ? "\"Infinity\"" : "\"-Infinity\"";
}

void JsonAppender::Value(float value) { RealValue(value); }
void JsonAppender::Value(double value) { RealValue(value); }

void JsonAppender::Value(std::uint64_t value) {
  Separate();
  AppendNumber(out_, value);
}

void JsonAppender::Value(std::int64_t value) {
  Separate();
  AppendNumber(out_, value);
}

void JsonAppender::Value(Flag value) {
  if (value.recorded <= 1)
    Value(value.recorded == 1);
  else
    Value(value.recorded);
}

void JsonAppender::Value(std::string_view text) {
  Separate();
  out_ += '"';
  for (std::size_t at = 0; at < text.size();) {
    const auto byte = static_cast<unsigned char>(text[at]);
    const std::size_t length = Utf8Length(text, at);
    if (byte == '"' || byte == '\\') out_ += '\\';
    if (byte < 0x20 || byte == 0x7f || length == 0)
      AppendEscaped(out_, byte);
    else
      out_ += text.substr(at, length);
    at += length == 0 ? 1 : length;
  }
  out_ += '"';
}

void JsonAppender::Value(const Rigid3f& transform) {
  BeginObject();
  Field("rotation_xyzw", transform.rotation.coeffs());
  Field("translation", transform.translation);
  EndObject();
}

void JsonAppender::Hex(const void* bytes, std::size_t size) {
  Separate();
  out_ += '"';
  const std::size_t begin = out_.size();
  out_.resize(begin + 2 * size);
  const auto* from = static_cast<const unsigned char*>(bytes);
  for (std::size_t i = 0; i < size; ++i) {
    out_[begin + 2 * i] = kHexDigits[from[i] >> 4];
    out_[begin + 2 * i + 1] = kHexDigits[from[i] & 15];
  }
  out_ += '"';
}

}  // namespace slamdb::detail
