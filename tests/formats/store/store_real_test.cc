// SPDX-License-Identifier: BSD-3-Clause
// .osa -> store -> .osa over files that ORB-SLAM3 wrote, in the folder that SLAMDB_ATLASES names.
#include <gmock/gmock.h>

#include <cstdlib>

#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

class StoreReal : public ::testing::TestWithParam<const char*> {};

TEST_P(StoreReal, SameBytesAgain) {
  const char* folder = std::getenv("SLAMDB_ATLASES");
  if (folder == nullptr) GTEST_SKIP() << GetParam() << ".osa: SLAMDB_ATLASES is not set";
  const std::string file = std::string(folder) + "/" + GetParam() + ".osa";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const TemporaryFolder temporary;
  Notices notices;
  const Atlas atlas = ReadOrbslam3(file, {}, notices);
  SaveIn(temporary / "s.db", atlas);
  const Atlas back = LoadFrom(temporary / "s.db");
  EXPECT_TRUE(EncodeOrbslam3(back) == FileBytes(file));
  EXPECT_EQ(SaveIn(temporary / "s.db", back).Total().unchanged > 0, true);
  EXPECT_EQ(Sql(temporary / "s.db", "PRAGMA quick_check"), "ok");
}

INSTANTIATE_TEST_SUITE_P(All, StoreReal,
                         ::testing::Values("fisheye_stereo", "mono_dist", "mono_small", "mono_small_newmap",
                                           "mono_small_text", "mono_small_twice", "multimap_rgbd", "race_mono",
                                           "session_a", "session_b", "session_small_a", "session_small_b",
                                           "stereo_inertial"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace slamdb::store_test
