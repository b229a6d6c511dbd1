// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/input.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>

namespace slamdb::orbslam3 {

std::string Place::ToString(std::size_t offset) const {
  std::string text = "byte " + std::to_string(offset);
  if (map >= 0) text += ", map " + std::to_string(map);
  if (entity != nullptr) {
    text += std::string(", ") + entity + " ";
    text += id != Id<KeyFrame>::kNone ? std::to_string(id) : "no. " + std::to_string(ordinal + 1);
    if (id == Id<KeyFrame>::kNone && of > 0) text += " of " + std::to_string(of);
  }
  if (field != nullptr) text += std::string(", ") + field;
  return text;
}

void Cursor::Fail(const std::string& problem, ErrorKind kind) const {
  throw Error(kind, stream_->path(), place.ToString(offset()), problem);
}

void Cursor::Refuse(const std::string& problem) const {
  constexpr std::size_t kMostNotes = 100;
  if (!tolerates_) Fail(problem);
  if (notes_ != nullptr && notes_->size() < kMostNotes) notes_->push_back(place.ToString(offset()) + ": " + problem);
}

// How much of the list that the cursor is in was read before it.
std::string Cursor::WholeSoFar() const {
  if (place.entity == nullptr || place.of == 0) return {};
  const char* kind = std::string_view(place.entity) == "kf" ? "keyframes" : "map points";
  return "; " + std::to_string(place.ordinal) + " of " + std::to_string(place.of) + " " + kind +
         " of this map are whole";
}

void Cursor::FailTruncated() const {
  throw Error(ErrorKind::kDamaged, stream_->path(), place.ToString(stream_->size()),
              "the file ends here: it is truncated" + WholeSoFar());
}

void Cursor::ReadOn(std::size_t bytes) {
  if (!reads_on_ || bytes > remaining()) FailTruncated();
  stream_->FillTo(offset() + bytes);
  end_ = begin_ + stream_->filled();
}

void Cursor::LeaveOut(std::size_t bytes) {
  const std::size_t left = reads_on_ ? remaining() : static_cast<std::size_t>(end_ - next_);
  if (bytes > left) FailTruncated();
  if (reads_on_) stream_->LeaveOut(offset() + bytes);
  next_ += bytes;
  if (reads_on_) end_ = begin_ + stream_->filled();
}

void BinaryInput::TakeLarge(char* to, std::size_t bytes) {
  const std::size_t begin = offset();
  LeaveOut(bytes);
  stream_->Copy(begin, bytes, to);
}

void Cursor::FailCount(std::uint64_t count) const {
  const std::string problem =
      "a count of " + std::to_string(count) + " does not fit into the " + std::to_string(remaining()) + " bytes left: ";
  // What a whole file could hold is more likely cut off than wrong.
  if (count <= stream_->size()) Fail(problem + "the file is truncated" + WholeSoFar());
  Fail(problem + "the file is damaged, or written by a fork with other members");
}

std::string BinaryInput::TakeString() {
  std::string text(CheckCount(TakeSize(), 1, 1), '\0');
  TakeArray(text.data(), text.size());
  return text;
}

std::string TextInput::TakeString() {
  const std::uint64_t size = Take<std::uint64_t>();
  if (remaining() == 0 || size > remaining() - 1) FailCount(size);
  Need(std::min<std::uint64_t>(size + 2, remaining()));
  std::string text(next_ + 1, size);
  if (!IsSpace(*next_) || (size + 1 < remaining() && !IsSpace(next_[size + 1])))
    Fail("a string of " + std::to_string(size) + " characters does not end where its length says: the file is damaged");
  next_ += 1 + size;
  return text;
}

bool TextInput::AtEnd() {
  Need(remaining());
  return std::all_of(next_, end_, IsSpace);
}

void TextInput::FailToken() const {
  const char* const end = std::find_if(next_, end_, IsSpace);
  if (end == end_) FailTruncated();
  const bool is_number = std::all_of(next_, end, [](char c) { return c == '-' || (c >= '0' && c <= '9'); });
  Fail(std::string(is_number ? "found the number '" : "expected a number, found '") +
       std::string(next_, std::min(end, next_ + 24)) + (is_number ? "', which cannot stand here" : "'") +
       ": the file is damaged, or not written by ORB-SLAM3 v1.0");
}

namespace {

constexpr std::ptrdiff_t kBlock = 64;

// Nothing up to a space is part of a token. Which of it stands there is looked at by who decodes the tokens.
bool IsBlank(char c) { return static_cast<unsigned char>(c) <= ' '; }

// A bit for each of the next 64 characters.
std::uint64_t MarkBlanks(const char* text) {
  std::uint64_t blanks = 0;
#ifdef __SSE2__
  const __m128i space = _mm_set1_epi8(' ');
  for (int i = 3; i >= 0; --i) {
    const __m128i part = _mm_loadu_si128(reinterpret_cast<const __m128i*>(text) + i);
    const int marks = _mm_movemask_epi8(_mm_cmpeq_epi8(_mm_max_epu8(part, space), space));
    blanks = blanks << 16 | static_cast<unsigned>(marks);
  }
#else
  for (std::ptrdiff_t i = 0; i < kBlock; ++i) blanks |= std::uint64_t{IsBlank(text[i])} << i;
#endif
  return blanks;
}

}  // namespace

// Counts the ends of tokens a block at a time, and walks where what can be looked at ends.
void TextInput::SkipTokens(std::size_t count) {
  while (count > 0) {
    while (end_ - next_ > kBlock) {
      const std::uint64_t blanks = MarkBlanks(next_);
      std::uint64_t ends = ~blanks & (blanks >> 1 | std::uint64_t{IsBlank(next_[kBlock])} << (kBlock - 1));
      const auto found = static_cast<std::size_t>(std::popcount(ends));
      if (found >= count) {
        while (--count > 0) ends &= ends - 1;
        next_ += std::countr_zero(ends) + 1;
        return;
      }
      count -= found;
      next_ += kBlock;
    }
    SkipSpace();
    while (next_ != end_ && !IsBlank(*next_)) ++next_;
    if (next_ == end_) FailTruncated();
    --count;
  }
}

// ---- bytes: descriptors are half of all tokens

namespace {

// A byte by the three digits that may stand for it, four bits each: its value, and above that how many digits are
// written: none where they are no number from 0 to 255.
constexpr std::array<std::uint16_t, 4096> kBytes = [] {
  std::array<std::uint16_t, 4096> bytes{};
  for (unsigned value = 0; value < 256; ++value) {
    const unsigned digits = 1U + (value > 9) + (value > 99);
    bytes[value / 100 << 8 | value / 10 % 10 << 4 | value % 10] = static_cast<std::uint16_t>(digits << 8 | value);
  }
  return bytes;
}();

// What the last four characters of a token of so many digits are made of, the space in front of it among them.
constexpr std::array<std::uint32_t, 4> kPartOfToken{0xFF000000, 0xFFFF0000, 0xFFFFFF00, 0xFFFFFFFF},
    kSpaceAndZeros{0x20000000, 0x30200000, 0x30302000, 0x30303020};

}  // namespace

void TextInput::TakeBytes(std::uint8_t* values, std::size_t count) {
  std::uint8_t* const end = values + count;
  while (values != end) {
    *values++ = Take<std::uint8_t>();
    values = TakeUsualBytes(values, end);
  }
}

// Takes tokens behind one that this cursor took, block by block, until one is not as usual or not wholly in sight.
// Returns how far it came. That all is well is looked at once for a block.
std::uint8_t* TextInput::TakeUsualBytes(std::uint8_t* values, std::uint8_t* const end) {
  std::uint8_t* taken = values;
  const char* space = next_;  // in front of the next token
  for (const char* block = next_ + 1; values != end && end_ - block > kBlock; block += kBlock) {
    std::uint32_t wrong = 0;
    for (std::uint64_t blanks = MarkBlanks(block); blanks != 0 && values != end; blanks &= blanks - 1) {
      const char* const behind = block + std::countr_zero(blanks);
      const auto length = static_cast<std::uint32_t>(behind - space - 1);
      space = behind;
      std::uint32_t digits;
      std::memcpy(&digits, behind - sizeof(digits), sizeof(digits));
      digits = (digits & kPartOfToken[length & 3]) ^ kSpaceAndZeros[length & 3];
      const std::uint32_t byte = kBytes[((digits >> 8) * 0x1001001 >> 16) & 0xFFF];
      wrong |= (digits & 0xF0F0F0F0) | (byte >> 8 ^ length);
      *values++ = static_cast<std::uint8_t>(byte);
    }
    if (wrong != 0 || !IsSpace(*space)) break;
    next_ = space;
    taken = values;
  }
  return taken;
}

// ---- all tokens

template <class T>
T TextInput::TakeAny() {
  const char* const token = SkipSpace();
  if constexpr (std::is_integral_v<T>)
    return TakeInteger<T>(token);
  else
    return TakeFloat<T>(token);
}

template <class T>
T TextInput::TakeInteger(const char* token) {
  T value{};
  const auto [parsed, error] = std::from_chars(token, end_, value);
  const bool minus_zero = value == 0 && *token == '-';
  Finish(parsed, error == std::errc() && !minus_zero && !HasZeroInFront(token, parsed));
  return value;
}

// ORB-SLAM3's own loader dies on `nan` and `inf`, which its writer produces from uninitialised members.
template <class T>
T TextInput::TakeFloat(const char* token) {
  T value{};
  const auto [parsed, error] = std::from_chars(token, end_, value);
  if (error == std::errc::result_out_of_range) {  // a subnormal that some libraries round to 0
    long double wide = 0;                         // strtod would follow the locale
    std::from_chars(token, parsed, wide);
    value = static_cast<T>(wide);
    Finish(parsed, !HasZeroInFront(token, parsed));
    return value;
  }
  Finish(parsed, error == std::errc() && !HasZeroInFront(token, parsed));
  return value;
}

template std::int8_t TextInput::TakeAny();
template std::uint8_t TextInput::TakeAny();
template std::int16_t TextInput::TakeAny();
template std::uint16_t TextInput::TakeAny();
template std::int32_t TextInput::TakeAny();
template std::uint32_t TextInput::TakeAny();
template std::int64_t TextInput::TakeAny();
template std::uint64_t TextInput::TakeAny();
template float TextInput::TakeAny();
template double TextInput::TakeAny();

}  // namespace slamdb::orbslam3
