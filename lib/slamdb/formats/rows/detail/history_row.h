// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "slamdb/base/detail/text.h"
#include "slamdb/formats/rows/stored.h"

// A row of the history beside its revision, as both databases select it.
namespace slamdb::rows {

// Its columns, in this order: at, tool, action, atlas, provenance; maps, keyframes, points, observations, inserted,
// updated, deleted, unchanged, hash; who, revision, whether that can be read, its tags (a line each); what it was made
// of besides: atlas, number, hash; what changed: of MapChanges each.
// `Row`: with Text, Integer and IsNull of a column.
template <class Row>
HistoryEntry HistoryEntryOf(const Row& row) {
  HistoryEntry entry;
  int column = 0;
  const auto number = [&] { return static_cast<std::uint64_t>(row.Integer(column++)); };
  for (std::string* text : {&entry.at, &entry.tool, &entry.action, &entry.atlas, &entry.provenance})
    *text = row.Text(column++);
  for (std::uint64_t* value : {&entry.maps, &entry.keyframes, &entry.points, &entry.observations, &entry.inserted,
                               &entry.updated, &entry.deleted, &entry.unchanged, &entry.hash})
    *value = number();
  entry.who = row.Text(column++);
  entry.revision = number();
  entry.readable = number() != 0;
  const std::string tags(row.Text(column++));
  if (!tags.empty())
    for (const std::string_view tag : detail::Split(tags, '\n')) entry.tags.emplace_back(tag);
  std::ranges::sort(entry.tags);
  const bool has_source = !row.IsNull(column);
  const std::string atlas(row.Text(column++));
  const std::uint64_t source = number(), hash = number();
  if (has_source) entry.from = RevisionName{atlas, source, hash};
  if (row.IsNull(column)) return entry;
  MapChanges& changes = entry.changes.emplace();
  for (std::uint64_t* count :
       {&changes.keyframes_added, &changes.keyframes_removed, &changes.keyframes_moved, &changes.points_added,
        &changes.points_removed, &changes.points_moved, &changes.observations_added, &changes.observations_removed})
    *count = number();
  return entry;
}

}  // namespace slamdb::rows
