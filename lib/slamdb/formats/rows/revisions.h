// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/export.h"

// Revisions: every save of an atlas in a store that changes it makes one, numbered from 1, and all can be read again
// until GiveUp.
//
// NAME@3               the third
// NAME@-1              the one before the newest; @-2 the one before that
// NAME@{2026-11-20}    the newest that was saved by the end of that day, UTC; {2026-11-20T08:30} by the end of that
//                      minute
// NAME@release         the one that has this tag
//
// An atlas whose name is the whole of it goes first, so that names with an @ stay what they are.
namespace slamdb {

// What a save changed in the maps, by ids.
struct MapChanges {
  std::uint64_t keyframes_added = 0, keyframes_removed = 0;
  std::uint64_t keyframes_moved = 0;  // that have another pose
  std::uint64_t points_added = 0, points_removed = 0;
  std::uint64_t points_moved = 0;  // that have another position
  std::uint64_t observations_added = 0, observations_removed = 0;
  friend bool operator==(const MapChanges&, const MapChanges&) = default;
};

// A revision of an atlas.
struct RevisionName {
  std::string atlas;
  std::uint64_t number = 0;
  std::uint64_t hash = 0;  // HashOf (model/digest.h) of it; 0: not known
  std::string ToString() const { return atlas + "@" + std::to_string(number); }
  friend bool operator==(const RevisionName&, const RevisionName&) = default;
};

// The revisions of an atlas that can be read, as stores are compared by.
struct RevisionChain {
  struct Link {
    std::uint64_t number = 0, hash = 0;
    std::uint64_t from_hash = 0;  // of what it was made of besides; 0: nothing
  };
  struct Tag {
    std::string name;
    std::uint64_t number = 0;
  };
  std::string name;
  std::vector<Link> links;     // oldest first
  std::vector<Link> given_up;  // likewise; see ChainQuery::given_up. What they were made of is not known
  std::vector<Tag> tags;       // by name
};

// Which atlases Store::Chains tells of.
struct ChainQuery {
  std::vector<std::string> names;  // only these; empty: all
  std::string after;               // only names behind this one
  std::size_t count = 1000;        // the first so many
  bool given_up = false;           // the revisions, too, that the log tells of and that can be read no more
};

// Which revisions GiveUp leaves. The newest of an atlas stays always, and so does what has a tag, and where another
// atlas of the store was branched off or merged from.
struct GiveUpOptions {
  std::optional<std::uint64_t> keep;  // so many of the newest of each atlas
  std::optional<double> keep_days;    // what was saved in so many days up to now
  bool dry_run = false;               // only tell what would go
};

// What it did with one atlas.
struct GivenUp {
  std::string atlas;
  std::vector<std::uint64_t> revisions;  // that are gone, ascending
  std::uint64_t kept = 0;                // how many are left
};

struct GiveUpReport {
  std::vector<GivenUp> atlases;  // by name
  std::uint64_t pictures = 0;    // that nobody had any more
  std::uint64_t bytes = 0;       // about what all that took in the file, which keeps its size until Store::Vacuum
};

// Whether a revision may have the name: that of an atlas (IsNameOfAtlas) without `@`, `{` and `}`, and no number.
[[nodiscard]] SLAMDB_EXPORT bool IsNameOfTag(const std::string& name);

}  // namespace slamdb
