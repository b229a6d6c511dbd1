// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

#include "slamdb/model/features.h"
#include "slamdb/model/flag.h"
#include "slamdb/model/ids.h"
#include "slamdb/model/rigid.h"

namespace slamdb::detail {

// Whether JSON can hold a text as it is.
bool IsUtf8(std::string_view text);

// Appends one JSON value after the other to a buffer, with the commas between them: fast enough for whole atlases.
// The caller pairs Begin and End. Names are those of the model's headers and need no escaping.
class JsonAppender {
 public:
  explicit JsonAppender(std::string& out) : out_(out) {}

  void BeginObject() { Open('{'); }
  void BeginObject(std::string_view name) { Name(name), Open('{'); }
  void EndObject() { Close('}'); }
  void BeginArray(std::string_view name) { Name(name), Open('['); }
  void EndArray() { Close(']'); }

  template <class T>
  void Field(std::string_view name, const T& value) {
    Name(name);
    Value(value);
  }

  // An id for every reader of JSON: a number up to 2^53, which all of them take, and text beyond; null: none.
  template <class Entity>
  void ExactField(std::string_view name, Id<Entity> id) {
    constexpr std::uint64_t kExact = std::uint64_t{1} << 53;
    Name(name);
    if (id && id.value() > kExact)
      Value(std::string_view(std::to_string(id.value())));
    else
      Value(id);
  }

  // An array of what `get` takes from each element of `range`.
  template <class Range, class Get>
  void Array(std::string_view name, const Range& range, Get get) {
    BeginArray(name);
    for (const auto& element : range) Value(get(element));
    EndArray();
  }
  template <class Range>
  void Array(std::string_view name, const Range& range) {
    Array(
        name, range, [](const auto& element) -> const auto& { return element; });
  }

  // JSON has no such numbers: "NaN", "Infinity" and "-Infinity" are written as strings.
  void Value(float value);
  void Value(double value);
  void Value(std::uint64_t value);
  void Value(std::int64_t value);
  template <std::integral Integer>
  requires(!std::same_as<Integer, bool>) void Value(Integer value) {
    if constexpr (std::signed_integral<Integer>)
      Value(static_cast<std::int64_t>(value));
    else
      Value(static_cast<std::uint64_t>(value));
  }
  void Value(bool value) { Raw(value ? "true" : "false"); }
  void Value(Flag value);             // true or false; the byte itself when it is neither 0 nor 1
  void Value(std::string_view text);  // bytes that are not UTF-8 are taken for Latin-1
  void Value(const char* text) { Value(std::string_view(text)); }
  void Null() { Raw("null"); }
  template <class Entity>
  void Value(Id<Entity> id) {  // null: none
    if (id)
      Value(id.value());
    else
      Null();
  }
  void Value(const Descriptor& descriptor) { Hex(descriptor.data(), descriptor.size()); }
  void Value(const Rigid3f& transform);  // {"rotation_xyzw":[4],"translation":[3]}
  template <class Derived>
  void Value(const Eigen::MatrixBase<Derived>& matrix) {  // row after row
    Open('[');
    for (Eigen::Index row = 0; row < matrix.rows(); ++row)
      for (Eigen::Index column = 0; column < matrix.cols(); ++column) Value(matrix(row, column));
    Close(']');
  }

  // Bytes as a string of lower-case hex digits.
  void Hex(std::string_view name, const void* bytes, std::size_t size) {
    Name(name);
    Hex(bytes, size);
  }

 private:
  void Separate() {
    if (comma_) out_ += ',';
    comma_ = true;
  }
  void Open(char bracket) {
    Separate();
    out_ += bracket;
    comma_ = false;
  }
  void Close(char bracket) {
    out_ += bracket;
    comma_ = true;
  }
  void Name(std::string_view name) {
    Separate();
    out_ += '"';
    out_ += name;
    out_ += "\":";
    comma_ = false;
  }
  void Raw(std::string_view text) {
    Separate();
    out_ += text;
  }
  void Hex(const void* bytes, std::size_t size);
  template <class Real>
  void RealValue(Real value);

  std::string& out_;
  bool comma_ = false;
};

}  // namespace slamdb::detail
