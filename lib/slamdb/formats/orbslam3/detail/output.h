// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <charconv>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>

#include "slamdb/base/column.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/detail/float_text.h"
#include "slamdb/model/atlas.h"

// The token layers that encoding stands on, the mirror of input.h. They append to a buffer.
namespace slamdb::orbslam3 {

// Cuts a 64-bit id to the 4-byte long of another platform. Throws Error when it does not fit.
inline std::uint32_t Narrow(std::uint64_t value) {
  if (value == ~std::uint64_t{0}) return std::numeric_limits<std::uint32_t>::max();
  if (value > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorKind::kNotPossible,
                "the id " + std::to_string(value) +
                    " does not fit into a 4-byte long; if it is uninitialised memory, Orbslam3WriteOptions::sanitize "
                    "clears it");
  return static_cast<std::uint32_t>(value);
}
inline std::int32_t Narrow(std::int64_t value) {
  if (value < std::numeric_limits<std::int32_t>::min() || value > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorKind::kNotPossible, "the number " + std::to_string(value) + " does not fit into a 4-byte long");
  return static_cast<std::int32_t>(value);
}

class BinaryOutput {
 public:
  static constexpr bool kText = false;
  BinaryOutput(Column<char>& buffer, const ArchiveEncoding& encoding) : buffer_(buffer), encoding_(encoding) {}

  template <class T>
  void Put(T value) {
    PutArray(&value, 1);
  }
  template <class T>
  void PutArray(const T* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t bytes = count * sizeof(T);
    if (bytes > 0) std::memcpy(Extend(bytes), values, bytes);
  }
  void PutUnsignedLong(std::uint64_t value) {
    if (encoding_.long_bytes == 8) return Put(value);
    Put(Narrow(value));
  }
  void PutLong(std::int64_t value) {
    if (encoding_.long_bytes == 8) return Put(value);
    Put(Narrow(value));
  }
  void PutUnsignedLongs(const std::uint64_t* values, std::size_t count) {
    if (encoding_.long_bytes == 8) return PutArray(values, count);
    for (std::size_t i = 0; i < count; ++i) PutUnsignedLong(values[i]);
  }
  void PutSize(std::uint64_t value) {
    if (encoding_.size_bytes == 8) return Put(value);
    Put(Narrow(value));
  }
  void PutSizes(const std::uint64_t* values, std::size_t count) {
    if (encoding_.size_bytes == 8) return PutArray(values, count);
    for (std::size_t i = 0; i < count; ++i) PutSize(values[i]);
  }
  void PutString(std::string_view text) {
    PutSize(text.size());
    PutArray(text.data(), text.size());
  }
  void PutObjectId(std::uint32_t id, bool /*is_new*/) { Put(id); }
  void PutEnd() {}

 private:
  char* Extend(std::size_t bytes) {
    const std::size_t size = buffer_.size();
    buffer_.resize(size + bytes);
    return buffer_.data() + size;
  }

  Column<char>& buffer_;
  const ArchiveEncoding& encoding_;
};

class TextOutput {
 public:
  static constexpr bool kText = true;
  TextOutput(Column<char>& buffer, const ArchiveEncoding& encoding) : buffer_(buffer), encoding_(encoding) {}

  template <class T>
  void Put(T value) {
    PutArray(&value, 1);
  }
  template <class T>
  void PutArray(const T* values, std::size_t count) {
    constexpr std::size_t kLongest = sizeof(T) == 1 ? 4 : 26;  // a space and `-2.22507385850720138e-308`
    const std::size_t size = buffer_.size();
    buffer_.resize(size + count * kLongest);
    char* next = buffer_.data() + size;
    for (std::size_t i = 0; i < count; ++i) next = Token(next, values[i]);
    buffer_.resize(static_cast<std::size_t>(next - buffer_.data()));
  }
  void PutUnsignedLong(std::uint64_t value) { Put(encoding_.long_bytes == 8 ? value : Narrow(value)); }
  void PutLong(std::int64_t value) { Put(value); }
  void PutUnsignedLongs(const std::uint64_t* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) PutUnsignedLong(values[i]);
  }
  void PutSize(std::uint64_t value) { Put(value); }
  void PutSizes(const std::uint64_t* values, std::size_t count) { PutArray(values, count); }
  void PutString(std::string_view text) {
    Put(static_cast<std::uint64_t>(text.size()));
    buffer_.push_back(' ');
    buffer_.insert(buffer_.end(), text.begin(), text.end());
  }
  // Boost begins a line in front of each new object.
  void PutObjectId(std::uint32_t id, bool is_new) {
    const std::size_t space = buffer_.size();
    Put(id);
    if (is_new) buffer_[space] = '\n';
  }
  void PutEnd() { buffer_.push_back('\n'); }

 private:
  template <class T>
  char* Token(char* next, T value) const {
    *next++ = ' ';
    if constexpr (std::is_same_v<T, std::uint8_t>) {
      return ByteToken(next, value);
    } else if constexpr (std::is_integral_v<T>) {
      return std::to_chars(next, next + 21, value).ptr;
    } else {
      return FloatToken(next, value);
    }
  }
  static char* ByteToken(char* next, std::uint8_t value) {
    if (value >= 100) *next++ = static_cast<char>('0' + value / 100);
    if (value >= 10) *next++ = static_cast<char>('0' + value / 10 % 10);
    *next++ = static_cast<char>('0' + value % 10);
    return next;
  }
  template <class T>
  char* FloatToken(char* next, T value) const {
    // Boost before 1.56 wrote one digit less, in the shorter of two notations.
    if (encoding_.boost_version <= 10)
      return std::to_chars(next, next + 25, value, std::chars_format::general, std::is_same_v<T, float> ? 8 : 17).ptr;
    if constexpr (std::is_same_v<T, float>)
      return WriteScientific(next, value);
    else
      return std::to_chars(next, next + 25, value, std::chars_format::scientific, 17).ptr;
  }

  Column<char>& buffer_;
  const ArchiveEncoding& encoding_;
};

// Writes nothing: an encoder over it only keeps the class table.
class NoOutput {
 public:
  static constexpr bool kText = false;
  template <class T>
  void Put(T) {}
  template <class T>
  void PutArray(const T*, std::size_t) {}
  void PutUnsignedLong(std::uint64_t) {}
  void PutLong(std::int64_t) {}
  void PutUnsignedLongs(const std::uint64_t*, std::size_t) {}
  void PutSize(std::uint64_t) {}
  void PutSizes(const std::uint64_t*, std::size_t) {}
  void PutString(std::string_view) {}
};

}  // namespace slamdb::orbslam3
