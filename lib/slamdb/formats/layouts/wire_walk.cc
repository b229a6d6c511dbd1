// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/detail/wire_walk.h"

#include <algorithm>

namespace slamdb::layouts {
namespace {

using Kind = WireType::Kind;

constexpr int kDeepest = 64;
constexpr std::uint64_t kKeypointBytes = 28;
constexpr std::array<std::uint64_t, 8> kDepthBytes = {1, 1, 2, 2, 4, 4, 8, 2};  // of OpenCV's element types

// Behind a cv::Mat; kNowhere when there can be none.
std::uint64_t BehindMatrix(std::string_view bytes, std::uint64_t at) {
  constexpr std::uint64_t kHead = 13;
  constexpr std::int32_t kMostTypes = 512 * 8;
  const auto columns = NumberAt<std::int32_t>(bytes, at), rows = NumberAt<std::int32_t>(bytes, at + 4),
             type = NumberAt<std::int32_t>(bytes, at + 8);
  const auto continuous = NumberAt<std::uint8_t>(bytes, at + 12);
  if (!continuous || *continuous > 1 || *columns < 0 || *rows < 0 || *type < 0 || *type >= kMostTypes) return kNowhere;
  const std::uint64_t element =
      kDepthBytes[static_cast<std::size_t>(*type & 7)] * (static_cast<std::uint64_t>(*type >> 3) + 1);
  const std::uint64_t elements = static_cast<std::uint64_t>(*columns) * static_cast<std::uint64_t>(*rows);
  const std::uint64_t left = bytes.size() - at - kHead;
  return elements > left / element ? kNowhere : at + kHead + elements * element;
}

std::uint64_t BehindKeypoints(std::string_view bytes, std::uint64_t at) {
  const auto count = NumberAt<std::int32_t>(bytes, at);
  if (!count || *count < 0) return kNowhere;
  const std::uint64_t wanted = static_cast<std::uint64_t>(*count);
  return wanted > (bytes.size() - at - 4) / kKeypointBytes ? kNowhere : at + 4 + wanted * kKeypointBytes;
}

}  // namespace

// ---- Where every class has been met

std::uint64_t WarmWalk::Add(std::uint64_t at, std::uint64_t count, std::uint64_t bytes) const {
  if (at > bytes_.size() || (bytes > 0 && count > (bytes_.size() - at) / bytes)) return kNowhere;
  return at + count * bytes;
}

std::optional<std::uint64_t> WarmWalk::Count(std::uint64_t at) const {
  if (size_bytes_ == 8) return NumberAt<std::uint64_t>(bytes_, at);
  const auto count = NumberAt<std::uint32_t>(bytes_, at);
  if (!count) return std::nullopt;
  return *count;
}

std::uint64_t WarmWalk::Behind(const WireType& type, std::uint64_t at, int depth) const {
  if (at == kNowhere || depth > kDeepest) return kNowhere;
  switch (type.kind) {
    case Kind::kFixed:
      return Add(at, 1, type.bytes);
    case Kind::kNumbers:
    case Kind::kBools:
    case Kind::kString: {
      const auto count = Count(at);
      return count ? Add(at + size_bytes_, *count, type.kind == Kind::kNumbers ? type.bytes : 1) : kNowhere;
    }
    case Kind::kCollection:
    case Kind::kMap:
    case Kind::kArray:
      return BehindElements(type, at, depth);
    case Kind::kPointer: {
      const auto id = NumberAt<std::int16_t>(bytes_, at);
      if (!id || *id < -1) return kNowhere;
      return Add(at, 1, *id == -1 ? 2 : 6);
    }
    case Kind::kValue:
    case Kind::kRaw:
      return BehindMembers(wire_.classes[type.class_row], at, depth + 1);
    case Kind::kMatrix:
      return BehindMatrix(bytes_, at);
    case Kind::kMatrix2:
      return kNowhere;
    case Kind::kKeypoints:
      return BehindKeypoints(bytes_, at);
  }
  return kNowhere;
}

std::uint64_t WarmWalk::BehindElements(const WireType& type, std::uint64_t at, int depth) const {
  std::uint64_t count = type.count;
  if (type.kind != Kind::kArray) {
    const auto found = Count(at);
    const auto version = NumberAt<std::uint32_t>(bytes_, at + size_bytes_);
    if (!found || version != 0U) return kNowhere;
    count = *found;
    at += size_bytes_ + 4U;
  }
  const WireType& element = wire_.types[type.element];
  const WireType* second = type.kind == Kind::kMap ? &wire_.types[type.second] : nullptr;
  if (element.kind == Kind::kFixed && (second == nullptr || second->kind == Kind::kFixed))
    return Add(at, count, element.bytes + (second != nullptr ? second->bytes : 0));
  if (count > bytes_.size()) return kNowhere;
  for (std::uint64_t i = 0; i < count; ++i) {
    at = Behind(element, at, depth + 1);
    if (second != nullptr) at = Behind(*second, at, depth + 1);
    if (at == kNowhere) return kNowhere;
  }
  return at;
}

std::uint64_t WarmWalk::BehindMembers(const WireClass& of, std::uint64_t at, int depth) const {
  for (const WireMember& member : of.members) {
    at = Behind(wire_.types[member.type], at, depth);
    if (at == kNowhere) return kNowhere;
  }
  return at;
}

// ---- A whole file

WireWalk::WireWalk(const Wire& wire, std::string_view bytes, const ArchiveEncoding& encoding)
    : wire_(wire),
      bytes_(bytes),
      size_bytes_(encoding.size_bytes),
      warm_(wire, bytes, encoding),
      ids_(wire.keys, -1),
      used_(wire.keys, false),
      seen_(wire.classes.size(), false),
      entered_(wire.classes.size(), 0) {}

bool WireWalk::Run(std::uint64_t at) {
  at_ = at;
  for (const std::uint32_t type : wire_.root)
    if (!Value(type, 0)) return false;
  return at_ == bytes_.size();
}

template <class Number>
bool WireWalk::Take(Number& number) {
  const auto found = NumberAt<Number>(bytes_, at_);
  if (!found) return false;
  number = *found;
  at_ += sizeof(Number);
  return true;
}

bool WireWalk::TakeCount(std::uint64_t& count) {
  if (size_bytes_ == 8) return Take(count);
  std::uint32_t narrow = 0;
  if (!Take(narrow)) return false;
  count = narrow;
  return true;
}

bool WireWalk::Skip(std::uint64_t bytes) {
  if (bytes > bytes_.size() - at_) return false;
  at_ += bytes;
  return true;
}

void WireWalk::Register(std::uint32_t key) {
  if (ids_[key] >= 0) return;
  ids_[key] = static_cast<std::int32_t>(key_of_id_.size());
  key_of_id_.push_back(key);
}

// Class information stands in front of the first of a class.
bool WireWalk::Info(std::uint32_t key, std::uint8_t tracking) {
  if (used_[key]) return true;
  used_[key] = true;
  std::uint8_t found = 0;
  std::uint32_t version = 0;
  return Take(found) && Take(version) && found == tracking && version == 0;
}

// What needs no class table where its classes have been met, or never does.
bool WireWalk::Warm(const WireType& type) {
  const std::uint64_t behind = warm_.Behind(type, at_, 0);
  if (behind == kNowhere) return false;
  at_ = behind;
  return true;
}

bool WireWalk::Value(std::uint32_t row, int depth) {
  const WireType& type = wire_.types[row];
  if (depth > kDeepest) return false;
  switch (type.kind) {
    case Kind::kFixed:
      return Skip(type.bytes);
    case Kind::kNumbers:
    case Kind::kBools:
      Register(type.key);
      return Warm(type);
    case Kind::kString:
    case Kind::kMatrix:
    case Kind::kKeypoints:
      return Warm(type);
    case Kind::kCollection:
    case Kind::kMap:
      return Collection(type, depth);
    case Kind::kArray:
      for (std::uint64_t i = 0; i < type.count; ++i)
        if (!Value(type.element, depth + 1)) return false;
      return true;
    case Kind::kPointer:
      return Pointer(type, depth);
    case Kind::kValue:
      Register(type.key);
      return Info(type.key, 0) && Members(wire_.classes[type.class_row], depth + 1);
    case Kind::kRaw:
      return Members(wire_.classes[type.class_row], depth + 1);
    case Kind::kMatrix2:
      return Matrix2(type);
  }
  return false;
}

bool WireWalk::Collection(const WireType& type, int depth) {
  Register(type.key);
  std::uint64_t count = 0;
  std::uint32_t version = 0;
  if ((type.info && !Info(type.key, 0)) || !TakeCount(count) || !Take(version) || version != 0) return false;
  const bool is_map = type.kind == Kind::kMap;
  const auto fixed = [&](std::uint32_t row) { return wire_.types[row].kind == Kind::kFixed; };
  if (is_map && count > 0) {
    Register(type.pair_key);
    if (!Info(type.pair_key, 0)) return false;
  }
  if (fixed(type.element) && (!is_map || fixed(type.second))) {
    const std::uint64_t bytes = wire_.types[type.element].bytes + (is_map ? wire_.types[type.second].bytes : 0);
    return (bytes == 0 || count <= (bytes_.size() - at_) / bytes) && Skip(count * bytes);
  }
  if (count > bytes_.size()) return false;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!is_map) i += SkipRun(wire_.types[type.element], count - i);
    if (i == count) return true;
    if (!Value(type.element, depth + 1) || (is_map && !Value(type.second, depth + 1))) return false;
  }
  return true;
}

// Passes over the next elements of a list of pointers whose ends are known; returns how many.
std::uint64_t WireWalk::SkipRun(const WireType& pointer, std::uint64_t most) {
  if (pointer.kind != Kind::kPointer || !seen_[pointer.class_row]) return 0;
  constexpr std::uint64_t kPointerBytes = 6;
  const std::int32_t id = ids_[wire_.classes[pointer.class_row].key];
  std::uint64_t skipped = 0;
  for (; skipped < most && objects_ < known_ends.size(); ++skipped, ++objects_) {
    const std::uint64_t end = known_ends[objects_];
    if (end <= at_ + kPointerBytes || NumberAt<std::int16_t>(bytes_, at_) != id ||
        NumberAt<std::uint32_t>(bytes_, at_ + 2) != objects_)
      break;
    at_ = end;
  }
  return skipped;
}

bool WireWalk::Matrix2(const WireType& type) {
  Register(type.key);
  std::int32_t columns = 0, rows = 0;
  std::uint64_t element = 0, kind = 0;
  if (!Info(type.key, 0) || !Take(columns) || !Take(rows) || !TakeCount(element) || !TakeCount(kind)) return false;
  if (columns < 0 || rows < 0 || element > 64) return false;
  return Skip(static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows) * element);
}

// The name of a class that nobody registered.
bool WireWalk::ExportKey(const WireClass& of) {
  std::uint64_t length = 0;
  if (of.exported.empty() || !TakeCount(length) || length != of.exported.size()) return false;
  return bytes_.substr(std::min<std::uint64_t>(at_, bytes_.size())).starts_with(of.exported) && Skip(length);
}

bool WireWalk::Pointer(const WireType& type, int depth) {
  const WireClass& declared = wire_.classes[type.class_row];
  if (!declared.abstract) Register(declared.key);
  std::int16_t id = 0;
  if (!Take(id)) return false;
  if (id == -1) return true;
  if (id < 0) return false;
  std::int64_t row = -1;
  if (static_cast<std::size_t>(id) < key_of_id_.size()) {
    row = wire_.class_of_key[key_of_id_[static_cast<std::size_t>(id)]];
  } else {  // an exported class: the first whose key stands here
    for (std::size_t i = 0; i < wire_.classes.size() && row < 0; ++i) {
      const std::uint64_t begin = at_;
      if (ids_[wire_.classes[i].key] < 0 && ExportKey(wire_.classes[i])) row = static_cast<std::int64_t>(i);
      if (row < 0) at_ = begin;
    }
    if (row >= 0) Register(wire_.classes[static_cast<std::size_t>(row)].key);
  }
  if (row < 0) return false;
  const WireClass& of = wire_.classes[static_cast<std::size_t>(row)];
  std::uint32_t object = 0;
  if (!Info(of.key, 1) || !Take(object) || object > objects_) return false;
  if (object < objects_) return true;
  ++objects_;
  const bool first = !seen_[static_cast<std::size_t>(row)];
  seen_[static_cast<std::size_t>(row)] = true;
  if (!first && object < known_ends.size() && known_ends[object] > at_) {
    at_ = known_ends[object];
    return true;
  }
  return Members(of, depth + 1);
}

bool WireWalk::Members(const WireClass& of, int depth) {
  for (const std::uint32_t key : of.registers) Register(key);
  const bool seen = visitor != nullptr && (of.name == "KeyFrame" || of.name == "MapPoint" || of.name == "Map" ||
                                           of.name == "Atlas" || of.name == "GeometricCamera");
  std::vector<std::uint64_t> offsets;
  if (seen) offsets.reserve(of.members.size() + 1);
  std::size_t& entered = entered_[static_cast<std::size_t>(&of - wire_.classes.data())];
  for (std::size_t i = 0; i < of.members.size(); ++i) {
    entered = std::max(entered, i + 1);
    if (seen) offsets.push_back(at_);
    if (!Value(of.members[i].type, depth)) return false;
  }
  entered = of.members.size() + 1;
  if (seen) {
    offsets.push_back(at_);
    visitor->Record(of, offsets);
  }
  return true;
}

}  // namespace slamdb::layouts
