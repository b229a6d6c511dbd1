// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/report/paint.h"
#include "cli/report/plan.h"

namespace slamdb::cli {
namespace {

TEST(Layout, GroupsDigitsByThousands) {
  EXPECT_EQ(Grouped(0), "0");
  EXPECT_EQ(Grouped(999), "999");
  EXPECT_EQ(Grouped(1000), "1,000");
  EXPECT_EQ(Grouped(1234567), "1,234,567");
  EXPECT_EQ(Grouped(std::numeric_limits<std::uint64_t>::max()), "18,446,744,073,709,551,615");
}

TEST(Layout, SharesForPeople) {
  EXPECT_EQ(Percent(0, 10), "0%");
  EXPECT_EQ(Percent(1, 1000), "< 1%");
  EXPECT_EQ(Percent(395, 1000), "40%");
  EXPECT_EQ(Percent(5, 5), "100%");
  EXPECT_EQ(Percent(5, 0), "0%");
}

TEST(Layout, CountsInWords) {
  EXPECT_EQ(Counted(1, "map"), "1 map");
  EXPECT_EQ(Counted(0, "map"), "0 maps");
  EXPECT_EQ(Counted(1200, "entry", "entries"), "1,200 entries");
}

TEST(Layout, WrapsParagraphs) {
  EXPECT_EQ(Wrapped("one two three", 0, 7), "one two\nthree\n");
  EXPECT_EQ(Wrapped("one\ntwo", 2, 20), "  one two\n");
  EXPECT_EQ(Wrapped("one\n\ntwo", 0, 20), "one\n\ntwo\n");
  EXPECT_EQ(Wrapped("one\n  kept as it is\ntwo", 1, 20), " one\n   kept as it is\n two\n");
  EXPECT_EQ(Wrapped("unbreakable", 0, 4), "unbreakable\n");
  EXPECT_EQ(Wrapped(""), "");
}

TEST(Layout, AlignsColumns) {
  Table table({Table::Align::kLeft, Table::Align::kRight}, 1);
  EXPECT_TRUE(table.empty());
  table.Add({"a", "1"});
  table.Add({"long", "1,000"});
  table.Add({"é", ""});
  EXPECT_EQ(table.ToString(), " a         1\n long  1,000\n é\n");
}

TEST(Layout, DatesOfDurations) {
  EXPECT_EQ(DatedDuration(1403636579.76, 1403636597.66), "17.9 s from 2014-06-24 19:02:59 UTC");
  EXPECT_EQ(DatedDuration(0, 75.2), "1 min 15 s");
}

// From the lower left corner to the upper right one: four dots in two letters.
TEST(Plan, DrawsInDots) {
  EXPECT_EQ(PlanText({{0, 0}, {1, 1}}, "m", 4, 1), "  \u2860\u280A\n  seen from above, 1 by 1 m\n");
  EXPECT_EQ(PlanText({{5, 2}, {7, 2}}, "units", 4, 3), "  \u2809\u2809\n  seen from above, 2 by 0 units\n");
}

TEST(Plan, IsBounded) {
  std::vector<Eigen::Vector2d> path;
  for (int i = 0; i < 100; ++i) path.emplace_back(std::sin(i) * 1e6, std::cos(i) * 1e-3);
  const std::string text = PlanText(path, "m", 30, 5);
  EXPECT_LE(std::ranges::count(text, '\n'), 6);
  EXPECT_EQ(PlanText({}, "m", 30, 5), "");
  EXPECT_EQ(PlanText({{1, 1}}, "m", 30, 5), "");
  EXPECT_EQ(PlanText({{1, 1}, {1, 1}}, "m", 30, 5), "") << "one place";
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(PlanText({{1, 1}, {none, 2}}, "m", 30, 5), "");
  EXPECT_EQ(PlanText({{1, 1}, {2, 2}}, "m", 3, 5), "") << "no room";
}

TEST(Paint, ColoursHeadingsAndFindings) {
  EXPECT_EQ(PaintHeadings("map 0  stereo\n  points  3\n"), "\033[1mmap 0\033[0m  stereo\n  points  3\n");
  EXPECT_EQ(PaintFindings("a.osa: 1 error: not sound (3 rules checked)\n\n  error point-bad (2)\n"),
            "a.osa: 1 error: \033[1;31mnot sound\033[0m (3 rules checked)\n\n  \033[1;31merror point-bad "
            "(2)\033[0m\n");
  EXPECT_EQ(PaintFindings("a.osa: sound, 3 notes\n"), "a.osa: \033[1;32msound\033[0m, 3 notes\n");
}

}  // namespace
}  // namespace slamdb::cli
