// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/infer_layout.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as an .osa file of a layout that nobody knows. One is found or refused; what is found is written as JSON
// and read again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  fuzz::MayRefuse([&] {
    const InferredLayout inferred = InferLayout({std::as_bytes(std::span(data, size)), "fuzz"});
    fuzz::Require(SameBytes(ParseLayout(ToJson(inferred.layout)), inferred.layout), "a layout survives its JSON");
  });
  return 0;
}
