// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/base/progress.h"
#include "slamdb/export.h"

// Two stores, files or databases of servers, come to hold the same atlases with the same revisions.
namespace slamdb {

// How two stores have an atlas, and what became of it.
enum class SyncResult {
  kSame,      // both have the same newest revision, and nothing was done
  kCopied,    // one was behind, or lacked the atlas or tags: it has them now
  kAhead,     // the second has more, which `one_way` leaves there
  kDiverged,  // each has revisions that the other lacks: both stay as they are
  kBranched,  // likewise, and the second has those of the first under another name, too
  kFailed,
};

struct SyncedAtlas {
  std::string name;
  SyncResult result = SyncResult::kSame;
  bool to_first = false;                 // where the revisions went: to the first store, or to the second
  std::vector<std::uint64_t> revisions;  // that were copied, by their numbers where they came from
  std::string branch;                    // kBranched: the name in the second
  struct Tag {
    std::string tag;
    bool to_first = false;
  };
  std::vector<Tag> tags;  // that were copied
  struct Conflict {
    std::string tag;
    std::uint64_t first = 0, second = 0;  // the revision that it names there
  };
  std::vector<Conflict> conflicts;  // tags that name another revision in each: both stay
  // What stays in one store, as what is newest is the same, and what comes before it is not brought.
  struct Alone {
    bool in_first = false;
    std::vector<std::uint64_t> revisions;  // that the other neither has nor had
    std::vector<std::string> tags;         // of these
  };
  std::vector<Alone> alone;  // one for each store that has such; of kSame and kCopied
  std::string failure;       // kFailed: why
};

struct SyncReport {
  std::string first, second;         // the stores
  std::vector<SyncedAtlas> atlases;  // by name, without those that are the same and of which no more is to be told
  std::uint64_t same = 0;            // of all

  SLAMDB_EXPORT std::uint64_t Count(SyncResult result) const;
  SLAMDB_EXPORT std::uint64_t Conflicts() const;  // tags
};

struct SyncOptions {
  std::vector<std::string> names;  // only these atlases; empty: all
  bool one_way = false;            // only from the first to the second
  // Where both went on from one revision: save what the first made of it in the second as NAME-of-HOST, HOST being
  // where its newest revision was made, branched off where they part; as NAME-of-HOST-2, -3, ... where that is another
  // atlas.
  bool branch_diverged = false;
  bool dry_run = false;  // only tell what would be done
  bool sync = true;      // see StoreOptions
  double lock_timeout = 5;
  // How often it goes on by itself after an error that doing it again may mend (IsWorthRetrying), since the last thing
  // that was copied; with pauses of 1, 2, 4, ... seconds, a minute at most.
  int retries = 0;
  std::function<void(const Error& error, double pause)> on_retry;  // may be empty
  std::function<void(const SyncedAtlas&)> on_done;                 // each that is not the same; may be empty
  // Called when the work ends early, with what was done, before that is thrown on. May be empty.
  std::function<void(const SyncReport&)> on_stopped;
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty; throwing ends the work, with whole revisions in the stores
};

// Copies what either store lacks: atlases, revisions, tags. A revision keeps its hash, what the log says of it, what it
// was made of, and its number, unless that is taken: then it gets the next one. Whether a revision is there is told by
// its hash; so nothing that was interrupted needs to be cleaned up: the next call goes on with the next revision.
//   An atlas that was removed from one store comes back from the other.
//   Revisions before the newest that both have are not brought, nor their tags: the report tells of them
//   (SyncedAtlas::alone).
//   Revisions that were given up in one store stay there in the other, and do not come back: only what is newer is
//   copied. Nor has a store diverged that gave up what the other has as its newest: its log tells that it had that.
//   Where one side merged what the newest revision of the other is (`from`), the other is behind it.
// A store is made where something is to be copied to it and it is missing.
//
// Cost: of atlases that are the same, some 20 bytes a revision, a thousand atlases in one statement; of a revision what
// changed (Store::LoadOnto, Store::Save). Memory: of three atlases.
//
// Throws Error: kUsage when both are one store, or what a path leads to is named like no store; kNotFound when neither
// is there, or the first where it is one way; and what ends the work for other atlases, too (the connection is lost,
// the disk is full, the store is locked). What fails for one atlas alone is in the report.
SLAMDB_EXPORT SyncReport SyncStores(const std::string& first, const std::string& second,
                                    const SyncOptions& options = {});

// `same`, `copied`, `ahead`, `diverged`, `branched`, `failed`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(SyncResult result);

// As schema/sync.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const SyncReport& report);

}  // namespace slamdb
