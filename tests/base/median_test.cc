// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/median.h"

#include <gtest/gtest.h>

#include <vector>

namespace slamdb::detail {
namespace {

TEST(MedianOf, IsTheUpperOfTheTwoInTheMiddle) {
  EXPECT_EQ(MedianOf(std::vector{4, 1, 3, 2}), 3);
  EXPECT_EQ(MedianOf(std::vector{5, 1, 3}), 3);
  EXPECT_EQ(MedianOf(std::vector<int>()), 0);
}

TEST(QuantileOf, IsAnElementAndTheLowerOfTwo) {
  std::vector<float> list{50, 10, 40, 20, 30};
  EXPECT_EQ(QuantileOf(list, 0), 10);
  EXPECT_EQ(QuantileOf(list, 0.49), 20);
  EXPECT_EQ(QuantileOf(list, 0.5), 30);
  EXPECT_EQ(QuantileOf(list, 1), 50);
  std::vector<float> none;
  EXPECT_EQ(QuantileOf(none, 0.5), 0);
}

// As numpy.quantile.
TEST(InterpolatedQuantileOf, IsBetweenTwoElements) {
  const std::vector<double> list{10, 20, 40, 80};
  EXPECT_EQ(InterpolatedQuantileOf(list, 0), 10);
  EXPECT_EQ(InterpolatedQuantileOf(list, 0.25), 17.5);
  EXPECT_EQ(InterpolatedQuantileOf(list, 0.5), 30);
  EXPECT_EQ(InterpolatedQuantileOf(list, 1), 80);
  EXPECT_EQ(InterpolatedQuantileOf({list.data(), 1}, 0.9), 10);
}

}  // namespace
}  // namespace slamdb::detail
