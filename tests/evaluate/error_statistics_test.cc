// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/evaluate/error_statistics.h"

#include <gmock/gmock.h>

#include <cmath>

namespace slamdb {
namespace {

TEST(ErrorStatistics, AreThoseOfNumpy) {
  const ErrorStatistics of = ErrorStatisticsOf({1.2, 0, 0.5, 0});
  EXPECT_EQ(of.count, 4U);
  EXPECT_DOUBLE_EQ(of.sse, 1.69);                               // 0.25 + 1.44
  EXPECT_DOUBLE_EQ(of.rmse, 0.65);                              // sqrt(1.69 / 4)
  EXPECT_DOUBLE_EQ(of.mean, 0.425);                             // 1.7 / 4
  EXPECT_DOUBLE_EQ(of.std, std::sqrt(0.4225 - 0.425 * 0.425));  // mean of squares less square of the mean
  EXPECT_DOUBLE_EQ(of.min, 0);
  EXPECT_DOUBLE_EQ(of.max, 1.2);
  EXPECT_DOUBLE_EQ(of.median, 0.25);  // between 0 and 0.5
  EXPECT_DOUBLE_EQ(of.p25, 0);        // place 0.75 of 0, 0, 0.5, 1.2
  EXPECT_DOUBLE_EQ(of.p75, 0.675);    // place 2.25: 0.5 + 0.25 * 0.7
  EXPECT_DOUBLE_EQ(of.p90, 0.99);     // place 2.7
  EXPECT_DOUBLE_EQ(of.p95, 1.095);    // place 2.85
  EXPECT_DOUBLE_EQ(of.p99, 1.179);    // place 2.97
}

TEST(ErrorStatistics, OfOneErrorAreThatError) {
  const ErrorStatistics of = ErrorStatisticsOf({3});
  EXPECT_EQ(of.rmse, 3);
  EXPECT_EQ(of.median, 3);
  EXPECT_EQ(of.p99, 3);
  EXPECT_EQ(of.std, 0);
}

TEST(ErrorStatistics, OfNothingAreNoNumbers) {
  const ErrorStatistics of = ErrorStatisticsOf({});
  EXPECT_EQ(of.count, 0U);
  EXPECT_TRUE(std::isnan(of.rmse) && std::isnan(of.max) && std::isnan(of.p95)) << "and not a perfect 0";
}

}  // namespace
}  // namespace slamdb
