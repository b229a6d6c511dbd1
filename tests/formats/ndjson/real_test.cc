// SPDX-License-Identifier: BSD-3-Clause
// Files of ORB-SLAM3 become lines, and the lines the same bytes again.
#include <gtest/gtest.h>

#include <algorithm>

#include "slamdb/formats/ndjson/detail/ndjson.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/model/digest.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/orbslam3/real_atlases.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;

// The file's bytes, but for payloads of NaN, which text does not have, and so do no text archives.
void ExpectTheSameBack(const std::string& path) {
  Notices notices;
  const Atlas atlas = ReadOrbslam3(path, {}, notices);
  const std::string text = Encoded(detail::kNdjsonFormat, atlas);
  const Atlas back = Decoded(detail::kNdjsonFormat, text);
  EXPECT_EQ(back.encoding, atlas.encoding);
  EXPECT_EQ(Encoded(detail::kNdjsonFormat, back), text);
  if (HashOf(back) == HashOf(atlas)) {
    EXPECT_TRUE(EncodeOrbslam3(back) == ReadWhole(path));
  } else {
    EXPECT_NE(text.find("\"NaN\""), text.npos) << "only a NaN can differ";
  }
}

class RealAtlasAsLines : public ::testing::TestWithParam<const char*> {};

TEST_P(RealAtlasAsLines, ComesBack) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  ExpectTheSameBack(path);
}

INSTANTIATE_TEST_SUITE_P(Ndjson, RealAtlasAsLines, ::testing::ValuesIn(kRealAtlases),
                         [](const auto& instance) { return std::string(instance.param); });

TEST(OtherAtlasesAsLines, ComeBack) {
  const char* folder = std::getenv("SLAMDB_LAB2");
  if (folder == nullptr) GTEST_SKIP() << "SLAMDB_LAB2 names no folder of atlases";
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".osa") paths.push_back(entry.path());
  std::ranges::sort(paths);
  for (const fs::path& path : paths) {
    SCOPED_TRACE(path.string());
    ExpectTheSameBack(path.string());
  }
}

}  // namespace
}  // namespace slamdb
