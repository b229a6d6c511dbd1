// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/pictures/detail/spread.h"

#include <gmock/gmock.h>

namespace slamdb::detail {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(SpreadCorners, KeepsTheStrongestOfEachLeaf) {
  // Three corners in the upper left quarter, one in the lower right one: two leaves after one division.
  const std::vector<Corner> corners = {{1, 1, 5}, {2, 1, 9}, {3, 3, 9}, {90, 90, 1}};
  EXPECT_THAT(SpreadCorners(corners, 100, 100, 2), ElementsAre(1, 3));
}

TEST(SpreadCorners, DividesUntilThereAreEnough) {
  const std::vector<Corner> corners = {{1, 1, 5}, {40, 1, 4}, {1, 40, 3}, {90, 90, 1}};
  EXPECT_THAT(SpreadCorners(corners, 100, 100, 4), ElementsAre(0, 1, 2, 3));
}

TEST(SpreadCorners, EndsWhereCornersAreInOnePlace) {
  const std::vector<Corner> corners = {{7, 7, 1}, {7, 7, 2}, {7, 7, 2}};
  EXPECT_THAT(SpreadCorners(corners, 100, 100, 50), ElementsAre(1));
}

TEST(SpreadCorners, HasNothingToKeep) {
  EXPECT_THAT(SpreadCorners({}, 10, 10, 5), IsEmpty());
  EXPECT_THAT(SpreadCorners(std::vector<Corner>{{1, 1, 1}}, 10, 10, 0), IsEmpty());
}

}  // namespace
}  // namespace slamdb::detail
