// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/osmap/detail/osmap.h"
#include "tests/fuzz/files.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as the four files of an osmap map. They are read or fail with an Error; what was read is written, or
// refused, and what was written is read.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  static const fuzz::Folder folder("slamdb_fuzz_osmap");
  const auto files = fuzz::SplitFiles<4>({reinterpret_cast<const char*>(data), size});
  folder.Write("map.yaml", files[0]);
  folder.Write("map.mappoints", files[1]);
  folder.Write("map.keyframes", files[2]);
  folder.Write("map.features", files[3]);
  Notices notices;
  Atlas atlas;
  bool is_written = false;
  fuzz::MayRefuse([&] {
    atlas = osmap::Read(folder.Path("map.yaml"), {.threads = 1}, notices);
    osmap::Write(atlas, folder.Path("out.yaml"), {.overwrite = true, .sync = false, .threads = 1}, notices);
    is_written = true;
  });
  if (!is_written) return 0;
  const Atlas again = osmap::Read(folder.Path("out.yaml"), {.threads = 1}, notices);
  fuzz::Require(again.maps.empty() == atlas.maps.empty(), "what was written is read");
  return 0;
}
