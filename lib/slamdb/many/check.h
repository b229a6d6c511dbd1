// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
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
};

// Holds the rules against each of the inputs. One that cannot be read is an outcome with its error.
//
// Throws Error: kNotFound where there is none; kUsage for unknown rules and gates; and what the progress throws.
// Cost: of each, reading it and what CheckAtlas costs.
[[nodiscard]] SLAMDB_EXPORT std::vector<Outcome<CheckReport>> CheckAtlases(const AtlasInputs& inputs,
                                                                           const CheckAtlasesOptions& options);

// As reports show them.
[[nodiscard]] SLAMDB_EXPORT std::vector<CheckedFile> CheckedFilesOf(std::span<const Outcome<CheckReport>> outcomes);

}  // namespace slamdb
