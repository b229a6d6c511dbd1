// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>

#include "slamdb/base/notices.h"
#include "slamdb/export.h"
#include "slamdb/formats/dbow2/vocabulary.h"
#include "slamdb/formats/format.h"
#include "slamdb/model/atlas.h"

// Which vocabulary atlases were made with.
namespace slamdb {

// What an atlas names, or what a vocabulary file is.
struct ShownVocabulary {
  std::string input;  // as it was named
  Vocabulary vocabulary;
  std::optional<VocabularyFile> file;  // none: it is an atlas
};

// `read` as for ReadAtlas; no more is read than is needed.
//
// Throws Error as ReadAtlas and ReadVocabularyFile do.
[[nodiscard]] SLAMDB_EXPORT ShownVocabulary ShowVocabulary(const std::string& path, const ReadOptions& read,
                                                           Notices& notices);

// As schema/vocabulary.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(std::span<const ShownVocabulary> shown);

// Throws Error (kUnsupported) when the file is no vocabulary, and as ReadVocabularyFile does.
[[nodiscard]] SLAMDB_EXPORT Vocabulary ReadVocabularyIdentity(const std::string& path);

// What an atlas is to name from now on: a file, or a name and a checksum; what is empty stays.
struct StampOptions {
  std::string vocabulary;      // a file
  std::string name, checksum;  // instead of its
  bool force = false;          // stamp also what is no vocabulary
};

// Why a vocabulary cannot be called so, or have that checksum; empty: it can.
[[nodiscard]] SLAMDB_EXPORT std::string WhyNoVocabularyName(const std::string& name);
[[nodiscard]] SLAMDB_EXPORT std::string WhyNoChecksum(const std::string& checksum);

// The words of the atlas stay as they are.
//
// Throws Error, before anything changes: kUsage, when nothing is given or what is given makes no sense; as
// ReadVocabularyIdentity.
SLAMDB_EXPORT void StampVocabulary(Atlas& atlas, const StampOptions& options);

}  // namespace slamdb
