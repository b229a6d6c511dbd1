// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam2/detail/orbslam2.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as a map of ORB-SLAM2. They are read or fail with an Error; what was read is written for ORB-SLAM3, and read
// again to the same.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  fuzz::MayRefuse([&] {
    Notices notices;
    const Source file(std::as_bytes(std::span(data, size)), "fuzz");
    const std::string bytes = EncodeOrbslam3(detail::kOrbslam2Format.read(file, {.threads = 1}, notices));
    const Source written(std::as_bytes(std::span(bytes)), "written");
    fuzz::Require(EncodeOrbslam3(ReadOrbslam3(written, {.threads = 1}, notices)) == bytes, "what was written is read");
  });
  return 0;
}
