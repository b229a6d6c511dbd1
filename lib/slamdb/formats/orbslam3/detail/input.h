// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "slamdb/base/detail/file_stream.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/detail/class_table.h"
#include "slamdb/formats/orbslam3/detail/digits.h"
#include "slamdb/formats/orbslam3/detail/float_text.h"

// The two token layers that decoding stands on: bounded cursors over a binary and over a text archive. They have the
// same functions; every one checks the bytes left and throws Error with byte offset and object path. Both are small
// values: a copy is a second cursor at the same place.
namespace slamdb::orbslam3 {

// Where in the atlas a cursor is, for error messages. Names are literals.
struct Place {
  std::int64_t map = -1;         // position in the list of maps
  const char* entity = nullptr;  // "kf" or "mp"
  std::uint64_t ordinal = 0;     // its position in its list ...
  std::uint64_t of = 0;          // ... of that many; 0: not known
  std::uint64_t id = Id<KeyFrame>::kNone;
  const char* field = nullptr;

  std::string ToString(std::size_t offset) const;
};

// What both cursors share: the position, the place, and how to fail. The cursor that a stream is given reads on through
// it; the others stay within what was filled when they were made.
class Cursor {
 public:
  Cursor(detail::FileStream* stream, const ArchiveEncoding& encoding)
      : stream_(stream), encoding_(&encoding), begin_(stream->data()), next_(begin_), end_(begin_ + stream->filled()) {}

  std::size_t offset() const { return static_cast<std::size_t>(next_ - begin_); }
  // Not beyond the end of the file.
  void Seek(std::size_t offset) { next_ = begin_ + std::min(offset, stream_->size()); }
  // Of the whole file.
  std::size_t remaining() const { return stream_->size() - offset(); }
  const ArchiveEncoding& encoding() const { return *encoding_; }
  detail::FileStream& stream() const { return *stream_; }

  // Makes this a cursor over [begin, end) alone, all of it filled: for another thread.
  void Confine(std::size_t begin, std::size_t end) {
    next_ = begin_ + begin;
    end_ = begin_ + end;
    reads_on_ = false;
  }
  // From here on large arrays do not go through the window of the file: this cursor leaves them out, and copies of it,
  // as it is itself, copy them from the file. It never goes back.
  void LeaveOutLarge() { leaves_out_ = true; }

  [[noreturn]] void Fail(const std::string& problem, ErrorKind kind = ErrorKind::kDamaged) const;
  [[noreturn]] void FailTruncated() const;
  // A count that the bytes left cannot hold.
  [[noreturn]] void FailCount(std::uint64_t count) const;

  // What is not kept has another than its only sound value: an error, or a note where that is tolerated.
  void Refuse(const std::string& problem) const;
  // For damaged files, of which more is lost by such an error than by such a value. `notes` may be null.
  void Tolerate(std::vector<std::string>* notes) {
    tolerates_ = true;
    notes_ = notes;
  }

  Place place;

 protected:
  static constexpr std::size_t kLarge = std::size_t{1} << 13;

  // Makes sure that `bytes` bytes can be looked at.
  void Need(std::size_t bytes) {
    if (bytes > static_cast<std::size_t>(end_ - next_)) ReadOn(bytes);
  }
  [[gnu::cold, gnu::noinline]] void ReadOn(std::size_t bytes);
  // Whether an array of that size is left out of the window.
  bool IsLarge(std::size_t bytes) const { return bytes >= kLarge && leaves_out_; }
  // Passes a large array.
  void LeaveOut(std::size_t bytes);
  std::string WholeSoFar() const;

  detail::FileStream* stream_;
  const ArchiveEncoding* encoding_;
  const char* begin_;
  const char* next_;
  const char* end_;  // of what can be looked at
  bool reads_on_ = true;
  bool leaves_out_ = false;
  bool tolerates_ = false;
  std::vector<std::string>* notes_ = nullptr;
};

class BinaryInput : public Cursor {
 public:
  using Cursor::Cursor;
  static constexpr bool kText = false;

  template <class T>
  T Take() {
    T value;
    TakeArray(&value, 1);
    return value;
  }
  template <class T>
  void TakeArray(T* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t bytes = count * sizeof(T);
    if (IsLarge(bytes)) [[unlikely]]
      return TakeLarge(reinterpret_cast<char*>(values), bytes);
    Need(bytes);
    if (bytes > 0) std::memcpy(values, next_, bytes);  // an empty column has no address
    next_ += bytes;
  }
  // Passes `count` values of T.
  template <class T>
  void SkipArray(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    if (IsLarge(bytes)) [[unlikely]]
      return LeaveOut(bytes);
    SkipBytes(bytes);
  }
  // Calls visit(key, value) for pairs that stand one behind the other.
  template <class Key, class Value, class Visit>
  void TakePairs(std::size_t count, const Visit& visit) {
    constexpr std::size_t kBytes = sizeof(Key) + sizeof(Value);
    Need(count * kBytes);
    for (; count > 0; --count) {
      Key key;
      Value value;
      std::memcpy(&key, next_, sizeof(Key));
      std::memcpy(&value, next_ + sizeof(Key), sizeof(Value));
      next_ += kBytes;
      visit(key, value);
    }
  }
  template <class Key, class Value>
  void SkipPairs(std::size_t count) {
    SkipBytes(count * (sizeof(Key) + sizeof(Value)));
  }

  std::uint64_t TakeUnsignedLong() {
    if (encoding_->long_bytes == 8) return Take<std::uint64_t>();
    return Widen(Take<std::uint32_t>());
  }
  std::int64_t TakeLong() {
    if (encoding_->long_bytes == 8) return Take<std::int64_t>();
    return Take<std::int32_t>();
  }
  // Bulk forms, for columns of ids.
  void TakeUnsignedLongs(std::uint64_t* values, std::size_t count) {
    if (encoding_->long_bytes == 8) return TakeArray(values, count);
    for (std::size_t i = 0; i < count; ++i) values[i] = TakeUnsignedLong();
  }
  std::uint64_t TakeSize() {
    if (encoding_->size_bytes == 8) return Take<std::uint64_t>();
    return Take<std::uint32_t>();
  }
  // Entries of vector<size_t>.
  void TakeSizes(std::uint64_t* values, std::size_t count) {
    if (encoding_->size_bytes == 8) return TakeArray(values, count);
    for (std::size_t i = 0; i < count; ++i) values[i] = Take<std::uint32_t>();
  }
  void SkipUnsignedLongs(std::size_t count) { SkipNumbers(count, encoding_->long_bytes); }
  void SkipSizes(std::size_t count) { SkipNumbers(count, encoding_->size_bytes); }
  // Entries of map<unsigned long, int>.
  template <class Visit>
  void TakeWeights(std::size_t count, const Visit& visit) {
    if (encoding_->long_bytes == 8) return TakePairs<std::uint64_t, std::int32_t>(count, visit);
    TakePairs<std::uint32_t, std::int32_t>(
        count, [&visit](std::uint32_t key, std::int32_t value) { visit(Widen(key), value); });
  }
  void SkipWeights(std::size_t count) { SkipBytes(count * (encoding_->long_bytes + sizeof(std::int32_t))); }
  // Calls visit(length, entries) for vectors of 8-byte sizes that stand one behind the other, at most `count`, as long
  // as they and `beyond` more entries lie in what can be looked at, and none is large: who went before may have left it
  // out. Returns how many.
  template <class Visit>
  std::size_t TakeSeenSizeVectors(std::size_t count, std::size_t beyond, const Visit& visit) {
    constexpr std::size_t kBytes = sizeof(std::uint64_t);
    if (encoding_->size_bytes != kBytes) return 0;
    const char* at = next_;
    std::size_t taken = 0;
    auto left = (end_ - next_) / static_cast<std::ptrdiff_t>(kBytes);
    if (leaves_out_)
      left = std::min(left, static_cast<std::ptrdiff_t>(kLarge / kBytes));  // so no vector in it is large
    left -= static_cast<std::ptrdiff_t>(beyond);
    for (; taken < count && left > 0; ++taken) {
      std::uint64_t length;
      std::memcpy(&length, at, kBytes);
      if (length >= static_cast<std::uint64_t>(left)) break;
      visit(static_cast<std::size_t>(length), at + kBytes);
      at += kBytes * (1 + length);
      left -= static_cast<std::ptrdiff_t>(1 + length);
    }
    next_ = at;
    return taken;
  }

  // A number of things that take at least `bytes` each (or `tokens` in text). What can be looked at already is nearly
  // always enough, and spares a division.
  std::uint64_t CheckCount(std::uint64_t count, std::size_t bytes, std::size_t /*tokens*/) const {
    const auto seen = static_cast<std::size_t>(end_ - next_);
    if (count <= seen && count * bytes <= seen) return count;
    if (count > remaining() / bytes) FailCount(count);
    return count;
  }
  std::string TakeString();
  // Whether nothing but padding is left.
  bool AtEnd() const { return remaining() == 0; }

  // -1 in 32 bits means none, as it does in 64.
  static std::uint64_t Widen(std::uint32_t value) {
    return value == std::numeric_limits<std::uint32_t>::max() ? ~std::uint64_t{0} : value;
  }

 private:
  void SkipBytes(std::size_t bytes) {
    Need(bytes);
    next_ += bytes;
  }
  // Those of 8 bytes are taken as an array.
  void SkipNumbers(std::size_t count, std::size_t each) {
    if (each == 8) return SkipArray<std::uint64_t>(count);
    SkipBytes(count * each);
  }
  [[gnu::noinline]] void TakeLarge(char* to, std::size_t bytes);
};

class TextInput : public Cursor {
 public:
  using Cursor::Cursor;
  static constexpr bool kText = true;

  template <class T>
  T Take() {
    T value;
    if (end_ - next_ < kLongestToken || *next_ != ' ' || !TakeUsual(value)) [[unlikely]]
      value = TakeAny<T>();
    return value;
  }
  template <class T>
  void TakeArray(T* values, std::size_t count) {
    if constexpr (std::is_same_v<T, std::uint8_t>)
      TakeBytes(values, count);
    else
      for (std::size_t i = 0; i < count; ++i) values[i] = Take<T>();
  }
  template <class T>
  void SkipArray(std::size_t count) {
    SkipTokens(count);
  }

  template <class Key, class Value, class Visit>
  void TakePairs(std::size_t count, const Visit& visit) {
    for (; count > 0; --count) {
      const Key key = Take<Key>();
      visit(key, Take<Value>());
    }
  }
  template <class Key, class Value>
  void SkipPairs(std::size_t count) {
    SkipTokens(2 * count);
  }

  std::uint64_t TakeUnsignedLong() {
    if (encoding_->long_bytes == 8) return Take<std::uint64_t>();
    return BinaryInput::Widen(Take<std::uint32_t>());
  }
  std::int64_t TakeLong() { return encoding_->long_bytes == 8 ? Take<std::int64_t>() : Take<std::int32_t>(); }
  void TakeUnsignedLongs(std::uint64_t* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) values[i] = TakeUnsignedLong();
  }
  std::uint64_t TakeSize() { return Take<std::uint64_t>(); }
  void TakeSizes(std::uint64_t* values, std::size_t count) { TakeArray(values, count); }
  void SkipUnsignedLongs(std::size_t count) { SkipTokens(count); }
  void SkipSizes(std::size_t count) { SkipTokens(count); }
  template <class Visit>
  void TakeWeights(std::size_t count, const Visit& visit) {
    for (; count > 0; --count) {
      const std::uint64_t key = TakeUnsignedLong();
      visit(key, Take<std::int32_t>());
    }
  }
  void SkipWeights(std::size_t count) { SkipTokens(2 * count); }
  template <class Visit>
  std::size_t TakeSeenSizeVectors(std::size_t /*count*/, std::size_t /*beyond*/, const Visit& /*visit*/) {
    return 0;  // one token at a time
  }

  std::uint64_t CheckCount(std::uint64_t count, std::size_t /*bytes*/, std::size_t tokens) const {
    if (count > (remaining() + 1) / (2 * tokens)) FailCount(count);
    return count;
  }
  std::string TakeString();
  bool AtEnd();

 private:
  static constexpr std::ptrdiff_t kLongestToken = 64;
  static bool IsSpace(char c) { return c == ' ' || c == '\n' || c == '\r'; }
  // Moves to the next token and returns its begin; fails at the end of the file. One space or end of a line stands in
  // front of it: where there are more, one of them was a digit, a point or a minus.
  const char* SkipSpace() {
    if (end_ - next_ < kLongestToken && reads_on_ && next_ + remaining() != end_)
      ReadOn(std::min<std::size_t>(remaining(), kLongestToken));
    if (next_ != end_ && *next_ == '\r') ++next_;  // a line may end as on Windows
    if (next_ != end_ && (*next_ == ' ' || *next_ == '\n')) ++next_;
    if (next_ == end_) FailTruncated();
    return next_;
  }
  void SkipTokens(std::size_t count);
  // A token that touches the end of the file may have been cut, so only a following space makes it whole.
  void Finish(const char* parsed, bool valid) {
    if (parsed == end_) FailTruncated();
    if (!valid || !IsSpace(*parsed)) FailToken();
    next_ = parsed;
  }
  [[noreturn]] void FailToken() const;

  // Takes a token as nearly all are, behind one space and in front of one, with kLongestToken bytes to look at. False,
  // and takes nothing, where it is another: TakeAny knows all of them, and their errors.
  template <class T>
  bool TakeUsual(T& value) {
    if constexpr (std::is_integral_v<T>) {
      return TakeShortInteger(value);
    } else {
      const char* const parsed = ReadScientific(next_ + 1, value);
      if (parsed != nullptr) next_ = parsed;
      return parsed != nullptr;
    }
  }
  // Of up to seven digits.
  template <class T>
  bool TakeShortInteger(T& value) {
    const char* begin = next_ + 1;
    const bool minus = std::is_signed_v<T> && *begin == '-';
    if (minus) ++begin;
    const std::uint64_t digits = LoadWord(begin) ^ kZeroDigits;
    const std::uint64_t behind = MarkAboveNine(digits);
    if (behind == 0) return false;
    const auto length = static_cast<unsigned>(std::countr_zero(behind)) / 8;
    if (length == 0 || begin[length] != ' ') return false;
    const std::uint32_t number = JoinDigits(digits << (64 - 8 * length));
    if (*begin == '0' && (length > 1 || minus)) return false;
    if (number > static_cast<std::uint64_t>(std::numeric_limits<T>::max())) return false;
    value = static_cast<T>(minus ? -static_cast<std::int64_t>(number) : number);
    next_ = begin + length;
    return true;
  }
  void TakeBytes(std::uint8_t* values, std::size_t count);
  std::uint8_t* TakeUsualBytes(std::uint8_t* values, std::uint8_t* end);

  template <class T>
  [[gnu::cold, gnu::noinline]] T TakeAny();
  // Nobody writes a number with a zero in front of other digits: a digit was changed.
  static bool HasZeroInFront(const char* token, const char* parsed) {
    if (*token == '-') ++token;
    return *token == '0' && parsed - token > 1 && token[1] >= '0' && token[1] <= '9';
  }
  template <class T>
  T TakeInteger(const char* token);
  template <class T>
  T TakeFloat(const char* token);
};

}  // namespace slamdb::orbslam3
