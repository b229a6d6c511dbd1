// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unordered_set>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/model/atlas.h"

// What all columns must be.
namespace slamdb::detail {

template <class... Parts>
[[noreturn]] void Refuse(const Parts&... parts) {
  throw Error(ErrorKind::kUsage, Concat(parts...));
}
template <class... Parts>
[[noreturn]] void RefuseRow(std::string_view column, std::size_t row, const Parts&... parts) {
  Refuse(column, ": row ", row, " ", parts...);
}

template <class List>
void RequireLength(std::string_view column, const List& list, std::size_t rows, std::string_view of) {
  if (list.size() != rows) Refuse(column, ": has ", list.size(), " rows, but there are ", rows, " ", of);
}
template <class List>
void RequireLengthOrNone(std::string_view column, const List& list, std::size_t rows, std::string_view of) {
  if (!list.empty()) RequireLength(column, list, rows, of);
}

// The ids of new entities: the given ones, which must be below `end` and such that no entity has them, or the next.
// `is_taken` tells of the atlas.
template <class Entity, class IsTaken>
std::vector<Id<Entity>> IdsOf(std::vector<Id<Entity>> given, std::size_t rows, std::uint64_t next, std::uint64_t end,
                              const IsTaken& is_taken) {
  if (given.empty()) {
    for (std::size_t row = 0; row < rows; ++row) given.emplace_back(next + row);
    if (rows > 0 && (next >= end || rows > end - next)) Refuse("ids: the next ones are used up; `Renumber` frees some");
    return given;
  }
  std::unordered_set<Id<Entity>> seen;
  for (std::size_t row = 0; row < rows; ++row) {
    const Id<Entity> id = given[row];
    if (id.value() >= end) RefuseRow("ids", row, "is ", id.value(), "; ids are below ", end);
    if (!seen.insert(id).second) RefuseRow("ids", row, "is ", id.value(), ", as a row above; each id is given once");
    if (is_taken(id)) RefuseRow("ids", row, "is ", id.value(), ", which the atlas has; leave ids out to get free ones");
  }
  return given;
}

// Throws Error (kNotFound) when there is none.
Map& MapOf(Atlas& atlas, MapId id);

}  // namespace slamdb::detail
