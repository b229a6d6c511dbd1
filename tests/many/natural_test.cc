// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/detail/natural.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

namespace slamdb::detail {
namespace {

TEST(NaturalLess, CountsAsPeopleDo) {
  EXPECT_TRUE(NaturalLess("map2", "map10"));
  EXPECT_FALSE(NaturalLess("map10", "map2"));
  EXPECT_TRUE(NaturalLess("a2", "a002")) << "the same number: fewer zeros first";
  EXPECT_TRUE(NaturalLess("a1b", "a01c"));
  EXPECT_TRUE(NaturalLess("a99999999999999999999999", "a100000000000000000000000")) << "beyond 64 bits";
  EXPECT_TRUE(NaturalLess("run/9", "run2/1")) << "a folder's files stand together";
}

TEST(NaturalLess, IsAStrictOrder) {
  const std::vector<std::string> names = {"",    "0", "00", "a0",   "a00", "a0b",   "a00a", "a/0",
                                          "a-0", "a", "A",  "\xff", "1a1", "01a01", "1a01"};
  for (const std::string& a : names) {
    EXPECT_FALSE(NaturalLess(a, a));
    for (const std::string& b : names) {
      if (a != b) {
        EXPECT_NE(NaturalLess(a, b), NaturalLess(b, a)) << a << " " << b;
      }
      for (const std::string& c : names)
        if (NaturalLess(a, b) && NaturalLess(b, c)) {
          EXPECT_TRUE(NaturalLess(a, c)) << a << " " << b << " " << c;
        }
    }
  }
}

}  // namespace
}  // namespace slamdb::detail
