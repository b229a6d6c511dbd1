// SPDX-License-Identifier: BSD-3-Clause
// How far what the live classes compute agrees with what ORB-SLAM3 stored: it does not recompute everything after every
// change, so less than all of the untouched points have the values that their observations give.
#include <algorithm>
#include <cstdio>

#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/live/bridge.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"
#include "slamdb/model/derive.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/equals_atlas.h"

namespace slamdb::live {
namespace {

constexpr float kSame = 1e-3F;  // of a unit direction, and of a distance

struct Agreement {
  std::size_t points = 0, descriptors = 0, normals = 0, ranges = 0;
  std::size_t tied = 0;  // another descriptor, of the same median distance: ORB-SLAM3 breaks ties by address

  double Share(std::size_t count) const { return static_cast<double>(count) / static_cast<double>(points); }
};

Descriptor ToDescriptor(const cv::Mat& matrix) {
  Descriptor descriptor{};
  std::copy_n(matrix.ptr<std::uint8_t>(), matrix.empty() ? 0 : descriptor.size(), descriptor.begin());
  return descriptor;
}

// The median distance of a descriptor to all that observers of the point have.
int MedianDistance(const Descriptor& descriptor, MapPoint& point) {
  std::vector<int> distances;
  for (const auto& [keyframe, rows] : point.GetObservations())
    for (const int row : {std::get<0>(rows), std::get<1>(rows)})
      if (row >= 0)
        distances.push_back(
            HammingDistance(descriptor, keyframe->features().descriptors[static_cast<std::size_t>(row)]));
  std::sort(distances.begin(), distances.end());
  return distances[(distances.size() - 1) / 2];
}

// Recomputes every good point and counts which values come out as stored.
Agreement Recompute(Atlas& atlas) {
  Agreement agreement;
  for (Map* map : atlas.GetAllMaps()) {
    for (MapPoint* point : map->GetAllMapPoints()) {
      if (point->isBad() || point->GetObservations().empty()) continue;
      const Descriptor descriptor = ToDescriptor(point->GetDescriptor());
      const Eigen::Vector3f normal = point->GetNormal();
      const float range = point->GetMaxDistanceInvariance();
      point->ComputeDistinctiveDescriptors();
      point->UpdateNormalAndDepth();
      const Descriptor again = ToDescriptor(point->GetDescriptor());
      ++agreement.points;
      agreement.descriptors += again == descriptor;
      agreement.tied += again != descriptor && MedianDistance(again, *point) == MedianDistance(descriptor, *point);
      agreement.normals += (point->GetNormal() - normal).norm() < kSame;
      agreement.ranges += std::abs(point->GetMaxDistanceInvariance() - range) < kSame * range;
    }
  }
  return agreement;
}

class StoredValues : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Derived, StoredValues, ::testing::ValuesIn(kRealAtlases));

TEST_P(StoredValues, AreMostlyWhatTheObservationsGive) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Notices notices;
  const LiveAtlas live = FromModel(ReadOrbslam3(path, {}, notices));
  const Agreement agreement = Recompute(*live.atlas);
  std::printf("%-20s %7zu points: descriptor %.4f (tied %.4f) normal %.4f range %.4f\n", GetParam(), agreement.points,
              agreement.Share(agreement.descriptors), agreement.Share(agreement.tied),
              agreement.Share(agreement.normals), agreement.Share(agreement.ranges));
  ASSERT_GT(agreement.points, 0U);
  EXPECT_GT(agreement.Share(agreement.descriptors + agreement.tied), 0.5);
  EXPECT_GT(agreement.Share(agreement.normals), 0.7);
  EXPECT_GT(agreement.Share(agreement.ranges), 0.9);
}

TEST(Derived, SyntheticValuesComeBackExactly) {
  for (const Sensor sensor : {Sensor::kMonocular, Sensor::kFisheyeStereo}) {
    const slamdb::Atlas model = SynthesizeAtlas({.sensor = sensor, .keyframes = 12, .points = 260, .features = 200});
    const LiveAtlas live = FromModel(model);
    const Agreement agreement = Recompute(*live.atlas);
    EXPECT_EQ(agreement.descriptors, agreement.points);
    EXPECT_EQ(agreement.normals, agreement.points);
    EXPECT_EQ(agreement.ranges, agreement.points);
  }
}

}  // namespace
}  // namespace slamdb::live
