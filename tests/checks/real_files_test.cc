// SPDX-License-Identifier: BSD-3-Clause
// What the rules say about files that ORB-SLAM3 itself wrote.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "slamdb/checks/check.h"
#include "slamdb/formats/orbslam3/orbslam3.h"

namespace slamdb {
namespace {

using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

using Counts = std::map<std::string, std::uint64_t>;

class RealFile : public ::testing::TestWithParam<const char*> {
 protected:
  // Reads from the fixtures, or from the folder that SLAMDB_ATLASES names; skips when the file is in neither.
  void SetUp() override {
    const std::string name = std::string(GetParam()) + ".osa";
    path_ = std::filesystem::path(SLAMDB_FIXTURES) / GetParam() / name;
    const char* folder = std::getenv("SLAMDB_ATLASES");
    if (!std::filesystem::exists(path_) && folder != nullptr) path_ = std::filesystem::path(folder) / name;
    if (!std::filesystem::exists(path_)) GTEST_SKIP() << name << ": set SLAMDB_ATLASES to the folder that has it";
    Notices notices;
    report_ = CheckAtlas(ReadOrbslam3(path_.string(), ReadOptions{}, notices), {});
  }

  Counts Found(Severity severity) const {
    Counts counts;
    for (const RuleResult& result : report_.results)
      if (result.severity == severity) counts[result.id] = result.count;
    return counts;
  }

  std::filesystem::path path_;
  CheckReport report_;
};

class FileAtRest : public RealFile {};
TEST_P(FileAtRest, IsSound) {
  EXPECT_THAT(Found(Severity::kError), IsEmpty());
  EXPECT_THAT(Found(Severity::kWarning), IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(Files, FileAtRest,
                         ::testing::Values("mono_small", "mono_dist", "stereo_inertial", "fisheye_stereo",
                                           "multimap_rgbd", "mono_small_newmap", "session_small_a", "session_small_b",
                                           "session_a", "session_b"));

class UnusualFile : public RealFile {};
TEST_P(UnusualFile, HasOneWarning) {
  EXPECT_THAT(Found(Severity::kError), IsEmpty());
  EXPECT_THAT(Found(Severity::kWarning), UnorderedElementsAre(Pair("text-numbers", 1)));
}
INSTANTIATE_TEST_SUITE_P(Files, UnusualFile, ::testing::Values("mono_small_text"));

class FileSavedTwice : public RealFile {};
TEST_P(FileSavedTwice, IsFound) {
  EXPECT_THAT(Found(Severity::kError), UnorderedElementsAre(Pair("map-listed-once", 1)));
  EXPECT_THAT(Found(Severity::kWarning), IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(Files, FileSavedTwice, ::testing::Values("mono_small_twice"));

// The counts are those of ORB-SLAM3's own loader.
class FileSavedInARace : public RealFile {};
TEST_P(FileSavedInARace, IsFound) {
  EXPECT_THAT(Found(Severity::kError), UnorderedElementsAre(Pair("point-bad", 30)));
  EXPECT_THAT(Found(Severity::kWarning), UnorderedElementsAre(Pair("bad-point-referenced", 94), Pair("slot-target", 5),
                                                              Pair("observation-count", 12)));
}
INSTANTIATE_TEST_SUITE_P(Files, FileSavedInARace, ::testing::Values("race_mono"));

}  // namespace
}  // namespace slamdb
