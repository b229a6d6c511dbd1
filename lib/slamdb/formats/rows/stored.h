// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/formats/rows/revisions.h"
#include "slamdb/model/summary.h"

// What stores (formats/store/store.h) tell of their atlases, of saves, and of what was done to them.
namespace slamdb {

// One atlas of a store.
struct StoredAtlas : AtlasSummary {
  std::string name;
  std::uint64_t bytes = 0;     // about what it takes in the file
  std::uint64_t revision = 0;  // the newest; counts the saves under this name that changed anything, from 1
  std::uint64_t hash = 0;      // HashOf (model/digest.h) of it
  std::string saved_at;        // UTC, `2026-01-31T12:00:00Z`
  std::string problem;         // what its row says that cannot be, as of one that was edited in SQL; empty: nothing
};

// What happened to the rows of a table.
struct TableChanges {
  std::string table;
  std::uint64_t inserted = 0, updated = 0, deleted = 0, unchanged = 0;
};

struct SaveReport {
  std::vector<TableChanges> tables;
  MapChanges map;              // against the revision before; of a first one everything is added
  std::uint64_t revision = 0;  // that the save made
  std::uint64_t hash = 0;      // HashOf the atlas
  bool replaced = false;       // an atlas of that name was there
  bool unchanged = false;      // it was there as it is: no revision was made, and at most the log tells of the save

  SLAMDB_EXPORT TableChanges Total() const;
};

// What a store takes over of a revision from another store, in place of what a save knows by itself.
struct Recorded {
  std::uint64_t number = 0;  // of the revision, above the newest of its atlas. It is made also where nothing differs
  std::string at;            // UTC, as HistoryEntry has it
  std::string who, tool;
};

struct SaveOptions {
  std::string provenance;   // one line for the history: what made the atlas (`convert session_a.osa`)
  bool overwrite = true;    // replace the atlas of that name; false: Error (kAlreadyExists), whoever was faster
  bool keep_equal = false;  // an atlas of that name and hash stays as it is, also without `overwrite`
  bool verify = false;  // of an atlas that is replaced: rows that somebody edited are written anew too, at the cost of
                        // a load; false: rows whose recorded hash is that of the new ones stay, whatever they hold, and
                        // where the hash of the atlas is that of the new one, none is looked at
  std::optional<RevisionName> from;     // what it was made of besides the revision before it, as by a merge
  std::optional<std::uint64_t> onto;    // the revision that it was made of: Error (kLocked) unless that is the newest
  std::optional<Recorded> recorded;     // of a revision of another store
  std::function<void()> before_commit;  // called when all rows are written, right before they are seen; may be empty
  int threads = 0;                      // 0: every core
  Progress progress;
};

// One line of a store's history.
struct HistoryEntry {
  std::string at;      // UTC
  std::string tool;    // `slamdb 0.1.0`
  std::string action;  // save, remove, migrate
  std::string atlas;   // name; empty for actions on the whole store
  std::string provenance;
  std::uint64_t maps = 0, keyframes = 0, points = 0, observations = 0;
  std::uint64_t inserted = 0, updated = 0, deleted = 0, unchanged = 0;  // rows
  std::uint64_t hash = 0;
  std::string who;                    // `user@host`; empty: not known, as before version 7 of stores
  std::uint64_t revision = 0;         // that it made; 0: none, or not known
  bool readable = false;              // that revision can still be read
  std::optional<MapChanges> changes;  // that it made
  std::optional<RevisionName> from;   // what it was made of besides
  std::vector<std::string> tags;      // of the revision, ascending
};

struct StoreStats {
  int version = 0;  // of the schema
  std::uint64_t page_bytes = 0, pages = 0, free_pages = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t log_bytes = 0;   // of the write-ahead log beside the file, or of a server (0: not told to this user)
  std::vector<PartSize> tables;  // bytes per table, its indexes included; largest first
  std::uint64_t partitions_elsewhere = 0;  // of a fleet, those on other servers, which are not in these figures
};

struct MigrateOptions {
  bool back = false;     // one version back instead, for an earlier slamdb; Error where it would lose something
  bool dry_run = false;  // only tell what would run
  bool backup = true;    // keep the store as it was in `<path>.v<version>.bak`
  double lock_timeout = 5;
};

struct MigrateReport {
  int from = 0, to = 0;            // versions
  std::vector<std::string> steps;  // names of the migrations that ran, or would
  std::string backup;              // path; empty when none was made
};

// Whether an atlas may have the name in a store: 1 to 255 bytes of UTF-8 without `#`, `/` and control characters.
[[nodiscard]] SLAMDB_EXPORT bool IsNameOfAtlas(std::string_view name);

}  // namespace slamdb
