// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

#include "slamdb/base/detail/pieces.h"
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

template <class Output, class Next>
void PutEach(Output& output, std::size_t count, Next next) {
  for (; count > 0; --count) {
    const std::pair<std::uint64_t, std::int32_t> entry = next();
    output.PutUnsignedLong(entry.first);
    output.Put(entry.second);
  }
}

// Adds to pieces. A large column is referred to where it outlives them; otherwise it is copied.
class BinaryOutput {
 public:
  static constexpr bool kText = false;
  enum class Columns { kCopied, kReferredTo };
  BinaryOutput(detail::Pieces& buffer, const ArchiveEncoding& encoding, Columns columns = Columns::kCopied)
      : buffer_(buffer), encoding_(encoding), refers_(columns == Columns::kReferredTo) {}

  template <class T>
  void Put(T value) {
    PutArray(&value, 1);
  }
  template <class T>
  void PutArray(const T* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    constexpr std::size_t kLarge = std::size_t{1} << 13;
    const std::size_t bytes = count * sizeof(T);
    if (bytes >= kLarge && refers_) return buffer_.Refer(std::as_bytes(std::span(values, count)));
    if (bytes > 0) std::memcpy(buffer_.Extend(bytes), values, bytes);
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
  // Entries of map<unsigned long, int>: next() gives one pair after the other.
  template <class Next>
  void PutWeights(std::size_t count, Next next) {
    constexpr std::size_t kBytes = sizeof(std::uint64_t) + sizeof(std::int32_t);
    if (encoding_.long_bytes != sizeof(std::uint64_t)) return PutEach(*this, count, next);
    char* to = buffer_.Extend(count * kBytes);
    for (; count > 0; --count, to += kBytes) {
      const std::pair<std::uint64_t, std::int32_t> entry = next();
      std::memcpy(to, &entry.first, sizeof(entry.first));
      std::memcpy(to + sizeof(entry.first), &entry.second, sizeof(entry.second));
    }
  }
  // Vectors of sizes one behind the other: the length of each, then its entries. Most have none, one or two, and
  // nothing tells which: two are copied for each, and what is not of it is overwritten, so that the processor need not
  // guess.
  void PutSizeVectors(std::span<const std::uint32_t> lengths, const std::uint64_t* entries, std::size_t left) {
    constexpr std::size_t kUsual = 2, kBytes = sizeof(std::uint64_t);
    const std::size_t total = std::accumulate(lengths.begin(), lengths.end(), std::size_t{0});
    if (encoding_.size_bytes != kBytes || left < total + kUsual) {
      for (const std::uint32_t length : lengths) {
        PutSize(length);
        PutSizes(entries, length);
        entries += length;
      }
      return;
    }
    char* to = buffer_.Extend(kBytes * (lengths.size() + total + kUsual));
    for (const std::uint64_t length : lengths) {
      std::memcpy(to, &length, kBytes);
      to += kBytes;
      std::memcpy(to, entries, kBytes * kUsual);
      if (length > kUsual) std::memcpy(to, entries, kBytes * length);
      to += kBytes * length;
      entries += length;
    }
    buffer_.Shorten(kBytes * kUsual);
  }
  void PutString(std::string_view text) {
    PutSize(text.size());
    PutArray(text.data(), text.size());
  }
  void PutObjectId(std::uint32_t id, bool /*is_new*/) { Put(id); }
  void PutEnd() {}
  void PutRaw(std::string_view bytes) { PutArray(bytes.data(), bytes.size()); }

 private:
  detail::Pieces& buffer_;
  const ArchiveEncoding& encoding_;
  const bool refers_;
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

class TextOutput {
 public:
  static constexpr bool kText = true;
  TextOutput(detail::Pieces& buffer, const ArchiveEncoding& encoding) : buffer_(buffer), encoding_(encoding) {}

  template <class T>
  void Put(T value) {
    PutArray(&value, 1);
  }
  template <class T>
  void PutArray(const T* values, std::size_t count) {
    PutTokens(count * kLongest<T>, [&](char* next) {
      for (std::size_t i = 0; i < count; ++i) next = Token(next, values[i]);
      return next;
    });
  }
  void PutUnsignedLong(std::uint64_t value) { Put(encoding_.long_bytes == 8 ? value : Narrow(value)); }
  void PutLong(std::int64_t value) { Put(value); }
  void PutUnsignedLongs(const std::uint64_t* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) PutUnsignedLong(values[i]);
  }
  void PutSize(std::uint64_t value) { Put(value); }
  void PutSizes(const std::uint64_t* values, std::size_t count) { PutArray(values, count); }
  template <class Next>
  void PutWeights(std::size_t count, Next next) {
    PutEach(*this, count, next);
  }
  void PutSizeVectors(std::span<const std::uint32_t> lengths, const std::uint64_t* entries, std::size_t /*left*/) {
    for (const std::uint32_t length : lengths) {
      PutTokens((std::size_t{2} + length) * kLongest<std::uint64_t>, [&](char* next) {
        next = Token(next, length);
        next = Token(next, 0);  // an item version
        for (const std::uint64_t* const end = entries + length; entries != end; ++entries) next = Token(next, *entries);
        return next;
      });
    }
  }
  void PutString(std::string_view text) {
    Put(static_cast<std::uint64_t>(text.size()));
    PutRaw(" ");
    PutRaw(text);
  }
  // Boost begins a line in front of each new object.
  void PutObjectId(std::uint32_t id, bool is_new) {
    PutTokens(kLongest<std::uint32_t>, [&](char* begin) {
      char* const end = Token(begin, id);
      if (is_new) *begin = '\n';
      return end;
    });
  }
  void PutEnd() { PutRaw("\n"); }
  void PutRaw(std::string_view text) { std::copy(text.begin(), text.end(), buffer_.Extend(text.size())); }

  // Whether there was no NaN or infinity.
  bool all_finite() const { return all_finite_; }

 private:
  // A space and a number.
  template <class T>
  static constexpr std::size_t kLongest = std::is_same_v<T, std::uint8_t> ? 4 : 26;  // ` -2.22507385850720138e-308`

  // put(begin) writes tokens of at most so many bytes and returns their end; it may write a few bytes beyond.
  template <class Write>
  void PutTokens(std::size_t most, const Write& put) {
    const std::size_t room = most + kLongestScientific;
    char* const begin = buffer_.Extend(room);
    buffer_.Shorten(static_cast<std::size_t>(begin + room - put(begin)));
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

  detail::Pieces& buffer_;
  const ArchiveEncoding& encoding_;
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
  template <class Next>
  void PutWeights(std::size_t, Next) {}
  void PutSizeVectors(std::span<const std::uint32_t>, const std::uint64_t*, std::size_t) {}
  void PutString(std::string_view) {}
};

}  // namespace slamdb::orbslam3
