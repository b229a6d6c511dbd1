// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/encode.h"

#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "slamdb/base/detail/concat.h"

namespace slamdb::postgresql {
namespace {

constexpr std::size_t kUuidSize = 16;

template <class Integer>
void AppendIntegerArray(std::string& out, std::uint32_t type, std::span<const Integer> values) {
  constexpr std::size_t kHeader = 20;
  out.reserve(out.size() + kHeader + values.size() * (sizeof(std::int32_t) + sizeof(Integer)));
  AppendArray(out, type, values, [](std::string& bytes, Integer value) { AppendField(bytes, value); });
}

}  // namespace

void AppendField(std::string& out, const void* data, std::size_t size) {
  AppendBigEndian(out, static_cast<std::int32_t>(size));
  out.append(static_cast<const char*>(size == 0 ? "" : data), size);
}

void AppendIntegers(std::string& out, std::span<const std::int64_t> values) {
  AppendIntegerArray(out, oid::kInt8, values);
}
void AppendIntegers(std::string& out, std::span<const std::int32_t> values) {
  AppendIntegerArray(out, oid::kInt4, values);
}

std::string BitsText(Bytes bits) {
  std::string text;
  AppendBigEndian(text, static_cast<std::uint32_t>(8 * bits.size()));
  return text.append(reinterpret_cast<const char*>(bits.data()), bits.size());
}

RowEncoder::RowEncoder(RowOrigin origin, std::vector<Type> types)
    : origin_(std::move(origin)), types_(std::move(types)), bytes_(kCopySignature) {
  constexpr std::uint32_t kFlags = 0, kExtension = 0;
  AppendBigEndian(bytes_, kFlags);
  AppendBigEndian(bytes_, kExtension);
}

void RowEncoder::Throw(ErrorKind kind, const std::string& problem) const {
  throw Error(kind, origin_.path, detail::Concat(origin_.place, ", row ", rows_, ", column ", column_), problem);
}
void RowEncoder::ThrowMismatch() const {
  Throw(ErrorKind::kInternal, detail::Concat("a value that does not go with its column, of ", types_.size()));
}

void RowEncoder::Begin() {
  row_ = bytes_.size();
  column_ = 0;
  AppendBigEndian(bytes_, static_cast<std::int16_t>(types_.size()));
}

void RowEncoder::End() {
  if (column_ != types_.size()) ThrowMismatch();
  if (bytes_.size() - row_ > kLargest) Throw(ErrorKind::kNotPossible, "a row larger than PostgreSQL holds (1 GB)");
  ++rows_;
}

void RowEncoder::Add(std::span<const Value> row) {
  Begin();
  for (const Value& value : row) Put(value);
  End();
}

Type RowEncoder::Next() {
  if (column_ >= types_.size()) ThrowMismatch();
  return types_[column_++];
}

template <class Integer>
void RowEncoder::PutInteger(std::int64_t value) {
  if (!std::in_range<Integer>(value))
    Throw(ErrorKind::kNotPossible,
          detail::Concat(value, " is too large for its column of ", sizeof(Integer), " bytes"));
  AppendField(bytes_, static_cast<Integer>(value));
}

void RowEncoder::Put(Type type, std::int64_t value) {
  switch (type) {
    case Type::kBool:
      return AppendField(bytes_, static_cast<std::uint8_t>(value != 0));
    case Type::kInt2:
      return PutInteger<std::int16_t>(value);
    case Type::kInt4:
      return PutInteger<std::int32_t>(value);
    case Type::kInt8:
      return PutInteger<std::int64_t>(value);
    default:
      ThrowMismatch();
  }
}

void RowEncoder::Put(Type type, double value) {
  if (type == Type::kFloat8) return AppendField(bytes_, std::bit_cast<std::uint64_t>(value));
  const auto narrow = static_cast<float>(value);
  const bool is_exact = static_cast<double>(narrow) == value || std::isnan(value);
  if (type != Type::kFloat4 || !is_exact) ThrowMismatch();
  AppendField(bytes_, std::bit_cast<std::uint32_t>(narrow));
}

void RowEncoder::Put(const Value& value) {
  const Type type = Next();
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return Put(type, *integer);
  if (const auto* real = std::get_if<double>(&value)) return Put(type, *real);
  if (const auto* text = std::get_if<std::string_view>(&value)) {
    if (type != Type::kText) ThrowMismatch();
    return AppendField(bytes_, text->data(), text->size());
  }
  if (const auto* blob = std::get_if<Bytes>(&value)) {
    if (type == Type::kBits) {
      const std::string bits = BitsText(*blob);
      return AppendField(bytes_, bits.data(), bits.size());
    }
    if (type != Type::kBytea && !(type == Type::kUuid && blob->size() == kUuidSize)) ThrowMismatch();
    return AppendField(bytes_, blob->data(), blob->size());
  }
  AppendBigEndian(bytes_, Field::kNull);
}

void RowEncoder::PutNull() { Put(Value()); }

void RowEncoder::PutReal32(float value) {
  if (Next() != Type::kFloat4) ThrowMismatch();
  AppendField(bytes_, std::bit_cast<std::uint32_t>(value));
}

template <class Integer>
void RowEncoder::PutArray(Type type, std::span<const Integer> values) {
  if (Next() != type) ThrowMismatch();
  const std::size_t start = bytes_.size();
  AppendBigEndian(bytes_, std::int32_t{0});  // the length
  AppendIntegers(bytes_, values);
  std::string length;
  AppendBigEndian(length, static_cast<std::int32_t>(bytes_.size() - start - sizeof(std::int32_t)));
  bytes_.replace(start, length.size(), length);
}

void RowEncoder::Put(std::span<const std::int64_t> values) { PutArray(Type::kInt8Array, values); }
void RowEncoder::Put(std::span<const std::int32_t> values) { PutArray(Type::kInt4Array, values); }

void RowEncoder::AppendTrailer() { AppendBigEndian(bytes_, kCopyTrailer); }

}  // namespace slamdb::postgresql
