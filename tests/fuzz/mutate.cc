// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "tests/fuzz/osa_mutator.h"

// How libFuzzer changes the inputs of fuzzers that take .osa files: most often a field of the atlas in it, and now and
// then bytes of the file. Random bytes alone hardly ever decode.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  using namespace slamdb;
  if (seed % 8 == 0) return LLVMFuzzerMutate(data, size, max_size);
  std::optional<Atlas> atlas = fuzz::AtlasOf(std::as_bytes(std::span(data, size)));
  if (!atlas) return LLVMFuzzerMutate(data, size, max_size);
  fuzz::Mutate(*atlas, seed);
  const std::optional<std::string> encoded = fuzz::Encoded(*atlas);
  if (!encoded || encoded->size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
  std::memcpy(data, encoded->data(), encoded->size());
  return encoded->size();
}
