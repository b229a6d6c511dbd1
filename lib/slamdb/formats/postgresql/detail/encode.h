// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/formats/postgresql/detail/row.h"
#include "slamdb/formats/rows/detail/value.h"

namespace slamdb::postgresql {

using rows::Value;

// What a binary COPY begins with, and what stands in place of the number of columns behind its last row.
constexpr std::string_view kCopySignature("PGCOPY\n\xff\r\n\0", 11);
constexpr std::int16_t kCopyTrailer = -1;

// What PostgreSQL holds in a row, or takes as a parameter: 1 GB.
constexpr std::size_t kLargest = (std::size_t{1} << 30) - 1;

// A field or an element, with its length in front.
void AppendField(std::string& out, const void* data, std::size_t size);
template <std::integral Integer>
void AppendField(std::string& out, Integer value) {
  AppendBigEndian(out, static_cast<std::int32_t>(sizeof(Integer)));
  AppendBigEndian(out, value);
}
// An array of one dimension, with nothing in front; `append` appends each element with its length in front.
template <class Element, class Append>
void AppendArray(std::string& out, std::uint32_t element_type, std::span<const Element> elements,
                 const Append& append) {
  constexpr std::uint32_t kHasNulls = 0, kFirstIndex = 1;
  for (const std::uint32_t number : {elements.empty() ? 0U : 1U /* dimensions */, kHasNulls, element_type})
    AppendBigEndian(out, number);
  if (elements.empty()) return;
  AppendBigEndian(out, static_cast<std::uint32_t>(elements.size()));
  AppendBigEndian(out, kFirstIndex);
  for (const Element& element : elements) append(out, element);
}
// int8[] and int4[] so.
void AppendIntegers(std::string& out, std::span<const std::int64_t> values);
void AppendIntegers(std::string& out, std::span<const std::int32_t> values);
// bit(n): how many there are, and they.
std::string BitsText(Bytes bits);

// Rows as a binary COPY takes them, one behind the other:
//   encoder.Begin(); encoder.Put(id); encoder.Put(array); encoder.End();
// A value that its column cannot hold throws Error: what is too large kNotPossible, another type or number of columns
// kInternal.
class RowEncoder {
 public:
  RowEncoder(RowOrigin origin, std::vector<Type> types);

  void Begin();
  void Put(const Value& value);
  void PutNull();
  void PutReal32(float value);  // every bit of NaNs too, which a double does not keep
  void Put(std::span<const std::int64_t> values);
  void Put(std::span<const std::int32_t> values);
  void End();
  // All columns of a row at once.
  void Add(std::span<const Value> row);

  // What is encoded so far, to be taken by the caller, who clears it. The header of the COPY comes first.
  std::string& bytes() { return bytes_; }
  void AppendTrailer();
  std::int64_t rows() const { return rows_; }

 private:
  Type Next();
  void Put(Type type, std::int64_t value);
  void Put(Type type, double value);
  template <class Integer>
  void PutInteger(std::int64_t value);
  template <class Integer>
  void PutArray(Type type, std::span<const Integer> values);
  [[noreturn]] void ThrowMismatch() const;
  [[noreturn]] void Throw(ErrorKind kind, const std::string& problem) const;

  RowOrigin origin_;
  std::vector<Type> types_;
  std::string bytes_;
  std::size_t row_ = 0;     // where it begins
  std::size_t column_ = 0;  // of it, that is put next
  std::int64_t rows_ = 0;
};

}  // namespace slamdb::postgresql
