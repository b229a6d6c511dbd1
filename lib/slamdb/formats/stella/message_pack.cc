// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/stella/detail/message_pack.h"

#include <algorithm>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"

namespace slamdb::stella {
namespace {

using detail::Concat;

// First bytes of values. Those below are fixed: a positive integer, a map, a list, a text with its size in it.
enum Type : std::uint8_t {
  kFixMap = 0x80,
  kFixList = 0x90,
  kFixText = 0xa0,
  kNil = 0xc0,
  kFalse = 0xc2,
  kTrue = 0xc3,
  kBinary8 = 0xc4,
  kBinary32 = 0xc6,
  kExtension8 = 0xc7,
  kExtension32 = 0xc9,
  kFloat32 = 0xca,
  kFloat64 = 0xcb,
  kUnsigned8 = 0xcc,
  kUnsigned64 = 0xcf,
  kSigned8 = 0xd0,
  kSigned64 = 0xd3,
  kFixExtension1 = 0xd4,
  kFixExtension16 = 0xd8,
  kText8 = 0xd9,
  kText32 = 0xdb,
  kList16 = 0xdc,
  kList32 = 0xdd,
  kMap16 = 0xde,
  kMap32 = 0xdf,
  kFixNegative = 0xe0,
};

std::string_view KindOf(std::uint8_t type) {
  if (type < kFixMap || type >= kFixNegative || (type >= kUnsigned8 && type <= kSigned64)) return "an integer";
  if (type < kFixList || type == kMap16 || type == kMap32) return "a map";
  if (type < kFixText || type == kList16 || type == kList32) return "a list";
  if (type < kNil || (type >= kText8 && type <= kText32)) return "a text";
  if (type == kFloat32 || type == kFloat64) return "a number";
  if (type == kNil) return "nil";
  if (type == kFalse || type == kTrue) return "a truth value";
  return type >= kBinary8 && type <= kBinary32 ? "binary data" : "a value of a type that no JSON has";
}

}  // namespace

void MessagePackReader::Fail(const std::string& problem) const {
  throw Error(ErrorKind::kDamaged, path_, Concat("byte ", at_, place_.empty() ? "" : ", ", place_), problem);
}

void MessagePackReader::FailWith(std::string_view expected, std::uint8_t found) const {
  Fail(Concat("expected ", expected, ", found ", KindOf(found)));
}

std::uint8_t MessagePackReader::Byte() {
  if (at_ == bytes_.size()) Fail("the file ends here; was it cut, or is it still being written?");
  return static_cast<std::uint8_t>(bytes_[at_++]);
}

template <class Value>
Value MessagePackReader::BigEndian() {
  if (left() < sizeof(Value)) Fail("the file ends here; was it cut, or is it still being written?");
  Value value;
  std::memcpy(&value, bytes_.data() + at_, sizeof value);
  at_ += sizeof value;
  return Swapped(value);
}

// The last two bits of the types of one kind tell how long the length is.
std::uint64_t MessagePackReader::Length(std::uint8_t type) {
  switch (type) {
    case kText8:
    case kBinary8:
    case kExtension8:
      return Byte();
    case kText32:
    case kBinary32:
    case kExtension32:
    case kList32:
    case kMap32:
      return BigEndian<std::uint32_t>();
    default:
      return BigEndian<std::uint16_t>();
  }
}

std::uint32_t MessagePackReader::Entries(std::uint64_t count, std::uint64_t least_bytes) const {
  if (count > left() / least_bytes)
    Fail(Concat("claims ", count, " entries, and the ", left(), " bytes behind it cannot hold them"));
  return static_cast<std::uint32_t>(count);
}

std::uint32_t MessagePackReader::Map() {
  const std::uint8_t type = Byte();
  if (type >= kFixMap && type < kFixList) return Entries(type & 0x0fU, 2);
  if (type != kMap16 && type != kMap32) FailWith("a map", type);
  return Entries(Length(type), 2);
}

std::uint32_t MessagePackReader::List() {
  const std::uint8_t type = Byte();
  if (type >= kFixList && type < kFixText) return Entries(type & 0x0fU, 1);
  if (type != kList16 && type != kList32) FailWith("a list", type);
  return Entries(Length(type), 1);
}

std::string_view MessagePackReader::Text() {
  const std::uint8_t type = Byte();
  std::uint64_t size = 0;
  if (type >= kFixText && type < kNil)
    size = type & 0x1fU;
  else if (type >= kText8 && type <= kText32)
    size = Length(type);
  else
    FailWith("a text", type);
  if (size > left()) Fail(Concat("a text claims ", size, " bytes, and ", left(), " are left"));
  const std::string_view text = bytes_.substr(at_, size);
  at_ += size;
  return text;
}

bool MessagePackReader::TakeInteger(std::uint8_t type, std::int64_t& value) {
  if (type < kFixMap || type >= kFixNegative) {
    value = static_cast<std::int8_t>(type);
    return true;
  }
  switch (type) {
    case kUnsigned8:
      value = Byte();
      return true;
    case kUnsigned8 + 1:
      value = BigEndian<std::uint16_t>();
      return true;
    case kUnsigned8 + 2:
      value = BigEndian<std::uint32_t>();
      return true;
    case kSigned8:
      value = static_cast<std::int8_t>(Byte());
      return true;
    case kSigned8 + 1:
      value = static_cast<std::int16_t>(BigEndian<std::uint16_t>());
      return true;
    case kSigned8 + 2:
      value = static_cast<std::int32_t>(BigEndian<std::uint32_t>());
      return true;
    case kSigned64:
      value = static_cast<std::int64_t>(BigEndian<std::uint64_t>());
      return true;
    case kUnsigned64: {
      const auto large = BigEndian<std::uint64_t>();
      if (large > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
        Fail(Concat("an integer is ", large, ", larger than any that a map has"));
      value = static_cast<std::int64_t>(large);
      return true;
    }
    default:
      return false;
  }
}

double MessagePackReader::Number() {
  const std::uint8_t type = Byte();
  if (type == kFloat32) return static_cast<double>(std::bit_cast<float>(BigEndian<std::uint32_t>()));
  if (type == kFloat64) return std::bit_cast<double>(BigEndian<std::uint64_t>());
  std::int64_t value = 0;
  if (!TakeInteger(type, value)) FailWith("a number", type);
  return static_cast<double>(value);
}

std::int64_t MessagePackReader::Integer() {
  if (at_ < bytes_.size()) {
    const auto type = static_cast<std::uint8_t>(bytes_[at_]);
    if (type != kFloat32 && type != kFloat64) {
      ++at_;
      std::int64_t value = 0;
      if (!TakeInteger(type, value)) FailWith("an integer", type);
      return value;
    }
  }
  const double value = Number();
  constexpr double kMost = 9007199254740992;  // up to which every integer is a double
  if (!(std::abs(value) <= kMost) || value != std::floor(value)) Fail(Concat("expected an integer, found ", value));
  return static_cast<std::int64_t>(value);
}

void MessagePackReader::Skip() {
  for (std::uint64_t pending = 1; pending > 0; --pending) {
    const std::uint8_t type = Byte();
    std::uint64_t bytes = 0;
    if (type >= kFixMap && type < kFixList) {
      pending += 2 * std::uint64_t{Entries(type & 0x0fU, 2)};
    } else if (type >= kFixList && type < kFixText) {
      pending += Entries(type & 0x0fU, 1);
    } else if (type == kMap16 || type == kMap32) {
      pending += 2 * std::uint64_t{Entries(Length(type), 2)};
    } else if (type == kList16 || type == kList32) {
      pending += Entries(Length(type), 1);
    } else if (type >= kFixText && type < kNil) {
      bytes = type & 0x1fU;
    } else if ((type >= kText8 && type <= kText32) || (type >= kBinary8 && type <= kBinary32)) {
      bytes = Length(type);
    } else if (type >= kExtension8 && type <= kExtension32) {
      bytes = Length(type) + 1;
    } else if (type >= kFixExtension1 && type <= kFixExtension16) {
      bytes = (std::uint64_t{1} << (type - kFixExtension1)) + 1;
    } else if (type == kFloat32 || type == kFloat64) {
      bytes = type == kFloat32 ? 4 : 8;
    } else if (type >= kUnsigned8 && type <= kSigned64) {
      bytes = std::uint64_t{1} << (type & 3U);
    } else if (type == kNil + 1) {
      FailWith("a value", type);
    }
    if (bytes > left()) Fail("the file ends in this value; was it cut, or is it still being written?");
    at_ += bytes;
  }
}

// By half of what is there at least, so that little is copied.
void MessagePackAppender::Grow(std::size_t bytes) {
  constexpr std::size_t kLeast = 4096;
  out_.resize(at_ + std::max({bytes, at_ / 2, kLeast}));
}

void MessagePackAppender::Head(std::size_t count, std::uint8_t small, std::uint8_t type16) {
  if (count <= 15)
    Byte(static_cast<std::uint8_t>(small | count));
  else if (count <= 0xffff)
    Append(type16, static_cast<std::uint16_t>(count));
  else
    Append(static_cast<std::uint8_t>(type16 + 1), static_cast<std::uint32_t>(count));
}

void MessagePackAppender::Text(std::string_view text) {
  if (text.size() <= 31)
    Byte(static_cast<std::uint8_t>(kFixText | text.size()));
  else if (text.size() <= 0xff)
    Append(kText8, static_cast<std::uint8_t>(text.size()));
  else if (text.size() <= 0xffff)
    Append(kText8 + 1, static_cast<std::uint16_t>(text.size()));
  else
    Append(kText32, static_cast<std::uint32_t>(text.size()));
  Raw(text);
}

// Below -32, which one byte holds.
char* MessagePackAppender::PutNegative(char* at, std::int64_t value) {
  if (value >= std::numeric_limits<std::int8_t>::min()) return Typed(at, kSigned8, static_cast<std::uint8_t>(value));
  if (value >= std::numeric_limits<std::int16_t>::min())
    return Typed(at, kSigned8 + 1, static_cast<std::uint16_t>(value));
  if (value >= std::numeric_limits<std::int32_t>::min())
    return Typed(at, kSigned8 + 2, static_cast<std::uint32_t>(value));
  return Typed(at, kSigned64, static_cast<std::uint64_t>(value));
}

char* MessagePackAppender::Put(char* at, double value) {
  constexpr double kMost = std::numeric_limits<float>::max();
  if (std::abs(value) <= kMost && static_cast<double>(static_cast<float>(value)) == value)
    return Typed(at, kFloat32, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
  return Typed(at, kFloat64, std::bit_cast<std::uint64_t>(value));
}

}  // namespace slamdb::stella
