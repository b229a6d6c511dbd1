// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/trajectory/detail/trajectory.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as a trajectory, TUM's, EuRoC's and KITTI's in turn. They are read or fail with an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const slamdb::Source file(std::as_bytes(std::span(data, size)), "fuzz");
  for (const slamdb::Format* format :
       {&slamdb::detail::kTumFormat, &slamdb::detail::kEurocFormat, &slamdb::detail::kKittiFormat}) {
    slamdb::Notices notices;
    slamdb::fuzz::MayRefuse([&] { format->read(file, {}, notices); });
  }
  return 0;
}
