// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/landmark.h"

#include <gmock/gmock.h>

#include <cmath>

#include "slamdb/base/error.h"

namespace slamdb {
namespace {

TEST(Landmark, PoseHasTheWholeCovariance) {
  Landmark landmark;
  GaussianPoint pose{.mean = {1, 2, 3}};
  pose.covariance << 1, 2, 3, -9, 4, 5, -9, -9, 6;  // of the lower triangle nothing counts
  landmark.set_pose(pose);
  EXPECT_EQ(landmark.cov_11, 1);
  EXPECT_EQ(landmark.cov_22, 4);
  EXPECT_EQ(landmark.cov_33, 6);
  EXPECT_EQ(landmark.cov_12, 2);
  EXPECT_EQ(landmark.cov_13, 3);
  EXPECT_EQ(landmark.cov_23, 5);
  Eigen::Matrix3d symmetric;
  symmetric << 1, 2, 3, 2, 4, 5, 3, 5, 6;
  EXPECT_EQ(landmark.pose().covariance, symmetric);
  EXPECT_EQ(landmark.pose().mean, Eigen::Vector3d(1, 2, 3));
}

TEST(Landmark, TypeIsThatOfTheFirstFeature) {
  Landmark landmark;
  EXPECT_FALSE(landmark.id);
  EXPECT_THROW(landmark.type(), Error);
  landmark.CreateOneFeature().type = FeatureType::kOrb;
  EXPECT_EQ(landmark.type(), FeatureType::kOrb);
  landmark.features.resize(3);
  EXPECT_EQ(landmark.CreateOneFeature().type, FeatureType::kOrb);
  EXPECT_EQ(landmark.features.size(), 1U);
}

TEST(Landmark, TicksCountFrom1601) {
  EXPECT_EQ(TicksOfSeconds(1700000000.25), 133444736002500000U);  // as MRPT has it
  EXPECT_EQ(SecondsOfTicks(133444736002500000U), 1700000000.25);
  EXPECT_EQ(TicksOfSeconds(0), 116444736000000000U);
  EXPECT_EQ(TicksOfSeconds(-11644473600.0), 0U);
  for (const double seconds : {double{NAN}, double{INFINITY}, -1e12, 1e18}) EXPECT_EQ(TicksOfSeconds(seconds), 0U);
  EXPECT_EQ(TicksOfSeconds(1403636579.763555), 130481101797635550U);
}

}  // namespace
}  // namespace slamdb
