// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "slamdb/optimize/pose_graph.h"
#include "tests/support/kind_of.h"
#include "tests/support/message_of.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;

TEST(ParseConstraints, TakesATableInAnyOrder) {
  const auto constraints = ParseConstraints(
      "second,first,tx,ty,tz,qx,qy,qz,qw,scale\n"
      "7,3,1,2,3,0,0,0,1,0.5\n"
      "8,4,-1,0,0,0,0,0.6,0.8,\n");
  ASSERT_EQ(constraints.size(), 2U);
  EXPECT_EQ(constraints[0].first, KeyFrameId(3));
  EXPECT_EQ(constraints[0].second, KeyFrameId(7));
  EXPECT_EQ(constraints[0].first_from_second.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(constraints[0].first_from_second.scale, 0.5);
  EXPECT_EQ(constraints[1].first_from_second.scale, 1);
  EXPECT_NEAR(constraints[1].first_from_second.rotation.z(), 0.6, 1e-15);
  EXPECT_TRUE(constraints[1].information.isIdentity(0));
}

TEST(ParseConstraints, SaysWhatIsWrongWithARow) {
  const std::string names = "first,second,tx,ty,tz,qx,qy,qz,qw\n";
  EXPECT_THAT(MessageOf([&] { static_cast<void>(ParseConstraints(names + "1,2,0,0,0,0,0,0,2\n")); }),
              HasSubstr("line 2: the quaternion is not of length 1"));
  EXPECT_THAT(MessageOf([&] { static_cast<void>(ParseConstraints(names + "1,2,x,0,0,0,0,0,1\n")); }),
              HasSubstr("line 2: expected a number, found 'x'"));
  EXPECT_THAT(MessageOf([&] { static_cast<void>(ParseConstraints(names + "-1,2,0,0,0,0,0,0,1\n")); }),
              HasSubstr("line 2"));
  EXPECT_EQ(KindOf([] { static_cast<void>(ParseConstraints("a,b\n1,2\n")); }), ErrorKind::kDamaged);
  EXPECT_EQ(KindOf([] { static_cast<void>(ReadConstraints("/nonexistent.csv")); }), ErrorKind::kNotFound);
}

}  // namespace
}  // namespace slamdb::testing
