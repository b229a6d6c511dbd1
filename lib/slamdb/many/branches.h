// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "slamdb/export.h"
#include "slamdb/formats/location.h"
#include "slamdb/formats/rows/revisions.h"
#include "slamdb/model/atlas.h"

// Two atlases of one store, as MergeThreeWays (edit/merge/three_way.h) takes them.
namespace slamdb {

struct StoredBranches {
  std::string store;                 // its path
  RevisionName ours, theirs;         // the revisions that they are now
  std::optional<RevisionName> base;  // that both come from, as the history knows (Store::CommonBase)
  bool is_newest = false;            // ours, of its atlas

  // Of one of the revisions, to be read.
  std::string LocationOf(const RevisionName& revision) const { return store + "#" + revision.ToString(); }
};

// nullopt: the two are not atlases of one store.
//
// Throws Error: kUsage where an atlas is called as one of the revisions is written; as Store::Open and FindRevision do.
[[nodiscard]] SLAMDB_EXPORT std::optional<StoredBranches> FindBranches(const Location& ours, const Location& theirs,
                                                                       double lock_timeout = 5);

// A side that lacks much of what the history says it comes from was more likely saved from before that, or is another
// map by now: all that it lacks would count as deleted.
//
// Throws Error (kNotPossible): a side lacks more than a tenth of the keyframes of the base, or half of few; the base
// has none. Cost: hashing all keypoints and descriptors.
SLAMDB_EXPORT void RequireBase(const StoredBranches& branches, const Atlas& base, const Atlas& ours,
                               const Atlas& theirs, int threads = 0);

}  // namespace slamdb
