// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/detail/salvage.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as an .osa file, binary or text by their first bytes. They decode or fail with an Error; what decoded is
// written to an archive that decodes to the same bytes again.
namespace {

slamdb::Atlas Decode(slamdb::Bytes bytes, int threads) {
  slamdb::Notices notices;
  slamdb::ReadOptions options;
  options.threads = threads;
  return slamdb::ReadOrbslam3({bytes, "fuzz"}, options, notices);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const slamdb::Bytes input = std::as_bytes(std::span(data, size));
  try {
    slamdb::detail::SalvageOrbslam3({input, "fuzz"}, {});
  } catch (const slamdb::Error&) {  // no header
  }
  std::string encoded;
  try {
    encoded = slamdb::EncodeOrbslam3(Decode(input, 1));
  } catch (const slamdb::Error&) {
    return 0;
  }
  const std::string again = slamdb::EncodeOrbslam3(Decode(std::as_bytes(std::span(encoded)), 2));
  slamdb::fuzz::Require(again == encoded, "what was written decodes to the same");
  return 0;
}
