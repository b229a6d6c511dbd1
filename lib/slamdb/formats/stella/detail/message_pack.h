// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "slamdb/base/column.h"
#include "slamdb/base/file.h"

// MessagePack (github.com/msgpack/msgpack, spec.md), as much of it as JSON has: without extension types.
namespace slamdb::stella {

// Numbers are big-endian.
template <class Value>
Value Swapped(Value value) {
  static_assert(std::endian::native == std::endian::little);
  if constexpr (sizeof value == 2) return __builtin_bswap16(value);
  if constexpr (sizeof value == 4) return __builtin_bswap32(value);
  if constexpr (sizeof value == 8) return __builtin_bswap64(value);
  return value;
}

// Takes one value behind the other: who reads knows what comes next, so that nothing of a large file is held in memory,
// and nothing recurses.
//
// Every function throws Error (kDamaged) with byte and place when something else stands there, or the bytes end. A map
// or list that claims more entries than the rest of the bytes can hold is such an error too.
class MessagePackReader {
 public:
  MessagePackReader(std::string_view bytes, std::string path) : bytes_(bytes), path_(std::move(path)) {}

  void SetPlace(std::string place) { place_ = std::move(place); }  // of errors: `keyframe 12`

  std::uint32_t Map();   // how many pairs follow
  std::uint32_t List();  // how many values follow
  std::string_view Text();
  double Number();         // of any numeric type
  std::int64_t Integer();  // likewise, as long as it is whole
  void Skip();             // a value of any kind and depth

  bool AtEnd() const { return at_ == bytes_.size(); }
  std::size_t left() const { return bytes_.size() - at_; }
  const std::string& path() const { return path_; }
  [[noreturn]] void Fail(const std::string& problem) const;

 private:
  std::uint8_t Byte();
  template <class Value>
  Value BigEndian();
  std::uint64_t Length(std::uint8_t type);  // of what has its length behind the type
  std::uint32_t Entries(std::uint64_t count, std::uint64_t least_bytes) const;
  bool TakeInteger(std::uint8_t type, std::int64_t& value);
  [[noreturn]] void FailWith(std::string_view expected, std::uint8_t found) const;

  std::string_view bytes_;
  std::size_t at_ = 0;
  std::string path_, place_;
};

// Appends values, each in the fewest bytes, as nlohmann's JSON library does: numbers that were integers are integers,
// all others are float32 where that is exact and float64 where it is not. The bytes are complete after Finish, which
// the destructor calls.
class MessagePackAppender {
 public:
  explicit MessagePackAppender(Column<char>& out) : out_(out), at_(out.size()) {}
  ~MessagePackAppender() { Finish(); }
  MessagePackAppender(const MessagePackAppender&) = delete;
  MessagePackAppender& operator=(const MessagePackAppender&) = delete;
  void Finish() { out_.resize(at_); }

  void Map(std::size_t pairs) { Head(pairs, 0x80, 0xde); }
  void List(std::size_t values) { Head(values, 0x90, 0xdc); }
  void Text(std::string_view text);
  void Integer(std::uint64_t value) {
    Fill(kMostOfNumber, [=](char* at) { return Put(at, value); });
  }
  void Integer(std::int64_t value) {
    Fill(kMostOfNumber, [=](char* at) { return Put(at, value); });
  }
  void Real(float value) {
    Fill(kMostOfNumber, [=](char* at) { return Put(at, value); });
  }
  void Real(double value) {
    Fill(kMostOfNumber, [=](char* at) { return Put(at, value); });
  }
  void Raw(std::string_view bytes) {
    Fill(bytes.size(), [=](char* at) { return Put(at, bytes); });
  }

  // Lets `fill` write values from a place on, where there is room for `most` bytes; it returns where they end. For
  // loops: a pointer of one's own stays in a register.
  template <class Filler>
  void Fill(std::size_t most, const Filler& fill) {
    if (out_.size() - at_ < most) Grow(most);
    char* const begin = out_.data() + at_;
    at_ += static_cast<std::size_t>(fill(begin) - begin);
  }
  static constexpr std::size_t kMostOfNumber = 9;  // bytes
  static char* Put(char* at, std::uint64_t value) {
    if (value < 0x80) return PutByte(at, static_cast<std::uint8_t>(value));
    if (value <= 0xff) return Typed(at, 0xcc, static_cast<std::uint8_t>(value));
    if (value <= 0xffff) return Typed(at, 0xcd, static_cast<std::uint16_t>(value));
    if (value <= 0xffffffff) return Typed(at, 0xce, static_cast<std::uint32_t>(value));
    return Typed(at, 0xcf, value);
  }
  static char* Put(char* at, std::int64_t value) {
    if (value >= 0) return Put(at, static_cast<std::uint64_t>(value));
    return value >= -32 ? PutByte(at, static_cast<std::uint8_t>(value)) : PutNegative(at, value);
  }
  // Of bits that are mostly all in use, as those of descriptors.
  static char* PutWord(char* at, std::uint32_t value) {
    return value > 0xffff ? Typed(at, 0xce, value) : Put(at, std::uint64_t{value});
  }
  static char* Put(char* at, float value) {
    if (std::isfinite(value)) return Typed(at, 0xca, std::bit_cast<std::uint32_t>(value));
    return Put(at, static_cast<double>(value));
  }
  static char* Put(char* at, double value);
  static char* Put(char* at, std::string_view bytes) {
    std::memcpy(at, bytes.data(), bytes.size());
    return at + bytes.size();
  }

 private:
  void Grow(std::size_t bytes);
  static char* PutByte(char* at, std::uint8_t byte) {
    *at = static_cast<char>(byte);
    return at + 1;
  }
  template <class Value>
  static char* Typed(char* at, std::uint8_t type, Value value) {
    *at = static_cast<char>(type);
    const Value swapped = Swapped(value);
    std::memcpy(at + 1, &swapped, sizeof value);
    return at + 1 + sizeof value;
  }
  template <class Value>
  void Append(std::uint8_t type, Value value) {
    Fill(kMostOfNumber, [=](char* at) { return Typed(at, type, value); });
  }
  void Byte(std::uint8_t byte) {
    Fill(1, [=](char* at) { return PutByte(at, byte); });
  }
  void Head(std::size_t count, std::uint8_t small, std::uint8_t type16);
  static char* PutNegative(char* at, std::int64_t value);

  Column<char>& out_;  // up to at_; behind that, room
  std::size_t at_;
};

}  // namespace slamdb::stella
