// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/formats/location.h"
#include "slamdb/model/atlas.h"

// What a list of files, folders and stores stands for, one atlas after the other: for every tool that takes many.
namespace slamdb {

// One atlas that was named, or found in what was named.
struct AtlasInput {
  Location location;
  std::string below;    // its path from the folder that was named; empty: named itself, or in a store that was
  std::string failure;  // why the location, a folder or a store, cannot be looked into; empty: it is an atlas, as far
                        // as can be told without reading it
  std::uint64_t hash = 0;              // HashOf (model/digest.h) it, where its store told; 0: not known
  std::shared_ptr<const Atlas> atlas;  // in memory, which CheckAtlases and WriteReports take; null: it is to be read
};

// What folders hold besides.
struct SkippedFiles {
  std::uint64_t others = 0;   // files of which neither the suffix nor the content is an atlas'
  std::uint64_t hidden = 0;   // files and folders whose name begins with a dot
  std::uint64_t special = 0;  // FIFOs, sockets, devices, links that lead nowhere: they are not opened
  std::uint64_t folders = 0;  // that were not asked for
};

struct AtlasInputs {
  std::vector<AtlasInput> atlases;        // in the order in which they were named
  std::vector<std::string> empty_stores;  // that were named and hold no atlas
  SkippedFiles skipped;
};

struct FindAtlasesOptions {
  bool recursive = false;          // folders in folders, too
  bool revisions = false;          // of atlases in stores each revision that can be read, oldest first, as `lab@2`
  std::uint64_t most = 1'000'000;  // entries of folders that are looked at
  double lock_timeout = 5;         // seconds to wait for a program that holds a store
  Progress progress;               // may be empty
};

// What each name stands for:
//   a folder       its files that are atlases, in natural order (map2 before map10): with the suffix .osa, .osa.txt,
//                  .slamdb or .mrpt, whatever they hold; with another suffix of a format that holds atlases (.db,
//                  .ndjson, ...), or with none, when their content is an atlas. Stores stand for their atlases
//   a store        all its atlases, in natural order; also a database of a server
//   STORE.db#lab_* those whose names match: `*` any letters, `?` one, `[a-f]` one of them. A name that is there as it
//                  was given is meant itself
//   anything else  itself, there or not: reading it says what is wrong
// Links are followed; a folder that was reached before, as by a link in a circle, is not entered again.
// A folder without atlases, and what cannot be looked into, is an input with a failure.
//
// Throws Error (kOutOfResources) when folders hold more than `most` entries, and what `progress` throws.
[[nodiscard]] SLAMDB_EXPORT AtlasInputs FindAtlases(std::span<const std::string> named,
                                                    const FindAtlasesOptions& options = {});

}  // namespace slamdb
