// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rtabmap/detail/rtabmap.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as a database of RTAB-Map. They are read or fail with an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const slamdb::Source file(std::as_bytes(std::span(data, size)), "fuzz");
  for (const slamdb::Format* format : {&slamdb::detail::kRtabmapFormat, &slamdb::detail::kRtabmapTruthFormat}) {
    slamdb::Notices notices;
    slamdb::fuzz::MayRefuse([&] { format->read(file, {.threads = 1}, notices); });
  }
  return 0;
}
