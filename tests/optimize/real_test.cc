// SPDX-License-Identifier: BSD-3-Clause
// Maps that ORB-SLAM3 itself wrote: SLAMDB_LAB2 names a folder of atlases, with true poses in its folder ground_truth;
// without these the error of trajectories is not looked at.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "slamdb/checks/check.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/optimize/optimize.h"
#include "tests/optimize/shaken.h"

namespace slamdb::testing {
namespace {

using ::testing::IsEmpty;

std::set<std::string> Errors(const Atlas& atlas) {
  std::set<std::string> errors;
  for (const RuleResult& result : CheckAtlas(atlas, {}).results)
    if (result.severity == Severity::kError) errors.insert(result.id);
  return errors;
}

std::map<std::int64_t, Eigen::Vector3d> ReadTruth(const std::filesystem::path& path) {
  std::map<std::int64_t, Eigen::Vector3d> places;
  std::ifstream file(path);
  double time = 0;
  Eigen::Vector3d place;
  for (std::string line; std::getline(file, line);)
    if (std::istringstream(line) >> time >> place.x() >> place.y() >> place.z())
      places[std::llround(time * 1e6)] = place;
  return places;
}

// Root mean square distance of cameras from the truth, metres, after the best transform.
double TrajectoryError(const Map& map, const std::map<std::int64_t, Eigen::Vector3d>& truth) {
  std::vector<Eigen::Vector3d> is, should;
  for (const KeyFrame& keyframe : map.keyframes)
    if (const auto found = truth.find(std::llround(keyframe.timestamp * 1e6)); found != truth.end()) {
      is.emplace_back(CameraCenter(keyframe).cast<double>());
      should.push_back(found->second);
    }
  return SolveUmeyama(is, should, {.with_scale = !IsMetric(map)}).rms;
}

class RealMap : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("SLAMDB_LAB2");
    if (folder == nullptr) GTEST_SKIP() << "SLAMDB_LAB2 names no folder of atlases";
    const std::filesystem::path path(folder);
    Notices notices;
    atlas_ = ReadOrbslam3((path / (GetParam() + std::string(".osa"))).string(), {}, notices);
    truth_ = ReadTruth(path / "ground_truth" / (GetParam() + std::string("_frames.txt")));
  }

  Atlas atlas_;
  std::map<std::int64_t, Eigen::Vector3d> truth_;
};

TEST_P(RealMap, GetsBetter) {
  const std::set<std::string> errors = Errors(atlas_);
  const double before = truth_.empty() ? 0 : TrajectoryError(atlas_.maps[0], truth_);
  const OptimizeReport report = OptimizeMaps(atlas_);
  ASSERT_TRUE(report.maps[0].bundle);
  const BundleReport& bundle = *report.maps[0].bundle;
  EXPECT_TRUE(bundle.converged);
  EXPECT_LE(bundle.cost_after, bundle.cost_before);
  EXPECT_LT(bundle.error_after.mean, bundle.error_before.mean + 1e-3);
  EXPECT_LT(bundle.dropped, bundle.observations / 50);
  EXPECT_THAT(Errors(atlas_), ::testing::IsSubsetOf(errors));
  if (truth_.empty()) GTEST_SKIP() << "no ground_truth in SLAMDB_LAB2";
  EXPECT_LT(TrajectoryError(atlas_.maps[0], truth_), before * 1.05);
}

// Shaken by about what the best step of a wrong merge would be, it comes back as near to the truth.
TEST_P(RealMap, ComesBackWhenItIsShaken) {
  if (truth_.empty()) GTEST_SKIP() << "no ground_truth in SLAMDB_LAB2";
  const double before = TrajectoryError(atlas_.maps[0], truth_);
  Shaker shaker;
  shaker.ShakePoses(atlas_.maps[0], 0.005F, 0.01F);
  shaker.ShakePoints(atlas_.maps[0], 0.01F);
  OptimizeMaps(atlas_);
  EXPECT_LT(TrajectoryError(atlas_.maps[0], truth_), std::max(before * 1.2, before + 0.001));
}

INSTANTIATE_TEST_SUITE_P(Lab, RealMap, ::testing::Values("p1", "p2", "m1", "m2", "b1", "b2", "i1", "f1", "l1"),
                         [](const auto& each) { return std::string(each.param); });

}  // namespace
}  // namespace slamdb::testing
