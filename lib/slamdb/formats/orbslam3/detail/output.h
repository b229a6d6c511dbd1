// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
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

// A space and the digits of 0 to 999, which most numbers are: the text in the lower bytes, its length in the highest.
inline constexpr std::array<std::uint64_t, 1000> kShortTokens = [] {
  std::array<std::uint64_t, 1000> tokens{};
  for (std::uint64_t number = 0; number < tokens.size(); ++number) {
    std::uint64_t text = '0' + number % 10, length = 2;
    for (std::uint64_t left = number / 10; left > 0; left /= 10, ++length) text = text << 8 | ('0' + left % 10);
    tokens[number] = length << 56 | text << 8 | ' ';
  }
  return tokens;
}();

// The bytes are in the buffer once Finish() was called.
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
    char* next = Room(count * kLongest<T> + kLongestScientific);
    for (std::size_t i = 0; i < count; ++i) next = Token(next, values[i]);
    next_ = next;
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
    *Room(text.size() + 1) = ' ';
    next_ = std::copy(text.begin(), text.end(), next_ + 1);
  }
  // Boost begins a line in front of each new object.
  void PutObjectId(std::uint32_t id, bool is_new) {
    char* const space = Room(kLongest<std::uint32_t> + kLongestScientific);
    Put(id);
    if (is_new) *space = '\n';
  }
  void PutEnd() { *Room(1) = '\n', ++next_; }

  void Finish() {
    if (next_ != nullptr) buffer_.resize(static_cast<std::size_t>(next_ - buffer_.data()));
    next_ = end_ = nullptr;
  }
  // Whether there was no NaN or infinity.
  bool all_finite() const { return all_finite_; }

 private:
  // A space and a number; a token may be written with up to kLongestScientific bytes behind it.
  template <class T>
  static constexpr std::size_t kLongest = std::is_same_v<T, std::uint8_t> ? 4 : 26;  // ` -2.22507385850720138e-308`

  // Where the next `bytes` bytes go.
  char* Room(std::size_t bytes) {
    if (static_cast<std::size_t>(end_ - next_) < bytes) [[unlikely]]
      Grow(bytes);
    return next_;
  }
  void Grow(std::size_t bytes) {
    Finish();
    const std::size_t size = buffer_.size();
    buffer_.resize(std::max(size + bytes, buffer_.capacity()));
    next_ = buffer_.data() + size;
    end_ = buffer_.data() + buffer_.size();
  }
  template <class T>
  char* Token(char* next, T value) {
    if constexpr (std::is_integral_v<T>) {
      if (static_cast<std::uint64_t>(value) < kShortTokens.size()) {
        const std::uint64_t token = kShortTokens[static_cast<std::size_t>(value)];
        std::memcpy(next, &token, sizeof(token));
        return next + (token >> 56);
      }
      *next++ = ' ';
      return std::to_chars(next, next + 21, value).ptr;
    } else {
      *next++ = ' ';
      return FloatToken(next, value);
    }
  }
  template <class T>
  char* FloatToken(char* next, T value) {
    if (!std::isfinite(value)) all_finite_ = false;
    // Boost before 1.56 wrote one digit less, in the shorter of two notations.
    if (encoding_.boost_version <= 10)
      return std::to_chars(next, next + 25, value, std::chars_format::general, std::is_same_v<T, float> ? 8 : 17).ptr;
    return WriteScientific(next, value);
  }

  Column<char>& buffer_;
  const ArchiveEncoding& encoding_;
  char* next_ = nullptr;  // where the next token goes, behind it room up to ...
  char* end_ = nullptr;   // ... here
  bool all_finite_ = true;
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
