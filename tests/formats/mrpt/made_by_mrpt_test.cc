// SPDX-License-Identifier: BSD-3-Clause
// What MRPT 2.5.8 itself made: which way its landmarks face, and what its fuseWith makes of two maps.
#include <gmock/gmock.h>

#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/formats/mrpt/detail/mrpt.h"

namespace slamdb {
namespace {

std::vector<Landmark> LandmarksOf(const std::string& name) {
  Notices notices;
  return detail::kMrptFormat.read({SLAMDB_FIXTURES "/mrpt/" + name, ""}, {}, notices).maps.at(0).landmarks;
}

// Of projectMatchedFeatures, whose left camera is at the origin.
TEST(MadeByMrpt, LandmarksFaceTheSensorAndTheirPointsAreInView) {
  Atlas atlas;
  atlas.maps.emplace_back().landmarks = LandmarksOf("stereo.mrpt.gz");
  ASSERT_EQ(atlas.maps[0].landmarks.size(), 2U);
  for (const Landmark& landmark : atlas.maps[0].landmarks) EXPECT_LT(landmark.normal.dot(landmark.mean), 0);
  MakePoints(atlas);
  for (const MapPoint& point : atlas.maps[0].points) EXPECT_GT(point.position.normalized().dot(point.normal), 0.99F);
}

TEST(MadeByMrpt, TwoMapsAreFusedAlike) {
  std::vector<Landmark> ours = LandmarksOf("fuse_a.mrpt.gz");
  const std::vector<Landmark> other = LandmarksOf("fuse_b.mrpt.gz"), theirs = LandmarksOf("fused.mrpt.gz");
  const std::size_t second = ours.size();
  ours.insert(ours.end(), other.begin(), other.end());
  EXPECT_EQ(FuseAlikeLandmarks(ours, second).fused, 4U);
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_EQ(ours[i].id, theirs[i].id);
    EXPECT_TRUE(ours[i].mean.isApprox(theirs[i].mean, 1e-6));
    EXPECT_TRUE(ours[i].pose().covariance.isApprox(theirs[i].pose().covariance, 1e-5));
    EXPECT_EQ(ours[i].seen_count, theirs[i].seen_count);
    EXPECT_EQ(ours[i].last_seen, theirs[i].last_seen);
    EXPECT_TRUE(ours[i].normal.isApprox(theirs[i].normal));
  }
}

}  // namespace
}  // namespace slamdb
