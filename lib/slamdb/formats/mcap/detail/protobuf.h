// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

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

 private:
  static void AppendVarint(std::string& out, std::uint64_t value);
  void Tag(int field, unsigned wire_type) { AppendVarint(out_, static_cast<std::uint64_t>(field) << 3 | wire_type); }

  std::string& out_;
};

}  // namespace slamdb::detail
