// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ply/detail/ply.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/fuzz_cloud.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  slamdb::fuzz::TryCloud(slamdb::detail::kPlyFormat, {reinterpret_cast<const char*>(data), size});
  return 0;
}
