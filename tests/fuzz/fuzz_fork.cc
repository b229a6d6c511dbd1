// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/layout.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/fuzz/fork_parts.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as a layout and an archive of it. Both are read or fail with an Error; a layout that was read is written
// and read as the same, and an atlas in an archive that reads as the same bytes again, and in v1.0.
namespace {

using slamdb::Atlas;

Atlas Decode(std::string_view bytes, const std::string& layout) {
  slamdb::Notices notices;
  slamdb::ReadOptions options;
  options.threads = 1;
  options.of<slamdb::Orbslam3ReadOptions>().layout = layout;
  return slamdb::ReadOrbslam3({std::as_bytes(std::span(bytes)), "fuzz"}, options, notices);
}

void WriteAsOwn(const Atlas& atlas) {
  slamdb::WriteOptions options;
  options.of<slamdb::Orbslam3WriteOptions>().layout = "v1.0";
  slamdb::Notices notices;
  slamdb::WriteOrbslam3(atlas, slamdb::Target([](slamdb::Bytes) {}, "fuzz"), options, notices);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const fuzz::ForkParts parts = fuzz::SplitFork({reinterpret_cast<const char*>(data), size});
  fuzz::MayRefuse([&] {
    const Layout layout = LayoutOf(parts.layout);
    const std::string json = ToJson(layout);
    fuzz::Require(ParseLayout(json) == layout, "a layout is read as it was written");
    const Atlas atlas = Decode(parts.archive, json);
    const std::string encoded = EncodeOrbslam3(atlas);
    fuzz::Require(EncodeOrbslam3(Decode(encoded, json)) == encoded, "what was written decodes to the same");
    WriteAsOwn(atlas);
  });
  return 0;
}
