// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include "slamdb/model/map_point.h"
#include "tests/boost/orb_classes.h"

// Points of the two sides that say the same.
namespace slamdb::testing {

inline void ExpectSame(const MapPoint& point, const orb::MapPoint& expected) {
  EXPECT_EQ(point.id.value(), expected.mnId);
  EXPECT_EQ(point.first_keyframe, expected.mnFirstKFid);
  EXPECT_EQ(point.first_frame, expected.mnFirstFrame);
  EXPECT_EQ(point.observation_count, expected.nObs);
  EXPECT_EQ(point.position, Eigen::Map<const Eigen::Vector3f>(expected.mWorldPos));
  EXPECT_EQ(point.normal, Eigen::Map<const Eigen::Vector3f>(expected.mNormalVector));
  ASSERT_EQ(point.observations.size(), expected.mBackupObservationsId1.size());
  for (const Observation& observation : point.observations) {
    EXPECT_EQ(observation.left, expected.mBackupObservationsId1.at(observation.keyframe.value()));
    EXPECT_EQ(observation.right, expected.mBackupObservationsId2.at(observation.keyframe.value()));
  }
  EXPECT_EQ(point.descriptor_form, MatrixForm::kUsual);
  EXPECT_TRUE(std::equal(point.descriptor.begin(), point.descriptor.end(), expected.mDescriptor.data.begin()));
  EXPECT_EQ(point.reference.value(), expected.mBackupRefKFId);
  EXPECT_EQ(static_cast<bool>(point.bad), expected.mbBad);
  EXPECT_EQ(static_cast<long long>(point.replaced_by.value()), expected.mBackupReplacedId);
  EXPECT_EQ(point.min_distance, expected.mfMinDistance);
  EXPECT_EQ(point.max_distance, expected.mfMaxDistance);
}

}  // namespace slamdb::testing
