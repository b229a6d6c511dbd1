// SPDX-License-Identifier: BSD-3-Clause
//
// What every input says it is when it is something else.
#include "slamdb/base/detail/recognize.h"

#include <gmock/gmock.h>

#include <cstring>
#include <string>

#include "slamdb/base/detail/parse_file.h"
#include "tests/support/temporary_folder.h"

namespace slamdb::detail {
namespace {

using ::testing::HasSubstr;
using std::string_literals::operator""s;

struct Known {
  std::string name, content;
  std::string_view id;
};

template <class... Values>
std::string Packed(const Values&... values) {
  std::string bytes;
  const auto append = [&bytes](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  (append(values), ...);
  return bytes;
}

constexpr std::uint64_t kOne = 1;
constexpr std::uint32_t kId = 7;

std::string ColmapCameras() {
  return Packed(kOne, kId, std::int32_t{1}, std::uint64_t{640}, std::uint64_t{480}, 450., 450., 320., 240.);
}
std::string ColmapImages() {
  return Packed(kOne, kId, 1., 0., 0., 0., 0.5, 0., 0., kId) + "a.png\0"s + Packed(kOne, 10., 20., kOne);
}
std::string ColmapPoints() { return Packed(kOne, kOne, 0.1, 0.2, 3.) + "\xc8\xc8\xc8"s + Packed(0.5, kOne, kId, kId); }
std::string ColmapFrames() {
  return Packed(kOne, kId, kId, 1., 0., 0., 0., 0.5, 0., 0., std::uint32_t{1}, std::uint32_t{0}, kId, kOne);
}

std::string OsmapPoints() {
  return "\x0a\x13\x08\x05\x12\x0f\x0d"s + Packed(1.F) + "\x15"s + Packed(1.F) + "\x1d"s + Packed(1.F);
}
std::string OsmapKeyFrames() { return "\x0a\x34\x12\x32\x0a\x30"s + std::string(48, '\0'); }

std::string Sqlite(const std::string& schema) {
  std::string file = "SQLite format 3\0"s;
  file.resize(5000);
  return file + schema;
}

const Known kKnown[] = {
    {"empty", "", "empty"},
    {"zeros", std::string(10, '\0'), "zeros"},
    {"lfs", "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n", "git-lfs"},
    {"annex", "/annex/objects/SHA256E-s12--ab.osa\n", "git-annex"},
    {"dvc", "outs:\n- md5: a1\n  path: a.osa\n", "dvc"},
    {"page", "<!DOCTYPE html>\n<html>", "web-page"},
    {"small_page", "\xef\xbb\xbf\n <HTML lang=en>", "web-page"},
    {"commented_page", "<!-- saved --><html>", "web-page"},
    {"reply", "{\"message\": \"Not Found\"}", "error-reply"},
    {"denied", "<Error><Code>AccessDenied</Code></Error>", "error-reply"},
    {"zip", "PK\x03\x04", "zip"},
    {"gzip", "\x1f\x8b\x08", "gzip"},
    {"xz", "\xfd\x37zXZ\0"s, "xz"},
    {"zstd", "\x28\xb5\x2f\xfd", "zstd"},
    {"lz4", "\x04\x22\x4d\x18", "lz4"},
    {"seven", "7z\xbc\xaf\x27\x1c", "7z"},
    {"rar", "Rar!\x1a\x07", "rar"},
    {"elf",
     "\x7f"
     "ELF",
     "elf"},
    {"script", "#!/bin/sh\n", "script"},
    {"png", "\x89PNG\r\n\x1a\n", "png"},
    {"gif", "GIF89a", "gif"},
    {"tiff", "II*\0"s, "tiff"},
    {"mp4",
     "\0\0\0\x20"
     "ftypisom"s,
     "mp4"},
    {"numpy", "\x93NUMPY\1\0"s, "numpy"},
    {"bag", "#ROSBAG V2.0\n", "rosbag"},
    {"mcap", "\x89MCAP0\r\n", "mcap"},
    {"bag2", Sqlite("CREATE TABLE topics CREATE TABLE messages"), "rosbag2"},
    {"bag2_metadata", "rosbag2_bagfile_information:\n  version: 5\n", "rosbag2"},
    {"cameras_bin", ColmapCameras(), "colmap-cameras"},
    {"images_bin", ColmapImages(), "colmap-images"},
    {"points_bin", ColmapPoints(), "colmap-points"},
    {"frames_bin", ColmapFrames(), "colmap-frames"},
    {"cameras_txt", "1 PINHOLE 640 480 450 450 320 240\n", "colmap-cameras"},
    {"images_txt", "# Image list with two lines of data per image:\n", "colmap-images"},
    {"bare_images_txt", "1 1 0 0 0 0 0 0 1 a.png\n10 20 1\n", "colmap-images"},
    {"points_txt", "# 3D point list with one line of data per point:\n1 0.1 0.2 0.3 255 255 255 0.5\n",
     "colmap-points"},
    {"colmap", Sqlite("CREATE TABLE keypoints CREATE TABLE two_view_geometries"), "colmap-database"},
    {"old_colmap", Sqlite("CREATE TABLE keypoints CREATE TABLE inlier_matches"), "colmap-database"},
    {"stella_db", Sqlite("CREATE TABLE keyframes CREATE TABLE landmarks CREATE TABLE associations"), "stella-sqlite"},
    {"stella",
     "\x86\xa7"
     "cameras\x81",
     "stella"},
    {"rtabmap", Sqlite("CREATE TABLE Node CREATE TABLE Link CREATE TABLE Admin"), "rtabmap"},
    {"simplemap",
     "\x8a"
     "CSimpleMap\1\0\0\0\0\x88"s,
     "simplemap"},
    {"mrpt", "\x99mrpt::maps::CLandmarksMap\x07\1\0\0\0"s, "mrpt"},
    {"osmap_header", "%YAML:1.0\n---\nmappointsFile: m.mappoints\n", "osmap"},
    {"osmap_points", OsmapPoints(), "osmap"},
    {"osmap_keyframes", OsmapKeyFrames(), "osmap"},
    {"orbslam2", "\0\0\1\0\0\0\0\0\0\0\0\0\0\0\0\0\2\0\0\0\0\0\0\0\0\0\0\0\3"s, "orbslam2"},
    {"settings", "%YAML:1.0\n---\nCamera.type: \"PinHole\"\n", "yaml"},
    {"vocabulary", "10 6  0 0 \n", "vocabulary"},
    {"dbow3", "\x81\x3f\x86\xb1\x14\0\0\0"s, "dbow3"},
    {"journal", "{\n  \"report\": \"slamdb-journal-1\",\n", "journal"},
    {"report", "{\n  \"report\": \"slamdb-check-2\",\n \"message\": \"\"}", "report"},
    {"nerf", R"({"w":640,"frames":[{"file_path":"a.png","transform_matrix":[[1,0,0,0]]}]})", "nerf"},
    {"base64", "FgAAAAAAAABzZXJpYWxpemF0aW9uOjphcmNoaXZl\n", "base64"},
    {"xxd", "00000000: 1600 0000 0000 0000 7365 7269  ........seri\n", "hex-dump"},
    {"hexdump", "00000000  16 00 00 00 00 00 00 00  73 65 72 69  |........|\n", "hex-dump"},
    {"od", "0000000 0016 0000 0000 0000 6573 6972\n", "hex-dump"},
    {"utf16",
     "\xff\xfe"
     "1\0 \0"s,
     "utf-16"},
    {"archive", "\x16\0\0\0\0\0\0\0serialization::archive"s, "archive"},
};

class Recognition : public ::testing::TestWithParam<Known> {};

TEST_P(Recognition, KnowsIt) {
  const std::string& content = GetParam().content;
  const auto recognized = Recognize(Probe::Of({std::as_bytes(std::span(content)), "name"}));
  ASSERT_TRUE(recognized);
  EXPECT_EQ(recognized->id, GetParam().id);
  const TemporaryFolder folder;
  const auto of_file = Recognize(Probe::Of(folder.Make("file", content)));
  ASSERT_TRUE(of_file);
  EXPECT_EQ(of_file->id, GetParam().id);
}

INSTANTIATE_TEST_SUITE_P(Files, Recognition, ::testing::ValuesIn(kKnown),
                         [](const auto& instance) { return instance.param.name; });

// What the texts are that slamdb reads must not be taken for anything else.
TEST(Recognize, LeavesTablesAndTrajectoriesAlone) {
  for (const std::string text :
       {"1403636579.763555 0 0 0 0 0 0 1\n", "1600000000000000000,0,0,0,1,0,0,0\n",
        "# timestamp tx ty tz qx qy qz qw\n", "0 0 0 0 0 0 1\n", "2 5 0 3\n0 0 1 2\n", "10 6 0 0\n0 0 1 2 3\n",
        "kind,before,after\nkeyframe,0,14\n", "timestamp,latitude,longitude,altitude\n", "1 0 0 0 0 1 0 0 0 0 1 0\n",
        "{\"inputs\": []}", "0000000 1 2 3\n"})
    EXPECT_FALSE(Recognize(Probe::Of({std::as_bytes(std::span(text)), "name"}))) << text;
}

TEST(RefuseOther, SaysWhatWasWantedAndWhatItIs) {
  const std::string page = "<html></html>", journal = "{\"report\": \"slamdb-journal-1\"}";
  const auto refusal = [](const std::string& text, std::initializer_list<std::string_view> takes) -> std::string {
    try {
      RefuseOther(Probe::Of({std::as_bytes(std::span(text)), "name"}), "a journal", takes);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(refusal(page, {"journal"}),
            "name: not a journal: this is a web page; was it saved in place of the file that was to be downloaded?");
  EXPECT_EQ(refusal(journal, {"journal"}), "");
  EXPECT_THAT(refusal(journal, {}), HasSubstr("this is a journal of `RepairAtlas`"));
  EXPECT_THAT(refusal("", {}), HasSubstr("is empty"));
}

}  // namespace
}  // namespace slamdb::detail
