// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/edit/repair/detail/field_bits.h"
#include "slamdb/edit/repair/journal.h"

// What is different about an entity, field by field.
namespace slamdb::field_bits {

template <class Field>
std::vector<std::uint64_t> BitsOf(const Field& field, std::size_t begin, std::size_t end) {
  std::vector<std::uint64_t> bits;
  for (std::size_t i = begin; i < end; ++i) AppendBits(ElementAt(field, i), bits);
  return bits;
}

// In fields of equal length every run of elements that differ is an edit; otherwise what lies between the common
// beginning and the common end is one.
template <class Field>
void AppendFieldChanges(std::string_view name, const Field& before, const Field& after, std::vector<FieldEdit>& edits) {
  const auto differs = [&](std::size_t i, std::size_t j) {
    return !SameElement(ElementAt(before, i), ElementAt(after, j));
  };
  const auto add = [&](std::size_t begin, std::size_t before_end, std::size_t after_end) {
    edits.push_back({std::string(name), KindsOf<Field>(), begin, BitsOf(before, begin, before_end),
                     BitsOf(after, begin, after_end)});
  };
  std::size_t before_end = SizeOf(before), after_end = SizeOf(after), begin = 0;
  if (before_end == after_end) {
    for (; begin < before_end; ++begin) {
      if (!differs(begin, begin)) continue;
      const std::size_t first = begin;
      while (begin < before_end && differs(begin, begin)) ++begin;
      add(first, begin, begin);
    }
    return;
  }
  while (begin < std::min(before_end, after_end) && !differs(begin, begin)) ++begin;
  for (; before_end > begin && after_end > begin && !differs(before_end - 1, after_end - 1); --before_end) --after_end;
  add(begin, before_end, after_end);
}

template <class Field>
requires kIsRecord<Field>
void AppendFieldChanges(std::string_view name, const Field& before, const Field& after, std::vector<FieldEdit>& edits) {
  AppendFieldChanges(name, BytesOf(before), BytesOf(after), edits);
}

template <class Entity>
std::vector<FieldEdit> ChangesOf(const Entity& before, const Entity& after) {
  std::vector<FieldEdit> edits;
  ForEachField(static_cast<const Entity*>(nullptr), [&](std::string_view name, auto... members) {
    const auto &one = Member(before, members...), &other = Member(after, members...);
    if (!SameField(one, other)) AppendFieldChanges(name, one, other, edits);
  });
  return edits;
}

}  // namespace slamdb::field_bits
