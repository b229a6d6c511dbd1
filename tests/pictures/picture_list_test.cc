// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/pictures/picture_list.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "tests/support/kind_of.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<PictureFile> Find(const std::vector<std::string>& named) { return FindPictures(named); }

TEST(FindPictures, OfAFolderByNameWithTheirTimes) {
  const TemporaryFolder folder;
  for (const char* name : {"1403636579763555584.png", "1305031102.175304.PNG", "notes.md", "b.jpg"})
    folder.Make(name, "");
  const auto pictures = Find({folder.path().string()});
  ASSERT_EQ(pictures.size(), 3U);
  EXPECT_DOUBLE_EQ(pictures[0].timestamp, 1305031102.175304);
  EXPECT_DOUBLE_EQ(pictures[1].timestamp, 1403636579.763555584);
  EXPECT_EQ(pictures[2].path, folder / "b.jpg");
  EXPECT_EQ(pictures[2].timestamp, 3);
}

TEST(FindPictures, OfListsOfTumAndEuroc) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "data");
  folder.Make("data/20.png", "");
  const auto pictures =
      Find({folder.Make("rgb.txt", "# color images\n1305031102.5 rgb/a.png\nb.png\n"),
            folder.Make("data.csv", "#timestamp [ns],filename\n1403636579763555584,20.png\r\n"), "c.png"});
  ASSERT_EQ(pictures.size(), 4U);
  EXPECT_EQ(pictures[0].path, folder / "rgb/a.png");
  EXPECT_DOUBLE_EQ(pictures[0].timestamp, 1305031102.5);
  EXPECT_EQ(pictures[1].timestamp, 2);
  EXPECT_EQ(pictures[2].path, folder / "data/20.png");
  EXPECT_DOUBLE_EQ(pictures[2].timestamp, 1403636579.763555584);
  EXPECT_EQ(pictures[3].path, "c.png");
}

TEST(FindPictures, OfListsAsSpreadsheetsWriteThem) {
  const TemporaryFolder folder;
  folder.Make("my frame.jpg", "");
  folder.Make("frame.jpg", "");
  const auto pictures =
      Find({folder.Make("list.csv", "timestamp,filename\n1.5;my frame.jpg\n2.5,\"frame.jpg\"\n\"my frame.jpg\"\n")});
  ASSERT_EQ(pictures.size(), 3U);
  EXPECT_EQ(pictures[0].path, folder / "my frame.jpg");
  EXPECT_EQ(pictures[0].timestamp, 1.5);
  EXPECT_EQ(pictures[1].path, folder / "frame.jpg");
  EXPECT_EQ(pictures[2].path, folder / "my frame.jpg");
  EXPECT_TRUE(pictures[0].has_time);
  EXPECT_FALSE(pictures[2].has_time);
}

// A time is one that a list or a name says; without it the place in the order is no time.
TEST(FindPictures, TellsTimesFromPlacesInTheOrder) {
  const TemporaryFolder folder;
  const auto have_times = [](const std::vector<PictureFile>& pictures) {
    std::vector<bool> all;
    for (const PictureFile& picture : pictures) all.push_back(picture.has_time);
    return all;
  };
  EXPECT_THAT(have_times(Find({folder.Make("times.txt", "1305031102.5 a.png\nb.png\n1305031103.5.png\n"),
                               folder.Make("times.csv", "1403636579763555584,c.png\n")})),
              ElementsAre(true, false, true, true));
  EXPECT_THAT(have_times(Find({folder.Make("names.txt", "a.png\nb.png\n")})), ElementsAre(false, false));
  EXPECT_THAT(have_times(Find({"12.5.png", "kitchen.png", "1403636579763555584.jpg"})), ElementsAre(true, false, true));
  std::filesystem::create_directory(folder.path() / "data");
  for (const char* name : {"data/17.png", "data/hall.png"}) folder.Make(name, "");
  EXPECT_THAT(have_times(Find({(folder.path() / "data").string()})), ElementsAre(true, false));
}

TEST(FindPictures, RefusesWhatNamesNone) {
  const TemporaryFolder folder;
  EXPECT_EQ(KindOf([&] { (void)Find({folder.path().string()}); }), ErrorKind::kNotFound);
  EXPECT_EQ(KindOf([&] { (void)Find({folder.Path("none.txt")}); }), ErrorKind::kNotFound);
  EXPECT_THAT(MessageOf([&] { (void)Find({folder.Make("list.txt", "\na.png\n1 2 3\n")}); }),
              HasSubstr("line 3: names no picture"));
  for (const char* nothing : {"", "# a list\n\n"})
    EXPECT_THAT(MessageOf([&] { (void)Find({folder.Make("empty.txt", nothing)}); }), HasSubstr("names no pictures"));
}

}  // namespace
}  // namespace slamdb
