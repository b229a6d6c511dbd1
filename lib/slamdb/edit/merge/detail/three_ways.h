// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <functional>
#include <string_view>

#include "slamdb/edit/merge/three_way.h"
#include "slamdb/model/detail/record_codec.h"

// The rule of merging three ways, for one value.
namespace slamdb::detail {

enum class Pick { kOurs, kTheirs, kConflict };

// Whose value stands: that of who changed it. `equal(a, b)` compares; without a base each that differs is a conflict.
template <class Value, class Equal = std::equal_to<>>
Pick PickOf(const Value* base, const Value& ours, const Value& theirs, const Equal& equal = {}) {
  if (equal(ours, theirs) || (base != nullptr && equal(*base, theirs))) return Pick::kOurs;
  return base != nullptr && equal(*base, ours) ? Pick::kTheirs : Pick::kConflict;
}

// Whether the fields that walk(visit) visits are the same to the bit.
template <class Entity, class Walk>
bool AreFieldsEqual(const Entity& a, const Entity& b, const Walk& walk) {
  thread_local ByteWriter first, second;
  first.Clear();
  second.Clear();
  RecordWriter to_first(first), to_second(second);
  walk(EachTo(to_first, a));
  walk(EachTo(to_second, b));
  return std::ranges::equal(first.bytes(), second.bytes());
}

// Whether a list has an id that it had not.
inline bool HasMore(const Column<KeyFrameId>& now, const Column<KeyFrameId>& before) {
  return std::ranges::any_of(now, [&](KeyFrameId id) { return std::ranges::find(before, id) == before.end(); });
}

template <class Entity, class Walk>
void CopyFields(const Entity& from, Entity& to, const Walk& walk) {
  walk([&](std::string_view, auto... members) { Member(to, members...) = Member(from, members...); });
}

}  // namespace slamdb::detail
