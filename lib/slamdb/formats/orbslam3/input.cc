// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/input.h"

#include <algorithm>
#include <cmath>

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

// Counts the ends of tokens in blocks that the compiler turns into vector code, and walks where a block holds the last
// token or what can be looked at ends. Which spaces stand there is looked at by who decodes the tokens.
void TextInput::SkipTokens(std::size_t count) {
  constexpr std::ptrdiff_t kBlock = 64;
  const auto is_space = [](char c) { return static_cast<unsigned char>(c) <= ' '; };
  while (count > 0) {
    SkipSpace();
    std::size_t walk = 1;
    while (end_ - next_ > kBlock) {
      std::uint8_t ends = 0;
      for (std::ptrdiff_t i = 0; i < kBlock; ++i)
        ends = static_cast<std::uint8_t>(ends + (!is_space(next_[i]) && is_space(next_[i + 1])));
      if (ends >= count) {
        walk = count;
        break;
      }
      count -= ends;
      next_ += kBlock;
    }
    for (; walk > 0; --walk, --count) {
      SkipSpace();
      while (next_ != end_ && !is_space(*next_)) ++next_;
      if (next_ == end_) FailTruncated();
    }
  }
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

template float TextInput::TakeFloat<float>(const char* token);
template double TextInput::TakeFloat<double>(const char* token);

}  // namespace slamdb::orbslam3
