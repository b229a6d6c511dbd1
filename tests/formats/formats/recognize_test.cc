// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/detail/recognize.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using std::string_literals::operator""s;
using ::testing::HasSubstr;

// What FormatOfInput throws of a file that is no atlas.
Error Refusal(const std::string& path) {
  try {
    FormatOfInput({path, ""});
  } catch (const Error& error) {
    EXPECT_EQ(error.path(), path);
    return error;
  }
  return {ErrorKind::kInternal, "an atlas"};
}
std::string Problem(const std::string& path) { return Refusal(path).problem(); }

struct WrongFile {
  std::string name, content, sentence;
  ErrorKind kind = ErrorKind::kUnsupported;
};

class Recognize : public ::testing::TestWithParam<WrongFile> {};

TEST_P(Recognize, SaysWhatItIs) {
  const TemporaryFolder folder;
  const std::string bare = folder.Make("file", GetParam().content);
  const Error refusal = Refusal(bare);
  EXPECT_THAT(refusal.problem(), HasSubstr(GetParam().sentence));
  EXPECT_EQ(refusal.kind(), GetParam().kind);
}

TEST_P(Recognize, SaysTheSameOfBytesInMemory) {
  try {
    static_cast<void>(DecodeAtlas(GetParam().content));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.path(), "memory");
    EXPECT_THAT(error.problem(), HasSubstr(GetParam().sentence));
    EXPECT_EQ(error.kind(), GetParam().kind);
  }
}

TEST_P(Recognize, FindsNoFormatForIt) {
  const TemporaryFolder folder;
  EXPECT_EQ(FindFormatOfInput(folder.Make("file", GetParam().content)), nullptr);
}

std::string Padded(std::string text, std::size_t size) {
  text.resize(size, '\0');
  return text;
}

std::string Sqlite(const std::string& schema) { return Padded("SQLite format 3\0"s, 5000) + schema; }

INSTANTIATE_TEST_SUITE_P(
    Files, Recognize,
    ::testing::Values(
        WrongFile{"empty", "", "is empty", ErrorKind::kDamaged},
        WrongFile{"zeros", std::string(100, '\0'), "begins with 100 zero bytes", ErrorKind::kDamaged},
        WrongFile{"gzip", "\x1f\x8b\x08"s,
                  "gzip-compressed, and what is in it, or left of it, does not begin like a landmarks map"},
        WrongFile{"xz", "\xfd\x37zXZ\0"s, "xz-compressed; unpack it first (unxz)"},
        WrongFile{"zstd", "\x28\xb5\x2f\xfd"s, "zstd-compressed"}, WrongFile{"bzip2", "BZh91AY"s, "bzip2-compressed"},
        WrongFile{"zip", "PK\x03\x04"s, "zip archive"}, WrongFile{"seven_zip", "7z\xbc\xaf\x27\x1c"s, "7z archive"},
        WrongFile{"tar", Padded("maps/a.osa", 257) + "ustar\0"s, "tar archive"},
        WrongFile{"png", "\x89PNG\r\n\x1a\n"s, "PNG image"}, WrongFile{"jpeg", "\xff\xd8\xff\xe0"s, "JPEG image"},
        WrongFile{"pdf", "%PDF-1.7", "PDF document"},
        WrongFile{"elf",
                  "\x7f"
                  "ELF"s,
                  "program or library (ELF)"},
        WrongFile{"rosbag", "#ROSBAG V2.0\n", "ROS bag, the recording a map is made from"},
        WrongFile{"mcap", "\x89MCAP0\r\n"s, "MCAP recording"}, WrongFile{"hdf5", "\x89HDF\r\n\x1a\n"s, "HDF5"},
        WrongFile{"lfs", "version https://git-lfs.github.com/spec/v1\noid", "git lfs pull"},
        WrongFile{"xml", "<?xml version=\"1.0\"?>", "XML file"}, WrongFile{"web_page", "<!DOCTYPE html>", "web page"},
        WrongFile{"settings", "%YAML:1.0\n---\nCamera.type: \"PinHole\"\n", "settings of ORB-SLAM3"},
        WrongFile{"osmap", "\x0a\x13\x08\x01\x12\x0f\x0d\0\0\x80?\x15\0\0\x80?\x1d\0\0\x80?"s,
                  "the map points of an osmap map (ORB-SLAM2); give its .yaml file"},
        WrongFile{"vocabulary", "10 6  0 0 \n0 0 252 188", "DBoW2 vocabulary"},
        WrongFile{"vocabulary_mark",
                  "\xef\xbb\xbf"
                  "10 6 0 0\r\n0 0 252 188",
                  "DBoW2 vocabulary"},
        WrongFile{"colmap", Sqlite("CREATE TABLE keypoints CREATE TABLE two_view_geometries"), "COLMAP database"},
        WrongFile{"ros2_bag", Sqlite("CREATE TABLE topics CREATE TABLE messages"), "ROS 2 bag"},
        WrongFile{"sqlite", Sqlite("CREATE TABLE people"), "SQLite database, but not a slamdb store"},
        WrongFile{"mrpt", "\x99mrpt::maps::CLandmarksMap\x07\1\0\0\0"s,
                  "MRPT objects (mrpt::maps::CLandmarksMap of version 7)"},
        WrongFile{"cut_mrpt", "\x99mrpt::maps::CLand", "this is the beginning of a landmarks map of MRPT",
                  ErrorKind::kDamaged},
        WrongFile{"cut_mrpt_count", "\x99mrpt::maps::CLandmarksMap\0\2"s, "the file is truncated", ErrorKind::kDamaged},
        WrongFile{"text", "To whom it may concern\n", "looks like a text file", ErrorKind::kDamaged},
        WrongFile{"bytes", "\x01\x02\x03\x00\x7f"s, "neither its first bytes nor its suffix", ErrorKind::kDamaged},
        WrongFile{"las", "LASF\0\0\0\0"s, "is a LAS point cloud, which slamdb writes but does not read"}),
    [](const auto& instance) { return instance.param.name; });

TEST(RecognizeFolder, KnowsColmapModelsThatLackAFile) {
  const TemporaryFolder folder;
  folder.Make("images.bin", ""), folder.Make("points3D.bin", "");
  EXPECT_THAT(Problem(folder.Path("")), HasSubstr("COLMAP model"));
}

TEST(RecognizeFolder, KnowsRos2Bags) {
  const TemporaryFolder folder;
  folder.Make("metadata.yaml", "");
  EXPECT_THAT(Problem(folder.Path("")), HasSubstr("ROS 2 bag"));
}

TEST(RecognizeFolder, KnowsScenesForNerfs) {
  const TemporaryFolder folder;
  folder.Make("transforms.json", "{}");
  EXPECT_THAT(Problem(folder.Path("")), HasSubstr("scene for NeRFs, which slamdb writes but does not read"));
}

TEST(RecognizeFolder, NamesTheAtlasInIt) {
  const TemporaryFolder folder;
  EXPECT_EQ(Problem(folder.Path("")),
            "is a directory, expected an atlas file; ListAtlases and CheckAtlas take all that is in it");
  EXPECT_EQ(Refusal(folder.Path("")).kind(), ErrorKind::kUsage);
  folder.Make("a.osa", "");
  EXPECT_THAT(Problem(folder.Path("")), HasSubstr("did you mean " + folder.Path("a.osa") + "?"));
  folder.Make("b.osa", "");
  EXPECT_EQ(Problem(folder.Path("")).find("did you mean"), std::string::npos) << "one of two";
}

TEST(FormatOfInput, SaysWhenTheFileIsMissing) {
  const TemporaryFolder folder;
  const Error missing = Refusal(folder.Path("no.osa"));
  EXPECT_THAT(missing.problem(), HasSubstr("No such file"));
  EXPECT_EQ(missing.kind(), ErrorKind::kNotFound);
  EXPECT_THROW(static_cast<void>(FindFormatOfInput(folder.Path("no.osa"))), Error);
}

TEST(FindFormatOfInput, IsTheFormatOfWhatIsReadAndNullOtherwise) {
  const TemporaryFolder folder;
  EXPECT_EQ(FindFormatOfInput(SLAMDB_FIXTURES "/tiny/tiny.osa"), &FormatById("orbslam3"));
  EXPECT_EQ(FindFormatOfInput(folder.Make("a.tum", "# only comments\n")), &FormatById("tum"));
  EXPECT_EQ(FindFormatOfInput(folder.Path("")), nullptr);
  EXPECT_EQ(FindFormatOfInput("-"), nullptr);
}

}  // namespace
}  // namespace slamdb
