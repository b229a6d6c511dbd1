// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "slamdb/base/file.h"

// MessagePack (github.com/msgpack/msgpack, spec.md), as much of it as JSON has: without extension types.
namespace slamdb::stella {

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
// all others are float32 where that is exact and float64 where it is not.
class MessagePackAppender {
 public:
  explicit MessagePackAppender(std::string& out) : out_(out) {}

  void Map(std::size_t pairs) { Head(pairs, 0x80, 0xde); }
  void List(std::size_t values) { Head(values, 0x90, 0xdc); }
  void Text(std::string_view text);
  void Integer(std::uint64_t value);
  void Integer(std::int64_t value);
  void Real(double value);
  void Raw(std::string_view bytes) { out_.append(bytes); }

 private:
  void Head(std::size_t count, std::uint8_t small, std::uint8_t type16);
  template <class Value>
  void Typed(std::uint8_t type, Value value);

  std::string& out_;
};

}  // namespace slamdb::stella
