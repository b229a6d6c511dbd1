// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/error.h"
#include "slamdb/formats/mrpt/detail/gzip.h"
#include "slamdb/formats/mrpt/detail/landmarks.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as a stream of MRPT, compressed or not. They decode or fail with an Error; what decoded is written to
// landmarks that decode to the same bytes again.
namespace {

std::string Encode(const std::vector<slamdb::Map>& maps) {
  std::string bytes;
  for (const slamdb::Map& map : maps)
    for (const slamdb::Landmark& landmark : map.landmarks) slamdb::mrpt::AppendLandmark2(bytes, landmark, false);
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  std::string encoded;
  try {
    const bool compressed = slamdb::mrpt::IsGzip(input);
    encoded = Encode(slamdb::mrpt::ReadMaps("fuzz", compressed ? slamdb::mrpt::Decompress("fuzz", input) : input));
  } catch (const slamdb::Error&) {
    return 0;
  }
  slamdb::fuzz::Require(Encode(slamdb::mrpt::ReadMaps("fuzz", encoded)) == encoded,
                        "what was written decodes to the same");
  return 0;
}
