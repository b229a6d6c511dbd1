// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <initializer_list>
#include <vector>

#include "slamdb/formats/orbslam3/detail/class_table.h"

// The pointers of an archive, and the objects that they have brought so far.
namespace slamdb::orbslam3 {

// Objects of one list get ids one after the other, so the object table is a list of ranges.
struct ObjectRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  WireClass wire_class = WireClass::kAtlas;
  std::uint32_t map = 0;
  std::uint64_t first_row = 0;
};

class ObjectTable {
 public:
  std::uint32_t next() const { return next_; }
  void Add(WireClass wire_class, std::uint32_t map, std::uint64_t row) {
    if (!ranges_.empty()) {
      ObjectRange& last = ranges_.back();
      if (last.wire_class == wire_class && last.map == map && last.first_row + last.count == row) {
        ++last.count;
        ++next_;
        return;
      }
    }
    ranges_.push_back({next_++, 1, wire_class, map, row});
  }
  // The range of a known object.
  const ObjectRange& Find(std::uint32_t id) const {
    const auto behind =
        std::upper_bound(ranges_.begin(), ranges_.end(), id,
                         [](std::uint32_t value, const ObjectRange& range) { return value < range.first; });
    return *(behind - 1);
  }

 private:
  std::vector<ObjectRange> ranges_;
  std::uint32_t next_ = 0;
};

struct Pointer {
  enum class Kind { kNull, kNew, kKnown } kind;
  WireClass wire_class = WireClass::kCount;
  std::uint32_t object = 0;
};

// Boost's pointer: class id, class info at first use, object id. `expected` is the static type of the list.
template <class Archive>
Pointer TakePointer(Archive& archive, const ObjectTable& objects, std::initializer_list<WireClass> expected) {
  if (expected.size() == 1) archive.classes.Register(*expected.begin());
  const auto class_id = archive.input.template Take<std::int16_t>();
  if (class_id == -1) return {Pointer::Kind::kNull};
  const WireClass found = archive.classes.Find(class_id);
  if (std::find(expected.begin(), expected.end(), found) == expected.end())
    archive.input.Fail("class id " + std::to_string(class_id) + ", expected " +
                       std::to_string(archive.classes.Register(*expected.begin())) +
                       ": the file is damaged, or written by a fork with other members");
  archive.TakeClassInfo(found, /*tracking=*/1);
  const auto object = archive.input.template Take<std::uint32_t>();
  if (object > objects.next())
    archive.input.Fail("object id " + std::to_string(object) + ", expected at most " + std::to_string(objects.next()) +
                       ": the file is damaged");
  if (object == objects.next()) return {Pointer::Kind::kNew, found, object};
  return {Pointer::Kind::kKnown, found, object};
}

// What a pointer that brings no new object stands for.
template <class Archive>
RepeatedEntry Repeated(const Archive& archive, const ObjectTable& objects, const Pointer& pointer,
                       std::uint64_t position) {
  if (pointer.kind == Pointer::Kind::kNull) return {.position = position};
  const ObjectRange& range = objects.Find(pointer.object);
  if (range.wire_class != pointer.wire_class)
    archive.input.Fail("a pointer to object " + std::to_string(pointer.object) +
                       ", which is of another class: the file is damaged");
  return {position, range.map, range.first_row + (pointer.object - range.first)};
}

}  // namespace slamdb::orbslam3
