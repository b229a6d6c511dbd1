// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "slamdb/base/file.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/vocabulary_tree.h"

namespace slamdb {

// What a DBoW2 vocabulary file says of itself, and how many words it holds.
struct VocabularyShape {
  int branching = 0;        // k: children of a node
  int depth = 0;            // L: levels
  std::string scoring;      // `L1`, `L2`,.
  std::string weighting;    // `TF-IDF`, `TF`,.
  std::uint64_t words = 0;  // leaves: bag-of-words entries refer to 0 .. words - 1
};

// A vocabulary file as ORB-SLAM3 identifies it.
struct VocabularyFile {
  Vocabulary identity;                   // base name, and MD5 of the file's bytes
  std::optional<VocabularyShape> shape;  // nullopt when it is not a text vocabulary (a binary conversion, an archive)
  std::string other;                     // what it is instead of a vocabulary, for people; empty: it is one
};

// Reads the file, or bytes in memory, once.
// The checksum is the one that ORB-SLAM3 computes on Linux: MD5 over all bytes, so the text file, its binary conversion
// and its archive differ although the vocabulary is the same.
//
// Throws Error when the file cannot be read, of the kind that the system's error has (SystemError), kUsage when it is a
// directory or no regular file.
[[nodiscard]] SLAMDB_EXPORT VocabularyFile ReadVocabularyFile(const Source& source);

// A vocabulary to compute words with.
struct LoadedVocabulary {
  Vocabulary identity;
  VocabularyTree tree;
};

// Reads a whole vocabulary: DBoW2's text as ORB-SLAM2 and 3 come with it, or the binary form that forks of them make of
// it (schema/vocabulary.md).
// The latter has weights rounded to float, so bags made with it differ in the last digits.
// Trusts nothing in the file.
//
// Throws Error as ReadVocabularyFile does, and
//   kDamaged      bytes are wrong, with the line or byte where there is one
//   kUnsupported  it is something else, with the name of what; it has more nodes than a tree can number
// Cost: memory below twice the file's size. `threads` 0: every core.
[[nodiscard]] SLAMDB_EXPORT LoadedVocabulary LoadVocabulary(const Source& source, int threads = 0);

// The MD5 of no bytes, which ORB-SLAM3 stores where its reading loop gets none (built with libc++, as on macOS).
inline constexpr const char* kChecksumOfNothing = "d41d8cd98f00b204e9800998ecf8427e";

// Whether ORB-SLAM3 takes an atlas when it is started with that vocabulary: empty when it does, else why it exits
// (after reading the whole map).
// It compares checksums alone; the name is for people.
[[nodiscard]] SLAMDB_EXPORT std::string VocabularyMismatch(const Vocabulary& of_atlas, const Vocabulary& of_file);

}  // namespace slamdb
