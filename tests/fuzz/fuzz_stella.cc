// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/stella/detail/stella.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as a map of stella_vslam, MessagePack or a database, by what they begin with. They are read or fail with an
// Error; what was read is written, or refused.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const slamdb::Source file(std::as_bytes(std::span(data, size)), "fuzz");
  const bool is_database = size > 0 && data[0] == 'S';
  const slamdb::Format& format = is_database ? slamdb::detail::kStellaDatabaseFormat : slamdb::detail::kStellaFormat;
  slamdb::fuzz::MayRefuse([&] {
    slamdb::Notices notices;
    const slamdb::Atlas atlas = format.read(file, {.threads = 1}, notices);
    format.write(atlas, slamdb::Target([](slamdb::Bytes) {}, "fuzz"), {.threads = 1}, notices);
  });
  return 0;
}
