// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/pcd/detail/pcd.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cstring>
#include <sstream>

#include "slamdb/formats/export/options.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

const WriteOptions kAscii = WriteOptions{}.With(PointCloudOptions{.binary = false});

std::string Write(const Atlas& atlas, const WriteOptions& options) {
  return Encoded(detail::kPcdFormat, atlas, options);
}

TEST(Pcd, WritesAscii) {
  const std::string text = Write(OneMapAtlas(), kAscii);
  const std::string header =
      "# .PCD v0.7 - Point Cloud Data file format\n"
      "VERSION 0.7\n"
      "FIELDS x y z normal_x normal_y normal_z rgb min_distance max_distance observations reprojection_error map id\n"
      "SIZE 4 4 4 4 4 4 4 4 4 4 4 4 4\n"
      "TYPE F F F F F F F F F U F U U\n"
      "COUNT 1 1 1 1 1 1 1 1 1 1 1 1 1\n"
      "WIDTH 2\n"
      "HEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\n"
      "POINTS 2\n"
      "DATA ascii\n";
  ASSERT_EQ(text.substr(0, header.size()), header);
  std::istringstream row(text.substr(header.size(), text.find('\n', header.size()) - header.size()));
  std::vector<std::string> cells;
  for (std::string cell; row >> cell;) cells.push_back(cell);
  ASSERT_EQ(cells.size(), 13U);
  float color = 0;
  std::from_chars(cells[6].data(), cells[6].data() + cells[6].size(), color);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(color), 0x3f90daU);
  cells[6] = "rgb";
  EXPECT_THAT(cells, ::testing::ElementsAre("0", "0", "2", "0", "0", "1", "rgb", "0.5", "4", "2", "2.5", "0", "10"));
}

TEST(Pcd, WritesBinaryRowsWithoutPadding) {
  const std::string text = Write(SmallAtlas(), {});
  const std::string end = "DATA binary\n";
  const std::string rows = text.substr(text.find(end) + end.size());
  ASSERT_EQ(rows.size(), 3 * 52U);
  std::string expected;
  const auto add = [&expected](auto value) { expected.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const float value : {0.F, 1.F, 0.F, 0.F, 0.F, 1.F}) add(value);
  add(std::uint32_t{0xffa90e}), add(0.5F), add(4.F), add(std::uint32_t{1}), add(0.F);
  add(std::uint32_t{1}), add(std::uint32_t{20});
  EXPECT_EQ(rows.substr(2 * 52), expected);
}

TEST(Pcd, WritesLargeIdsAsDoubles) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].id = MapId(std::uint64_t{1} << 33);
  atlas.maps[0].points[0].id = MapPointId(std::uint64_t{1} << 40);
  const std::string text = Write(atlas, kAscii);
  EXPECT_THAT(text, HasSubstr("SIZE 4 4 4 4 4 4 4 4 4 4 4 8 8\nTYPE F F F F F F F F F U F F F\n"));
  EXPECT_THAT(text, HasSubstr(" 8589934592 1099511627776\n"));
}

}  // namespace
}  // namespace slamdb
