// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "slamdb/formats/layouts/detail/wire.h"

// Walks through a binary archive as a layout says, counts and all, and decodes nothing.
namespace slamdb::layouts {

inline constexpr std::uint64_t kNowhere = ~std::uint64_t{0};

// A number at a place that may be past the end.
template <class Number>
std::optional<Number> NumberAt(std::string_view bytes, std::uint64_t at) {
  if (at > bytes.size() || bytes.size() - at < sizeof(Number)) return std::nullopt;
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof(number));
  return number;
}

// Steps over values where every class has been met before: no class information, no new objects. That is how all
// records of a file are but the first ones, and it needs no class table.
class WarmWalk {
 public:
  WarmWalk(const Wire& wire, std::string_view bytes, const ArchiveEncoding& encoding)
      : wire_(wire), bytes_(bytes), size_bytes_(encoding.size_bytes) {}

  // Behind a value at `at`; kNowhere when there can be none.
  std::uint64_t Behind(std::uint32_t type, std::uint64_t at) const { return Behind(wire_.types[type], at, 0); }
  std::uint64_t Behind(const WireType& type, std::uint64_t at, int depth) const;
  std::uint64_t BehindMembers(const WireClass& of, std::uint64_t at, int depth) const;

 private:
  std::uint64_t BehindElements(const WireType& type, std::uint64_t at, int depth) const;
  std::uint64_t Add(std::uint64_t at, std::uint64_t count, std::uint64_t bytes) const;
  std::optional<std::uint64_t> Count(std::uint64_t at) const;

  const Wire& wire_;
  const std::string_view bytes_;
  const std::uint8_t size_bytes_;
};

// Sees each keyframe, map point, map, camera and atlas that a walk has passed.
class RecordVisitor {
 public:
  virtual ~RecordVisitor() = default;
  // `offsets`: of each member; then the end.
  virtual void Record(const WireClass& of, std::span<const std::uint64_t> offsets) = 0;
};

// Walks through a whole file: class table, object ids, class information.
class WireWalk {
 public:
  WireWalk(const Wire& wire, std::string_view bytes, const ArchiveEncoding& encoding);

  // From `at` on. Returns whether the last byte was reached.
  bool Run(std::uint64_t at);
  // How far it came.
  std::uint64_t at() const { return at_; }
  // By class: of how many of its members the first ones were come to; one more than there are where an object is whole.
  const std::vector<std::size_t>& members_entered() const { return entered_; }

  RecordVisitor* visitor = nullptr;           // may be null
  std::span<const std::uint64_t> known_ends;  // by object id: where records end that were seen before; 0: unknown

 private:
  bool Value(std::uint32_t type, int depth);
  bool Members(const WireClass& of, int depth);
  bool Pointer(const WireType& type, int depth);
  bool Collection(const WireType& type, int depth);
  std::uint64_t SkipRun(const WireType& pointer, std::uint64_t most);
  bool Matrix2(const WireType& type);
  bool Warm(const WireType& type);
  bool Info(std::uint32_t key, std::uint8_t tracking);
  void Register(std::uint32_t key);
  bool ExportKey(const WireClass& of);
  template <class Number>
  bool Take(Number& number);
  bool TakeCount(std::uint64_t& count);
  bool Skip(std::uint64_t bytes);

  const Wire& wire_;
  const std::string_view bytes_;
  const std::uint8_t size_bytes_;
  const WarmWalk warm_;
  std::uint64_t at_ = 0;
  std::vector<std::int32_t> ids_;  // by key; -1: not registered
  std::vector<bool> used_;         // by key: its information was there
  std::vector<std::uint32_t> key_of_id_;
  std::vector<bool> seen_;  // by class: objects of it
  std::vector<std::size_t> entered_;
  std::uint32_t objects_ = 0;
};

}  // namespace slamdb::layouts
