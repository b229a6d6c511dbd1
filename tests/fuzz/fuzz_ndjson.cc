// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ndjson/detail/ndjson.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as ndjson. They are read or fail with an Error; what was read is written to lines that read to the same
// lines again, and can be written as an archive.
namespace {

std::string Written(const slamdb::Atlas& atlas) {
  std::string text;
  slamdb::Notices notices;
  const slamdb::Target::Sink sink = [&](slamdb::Bytes bytes) {
    text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  slamdb::detail::kNdjsonFormat.write(atlas, {sink, "fuzz"}, {.threads = 1}, notices);
  return text;
}

slamdb::Atlas Read(std::string_view text) {
  slamdb::Notices notices;
  return slamdb::detail::kNdjsonFormat.read({std::as_bytes(std::span(text)), "fuzz"}, {.threads = 1}, notices);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  slamdb::fuzz::MayRefuse([&] {
    const slamdb::Atlas atlas = Read({reinterpret_cast<const char*>(data), size});
    const std::string text = Written(atlas);
    slamdb::fuzz::Require(Written(Read(text)) == text, "what was written reads to the same");
    slamdb::fuzz::MayRefuse([&] { (void)slamdb::EncodeOrbslam3(atlas); });
  });
  return 0;
}
