// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "tests/evaluate/trajectories.h"

namespace slamdb {
namespace {

TrajectoryCoverage CoverageOf(const std::vector<double>& estimate, const std::vector<double>& truth,
                              double time_offset = 0) {
  return Evaluated(AlongX(estimate), AlongX(truth), {.alignment = AlignmentKind::kNone, .time_offset = time_offset})
      .coverage;
}

const std::vector<double> kTruth = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};

TEST(Coverage, LeavesGapsOut) {
  const TrajectoryCoverage coverage = CoverageOf({0, 1, 2, 3, 3.5, 9, 10}, kTruth);
  EXPECT_EQ(coverage.estimate_poses, 7U);
  EXPECT_EQ(coverage.reference_poses, 11U);
  EXPECT_EQ(coverage.pairs, 6U);
  EXPECT_DOUBLE_EQ(coverage.paired_share(), 6.0 / 7);
  EXPECT_DOUBLE_EQ(coverage.gap_limit, 5);  // five times a second
  ASSERT_EQ(coverage.gaps.size(), 1U);
  EXPECT_EQ(coverage.gaps[0].begin_time, 3);
  EXPECT_EQ(coverage.gaps[0].end_time, 9);
  EXPECT_EQ(coverage.gaps[0].length, 6);
  EXPECT_DOUBLE_EQ(coverage.covered_duration, 4);  // 0 to 3 and 9 to 10
  EXPECT_DOUBLE_EQ(coverage.duration_share(), 0.4);
  EXPECT_DOUBLE_EQ(coverage.length_share(), 0.4);
}

TEST(Coverage, WhatIsBeforeAndBehindIsNotCovered) {
  const TrajectoryCoverage coverage = CoverageOf({6, 7, 8}, kTruth);
  EXPECT_DOUBLE_EQ(coverage.duration_share(), 0.2);
  ASSERT_EQ(coverage.gaps.size(), 1U) << "two seconds behind are none";
  EXPECT_EQ(coverage.gaps[0].begin_time, 0);
  EXPECT_EQ(coverage.gaps[0].end_time, 6);
}

TEST(Coverage, OfDenseTrajectoriesASecondIsNoGap) {
  std::vector<double> dense;
  for (int i = 0; i < 100; ++i) dense.push_back(0.01 * i);
  dense.push_back(1.98);
  EXPECT_TRUE(CoverageOf(dense, dense).gaps.empty());
  dense.push_back(3);
  EXPECT_EQ(CoverageOf(dense, dense).gaps.size(), 1U);
}

TEST(Coverage, TellsHowFarPairsAreApartAndTheSpans) {
  const TrajectoryCoverage coverage = CoverageOf({100.005, 101, 102}, kTruth, -100);
  EXPECT_NEAR(coverage.largest_time_difference, 0.005, 1e-9);
  EXPECT_EQ(coverage.estimate_begin, 100.005);
  EXPECT_EQ(coverage.reference_end, 10);
  EXPECT_EQ(coverage.reference_length, 10);
  EXPECT_NEAR(coverage.estimate_length, 1.995, 1e-9);
}

TEST(Coverage, OfOnePoseIsWhole) {
  const TrajectoryCoverage coverage = CoverageOf({3}, {3});
  EXPECT_EQ(coverage.duration_share(), 1);
  EXPECT_EQ(coverage.length_share(), 1);
}

}  // namespace
}  // namespace slamdb
