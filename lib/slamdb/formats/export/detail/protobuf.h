// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/export/detail/raw.h"

namespace slamdb::detail {

// Appends the fields of a message of Protocol Buffers to a buffer, in the order of the calls. Fields that have their
// default are written as others are; the caller leaves them out.
class ProtoAppender {
 public:
  explicit ProtoAppender(std::string& out) : out_(out) {}

  void Varint(int field, std::uint64_t value) {
    Tag(field, 0);
    AppendVarint(out_, value);
  }
  void Double(int field, double value) {
    Tag(field, 1);
    AppendRaw(out_, value);
  }
  void Fixed32(int field, std::uint32_t value) {
    Tag(field, 5);
    AppendRaw(out_, value);
  }
  void Float(int field, float value) { Fixed32(field, std::bit_cast<std::uint32_t>(value)); }
  void Text(int field, std::string_view value) {
    Head(field, value.size());
    out_ += value;
  }
  // What is in front of so many bytes.
  void Head(int field, std::uint64_t size) {
    Tag(field, 2);
    AppendVarint(out_, size);
  }
  // And these bytes themselves.
  void Raw(std::span<const std::byte> bytes) { out_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size()); }
  // A message in the message: `fill(appender)` appends its fields.
  template <std::invocable<ProtoAppender&> Fill>
  void Message(int field, Fill fill) {
    Tag(field, 2);
    const std::size_t begin = out_.size();
    fill(*this);
    std::string size;
    AppendVarint(size, out_.size() - begin);
    out_.insert(begin, size);
  }

  static void AppendVarint(std::string& out, std::uint64_t value);

 private:
  void Tag(int field, unsigned wire_type) { AppendVarint(out_, static_cast<std::uint64_t>(field) << 3 | wire_type); }

  std::string& out_;
};

// The bytes of a file that messages are in, for errors with their place.
struct ProtoFile {
  std::string_view bytes;
  std::string path;

  // Throws Error (kDamaged) about what stands at `at`; null: somewhere.
  [[noreturn]] void Fail(const char* at, const std::string& problem) const;
};

// A field as it stands on the wire: a number, or bytes.
struct ProtoField {
  enum class Wire : std::uint8_t { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };
  std::uint32_t number = 0;
  Wire wire = Wire::kVarint;
  std::uint64_t value = 0;  // the bits of all but kBytes
  std::string_view bytes;

  bool is_bytes() const { return wire == Wire::kBytes; }
  float AsFloat() const { return std::bit_cast<float>(static_cast<std::uint32_t>(value)); }
  double AsDouble() const { return std::bit_cast<double>(value); }
};

// Reads the fields of a message from front to back, all of them: which ones are known is the caller's matter. Messages
// in it are bytes, for a reader of their own.
class ProtoReader {
 public:
  ProtoReader(const ProtoFile& file, std::string_view message) : file_(&file), rest_(message) {}

  std::string_view rest() const { return rest_; }
  // False at the end. Throws Error where the bytes are no field.
  bool Next(ProtoField& field);
  // So many bytes behind their length, without a tag: how messages stand one behind the other.
  std::string_view TakeDelimited();
  // A number without a tag: of a packed field.
  std::uint64_t TakeVarint();

 private:
  [[noreturn]] void FailTruncated() const;
  std::uint64_t TakeFixed(std::size_t bytes);

  const ProtoFile* file_;
  std::string_view rest_;
};

// Appends the 32-bit numbers of a repeated field, which stand one by one or packed. Throws Error where they are
// neither.
template <class Number>
requires(sizeof(Number) == 4) void AppendFixed32(const ProtoFile& file, const ProtoField& field,
                                                 std::vector<Number>& numbers) {
  if (field.wire == ProtoField::Wire::kFixed32) {
    numbers.push_back(std::bit_cast<Number>(static_cast<std::uint32_t>(field.value)));
    return;
  }
  if (!field.is_bytes() || field.bytes.size() % sizeof(Number) != 0)
    file.Fail(field.bytes.data(), "expected packed numbers of 32 bits: the file is damaged");
  const std::size_t begin = numbers.size();
  numbers.resize(begin + field.bytes.size() / sizeof(Number));
  if (!field.bytes.empty()) std::memcpy(numbers.data() + begin, field.bytes.data(), field.bytes.size());
}

}  // namespace slamdb::detail
