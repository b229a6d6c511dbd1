// SPDX-License-Identifier: BSD-3-Clause
// Repairs of files that ORB-SLAM3 itself wrote: sound afterwards for its reader too, and back again to the byte.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <set>

#include "slamdb/edit/repair/repair.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/support/boost_reference/boost_reference.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

class RepairRealFile : public ::testing::TestWithParam<const char*> {
 protected:
  static std::filesystem::path PathOf(const std::string& stem) {
    const std::string name = stem + ".osa";
    const std::filesystem::path fixture = std::filesystem::path(SLAMDB_FIXTURES) / stem / name;
    const char* folder = std::getenv("SLAMDB_ATLASES");
    return std::filesystem::exists(fixture) || folder == nullptr ? fixture : std::filesystem::path(folder) / name;
  }
  void SetUp() override {
    if (!std::filesystem::exists(PathOf(GetParam())))
      GTEST_SKIP() << GetParam() << ": set SLAMDB_ATLASES to the folder that has it";
    atlas_ = ReadOrbslam3(PathOf(GetParam()).string(), {}, notices_);
    bytes_ = EncodeOrbslam3(atlas_);
    report_ = RepairAtlas(atlas_);
  }

  Notices notices_;
  Atlas atlas_;
  std::string bytes_;  // of the original, which the codec's own tests prove to be the file's
  RepairReport report_;
};

TEST_P(RepairRealFile, IsSoundAfterwards) {
  for (const Unrepaired& rule : report_.left) EXPECT_EQ(rule.severity, Severity::kNote) << rule.rule;
  EXPECT_TRUE(CheckAtlas(atlas_, {}).ok());
}

TEST_P(RepairRealFile, IsTakenBackToTheByte) {
  TakeBack(report_.journal, atlas_);
  EXPECT_TRUE(EncodeOrbslam3(atlas_) == bytes_);
}

// ORB-SLAM3's PostLoad wipes what it has restored when a map, keyframe or point comes twice, and crashes on bad ones.
TEST_P(RepairRealFile, IsSeenWholeByBoost) {
  const TemporaryFolder folder;
  const std::string path = folder / "repaired.osa";
  WriteOrbslam3(atlas_, path, {.overwrite = true, .sync = false}, notices_);
  const auto encoding = atlas_.encoding.text ? reference::Encoding::kText : reference::Encoding::kBinary;
  const Atlas loaded = reference::Load(path, encoding);
  std::size_t observations = 0, expected = 0;
  EXPECT_TRUE(loaded.repeated_maps.empty());
  for (const Map& map : loaded.maps) {
    EXPECT_TRUE(map.repeated_keyframes.empty());
    EXPECT_TRUE(map.repeated_points.empty());
    std::set<KeyFrameId> keyframes;
    for (const KeyFrame& keyframe : map.keyframes) {
      EXPECT_FALSE(keyframe.bad);
      keyframes.insert(keyframe.id);
    }
    for (const MapPoint& point : map.points) {
      EXPECT_FALSE(point.bad);
      EXPECT_TRUE(keyframes.contains(point.reference));
      for (const Observation& observation : point.observations) observations += keyframes.count(observation.keyframe);
    }
  }
  for (const Map& map : atlas_.maps)
    for (const MapPoint& point : map.points) expected += point.observations.size();
  EXPECT_EQ(observations, expected);
  EXPECT_GT(observations, 5000u);
}

INSTANTIATE_TEST_SUITE_P(Files, RepairRealFile,
                         ::testing::Values("mono_small", "mono_small_twice", "mono_small_newmap", "mono_small_text",
                                           "race_mono", "stereo_inertial", "fisheye_stereo", "multimap_rgbd",
                                           "session_small_a"),
                         [](const auto& file) { return std::string(file.param); });

TEST(RepairRealFile, ChangesOnlyTheListOfAMapThatWasSavedTwice) {
  const auto path = std::filesystem::path(SLAMDB_FIXTURES) / "mono_small_twice" / "mono_small_twice.osa";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path;
  Notices notices;
  Atlas atlas = ReadOrbslam3(path.string(), {}, notices);
  const RepairReport report = RepairAtlas(atlas, {.rules = {"map-listed-once"}});
  ASSERT_EQ(report.journal.edits.size(), 1u);
  EXPECT_EQ(report.journal.edits[0].fields[0].field, "repeated_maps");
  EXPECT_TRUE(report.sound());
}

}  // namespace
}  // namespace slamdb
