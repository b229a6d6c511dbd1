// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/checks/check.h"
#include "slamdb/export.h"
#include "slamdb/formats/rows/atlas_query.h"
#include "slamdb/many/inputs.h"
#include "slamdb/model/map_query.h"
#include "slamdb/model/summary.h"

namespace slamdb {

// One atlas of a list: what is in it, or why that cannot be told.
struct ListedAtlas {
  std::string input;    // as it is named: a path, or STORE.db#NAME
  std::string name;     // in a store, or the file's without its folders and suffix
  std::string format;   // id; `store` for those of a store; empty: not known
  std::string failure;  // why it could not be read; empty: it was
  AtlasSummary summary;
  std::optional<std::uint64_t> bytes;  // of the file, or about what it takes in its store
  std::string saved_at;        // UTC, `2026-01-31T12:00:00Z`: of the save, or the file's last change; may be empty
  std::uint64_t revision = 0;  // in a store: counts the saves under this name, from 1; 0: a file
  std::optional<std::uint64_t> hash;  // HashOf it, which stores record

  // With `check`: how many findings of each severity. None: not checked.
  struct Findings {
    std::uint64_t errors = 0, warnings = 0, notes = 0;
  };
  std::optional<Findings> findings;
  std::string verdict;  // "sound", "1 error, 3 notes: not sound", "not readable", see Verdict (checks/report.h)

  bool ok() const { return failure.empty() && (!findings || findings->errors == 0); }
};

struct ListOptions {
  MapQuery query;                     // only atlases that match, and those that cannot be read
  AtlasQuery stored;                  // likewise; files have no revisions
  std::optional<CheckOptions> check;  // hold them against the rules, which reads them all
  std::string format;                 // of files, as ReadOptions::format
  std::string layout;                 // of .osa files, as Orbslam3ReadOptions::layout
  double lock_timeout = 5;            // seconds to wait for a program that holds a store
  int threads = 0;                    // 0: every core
  // Called from several threads, one at a time. May be empty.
  Progress progress;
};

// What is in each of the inputs, in their order. Files are read, several at a time; atlases of a store are not, unless
// they are to be checked. An input that cannot be read is an entry with its failure.
//
// Throws Error (kUsage) for unknown rules, and what `progress` throws.
// Cost: of files, reading them; of stores, what Store::List and Store::Find cost.
[[nodiscard]] SLAMDB_EXPORT std::vector<ListedAtlas> ListAtlases(const AtlasInputs& inputs,
                                                                 const ListOptions& options = {});

// By what atlases are sorted.
enum class ListKey {
  kName,
  kInput,
  kMaps,
  kSensor,
  kKeyframes,
  kPoints,
  kObservations,
  kLandmarks,
  kLength,
  kSpan,
  kDate,  // of the first keyframe
  kSize,
  kFormat,
  kRevision,
  kSaved,
  kVerdict,  // by errors, then warnings
};
// The number that AtlasQuery asks for; none for what is no number there.
[[nodiscard]] SLAMDB_EXPORT std::optional<AtlasQuery::Number> NumberOf(ListKey key);

struct SortKey {
  ListKey key = ListKey::kName;
  bool descending = false;
};

// All of them, by their words: `name`, `input`, `maps`, ...
[[nodiscard]] SLAMDB_EXPORT std::span<const ListKey> ListKeys();
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(ListKey key);

// By its word, `-` before it: downwards.
//
// Throws Error (kUsage), with all words, for another one.
[[nodiscard]] SLAMDB_EXPORT SortKey SortKeyOf(std::string_view word);

// Sorts by the first key, equal ones by the next, and so on; what is equal in all stays as it was. Names are in natural
// order. What is not known, as of atlases that could not be read, is last, whichever way is sorted.
SLAMDB_EXPORT void SortAtlases(std::vector<ListedAtlas>& atlases, std::span<const SortKey> keys);

// As schema/list.schema.json describes it. `input` is what was listed, when that is one file, folder or store.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(std::span<const ListedAtlas> atlases, const std::string& input = {});

// The same text, piece by piece, without all of it in memory. Throws what `sink` throws.
SLAMDB_EXPORT void WriteJson(std::span<const ListedAtlas> atlases, const std::string& input,
                             const std::function<void(std::string_view text)>& sink);

// What that says of the content of an atlas: an object of its counts, sensors, length and times.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const AtlasSummary& summary);

}  // namespace slamdb
