// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ply/detail/ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "slamdb/base/error.h"
#include "slamdb/formats/export/options.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const WriteOptions kAscii = WriteOptions{}.With(PointCloudOptions{.binary = false});

std::string Write(const Atlas& atlas, const WriteOptions& options, Notices& notices) {
  return Encoded(detail::kPlyFormat, atlas, options, notices);
}

constexpr std::string_view kHeaderEnd = "end_header\n";

TEST(Ply, WritesAscii) {
  Notices notices;
  EXPECT_EQ(Write(SmallAtlas(), kAscii, notices),
            "ply\n"
            "format ascii 1.0\n"
            "comment written by slamdb: map points\n"
            "element vertex 3\n"
            "property float x\nproperty float y\nproperty float z\n"
            "property float nx\nproperty float ny\nproperty float nz\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "property float min_distance\nproperty float max_distance\n"
            "property uint observations\nproperty float reprojection_error\n"
            "property uint map\nproperty uint id\n"
            "end_header\n"
            "0 0 2 0 0 1 31 119 180 0.5 4 2 2.5 0 10\n"
            "0.25 -1.5 1e-05 0 0 1 31 119 180 0.5 4 0 nan 0 12\n"
            "0 1 0 0 0 1 255 127 14 0.5 4 1 0 1 20\n");
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_THAT(notices.written(), HasSubstr(", 1 bad one left out"));
  EXPECT_EQ(notices.items()[0].kind, Notice::Kind::kWarning);
  EXPECT_THAT(notices.items()[0].text, HasSubstr("2 maps are in one file"));
}

TEST(Ply, WritesBinaryRowsWithoutPadding) {
  Notices notices;
  const std::string text = Write(OneMapAtlas(), {}, notices);
  EXPECT_THAT(text, HasSubstr("ply\nformat binary_little_endian 1.0\n"));
  const std::string rows = text.substr(text.find(kHeaderEnd) + kHeaderEnd.size());
  constexpr std::size_t kRow = 6 * 4 + 3 + 2 * 4 + 4 + 4 + 4 + 4;
  ASSERT_EQ(rows.size(), 2 * kRow);
  std::string expected;
  const auto add = [&expected](auto value) { expected.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const float value : {0.F, 0.F, 2.F, 0.F, 0.F, 1.F}) add(value);
  for (const std::uint8_t value : std::array<std::uint8_t, 3>{31, 119, 180}) add(value);
  add(0.5F), add(4.F), add(std::uint32_t{2}), add(2.5F), add(std::uint32_t{0}), add(std::uint32_t{10});
  EXPECT_EQ(rows.substr(0, kRow), expected);
}

TEST(Ply, WritesLargeIdsAsDoubles) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].points[0].id = MapPointId(std::uint64_t{1} << 40);
  Notices notices;
  const std::string text = Write(atlas, kAscii, notices);
  EXPECT_THAT(text, HasSubstr("property uint map\nproperty double id\n"));
  EXPECT_THAT(text, HasSubstr(" 2.5 0 1099511627776\n"));
  const std::string binary = Write(atlas, {}, notices);
  double id = 0;
  std::memcpy(&id, binary.data() + binary.find(kHeaderEnd) + kHeaderEnd.size() + 47, sizeof id);
  EXPECT_EQ(id, 1099511627776.0);
}

TEST(Ply, WritesOneMap) {
  Notices notices;
  const std::string text = Write(SmallAtlas(), kAscii.With(ExportOptions{.map = MapId(1)}), notices);
  EXPECT_THAT(text, HasSubstr("element vertex 1\n"));
  EXPECT_TRUE(notices.items().empty());
}

TEST(Ply, RefusesAMapThatIsNotThere) {
  Notices notices;
  try {
    Write(SmallAtlas(), WriteOptions{}.With(ExportOptions{.map = MapId(5)}), notices);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.problem(), "the atlas has no map 5; it has map 0, map 1");
  }
}

TEST(Ply, WritesAnEmptyAtlas) {
  Notices notices;
  EXPECT_THAT(Write({}, {}, notices), HasSubstr("element vertex 0\n"));
  EXPECT_TRUE(notices.items().empty());
}

}  // namespace
}  // namespace slamdb
