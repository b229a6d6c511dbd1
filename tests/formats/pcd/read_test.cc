// SPDX-License-Identifier: BSD-3-Clause
// Point clouds of slamdb and of PCL's kin, and wrong ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "slamdb/formats/export/options.h"
#include "slamdb/formats/pcd/detail/lzf.h"
#include "slamdb/formats/pcd/detail/pcd.h"
#include "slamdb/model/counters.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/formats/points/clouds.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

const Format& kPcd = detail::kPcdFormat;
const WriteOptions kAscii = WriteOptions{}.With(PointCloudOptions{.binary = false});

struct Head {
  std::string fields = "x y z", size = "4 4 4", type = "F F F", count = "1 1 1";
  int width = 1, height = 1;
  std::string data = "ascii", version = "0.7", viewpoint = "0 0 0 1 0 0 0";

  std::string text(std::string_view body) const {
    std::string text = "VERSION " + version + "\nFIELDS " + fields + "\nSIZE " + size + "\nTYPE " + type + "\nCOUNT " +
                       count + "\nWIDTH " + std::to_string(width) + "\nHEIGHT " + std::to_string(height) +
                       "\nVIEWPOINT " + viewpoint + "\nPOINTS " + std::to_string(width * height) + "\nDATA " + data +
                       "\n";
    return text.append(body);
  }
};

Error ErrorOf(const std::string& text) {
  const auto error = CloudError(kPcd, text);
  return error ? *error : Error(ErrorKind::kInternal, "was read");
}

// What LZF may make of any bytes: runs of literals alone.
std::string Literals(std::string_view bytes) {
  std::string out;
  for (; !bytes.empty(); bytes.remove_prefix(std::min<std::size_t>(32, bytes.size()))) {
    const std::string_view run = bytes.substr(0, 32);
    out += static_cast<char>(run.size() - 1);
    out += run;
  }
  return out;
}
std::string Compressed(const std::string& lzf, std::size_t size) {
  CloudBytes bytes;
  bytes.Add(static_cast<std::uint32_t>(lzf.size())).Add(static_cast<std::uint32_t>(size));
  return bytes.text() + lzf;
}

TEST(PcdReader, GivesBackEveryBitOfWhatAPcdHolds) {
  Atlas odd = OneMapAtlas();
  odd.maps[0].points[0].position = {std::nanf(""), HUGE_VALF, -0.0F};
  odd.maps[0].points[0].normal = {std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::max(), 1e-30F};
  odd.maps[0].points[2].id = MapPointId((std::uint64_t{1} << 53) - 1);
  const Atlas two = SynthesizeAtlas({.maps = 2, .keyframes = 6, .points = 300, .features = 300});
  for (const Atlas& atlas : {SmallAtlas(), two, odd})
    for (const WriteOptions& options : {WriteOptions{}, kAscii}) {
      Atlas expected = PointsAlone(atlas);
      RaiseCounters(expected);
      EXPECT_THAT(Decoded(kPcd, Encoded(kPcd, atlas, options)), EqualsAtlas(expected));
    }
}

TEST(PcdReader, ReadsEveryTypeInEveryEncoding) {
  for (const std::string letter : {"I", "U", "F"})
    for (const int size : {1, 2, 4, 8}) {
      if (letter == "F" && size < 4) continue;
      CloudBytes x, y, z;  // 5, 0.5, -7 or 7
      const int z_value = letter == "U" ? 7 : -7;
      const auto add = [&](CloudBytes& bytes, int value) {
        if (letter == "F")
          size == 4 ? bytes.Add(static_cast<float>(value)) : bytes.Add(static_cast<double>(value));
        else if (size == 1)
          bytes.Add(static_cast<std::int8_t>(value));
        else if (size == 2)
          bytes.Add(static_cast<std::int16_t>(value));
        else if (size == 4)
          bytes.Add(static_cast<std::int32_t>(value));
        else
          bytes.Add(static_cast<std::int64_t>(value));
      };
      add(x, 5), y.Add(0.5F), add(z, z_value);
      Head head{.size = std::to_string(size) + " 4 " + std::to_string(size), .type = letter + " F " + letter};
      const Eigen::Vector3f expected(5, 0.5F, static_cast<float>(z_value));
      EXPECT_EQ(ReadAsCloud(kPcd, head.text("5 0.5 " + std::to_string(z_value) + "\n")).position(0), expected);
      const std::string body = x.text() + y.text() + z.text();
      head.data = "binary";
      EXPECT_EQ(ReadAsCloud(kPcd, head.text(body)).position(0), expected) << letter << size;
      head.data = "binary_compressed";
      EXPECT_EQ(ReadAsCloud(kPcd, head.text(Compressed(Literals(body), body.size()))).position(0), expected);
    }
}

TEST(PcdReader, GoesPastPaddingAndHistograms) {
  Head head{.fields = "x _ y z fpfh",
            .size = "4 1 4 4 4",
            .type = "F U F F F",
            .count = "1 3 1 1 2",
            .width = 2,
            .data = "binary"};
  CloudBytes rows;
  for (const float offset : {0.F, 10.F}) {
    rows.Add(offset + 1);
    for (int pad = 0; pad < 3; ++pad) rows.Add(std::uint8_t{255});
    rows.Add(offset + 2).Add(offset + 3).Add(8.F).Add(9.F);
  }
  const ReadCloud read = ReadAsCloud(kPcd, head.text(rows.text()));
  EXPECT_EQ(read.position(1), Eigen::Vector3f(11, 12, 13));
  EXPECT_TRUE(read.Tells(Notice::Kind::kLoss, "the columns fpfh;"));
  head.data = "ascii";
  EXPECT_EQ(ReadAsCloud(kPcd, head.text("1 0 0 0 2 3 8 9\n11 0 0 0 12 13 8 9\n")).position(1),
            Eigen::Vector3f(11, 12, 13));
}

// Compressed, the numbers of a field stand behind each other.
TEST(PcdReader, ReadsCompressedFields) {
  Head head{.fields = "x y z intensity",
            .size = "4 4 4 4",
            .type = "F F F F",
            .count = "1 1 1 1",
            .width = 3,
            .data = "binary_compressed"};
  CloudBytes bytes;
  for (const float axis : {1.F, 2.F, 3.F, 4.F})
    for (const float row : {0.F, 10.F, 20.F}) bytes.Add(axis + row);
  const ReadCloud read = ReadAsCloud(kPcd, head.text(Compressed(Literals(bytes.text()), bytes.text().size())));
  EXPECT_EQ(read.position(0), Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(read.position(2), Eigen::Vector3f(21, 22, 23));
  EXPECT_TRUE(read.Tells(Notice::Kind::kLoss, "intensity"));
}

TEST(PcdReader, LeavesOutWhatAnOrganisedCloudDidNotMeasure) {
  const Head head{.width = 2, .height = 2};
  const ReadCloud read = ReadAsCloud(kPcd, head.text("1 2 3\nnan nan nan\n-nan -nan -nan\n4 5 6\n"));
  ASSERT_EQ(read.atlas.maps[0].points.size(), 2U);
  EXPECT_EQ(read.point(1).id, MapPointId(3));
  EXPECT_TRUE(read.Tells(Notice::Kind::kNote, "where nothing was measured: 2 points"));
}

TEST(PcdReader, TellsOfAnotherViewpoint) {
  Head head;
  EXPECT_TRUE(ReadAsCloud(kPcd, head.text("1 2 3\n")).notices.items().empty());
  head.viewpoint = "0 0 1.5 0 1 0 0";
  EXPECT_TRUE(ReadAsCloud(kPcd, head.text("1 2 3\n")).Tells(Notice::Kind::kLoss, "viewpoint `0 0 1.5 0 1 0 0`"));
}

TEST(PcdReader, ReadsOldHeaders) {
  const std::string old =
      "# .PCD v.5 - Point Cloud Data file format\r\nVERSION .5\r\nFIELDS x y z\r\nSIZE 4 4 4\r\nTYPE F F F\r\nWIDTH "
      "1\r\nHEIGHT 1\r\nPOINTS 1\r\nDATA ascii\r\n1 2 3\r\n";
  EXPECT_TRUE(kPcd.sniff({.path = "", .head = old}));
  EXPECT_EQ(ReadAsCloud(kPcd, old).position(0), Eigen::Vector3f(1, 2, 3));
}

// ---- LZF

TEST(Lzf, FollowsReferencesIntoWhatTheyMake) {
  EXPECT_EQ(detail::DecompressLzf(std::string("\x00"
                                              "a"
                                              "\xe0\x01\x00",
                                              5),
                                  11),
            "aaaaaaaaaaa");
  EXPECT_EQ(detail::DecompressLzf(std::string("\x02"
                                              "abc"
                                              "\x20\x02",
                                              6),
                                  6),
            "abcabc");
  EXPECT_EQ(detail::DecompressLzf("", 0), "");
}

TEST(Lzf, RefusesWhatReachesOutside) {
  const auto refuses = [](std::string_view bytes, std::size_t size) {
    EXPECT_FALSE(detail::DecompressLzf(bytes, size)) << bytes.size() << " " << size;
  };
  const std::string_view no_such("\x00z\x20\x01", 4);  // two back of one
  refuses(no_such, 4);
  refuses(std::string_view("\x05zz", 3), 6);     // a run that is cut off
  refuses(std::string_view("\x00z\x20", 3), 4);  // a reference that is cut off
  refuses(std::string_view("\x00z\xe0", 3), 4);  // a long one
  refuses(std::string_view("\x00z\xe0\xff", 4), 4);
  refuses(std::string_view("\x00z", 2), 2);   // less than was said
  refuses(std::string_view("\x01zz", 3), 1);  // more
  refuses(std::string_view("\x00z", 2), std::size_t{1} << 60);
}

// ---- wrong files

struct Wrong {
  std::string_view name, from, to, place, problem;
  friend void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.name; }
};
class PcdErrors : public ::testing::TestWithParam<Wrong> {};

TEST_P(PcdErrors, SayWhere) {
  const auto& [name, from, to, place, problem] = GetParam();
  std::string text = Head{}.text("1 2 3\n");
  text.replace(text.find(from), from.size(), to);
  const Error error = ErrorOf(text);
  EXPECT_NE(error.kind(), ErrorKind::kInternal) << error.what();
  EXPECT_EQ(error.place(), place) << error.what();
  EXPECT_THAT(error.problem(), HasSubstr(problem));
}

constexpr Wrong kWrong[] = {
    {"Version", "0.7", "0.8", "line 1", "PCD of version `0.8`"},
    {"Word", "FIELDS", "FILEDS", "line 2", "expected a line of a header, found `FILEDS`"},
    {"Sizes", "SIZE 4 4 4", "SIZE 4 4", "line 10", "as many words each"},
    {"Types", "F F F", "F F", "line 10", "as many words each"},
    {"Counts", "1 1 1", "1 1", "line 10", "as many words each"},
    {"NoFields", "FIELDS x y z\n", "", "line 9", "as many words each"},
    {"Type", "F F F", "F D F", "line 10", "no type `D` of 4 bytes"},
    {"Size", "4 4 4", "4 3 4", "line 10", "no type `F` of 3 bytes"},
    {"SmallFloat", "4 4 4", "4 2 4", "line 10", "no type `F` of 2 bytes"},
    {"Data", "ascii", "zip", "line 10", "expected ascii, binary or binary_compressed"},
    {"Product", "WIDTH 1", "WIDTH 2", "line 10", "POINTS is not WIDTH times HEIGHT"},
    {"ProductTooLarge", "WIDTH 1\nHEIGHT 1", "WIDTH 4294967296\nHEIGHT 4294967296", "line 10", "not WIDTH times"},
    {"NoNumberOfPoints", "POINTS 1", "POINTS all", "line 9", "expected a whole number, found `all`"},
    {"NoData", "DATA ascii\n1 2 3\n", "", "line 9", "ends in its header, before a line DATA"},
    {"NoZ", "x y z", "x y w", "", "without columns x, y and z"},
    {"CountOfX", "1 1 1", "2 1 1", "", "claims 1 row of 8 bytes"},
    {"ManyNumbers", "1 1 1", "1 18446744073709551615 1", "line 10", "numbers each"},
    {"NoNumbers", "1 1 1", "0 0 0", "", "claims 1 row of 0 bytes"},
    {"NoNumber", "1 2 3", "1 two 3", "point 0", "expected a number for y, found `two`"},
    {"Cut", "1 2 3\n", "1.25 2.25\n", "point 0", "the file ends here"},
    {"CutBinary", "ascii\n1 2 3\n", "binary\n0123456789a", "", "claims 1 row of 12 bytes or more, but 11 bytes"},
    {"CutCompressed", "ascii\n1 2 3\n", "binary_compressed\n0123", "", "ends behind its header"},
    {"CutLzf", "ascii\n1 2 3\n", "binary_compressed\n\x7f\x7f\x7f\x7f\x7f\x7f\x7f\x7fzz", "",
     "claims 2139062143 compressed bytes, but 2 follow"}};

INSTANTIATE_TEST_SUITE_P(Pcd, PcdErrors, ::testing::ValuesIn(kWrong),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(PcdReader, RefusesCompressedPointsThatAreNotThere) {
  Head head{.data = "binary_compressed"};
  EXPECT_THAT(ErrorOf(head.text(Compressed("", 0))).problem(), HasSubstr("claims 1 row of 12 bytes"));
  EXPECT_THAT(ErrorOf(head.text(Compressed("zz", 12))).problem(), HasSubstr("cannot be decompressed"));
  EXPECT_THAT(ErrorOf(head.text(Compressed("zz", 0xffffffff))).problem(), HasSubstr("cannot be decompressed"));
}

TEST(PcdReader, RefusesFilesCutAnywhere) {
  for (const WriteOptions& options : {WriteOptions{}, kAscii}) {
    const std::string whole = Encoded(kPcd, OneMapAtlas(), options);
    for (std::size_t size = 0; size + 3 < whole.size(); ++size)
      EXPECT_TRUE(CloudError(kPcd, whole.substr(0, size))) << size;
  }
}

}  // namespace
}  // namespace slamdb
