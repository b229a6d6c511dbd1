// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/layout.h"

#include <gtest/gtest.h>

#include <limits>

namespace slamdb::cli {
namespace {

TEST(Layout, GroupsDigitsByThousands) {
  EXPECT_EQ(Grouped(0), "0");
  EXPECT_EQ(Grouped(999), "999");
  EXPECT_EQ(Grouped(1000), "1,000");
  EXPECT_EQ(Grouped(1234567), "1,234,567");
  EXPECT_EQ(Grouped(std::numeric_limits<std::uint64_t>::max()), "18,446,744,073,709,551,615");
}

TEST(Layout, BytesForPeople) {
  EXPECT_EQ(HumanBytes(0), "0 B");
  EXPECT_EQ(HumanBytes(999), "999 B");
  EXPECT_EQ(HumanBytes(1000), "1.0 kB");
  EXPECT_EQ(HumanBytes(33424706), "33.4 MB");
  EXPECT_EQ(HumanBytes(999'999), "1.0 MB");
  EXPECT_EQ(HumanBytes(200'000'000), "200 MB");
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

}  // namespace
}  // namespace slamdb::cli
