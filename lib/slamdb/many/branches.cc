// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/branches.h"

#include <algorithm>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/merge/three_way.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"

namespace slamdb {
namespace {

using detail::Concat;

// An atlas may be called as a revision of another one is written, in stores that earlier slamdbs made.
void RequireSeen(Store& store, const RevisionName& revision) {
  if (store.FindRevision(revision.ToString()) != revision)
    throw Error(ErrorKind::kUsage, store.path(), "",
                Concat("an atlas is called ", revision.ToString(),
                       ", which hides the revision of that number: save it under another name and remove it"));
}

}  // namespace

std::optional<StoredBranches> FindBranches(const Location& ours, const Location& theirs, double lock_timeout) {
  const bool are_named = !ours.name.empty() && !theirs.name.empty() && HoldsNamedAtlases(ours.path);
  if (!are_named || !detail::IsSameFile(ours.path, std::nullopt, theirs.path, std::nullopt)) return std::nullopt;
  Store store = Store::Open(ours.path, lock_timeout);
  StoredBranches branches{.store = ours.path,
                          .ours = store.FindRevision(ours.name),
                          .theirs = store.FindRevision(theirs.name),
                          .base = store.CommonBase(ours.name, theirs.name)};
  branches.is_newest = branches.ours == store.FindRevision(branches.ours.atlas);
  for (const RevisionName& revision : {branches.ours, branches.theirs}) RequireSeen(store, revision);
  if (branches.base) RequireSeen(store, *branches.base);
  return branches;
}

void RequireBase(const StoredBranches& branches, const Atlas& base, const Atlas& ours, const Atlas& theirs,
                 int threads) {
  constexpr std::size_t kMostDeleted = 10, kFewDeleted = 3;  // a tenth of the base
  const RevisionName& revision = *branches.base;
  const auto refuse = [&](const std::string& why) { throw Error(ErrorKind::kNotPossible, branches.store, "", why); };
  std::size_t keyframes = 0;
  for (const Map& map : base.maps) keyframes += map.keyframes.size();
  if (keyframes == 0)
    refuse(Concat("the history says that both were made of ", revision.ToString(),
                  ", which has no keyframes to tell what they have in common: --base ", branches.LocationOf(revision),
                  " takes it all the same, --no-base keeps their maps side by side"));
  for (const auto& [name, side] : {std::pair(branches.ours, &ours), std::pair(branches.theirs, &theirs)}) {
    const std::size_t lacking = CountMissingKeyframes(base, *side, threads);
    if (lacking <= std::max(keyframes / kMostDeleted, kFewDeleted) && 2 * lacking < keyframes) continue;
    refuse(
        Concat(name.ToString(), " lacks ", lacking, " of the ", keyframes, " keyframes of ", revision.ToString(),
               ", which the history says it was made of: they would count as deleted. Where it was saved from before "
               "that, say what both were made of, as --base ",
               branches.store, "#NAME@N ('slamdb log' lists them); where they were culled, --base ",
               branches.LocationOf(revision)));
  }
}

}  // namespace slamdb
