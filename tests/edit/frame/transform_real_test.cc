// SPDX-License-Identifier: BSD-3-Clause
// Maps that ORB-SLAM3 made of a room whose true poses are known.
#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "slamdb/checks/check.h"
#include "slamdb/edit/diff/diff.h"
#include "slamdb/edit/frame/align_trajectory.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/statistics.h"
#include "slamdb/model/up.h"
#include "tests/support/boost_reference/boost_reference.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

// What another implementation found by Umeyama over the keyframe centres.
struct Session {
  const char* name;
  std::size_t keyframes;
  double scale, rmse, max;
};
void PrintTo(const Session& session, std::ostream* out) { *out << session.name; }

class RealMap : public ::testing::TestWithParam<Session> {
 protected:
  void SetUp() override {
    const char *atlases = std::getenv("SLAMDB_ATLASES"), *meaning = std::getenv("SLAMDB_MEANING");
    if (atlases == nullptr || meaning == nullptr) GTEST_SKIP() << "set SLAMDB_ATLASES and SLAMDB_MEANING";
    const std::string name = GetParam().name;
    const auto truth = std::filesystem::path(meaning).parent_path() / "ground_truth" / (name + "_frames.txt");
    atlas_ = ReadAtlas(std::string(atlases) + "/" + name + ".osa");
    const Atlas poses = ReadAtlas(truth.string());
    for (const KeyFrame& pose : poses.maps.at(0).keyframes)
      truth_.push_back({pose.timestamp, CameraCenter(pose).cast<double>()});
  }

  TrajectoryAlignment Align(const Map& map) const {
    return AlignToTrajectory(map, truth_, {.fit = {.with_scale = !IsMetric(map)}});
  }

  Atlas atlas_;
  std::vector<TimedPosition> truth_;
};

TEST_P(RealMap, GoesOntoItsTrajectoryWithTheKnownResiduals) {
  const TrajectoryAlignment alignment = Align(atlas_.maps[0]);
  EXPECT_EQ(alignment.pairs, GetParam().keyframes);
  EXPECT_NEAR(alignment.reference_from_map.scale, GetParam().scale, 1e-6);
  EXPECT_NEAR(alignment.residuals.rmse, GetParam().rmse, 1e-6);
  EXPECT_NEAR(alignment.residuals.max, GetParam().max, 1e-6);
  TransformMap(atlas_.maps[0], alignment.reference_from_map);
  const TrajectoryAlignment again = Align(atlas_.maps[0]);
  EXPECT_LT(again.reference_from_map.rotation.angularDistance(Eigen::Quaterniond::Identity()), 1e-6);
  EXPECT_LT(again.reference_from_map.translation.norm(), 1e-5);
  EXPECT_NEAR(again.residuals.rmse, GetParam().rmse, 1e-6);
}

TEST_P(RealMap, ThereAndBackIsTheSame) {
  Atlas moved = atlas_;
  const Similarity3d move = Align(moved.maps[0]).reference_from_map;
  TransformMap(moved.maps[0], move);
  const AtlasDiff there = DiffAtlases(atlas_, moved, {});
  ASSERT_TRUE(there.motions.at(0).after_from_before);
  EXPECT_NEAR(there.motions[0].after_from_before->scale, move.scale, 1e-5);
  EXPECT_LT(there.motions[0].rest.max, 1e-4);
  TransformMap(moved.maps[0], move.Inverse());
  const AtlasDiff back = DiffAtlases(atlas_, moved, {.tolerance = 1e-5});
  EXPECT_EQ(back.verdict(), AtlasDiff::Verdict::kSame);
}

TEST_P(RealMap, IsStillSoundAndReadByBoost) {
  const Similarity3d move = Align(atlas_.maps[0]).reference_from_map;
  const auto severe = [](const Atlas& atlas) {
    const CheckReport report = CheckAtlas(atlas, {});
    return report.Count(Severity::kError) + report.Count(Severity::kWarning);
  };
  ASSERT_EQ(severe(atlas_), 0U);
  TransformMap(atlas_.maps[0], move);
  EXPECT_EQ(severe(atlas_), 0U);
  const TemporaryFolder folder;
  const std::string path = folder / "moved.osa";
  WriteAtlas(atlas_, path, {.sync = false});
  const Atlas loaded = reference::Load(path, reference::Encoding::kBinary);
  const Map& map = loaded.maps.at(0);
  ASSERT_EQ(map.points.size(), atlas_.maps[0].points.size());
  for (std::size_t row = 0; row < atlas_.maps[0].points.size(); ++row)
    ASSERT_EQ(map.points[row].position, atlas_.maps[0].points[row].position);
}

INSTANTIATE_TEST_SUITE_P(
    Files, RealMap,
    ::testing::Values(Session{"session_a", 186, 1, 0.009137408924826404, 0.019273468426952572},
                      Session{"session_b", 247, 1, 0.009585669188046963, 0.03460640060468127},
                      Session{"mono_small", 27, 3.113584771516397, 0.003192435837252089, 0.005543183250623708},
                      Session{"stereo_inertial", 71, 1, 0.003689907085616887, 0.006740560411451612},
                      Session{"fisheye_stereo", 28, 1, 0.025237702535153783, 0.05355249067545369}));

TEST(RealInertialMap, ItsInertiaTellsGravity) {
  const char* atlases = std::getenv("SLAMDB_ATLASES");
  if (atlases == nullptr) GTEST_SKIP() << "set SLAMDB_ATLASES";
  Map map = ReadAtlas(std::string(atlases) + "/stereo_inertial.osa").maps.at(0);
  const auto gravity = GravityByInertia(map);
  ASSERT_TRUE(gravity);
  EXPECT_NEAR(gravity->norm(), 9.81, 0.01);
  EXPECT_LT(std::acos(-gravity->normalized().z()), 1e-3);
  const Similarity3d tilt{1, Eigen::Quaterniond(0.7, 0.5, -0.4, 0.2).normalized(), {1, 2, 3}};
  TransformMap(map, tilt);
  EXPECT_LT((FindUp(map).direction - tilt.rotation * -gravity->normalized()).norm(), 1e-5);
}

}  // namespace
}  // namespace slamdb
