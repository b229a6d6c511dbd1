// SPDX-License-Identifier: BSD-3-Clause
// One session that ORB-SLAM3 continued twice, p1 as b1 and b2 (SLAMDB_LAB2, with true poses in its folder
// ground_truth).
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "slamdb/checks/check.h"
#include "slamdb/edit/merge/three_way.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/digest.h"
#include "slamdb/model/umeyama.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;

class RealBranches : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* lab = std::getenv("SLAMDB_LAB2");
    if (lab == nullptr || !fs::exists(fs::path(lab) / "b2.osa")) GTEST_SKIP() << "SLAMDB_LAB2 names no such folder";
    base_ = ReadAtlas((fs::path(lab) / "p1.osa").string());
    ours_ = ReadAtlas((fs::path(lab) / "b1.osa").string());
    theirs_ = ReadAtlas((fs::path(lab) / "b2.osa").string());
    for (const char* name : {"b1_frames.txt", "b2_frames.txt"}) ReadTruth(fs::path(lab) / "ground_truth" / name);
  }

  // Root mean square over all keyframes, millimetres.
  double Error(const Atlas& atlas) const {
    std::vector<Eigen::Vector3d> is, should;
    for (const KeyFrame& keyframe : atlas.maps.front().keyframes)
      if (const auto found = truth_.find(std::llround(keyframe.timestamp * 1e6)); found != truth_.end()) {
        is.emplace_back(CameraCenter(keyframe).cast<double>());
        should.push_back(found->second);
      }
    return 1000 * SolveUmeyama(is, should, {.with_scale = false}).rms;
  }

  Atlas base_, ours_, theirs_;

 private:
  void ReadTruth(const fs::path& path) {
    std::ifstream file(path);
    double time = 0;
    Eigen::Vector3d center;
    for (std::string line; std::getline(file, line);) {
      std::istringstream numbers(line);
      if (numbers >> time >> center.x() >> center.y() >> center.z()) truth_[std::llround(time * 1e6)] = center;
    }
  }

  std::map<std::int64_t, Eigen::Vector3d> truth_;  // by microsecond
};

TEST_F(RealBranches, BecomeOneMap) {
  const double worse = std::max(Error(ours_), Error(theirs_));
  EXPECT_NEAR(worse, 8.9, 0.1);
  for (const BranchGeometry geometry : {BranchGeometry::kOurs, BranchGeometry::kTheirs, BranchGeometry::kAlign}) {
    SCOPED_TRACE(NameOf(geometry));
    const ThreeWayResult merged = MergeThreeWays(base_, ours_, theirs_, {.geometry = geometry});
    ASSERT_EQ(merged.atlas.maps.size(), 1U);
    EXPECT_EQ(merged.atlas.maps[0].keyframes.size(), 68U + 49 + 47);
    EXPECT_EQ(merged.report.keyframes.added_by_ours, 49U);
    EXPECT_EQ(merged.report.keyframes.added_by_theirs, 47U);
    for (const RuleResult& result : CheckAtlas(merged.atlas, {}).results)
      EXPECT_EQ(result.severity, Severity::kNote) << result.id << ": " << result.count;
    const double error = Error(merged.atlas);
    RecordProperty("millimetres_" + std::string(NameOf(geometry)), std::to_string(error));
    EXPECT_LE(error, worse) << error;
  }
}

TEST_F(RealBranches, OnceMoreChangesNothing) {
  const Atlas merged = MergeThreeWays(base_, ours_, theirs_).atlas;
  EXPECT_EQ(HashOf(MergeThreeWays(base_, merged, theirs_).atlas), HashOf(merged));
  EXPECT_EQ(HashOf(MergeThreeWays(base_, ours_, base_).atlas), HashOf(ours_));
  EXPECT_EQ(HashOf(MergeThreeWays(base_, base_, theirs_).atlas), HashOf(theirs_));
}

}  // namespace
}  // namespace slamdb
