// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/many/inputs.h"
#include "slamdb/model/summary.h"

namespace slamdb {

// What became of an atlas that was to be added.
enum class AddResult {
  kAdded,
  kReplaced,   // by `overwrite`: saved as a new revision
  kUnchanged,  // the store holds it as it is, by its hash: nothing was written
  kFailed,
  kNotTried,  // the work ended before
};

struct AddedAtlas {
  std::string input;  // as it is named: a path, or STORE.db#NAME
  std::string name;   // in the store
  AddResult result = AddResult::kFailed;
  std::string failure;     // why it failed; empty: it did not
  std::uint64_t hash = 0;  // HashOf it; 0 where it failed
  AtlasSummary summary;
  Notices notices;  // what its reader had to say, and how it came by its name where that is not its own
};

struct AddReport {
  std::string store;  // its path
  bool dry_run = false;
  std::vector<AddedAtlas> atlases;  // in the order of the inputs
  std::uint64_t in_store = 0;       // atlases that are there now, or would be

  SLAMDB_EXPORT std::uint64_t Count(AddResult result) const;
  bool ok() const { return Count(AddResult::kFailed) + Count(AddResult::kNotTried) == 0; }
};

struct AddOptions {
  // Where an atlas gets its name in the store from; those of stores keep theirs.
  enum class NameFrom {
    kStem,  // the file's name without its suffix. Where several have the same, their folders' names stand before it:
            // monday_map, tuesday_map; where these do not tell them apart, a number behind it: map, map-2
    kPath,  // the whole path from the folder that was named: run_1_map for run_1/map.osa
  };
  NameFrom name_from = NameFrom::kStem;
  std::string name;        // of the only input instead; empty: from that
  bool overwrite = false;  // save another atlas of a name that is taken as its next revision; false: it fails
  bool dry_run = false;    // read everything and write nothing
  std::string format;      // of the inputs, as ReadOptions::format
  std::string layout;      // of .osa files among them, as Orbslam3ReadOptions::layout
  bool sync = true;        // see StoreOptions
  double lock_timeout = 5;
  std::string provenance;  // before the input, in the history: `add`
  // Called with the names that the inputs will have, before any is read; then with each as soon as it is done. May be
  // empty.
  std::function<void(const std::vector<std::string>& names)> on_names;
  std::function<void(const AddedAtlas&)> on_done;
  // Called when the work ends early, with what became of every input, before that is thrown on. May be empty.
  std::function<void(const AddReport&)> on_stopped;
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty; throwing ends the work, with whole atlases in the store
};

// Saves every input in the store, which is made where it is missing: each in a transaction of its own, the next being
// read meanwhile. One that cannot be read, or whose name is taken by another atlas, fails by itself. One that the store
// holds as it is, by its hash, under another name that comes of its path (`map`, `monday_map`), keeps that name.
// The store itself, found in a folder, is no input.
//
// Throws Error: kUsage when the path is neither a store nor named like one, is an input itself by whatever path, or a
// name is given for several inputs; and
// as Store::OpenForWriting and Store::Save do where no other atlas could be saved either (the disk is full, the store
// is locked); what was saved until then stays. Memory: of two atlases.
SLAMDB_EXPORT AddReport AddToStore(const std::string& store, const AtlasInputs& inputs, const AddOptions& options = {});

// `added`, `replaced`, `unchanged`, `failed`, `not tried`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(AddResult result);

// As schema/add.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const AddReport& report);

}  // namespace slamdb
