// SPDX-License-Identifier: BSD-3-Clause
// Point clouds of slamdb and of others, and wrong ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "slamdb/formats/export/options.h"
#include "slamdb/formats/ply/detail/ply.h"
#include "slamdb/model/counters.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/formats/points/clouds.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

const Format& kPly = detail::kPlyFormat;
const WriteOptions kAscii = WriteOptions{}.With(PointCloudOptions{.binary = false});

// A header of vertices with these properties: `float x`.
std::string Header(std::string_view format, std::size_t vertices, const std::vector<std::string>& properties,
                   std::string_view end = "\n") {
  std::string text = "ply\nformat " + std::string(format) + " 1.0\nelement vertex " + std::to_string(vertices) + "\n";
  for (const std::string& property : properties) text += "property " + property + "\n";
  text += "end_header\n";
  std::string lines;
  for (const char letter : text) lines += letter == '\n' ? std::string(end) : std::string(1, letter);
  return lines;
}
const std::vector<std::string> kXyz = {"float x", "float y", "float z"};

Error ErrorOf(const std::string& text) {
  const auto error = CloudError(kPly, text);
  return error ? *error : Error(ErrorKind::kInternal, "was read");
}

Atlas Counted(Atlas atlas) {
  RaiseCounters(atlas);
  return atlas;
}

TEST(PlyReader, GivesBackEveryBitOfWhatAPlyHolds) {
  Atlas odd = OneMapAtlas();
  odd.maps[0].points[0].position = {std::nanf(""), HUGE_VALF, -0.0F};
  odd.maps[0].points[0].normal = {std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::max(), 1e-30F};
  odd.maps[0].points[2].id = MapPointId((std::uint64_t{1} << 53) - 1);  // the largest that a double tells from others
  const Atlas two = SynthesizeAtlas({.maps = 2, .keyframes = 6, .points = 300, .features = 300});
  for (const Atlas& atlas : {SmallAtlas(), two, odd})
    for (const WriteOptions& options : {WriteOptions{}, kAscii}) {
      Atlas expected = Counted(PointsAlone(atlas));
      const Atlas back = Decoded(kPly, Encoded(kPly, atlas, options));
      EXPECT_THAT(back, EqualsAtlas(expected));
    }
}

TEST(PlyReader, LeavesOutTheCamerasThatItWrites) {
  const WriteOptions cameras = WriteOptions{}.With(PointCloudOptions{.cameras = true});
  const ReadCloud read = ReadAsCloud(kPly, Encoded(kPly, OneMapAtlas(), cameras));
  EXPECT_THAT(read.atlas, EqualsAtlas(Counted(PointsAlone(OneMapAtlas()))));
  EXPECT_TRUE(read.Tells(Notice::Kind::kNote, "corners of cameras that are drawn: 10"));
  EXPECT_FALSE(read.notices.lossy());
}

TEST(PlyReader, SaysThatCountsOfKeyframesAreLeftOut) {
  const ReadCloud read = ReadAsCloud(kPly, Encoded(kPly, OneMapAtlas()));
  EXPECT_TRUE(read.Tells(Notice::Kind::kNote, "observations, reprojection_error"));
  EXPECT_FALSE(read.notices.lossy());
}

struct Named {
  std::string name, old_name;
};

// Every type by both of its names, in both byte orders and as text.
TEST(PlyReader, ReadsEveryTypeInEveryEncoding) {
  const Named types[] = {{"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
                         {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
  const auto add = [](CloudBytes& bytes, std::size_t type, int value) {
    switch (type) {
      case 0:
        return bytes.Add(static_cast<std::int8_t>(value));
      case 1:
        return bytes.Add(static_cast<std::uint8_t>(value));
      case 2:
        return bytes.Add(static_cast<std::int16_t>(value));
      case 3:
        return bytes.Add(static_cast<std::uint16_t>(value));
      case 4:
        return bytes.Add(static_cast<std::int32_t>(value));
      case 5:
        return bytes.Add(static_cast<std::uint32_t>(value));
      case 6:
        return bytes.Add(static_cast<float>(value));
      default:
        return bytes.Add(static_cast<double>(value));
    }
  };
  for (std::size_t type = 0; type < std::size(types); ++type)
    for (const std::string& name : {types[type].name, types[type].old_name}) {
      const std::vector<std::string> properties = {name + " x", "float y", name + " z", name + " id"};
      for (const bool big : {false, true}) {
        CloudBytes bytes(big);
        add(bytes, type, 7), bytes.Add(0.5F), add(bytes, type, 9), add(bytes, type, 12);
        const std::string format = big ? "binary_big_endian" : "binary_little_endian";
        const ReadCloud read = ReadAsCloud(kPly, Header(format, 1, properties) + bytes.text());
        EXPECT_EQ(read.position(0), Eigen::Vector3f(7, 0.5F, 9)) << name << big;
        EXPECT_EQ(read.point(0).id, MapPointId(12)) << name << big;
      }
      const ReadCloud text = ReadAsCloud(kPly, Header("ascii", 1, properties) + "7 0.5 9 12\n");
      EXPECT_EQ(text.position(0), Eigen::Vector3f(7, 0.5F, 9)) << name;
      EXPECT_EQ(text.point(0).id, MapPointId(12)) << name;
    }
}

TEST(PlyReader, GoesPastListsAndOtherElements) {
  const auto text = [](const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\ncomment of others\nobj_info too\n\nelement material 2\nproperty uchar red\nproperty list uchar int "
           "parts\nelement vertex 2\nproperty float x\nproperty list int double weights\nproperty float y\nproperty "
           "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  };
  EXPECT_EQ(ErrorOf(text("ascii")).place(), "line 5");  // an empty line is none of a header
  const auto without = [&](const std::string& format) {
    std::string header = text(format);
    return header.erase(header.find("\n\n"), 1);
  };
  for (const bool big : {false, true}) {
    CloudBytes bytes(big);
    bytes.Add(std::uint8_t{9}).Add(std::uint8_t{2}).Add(1).Add(2).Add(std::uint8_t{9}).Add(std::uint8_t{0});
    bytes.Add(1.F).Add(2).Add(0.5).Add(0.25).Add(2.F).Add(3.F);
    bytes.Add(4.F).Add(0).Add(5.F).Add(6.F);
    bytes.Add(std::uint8_t{3}).Add(0).Add(1).Add(1);
    const ReadCloud read =
        ReadAsCloud(kPly, without(big ? "binary_big_endian" : "binary_little_endian") + bytes.text());
    EXPECT_EQ(read.position(1), Eigen::Vector3f(4, 5, 6));
    EXPECT_TRUE(read.Tells(Notice::Kind::kLoss, "columns weights"));
    EXPECT_TRUE(read.Tells(Notice::Kind::kLoss, "elements `face`: 1"));
    EXPECT_TRUE(read.Tells(Notice::Kind::kLoss, "elements `material`: 2"));
  }
  const ReadCloud read = ReadAsCloud(kPly, without("ascii") + "9 2 1 2\n9 0\n1 2 0.5 0.25 2 3\n4 0 5 6\n3 0 1 1\n");
  EXPECT_EQ(read.position(0), Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(read.position(1), Eigen::Vector3f(4, 5, 6));
}

TEST(PlyReader, TakesHeadersOfWindows) {
  CloudBytes bytes;
  bytes.Add(13.F).Add(std::bit_cast<float>(0x0a0d0a0dU)).Add(3.F);
  const ReadCloud read = ReadAsCloud(kPly, Header("binary_little_endian", 1, kXyz, "\r\n") + bytes.text());
  EXPECT_EQ(read.position(0).x(), 13);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(read.position(0).y()), 0x0a0d0a0dU);
  EXPECT_EQ(ReadAsCloud(kPly, Header("ascii", 1, kXyz, "\r\n") + "1 2 3\r\n").position(0), Eigen::Vector3f(1, 2, 3));
}

TEST(PlyReader, SaysByHowMuchDoublesAreRounded) {
  const std::vector<std::string> properties = {"double x", "double y", "double z"};
  CloudBytes exact, utm;
  exact.Add(0.5).Add(static_cast<double>(0.1F)).Add(-3.0);
  utm.Add(456789.125).Add(5412345.3).Add(500.0);
  CloudBytes near;
  near.Add(0.1).Add(0.5).Add(1000.0001);
  EXPECT_TRUE(ReadAsCloud(kPly, Header("binary_little_endian", 1, properties) + exact.text()).notices.items().empty());
  const ReadCloud rounded = ReadAsCloud(kPly, Header("binary_little_endian", 1, properties) + utm.text());
  EXPECT_TRUE(rounded.Tells(Notice::Kind::kLoss, "rounded to the 32-bit floats of an atlas: 1, by up to 0.2"));
  const ReadCloud little = ReadAsCloud(kPly, Header("binary_little_endian", 1, properties) + near.text());
  EXPECT_TRUE(little.Tells(Notice::Kind::kWarning, "rounded to the 32-bit floats of an atlas: 2, by up to "));
}

// What programs write: Open3D, CloudCompare, MeshLab, PCL, COLMAP's fused clouds, 3D Gaussian splats.
TEST(PlyReader, ReadsTheColumnsOfOthers) {
  struct Foreign {
    const char* program;
    std::vector<std::string> properties;
    std::string row;
    const char* lost;
  };
  const Foreign foreign[] = {
      {"Open3D",
       {"double x", "double y", "double z", "double nx", "double ny", "double nz", "uchar red", "uchar green",
        "uchar blue"},
       "1 2 3 0 0 1 255 0 9",
       "red, green, blue"},
      {"CloudCompare",
       {"float x", "float y", "float z", "float scalar_min_distance", "float scalar_id", "float scalar_map"},
       "1 2 3 0.5 77 2",
       ""},
      {"MeshLab",
       {"float x", "float y", "float z", "float nx", "float ny", "float nz", "int flags", "uchar red", "uchar green",
        "uchar blue", "uchar alpha", "float quality"},
       "1 2 3 0 0 1 0 255 0 9 255 0.5",
       "flags, red, green, blue, alpha, quality"},
      {"PCL",
       {"float x", "float y", "float z", "uint rgba", "float normal_x", "float normal_y", "float normal_z",
        "float curvature"},
       "1 2 3 4278190335 0 0 1 0",
       "rgba, curvature"},
      {"splats",
       {"float x", "float y", "float z", "float nx", "float ny", "float nz", "float f_dc_0", "float opacity",
        "float scale_0", "float rot_0"},
       "1 2 3 0 0 1 -0.5 2 -7 1",
       "f_dc_0, opacity, scale_0, rot_0"}};
  for (const auto& [program, properties, row, lost] : foreign) {
    const ReadCloud read = ReadAsCloud(kPly, Header("ascii", 1, properties) + row + "\n");
    EXPECT_EQ(read.position(0), Eigen::Vector3f(1, 2, 3)) << program;
    if (*lost != 0) {
      EXPECT_TRUE(read.Tells(Notice::Kind::kLoss, "the columns " + std::string(lost) + ";")) << program;
      EXPECT_EQ(read.point(0).normal, Eigen::Vector3f(0, 0, 1)) << program;
      EXPECT_EQ(read.point(0).id, MapPointId(0)) << program;
    } else {
      EXPECT_FALSE(read.notices.lossy()) << program;
      EXPECT_EQ(read.point(0).id, MapPointId(77)) << program;
      EXPECT_EQ(read.atlas.maps[0].id, MapId(2)) << program;
      EXPECT_EQ(read.point(0).min_distance, 0.5F) << program;
    }
  }
}

TEST(PlyReader, NumbersThatAreNoIdsAreNone) {
  const ReadCloud read = ReadAsCloud(kPly, Header("ascii", 5, {"float x", "float y", "float z", "double id"}) +
                                               "0 0 0 -1\n0 0 0 0.5\n0 0 0 nan\n"
                                               "0 0 0 1e300\n0 0 0 3\n");
  for (std::size_t row = 0; row < 4; ++row) EXPECT_FALSE(read.point(row).id) << row;
  EXPECT_EQ(read.point(4).id, MapPointId(3));
}

TEST(PlyReader, LaterPointsOfAnIdAreNamedAndLeftOut) {
  const std::vector<std::string> properties = {"float x", "float y", "float z", "uint id", "uint map"};
  const ReadCloud read =
      ReadAsCloud(kPly, Header("ascii", 4, properties) + "1 0 0 7 0\n2 0 0 5 0\n3 0 0 7 0\n4 0 0 7 1\n");
  ASSERT_EQ(read.atlas.maps.at(0).points.size(), 2U);
  EXPECT_EQ(read.position(0).x(), 1);
  EXPECT_EQ(read.atlas.maps.at(1).points.size(), 1U);
  EXPECT_TRUE(read.Tells(Notice::Kind::kLoss, "an earlier point of the map has their id: 1 point;"));
}

TEST(PlyReader, CoordinatesThatNoFloatHoldsAreRefused) {
  EXPECT_EQ(ReadAsCloud(kPly, Header("ascii", 1, kXyz) + "1e-50 0 0\n").position(0).x(), 0);
  const Error error = ErrorOf(Header("ascii", 2, kXyz) + "0 0 0\n1 -1e39 0\n");
  EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
  EXPECT_EQ(error.place(), "point 1");
  EXPECT_THAT(error.problem(), HasSubstr("the coordinate -1e+39 does not fit"));
  const std::string doubles = Header("binary_little_endian", 1, {"double x", "double y", "double z"});
  EXPECT_EQ(ErrorOf(doubles + CloudBytes().Add(0.0).Add(1e300).Add(0.0).text()).place(), "point 0");
}

TEST(PlyReader, PointsOfScansWithoutAPlaceAreNone) {
  const ReadCloud read = ReadAsCloud(kPly, Header("ascii", 3, kXyz) + "1 2 3\nnan nan nan\n4 5 6\n");
  ASSERT_EQ(read.atlas.maps[0].points.size(), 2U);
  EXPECT_EQ(read.point(1).id, MapPointId(2)) << "ids stay those of the rows";
  EXPECT_TRUE(read.Tells(Notice::Kind::kNote, "where nothing was measured: 1 point"));
}

TEST(PlyReader, ReadsAPartOfIt) {
  ReadOptions options;
  options.selection.map = MapId(1);
  EXPECT_EQ(ReadAsCloud(kPly, Encoded(kPly, SmallAtlas()), options).atlas.maps.size(), 1U);
  options = {};
  options.selection.box.emplace(Eigen::Vector3f(-1, -1, 1), Eigen::Vector3f(1, 1, 3));
  EXPECT_EQ(ReadAsCloud(kPly, Encoded(kPly, OneMapAtlas()), options).atlas.maps[0].points.size(), 1U);
}

// ---- wrong files

struct Wrong {
  std::string_view name, text, place, problem;
  friend void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.name; }
};
class PlyErrors : public ::testing::TestWithParam<Wrong> {};

TEST_P(PlyErrors, SayWhere) {
  const auto& [name, text, place, problem] = GetParam();
  const Error error = ErrorOf(std::string(text));
  EXPECT_NE(error.kind(), ErrorKind::kInternal) << error.what();
  EXPECT_EQ(error.place(), place) << error.what();
  EXPECT_THAT(error.problem(), HasSubstr(problem));
}

#define XYZ "property float x\nproperty float y\nproperty float z\n"
constexpr Wrong kWrong[] = {
    {"NoPly", "plyx\nformat ascii 1.0\n", "line 1", "expected `ply`"},
    {"NoFormat", "ply\nelement vertex 1\n" XYZ "end_header\n0 0 0\n", "line 6", "expected a format"},
    {"Format", "ply\nformat ascii2 1.0\n", "line 2", "expected ascii, binary_little_endian or"},
    {"Version", "ply\nformat ascii 2.0\n", "line 2", "PLY of version `2.0`"},
    {"NoEnd", "ply\nformat ascii 1.0\nelement vertex 1\n", "line 3", "ends in its header"},
    {"NoCount", "ply\nformat ascii 1.0\nelement vertex many\n", "line 3", "how many there are"},
    {"NegativeCount", "ply\nformat ascii 1.0\nelement vertex -1\n", "line 3", "how many there are"},
    {"Type", "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n", "line 4", "expected a type, found `half`"},
    {"ListLength", "ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\n", "line 4", "a whole type"},
    {"NoElement", "ply\nformat ascii 1.0\nproperty float x\n", "line 3", "before the first element"},
    {"Word", "ply\nformat ascii 1.0\nelements\n", "line 3", "expected a line of a header, found `elements`"},
    {"NoVertices", "ply\nformat ascii 1.0\nelement face 0\nend_header\n", "", "without an element `vertex`"},
    {"NoZ", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nend_header\n", "",
     "without columns x, y and z"},
    {"ListOfX",
     "ply\nformat ascii 1.0\nelement vertex 0\nproperty list uchar float x\nproperty float y\nproperty float "
     "z\nend_header\n",
     "", "without columns x, y and z"},
    {"NoNumber", "ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "end_header\n0 zero 0\n", "vertex 0",
     "expected a number for y, found `zero`"},
    {"Cut", "ply\nformat ascii 1.0\nelement vertex 2\n" XYZ "end_header\n0.5 0.5 0.5\n1 2\n", "vertex 1",
     "the file ends here"},
    {"CutBinary", "ply\nformat binary_little_endian 1.0\nelement vertex 2\n" XYZ "end_header\n0123456789ab0123456789a",
     "", "claims 2 rows of 12 bytes or more, but 23 bytes follow"},
    {"Claims", "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\n" XYZ "end_header\n0123", "",
     "claims 18,446,744,073,709,551,615 rows of 12 bytes or more, but 4 bytes follow"},
    {"ClaimsText", "ply\nformat ascii 1.0\nelement vertex 4000000000\n" XYZ "end_header\n0 0 0\n", "",
     "claims 4,000,000,000 rows of 6 bytes or more"},
    {"ClaimsOther",
     "ply\nformat ascii 1.0\nelement face 4000000000\nproperty list uchar int i\nelement vertex 0\n" XYZ "end_header\n",
     "", "claims 4,000,000,000 rows of 2 bytes"},
    {"LongList",
     "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uint double w\n" XYZ
     "end_header\n\xff\xff\xff\xff"
     "0123456789ab",
     "vertex 0", "the file ends here"},
    {"LongListOfText",
     "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uint double w\n" XYZ "end_header\n4000000000 1 2 3 4\n",
     "vertex 0", "the file ends here"},
    {"ListWithoutLength",
     "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uint double w\n" XYZ "end_header\n-1 0 0 0\n", "vertex 0",
     "expected the length of a list"}};
#undef XYZ

INSTANTIATE_TEST_SUITE_P(Ply, PlyErrors, ::testing::ValuesIn(kWrong),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(PlyReader, RefusesFilesCutAnywhere) {
  for (const WriteOptions& options : {WriteOptions{}, kAscii}) {
    const std::string whole = Encoded(kPly, OneMapAtlas(), options);
    for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
      const std::string cut = whole.substr(0, size);
      const auto error = CloudError(kPly, cut);
      const bool may_stay = !options.of<PointCloudOptions>().binary && size + 3 >= whole.size();
      EXPECT_TRUE(error || may_stay) << size << ": a number at the end of a text can lose digits";
    }
  }
}

TEST(PlyReader, RefusesMoreMapsThanThereAre) {
  std::string text = Header("ascii", 70000, {"uchar x", "uchar y", "uchar z", "uint map"});
  for (int row = 0; row < 70000; ++row) text += "0 0 0 " + std::to_string(row) + "\n";
  EXPECT_THAT(ErrorOf(text).problem(), HasSubstr("more than 65536 maps"));
}

}  // namespace
}  // namespace slamdb
