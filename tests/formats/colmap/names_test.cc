// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/names.h"

#include <gmock/gmock.h>

#include "slamdb/base/error.h"
#include "tests/formats/formats/small_atlas.h"

namespace slamdb::colmap {
namespace {

std::vector<std::string> NamesOf(const Atlas& atlas, const KeyFramePictures& pictures = {}) {
  std::vector<std::string> names;
  const Outline outline = OutlineOf(atlas, "out", {}, pictures);
  for (const MapOutline& map : outline.maps)
    for (const View& view : map.views) names.push_back(view.name);
  return names;
}

TEST(ColmapNames, AreTimes) {
  EXPECT_EQ(NamesOf(SmallAtlas()), (std::vector<std::string>{"1.5.png", "0.5.png", "2.png"}));
}

TEST(ColmapNames, AreDistinct) {
  Atlas atlas = SmallAtlas();
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) keyframe.timestamp = 3;
  const std::vector<std::string> names = NamesOf(atlas);
  EXPECT_EQ(names, (std::vector<std::string>{"3.png", "2/3.png", "8/3.png"}));
  for (const std::string& name : names) EXPECT_EQ(TimeInName(name), 3);
}

TEST(ColmapNames, AreThoseOfThePicturesNearestInTime) {
  KeyFramePictures pictures{.files = {{"/data/cam/a.png", 0.45, true},
                                      {"/data/cam/b.png", 0.75, true},
                                      {"/data/cam/c.png", 1.05, true},
                                      {"/data/cam/d.png", 1.35, true}},
                            .folder = "/data"};
  // Half of 0.3 s at most: 1.5 is 0.15 s from d, 2 is too far from all.
  EXPECT_EQ(NamesOf(SmallAtlas(), pictures), (std::vector<std::string>{"cam/d.png", "cam/a.png", "2.png"}));
  EXPECT_EQ(OutlineOf(SmallAtlas(), "out", {}, pictures).without_picture, 1U);
}

// Whatever files are called, names are distinct, and none leads out of the folder.
TEST(ColmapNames, OfHostileFilesAreDistinctAndInside) {
  KeyFramePictures pictures{.files = {{"/data/2/\"\n\xff.png", 0.5, true},
                                      {"/data/\"\n\xff.png", 1.5, true},
                                      {"/other/../etc/\"\n\xff.png", 2.5, true}},
                            .folder = "/data"};
  Atlas atlas = SmallAtlas();
  atlas.maps[1].keyframes[0].timestamp = 2.5;
  EXPECT_EQ(NamesOf(atlas, pictures), (std::vector<std::string>{"\"\n\xff.png", "2/\"\n\xff.png", "8/\"\n\xff.png"}));
  // The folder is given by another way than the files.
  pictures.folder = "data";
  EXPECT_EQ(NamesOf(atlas, pictures)[0], "\"\n\xff.png");
}

// A folder that is made for the second of two names may be that of a file.
TEST(ColmapNames, StayDistinctWhereFoldersAreNumbers) {
  Atlas atlas = SmallAtlas();
  atlas.maps[0].keyframes[0].timestamp = 0.5;
  KeyFramePictures pictures{.files = {{"a.png", 0.5, true}, {"2/a.png", 2, true}}, .folder = "."};
  pictures.files[0].path = "./a.png", pictures.files[1].path = "./2/a.png";
  const std::vector<std::string> names = NamesOf(atlas, pictures);
  EXPECT_EQ(names, (std::vector<std::string>{"a.png", "2/a.png", "8/2/a.png"}));
}

TEST(ColmapNames, NeedPicturesWithTimesThatAreNear) {
  const auto problem = [](const KeyFramePictures& pictures) {
    try {
      NamesOf(SmallAtlas(), pictures);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(problem({.files = {{"frame_1.png", 1, false}}, .folder = ""}),
              ::testing::HasSubstr("has no time in its name"));
  EXPECT_THAT(problem({.files = {{"77.png", 77, true}}, .folder = ""}),
              ::testing::HasSubstr("none of the 1 picture is near in time to a keyframe"));
}

TEST(ColmapNames, TellTimes) {
  EXPECT_EQ(TimeInName("left/1403636579.763555.png"), 1403636579.763555);
  EXPECT_EQ(TimeInName("1403636579763555584.jpg"), 1403636579.763555584);
  EXPECT_EQ(TimeInName("-1.5.png"), -1.5);
  EXPECT_EQ(TimeInName("12"), 12);
  for (const char* name : {"a.png", "frame_000012.png", "", "nan.png", "inf.png", "1.5s.png"})
    EXPECT_FALSE(TimeInName(name)) << name;
}

}  // namespace
}  // namespace slamdb::colmap
