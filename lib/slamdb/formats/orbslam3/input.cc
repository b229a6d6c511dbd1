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
    text += id != Id<KeyFrame>::kNone ? std::to_string(id)
                                      : "no. " + std::to_string(ordinal + 1) + " of " + std::to_string(of);
  }
  if (field != nullptr) text += std::string(", ") + field;
  return text;
}

void Cursor::Fail(const std::string& problem, ErrorKind kind) const {
  throw Error(kind, stream_->path(), place.ToString(offset()), problem);
}

// How much of the list that the cursor is in was read before it.
std::string Cursor::WholeSoFar() const {
  if (place.entity == nullptr) return {};
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
  Need(size + 1);
  std::string text(next_ + 1, size);
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
  Fail("expected a number, found '" + std::string(next_, std::min(end, next_ + 24)) +
       "': the file is damaged, or not written by ORB-SLAM3 v1.0");
}

// Counts the ends of tokens in blocks that the compiler turns into vector code, and walks where a block holds the last
// token or what can be looked at ends.
void TextInput::SkipTokens(std::size_t count) {
  constexpr std::ptrdiff_t kBlock = 64;
  while (count > 0) {
    SkipSpace();
    std::size_t walk = 1;
    while (end_ - next_ > kBlock) {
      std::uint8_t ends = 0;
      for (std::ptrdiff_t i = 0; i < kBlock; ++i)
        ends = static_cast<std::uint8_t>(ends + (!IsSpace(next_[i]) && IsSpace(next_[i + 1])));
      if (ends >= count) {
        walk = count;
        break;
      }
      count -= ends;
      next_ += kBlock;
    }
    for (; walk > 0; --walk, --count) {
      SkipSpace();
      while (next_ != end_ && !IsSpace(*next_)) ++next_;
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
    Finish(parsed, true);
    return value;
  }
  Finish(parsed, error == std::errc());
  return value;
}

template float TextInput::TakeFloat<float>(const char* token);
template double TextInput::TakeFloat<double>(const char* token);

}  // namespace slamdb::orbslam3
