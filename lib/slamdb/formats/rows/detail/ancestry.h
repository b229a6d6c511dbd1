// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/formats/rows/detail/revision_names.h"
#include "slamdb/formats/rows/revisions.h"

// What revisions were made of.
namespace slamdb::rows {

// A revision as a store tells of it.
struct RevisionOf {
  std::string atlas;
  std::int64_t number = 0, hash = 0;
  std::int64_t history = 0;          // when it came into the store: greater is later
  std::optional<RevisionName> from;  // besides the one before it
};

// Of a row with its columns: atlas, number, hash, history; what it was made of besides: atlas, number, hash.
// `Row`: with Text, Integer and IsNull of a column.
template <class Row>
RevisionOf RevisionOfRow(const Row& row) {
  RevisionOf revision{std::string(row.Text(0)), row.Integer(1), row.Integer(2), row.Integer(3), std::nullopt};
  if (!row.IsNull(4))
    revision.from = RevisionName{std::string(row.Text(4)), static_cast<std::uint64_t>(row.Integer(5)),
                                 static_cast<std::uint64_t>(row.Integer(6))};
  return revision;
}

// The newest revision that both come from. One that is again what the one before it was made of, and says so (`from`),
// was restored, and not made of the one before. `all`: at least those of the atlases that the two were made of, and of
// these, by atlas and number.
//
// Of two revisions with one content each is the other, where their atlases have something in common: one may be a copy
// of the other that the history does not tell of. What one content alone connects has nothing in common.
std::optional<RevisionName> CommonBase(const std::vector<RevisionOf>& all, const Named& first, const Named& second);

}  // namespace slamdb::rows
