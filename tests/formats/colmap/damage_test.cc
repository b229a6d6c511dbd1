// SPDX-License-Identifier: BSD-3-Clause
// What no COLMAP wrote: cut, flipped and hostile files, and models whose parts do not fit together.
#include <gmock/gmock.h>

#include <cmath>

#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/colmap.h"
#include "slamdb/formats/colmap/options.h"
#include "tests/formats/colmap/model_files.h"
#include "tests/support/error_of.h"

namespace slamdb::colmap {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::array kParts = {Part::kCameras, Part::kImages, Part::kPoints, Part::kRigs, Part::kFrames};

TEST(ColmapDamage, EveryCutIsAnErrorWithItsPlace) {
  for (const Part part : kParts) {
    const std::string whole = SmallBytes(part);
    for (std::size_t size = 0; size < whole.size(); ++size)
      EXPECT_THAT(Refusal(part, whole.substr(0, size)), AllOf(HasSubstr("byte "), HasSubstr("truncated")))
          << int(part) << " " << size;
    EXPECT_THAT(Refusal(part, whole + "x"), HasSubstr("1 bytes follow behind the last "));
  }
}

TEST(ColmapDamage, AnyFlipIsReadOrRefused) {
  for (const Part part : kParts)
    for (const bool binary : {true, false}) {
      const std::string whole = binary ? SmallBytes(part) : SmallText(part);
      for (std::size_t at = 0; at < whole.size(); ++at)
        for (const int bit : {0x01, 0x10, 0x80}) {
          std::string flipped = whole;
          flipped[at] = static_cast<char>(flipped[at] ^ bit);
          Refusal(part, flipped, binary);
        }
    }
}

TEST(ColmapDamage, CountsAreComparedWithTheBytesLeft) {
  std::string bytes = SmallBytes(Part::kCameras);
  bytes.replace(0, 8, "\xff\xff\xff\xff\xff\xff\xff\x0f");
  EXPECT_THAT(Refusal(Part::kCameras, bytes), HasSubstr("a count of 1152921504606846975 cameras does not fit"));
  bytes = SmallBytes(Part::kRigs);
  bytes.replace(12, 4, "\xff\xff\xff\xff");
  EXPECT_THAT(Refusal(Part::kRigs, bytes), HasSubstr("a count of 4294967295 sensors does not fit"));
  EXPECT_THAT(Refusal(Part::kRigs, "1 4000000000 CAMERA 1\n", false), HasSubstr("does not fit into the line"));
}

TEST(ColmapDamage, WordsAreNamedWithTheirLine) {
  EXPECT_THAT(Refusal(Part::kCameras, "# c\n1 OWL 1 1 1\n", false), HasSubstr("line 2: there is no camera model"));
  EXPECT_THAT(Refusal(Part::kCameras, "1 PINHOLE 64 48 100 101 32.5\n", false), HasSubstr("the line ends where"));
  EXPECT_THAT(Refusal(Part::kCameras, "1 PINHOLE 64 48 1 1 1 1 1\n", false), HasSubstr("too much in the line"));
  EXPECT_THAT(Refusal(Part::kPoints, "1 a 0 0 0 0 0 0\n", false), HasSubstr("expected a position, found"));
  EXPECT_THAT(Refusal(Part::kPoints, "1 0 0 0 256 0 0 0\n", false), HasSubstr("expected a colour, found"));
  EXPECT_THAT(Refusal(Part::kRigs, "1 1 OWL 1\n", false), HasSubstr("there is no sensor of type"));
}

// Text that is cut between its lines is whole to the eye; the head says how many there were.
TEST(ColmapDamage, TextThatEndsBeforeWhatItsHeadCountsIsRefused) {
  const std::array<std::string, 5> heads = {"cameras", "images", "points", "rigs", "frames"};
  for (const Part part : kParts) {
    const std::string head = "# List\n# Number of " + heads[static_cast<std::size_t>(part)] + ": ";
    const std::string rest = ", mean of something: 2.5\n" + SmallText(part);
    EXPECT_EQ(Refusal(part, head + "1" + rest, false), "read") << int(part);  // written on by hand
    EXPECT_THAT(Refusal(part, head + "7" + rest, false), HasSubstr("of the 7 entries that its head counts"))
        << int(part);
    EXPECT_THAT(Refusal(part, head + "1\n", false), HasSubstr("after 0 of the 1 entries")) << int(part);
    EXPECT_EQ(Refusal(part, head + "many\n", false), "read");
  }
}

struct Read {
  Atlas atlas;
  Notices notices;
};

Read ReadFiles(const std::map<std::string, std::string>& instead, bool binary = false) {
  const TemporaryFolder folder;
  MakeFiles(folder, binary, instead);
  Read read;
  read.atlas = slamdb::detail::kColmapFormat.read(folder.Path(""), {}, read.notices);
  return read;
}

// Cut off in its head, before the head counts anything, a text file is one of nothing: the others tell.
TEST(ColmapDamage, APartOfNothingToWhichOthersReferIsCutOff) {
  EXPECT_THAT(RefusalOf([] { ReadFiles({{"cameras.txt", "# Camera list\n"}}); }), HasSubstr("not one camera"));
  EXPECT_THAT(RefusalOf([] { ReadFiles({{"rigs.txt", "# Rig cal"}}); }), HasSubstr("not one rig"));
  EXPECT_THAT(RefusalOf([] { ReadFiles({{"frames.txt", "#"}}); }), HasSubstr("no frames; was their file cut off?"));
  EXPECT_THAT(RefusalOf([] { ReadFiles({{"points3D.txt", "# 3D"}}); }), HasSubstr("and no points; was their file"));
  EXPECT_THAT(RefusalOf([] {
                ReadFiles({{"images.txt", "# I"}});
              }),
              HasSubstr("points that images see, and no images"));
  EXPECT_THAT(RefusalOf([] {
                ReadFiles({{"images.txt", ""}, {"points3D.txt", "#"}, {"frames.txt", ""}, {"rigs.txt", ""}});
              }),
              HasSubstr("no image and no point"));
}

auto Says(const std::string& text) { return Contains(Field(&Notice::text, HasSubstr(text))); }

TEST(ColmapContent, BinaryAndTextAreTheSameAtlas) {
  for (const bool binary : {true, false}) {
    const Read read = ReadFiles({}, binary);
    ASSERT_EQ(read.atlas.maps.size(), 1U);
    const Map& map = read.atlas.maps[0];
    ASSERT_EQ(map.keyframes.size(), 2U);  // no fisheye pair: each image is a keyframe
    EXPECT_EQ(map.keyframes[0].id, KeyFrameId(4));
    EXPECT_EQ(map.keyframes[0].timestamp, 1.5);
    EXPECT_EQ(map.keyframes[0].features.keypoints[0].x, 1);
    EXPECT_EQ(map.keyframes[0].features.keypoints[0].y, 1.5);
    EXPECT_EQ(map.keyframes[0].features.map_points[0], MapPointId(9));
    EXPECT_EQ(map.keyframes[0].intrinsics.cx, 32);
    // right_from_left * left_from_world: (0.5, -1, 2) turned to (2, -0.5, 1)... by (0.5, 0.5, -0.5, 0.5)
    EXPECT_TRUE(map.keyframes[1].camera_from_world.rotation.isApprox(Quaternionf(0.5F, 0.5F, -0.5F, 0.5F)));
    ASSERT_EQ(map.points.size(), 1U);
    EXPECT_EQ(map.points[0].position, Eigen::Vector3f(1, 2, -3));
    EXPECT_EQ(map.points[0].observations.size(), 2U);
    EXPECT_THAT(read.notices.items(), Says("1 point lose their colours"));
    EXPECT_THAT(read.notices.items(), Says("1 point left out, which no image sees"));
    EXPECT_THAT(read.notices.items(), Says("have no ORB descriptors"));
  }
}

TEST(ColmapContent, WhatLeadsNowhereIsLeftOutAndCounted) {
  EXPECT_THAT(ReadFiles({{"points3D.txt", "11 0 0 1 0 0 0 -1\n"}}).notices.items(),
              Says("2 keypoints see nothing now"));
  EXPECT_THAT(ReadFiles({{"points3D.txt", "9 0 0 1 0 0 0 -1\n9 0 0 1 0 0 0 -1\n"}}).notices.items(),
              Says("1 point left out: their id is there twice"));
  EXPECT_THAT(ReadFiles({{"cameras.txt", "1 PINHOLE 64 48 100 101 32.5 24.5\n"}}).notices.items(),
              Says("1 image left out"));
  const Read twice = ReadFiles({{"images.txt", "5 1 0 0 0 0 0 0 1 a.png\n1 2 9 3 4 9\n"}});
  EXPECT_THAT(twice.notices.items(), Says("1 keypoint see nothing now"));
  EXPECT_THAT(twice.notices.items(), Says("1 image lose their names"));
  EXPECT_EQ(twice.atlas.maps[0].keyframes[0].timestamp, 1);
}

// Without a head that counts, tracks tell that images are gone.
TEST(ColmapContent, TracksThatLeadNowhereAreCounted) {
  const std::string images = "5 1 0 0 0 0 0 0 1 1.png\n1 2 9 3 4 -1\n";
  const auto read = [&](const std::string& track) {
    return ReadFiles({{"images.txt", images}, {"points3D.txt", "9 0 0 1 0 0 0 -1 " + track + "\n"}}).notices;
  };
  EXPECT_THAT(read("5 0").items(), Not(Says("of tracks left out")));
  for (const char* track : {"5 0 6 0", "5 0 5 2", "5 0 5 1", "5 0 4294967295 4294967295"})
    EXPECT_THAT(read(track).items(), Says("1 element of tracks left out")) << track;
}

// Coordinates of the world would be rounded by half a metre.
TEST(ColmapContent, ModelsFarFromTheirOriginAreMovedBeforeTheyAreRounded) {
  const Read read = ReadFiles({{"images.txt",
                                "5 0.5 0.5 0.5 0.5 -487654.25 -4600000.5 -4200000.125 1 1.png\n1 2 9 3 4 -1\n"
                                "6 0.5 0.5 0.5 0.5 -487652.25 -4600000.5 -4200000.125 1 2.png\n1 2 9 3 4 -1\n"},
                               {"points3D.txt", "9 4600003.0625 4200001 487650.1875 0 0 0 -1 5 0 6 0\n"},
                               {"rigs.txt", ""},
                               {"frames.txt", ""}});
  EXPECT_THAT(read.notices.items(), Says("(4600001, 4200000, 487652) was taken off all positions"));
  // Turned by a third about (1, 1, 1): camera x is world z.
  const Map& map = read.atlas.maps[0];
  EXPECT_EQ(map.keyframes[0].camera_from_world.translation, Eigen::Vector3f(-2.25, 0.5, -0.125));
  EXPECT_EQ(map.points[0].position, Eigen::Vector3f(2.0625, 1, -1.8125));
  EXPECT_THAT(ReadFiles({}).notices.items(), Not(Says("was taken off")));
}

// Ids, keypoints and tracks may be anything; poses, points and cameras may not.
TEST(ColmapContent, StrangeNumbersAreRead) {
  const Read read =
      ReadFiles({{"images.txt", "5 3 0 0 0 0 0 0 1 1.png\n1e300 -inf 9\n4294967295 1 0 0 0 0 0 0 1 2.png\n\n"},
                 {"points3D.txt", "18446744073709551614 0 0 0 0 0 0 -1\n9 0 0 0 0 0 0 -1 77 99\n"},
                 {"frames.txt", "1 99 1 0 0 0 0 0 0 1 CAMERA 1 5\n2 1 1 0 0 0 0 0 0 0\n"}});
  const Map& map = read.atlas.maps[0];
  ASSERT_EQ(map.keyframes.size(), 2U);
  EXPECT_EQ(map.keyframes[0].camera_from_world.rotation.coeffs(), Eigen::Vector4f(0, 0, 0, 1));
  EXPECT_EQ(map.points.size(), 1U);
}

TEST(ColmapDamage, NumbersThatNoPoseNorPointHasAreRefused) {
  for (const char* quaternion : {"0 0 0 0", "nan 0 0 1", "0 1e39 0 0"})
    EXPECT_THAT(Refusal(Part::kImages, "5 " + std::string(quaternion) + " 0 0 0 1 a.png\n\n", false),
                AllOf(HasSubstr("line 1: the quaternion"), HasSubstr("the file is damaged")));
  EXPECT_THAT(Refusal(Part::kImages, "5 1 0 0 0 0 1e39 0 1 a.png\n\n", false), HasSubstr("line 1: the position"));
  EXPECT_THAT(Refusal(Part::kFrames, "1 1 0 0 0 0 0 0 0 1 CAMERA 1 5\n", false), HasSubstr("line 1: the quaternion"));
  EXPECT_THAT(Refusal(Part::kPoints, "9 0 -1e39 1 0 0 0 -1\n", false), HasSubstr("line 1: the position"));
  std::string bytes = SmallBytes(Part::kImages);
  bytes.replace(12, 32, std::string(32, '\0'));
  EXPECT_THAT(Refusal(Part::kImages, bytes), HasSubstr("image 0: the quaternion 0 0 0 0"));
  bytes = SmallBytes(Part::kPoints);
  bytes.replace(16, 8, std::string(8, '\xff'));
  EXPECT_THAT(Refusal(Part::kPoints, bytes), HasSubstr("point 0: the position"));
}

TEST(ColmapDamage, NumbersThatNoCameraHasAreRefused) {
  const auto refusal = [](const char* numbers) {
    return Refusal(Part::kCameras, "1 PINHOLE " + std::string(numbers) + "\n", false);
  };
  for (const char* size : {"0 48", "64 0", "1048577 48", "64 18446744073709551615"})
    EXPECT_THAT(refusal((size + std::string(" 100 100 32 24")).c_str()), HasSubstr("line 1: images of")) << size;
  for (const char* lengths : {"nan 100", "-1 100", "100 0", "1e39 100", "100 inf"})
    EXPECT_THAT(refusal(("64 48 " + std::string(lengths) + " 32 24").c_str()), HasSubstr("line 1: the focal lengths"));
  EXPECT_THAT(refusal("64 48 100 100 nan 24"), HasSubstr("line 1: the camera's numbers"));
  std::string bytes = SmallBytes(Part::kCameras);
  bytes.replace(16, 8, std::string(8, '\0'));
  EXPECT_THAT(Refusal(Part::kCameras, bytes), HasSubstr("camera 0: images of 0 x"));
}

TEST(ColmapContent, CamerasThatSlamdbHasNotAreRefusedByName) {
  const auto refusal = [](const std::string& cameras) {
    try {
      ReadFiles({{"cameras.txt", cameras}});
    } catch (const Error& error) {
      return error.kind() == ErrorKind::kUnsupported ? error.problem() : "another kind";
    }
    return std::string("read");
  };
  EXPECT_THAT(refusal("1 EQUIRECTANGULAR 64 48 64 48\n"), HasSubstr("of model EQUIRECTANGULAR is not read"));
}

// Ids are moved apart where models share some; there is no room above the largest.
TEST(ColmapContent, IdsNearTheEndAreNotMoved) {
  const TemporaryFolder folder;
  Notices notices;
  for (const char* name : {"0/", "1/"}) {
    std::filesystem::create_directory(folder.Path(name));
    folder.Make(std::string(name) + "cameras.txt", "1 PINHOLE 64 48 100 100 32 24\n");
    folder.Make(std::string(name) + "images.txt", "4294967294 1 0 0 0 0 0 0 1 1.png\n1 2 9223372036854775807\n");
    folder.Make(std::string(name) + "points3D.txt", "9223372036854775807 0 0 1 0 0 0 -1 4294967294 0\n");
  }
  const auto read = [&](const std::string& path) { return slamdb::detail::kColmapFormat.read(path, {}, notices); };
  EXPECT_EQ(read(folder.Path("0")).maps[0].points[0].id, MapPointId(9223372036854775807U));
  try {
    read(folder.Path(""));
    ADD_FAILURE() << "read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUnsupported);
    EXPECT_THAT(error.problem(), HasSubstr("too large to be moved apart"));
  }
}

TEST(ColmapContent, FoldersWithoutAWholeModelAreRefused) {
  const TemporaryFolder folder;
  Notices notices;
  EXPECT_THROW(static_cast<void>(slamdb::detail::kColmapFormat.read(folder.Path(""), {}, notices)), Error);
  folder.Make("cameras.bin", SmallBytes(Part::kCameras));
  EXPECT_FALSE(slamdb::detail::kColmapFormat.sniff(Probe::Of(folder.Path(""))));
}

}  // namespace
}  // namespace slamdb::colmap
