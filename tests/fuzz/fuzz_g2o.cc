// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/g2o/detail/g2o.h"
#include "slamdb/formats/g2o/options.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as a pose graph. They are read or fail with an Error; what was read is written and read again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const Source file(std::as_bytes(std::span(data, size)), "fuzz");
  Notices notices;
  fuzz::MayRefuse([&] {
    const Atlas atlas = detail::ReadG2o(file, {.threads = 1}, notices);
    for (const bool similarities : {false, true}) {
      std::string text;
      const Target target([&](Bytes more) { text.append(reinterpret_cast<const char*>(more.data()), more.size()); },
                          "fuzz");
      const WriteOptions options = WriteOptions{.threads = 1}.With(G2oWriteOptions{.similarities = similarities});
      detail::kG2oFormat.write(atlas, target, options, notices);
      detail::ReadG2o({std::as_bytes(std::span(text)), "written"}, {.threads = 1}, notices);
    }
  });
  return 0;
}
