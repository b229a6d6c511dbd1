// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <charconv>
#include <cstring>
#include <limits>
#include <numeric>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

#include "slamdb/base/column.h"
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
  using Buffer = detail::Pieces;
  static constexpr bool kText = false;
  enum class Columns { kCopied, kReferredTo };
  BinaryOutput(Buffer& buffer, const ArchiveEncoding& encoding, Columns columns = Columns::kCopied)
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
  // Writes what was put and takes it away, if it is more than `least` bytes.
  template <class Write>
  void Flush(std::size_t least, const Write& write) {
    if (buffer_.collected() <= least) return;
    buffer_.ForEach(write);
    buffer_.clear();
  }

 private:
  Buffer& buffer_;
  const ArchiveEncoding& encoding_;
  const bool refers_;
};

class TextOutput {
 public:
  using Buffer = Column<char>;
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
  template <class Next>
  void PutWeights(std::size_t count, Next next) {
    PutEach(*this, count, next);
  }
  void PutSizeVectors(std::span<const std::uint32_t> lengths, const std::uint64_t* entries, std::size_t /*left*/) {
    for (const std::uint32_t length : lengths) {
      PutSize(length);
      Put(std::uint32_t{0});  // an item version
      PutSizes(entries, length);
      entries += length;
    }
  }
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
  void PutRaw(std::string_view text) { buffer_.insert(buffer_.end(), text.begin(), text.end()); }
  template <class Write>
  void Flush(std::size_t least, const Write& write) {
    if (buffer_.size() <= least) return;
    write(std::as_bytes(std::span(buffer_)));
    buffer_.clear();
  }

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
  template <class Next>
  void PutWeights(std::size_t, Next) {}
  void PutSizeVectors(std::span<const std::uint32_t>, const std::uint64_t*, std::size_t) {}
  void PutString(std::string_view) {}
};

}  // namespace slamdb::orbslam3
