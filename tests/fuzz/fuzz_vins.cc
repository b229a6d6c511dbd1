// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/vins/detail/vins.h"
#include "tests/fuzz/files.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as the files of a pose graph of VINS. They are read or fail with an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  static const fuzz::Folder folder("slamdb_fuzz_vins");
  const auto files = fuzz::SplitFiles<3>({reinterpret_cast<const char*>(data), size});
  folder.Write("pose_graph.txt", files[0]);
  folder.Write("0_keypoints.txt", files[1]);
  folder.Write("0_briefdes.dat", files[2]);
  fuzz::MayRefuse([&] {
    Notices notices;
    detail::kVinsFormat.read(folder.Path(""), {.threads = 1}, notices);
  });
  return 0;
}
