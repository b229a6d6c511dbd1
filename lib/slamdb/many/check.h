// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "slamdb/checks/check.h"
#include "slamdb/checks/report.h"
#include "slamdb/export.h"
#include "slamdb/formats/dbow2/vocabulary.h"
#include "slamdb/many/each.h"

namespace slamdb {

struct CheckAtlasesOptions {
  ReadOptions read;                              // with the threads and the progress of it all
  CheckOptions check;                            // without them
  const LoadedVocabulary* vocabulary = nullptr;  // words are held against it, and an atlas of another one fails
  // A file that keeps what was found: the same check goes on with it where it was interrupted, and reads no atlas again
  // that is as it was, by its hash in a store, or by size and time of its file. Made where it is missing; empty: none.
  std::string journal;
};

// Holds the rules against each of the inputs. One that cannot be read is an outcome with its error.
//
// Throws Error: kNotFound where there is none; kUsage for unknown rules and gates; and what the progress throws.
// Cost: of each, reading it and what CheckAtlas costs.
[[nodiscard]] SLAMDB_EXPORT std::vector<Outcome<CheckReport>> CheckAtlases(const AtlasInputs& inputs,
                                                                           const CheckAtlasesOptions& options);

// Likewise, but gives each to take(outcome), in the order of the inputs, one at a time, on any thread, as soon as it
// and those before it are done: memory is that of some atlases, however many there are. Returns how many the journal
// knew.
//
// Throws Error likewise, and for the journal: kUsage when it is of a check with other options or of another version of
// slamdb, kAlreadyExists when it is another file, kDamaged, kLocked, as the system has it; and what `take` throws.
SLAMDB_EXPORT std::uint64_t CheckAtlases(const AtlasInputs& inputs, const CheckAtlasesOptions& options,
                                         const std::function<void(Outcome<CheckReport>&& outcome)>& take);

// As reports show them.
[[nodiscard]] SLAMDB_EXPORT CheckedFile CheckedFileOf(const Outcome<CheckReport>& outcome);
[[nodiscard]] SLAMDB_EXPORT std::vector<CheckedFile> CheckedFilesOf(std::span<const Outcome<CheckReport>> outcomes);

}  // namespace slamdb
