// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/dbow2/vocabulary.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as a DBoW2 vocabulary, text or binary by their first bytes. They load, so that every descriptor finds a
// word, or fail with an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const slamdb::Source file(std::as_bytes(std::span(data, size)), "fuzz");
  slamdb::fuzz::MayRefuse([&] {
    static_cast<void>(slamdb::ReadVocabularyFile(file));
    const slamdb::LoadedVocabulary loaded = slamdb::LoadVocabulary(file, 1);
    slamdb::ComputeWords(loaded.tree, slamdb::Column<slamdb::Descriptor>(3, slamdb::Descriptor{}));
  });
  return 0;
}
