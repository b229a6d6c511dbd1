// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/detail/losses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slamdb/base/error.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/formats.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(ContentOf, IsWhatTheAtlasHas) {
  EXPECT_EQ(detail::ContentOf({}), Content::kNothing);
  const Content one = Content::kPoses | Content::kPoints | Content::kNormals | Content::kObservations |
                      Content::kKeypoints | Content::kDescriptors | Content::kGraph | Content::kCameras |
                      Content::kIdentity;
  EXPECT_EQ(detail::ContentOf(OneMapAtlas()), one);
  EXPECT_EQ(detail::ContentOf(SmallAtlas()), one | Content::kMaps);
  EXPECT_EQ(detail::ContentOf(InertialAtlas()), one | Content::kInertial);
  EXPECT_EQ(detail::ContentOf(SmallAtlas(), MapId(0)), one);
}

TEST(Content, IsASet) {
  using enum Content;
  static_assert((kPoses | kPoints) == (kPoints | kPoses));
  static_assert(HasAny(kPoses | kPoints, kPoints | kMaps) && !HasAny(kPoses, kPoints));
  static_assert(HasAll(kAtlas, kPoses | kPoints) && !HasAll(kPoses, kPoses | kPoints));
  static_assert(~kNothing == kEverything && ~kAtlas == (kLandmarks | kTracking | kCarried) && ~kEverything == kNothing);
  Content content = kPoses;
  content |= kMaps;
  EXPECT_EQ(content, kPoses | kMaps);
  content &= ~kPoses;
  EXPECT_EQ(content, kMaps);
}

TEST(ContentOf, KnowsBagsOfWords) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].keyframes[0].features.bag_of_words = {.words = {1}, .weights = {1.0}};
  EXPECT_EQ(detail::ContentOf(atlas) & Content::kBagOfWords, Content::kBagOfWords);
}

TEST(LossesOf, NamesEachWithItsCount) {
  EXPECT_THAT(detail::LossesOf(SmallAtlas(), FormatById("ply"), {}),
              ElementsAre("ply cannot hold keyframe poses (3)", "ply cannot hold observations (3)",
                          "ply cannot hold keypoints (3)", "ply cannot hold descriptors (7)",
                          "ply cannot hold edges between keyframes (covisibility, spanning tree, loops, merges) (3)",
                          "ply cannot hold cameras (1)",
                          "ply cannot hold all ids and flags, the counters and the vocabulary's name"));
  EXPECT_THAT(detail::LossesOf(SmallAtlas(), FormatById("kitti"), {}), Contains("kitti cannot hold several maps (2)"));
  EXPECT_THAT(detail::LossesOf(SmallAtlas(), FormatById("kitti"), WriteOptions{}.With(ExportOptions{.map = MapId(0)})),
              Not(Contains(HasSubstr("several maps"))));
  EXPECT_THAT(detail::LossesOf(InertialAtlas(), FormatById("tum"), {}),
              Contains("tum cannot hold inertial data of keyframes (2)"));
}

// A format that writes all maps loses what is in all of them, whichever map an export would choose.
TEST(LossesOf, CountAllMapsWhereNoneIsChosen) {
  Atlas atlas = LandmarkAtlas();
  atlas.maps.insert(atlas.maps.begin(), Map());
  atlas.maps[0].id = MapId(77);
  const WriteOptions options = WriteOptions{}.With(ExportOptions{.map = MapId(77)});
  EXPECT_THAT(detail::LossesOf(atlas, FormatById("orbslam3"), options), Contains(HasSubstr("landmarks")));
  EXPECT_THAT(detail::LossesOf(atlas, FormatById("ply"), options), Not(Contains(HasSubstr("landmarks"))));
}

TEST(LossesOf, LandmarksAreOne) {
  EXPECT_THAT(detail::LossesOf(LandmarkAtlas(), FormatById("orbslam3"), {}),
              ElementsAre("orbslam3 cannot hold landmarks (3)"));
  EXPECT_THAT(detail::LossesOf(LandmarkAtlas(), FormatById("mrpt"), {}), Not(Contains(HasSubstr("landmarks"))));
}

// In memory and in stores only.
TEST(LossesOf, OriginsAndCountsOfPointsAreOne) {
  Atlas atlas = OneMapAtlas();
  EXPECT_EQ(detail::ContentOf(atlas) & Content::kTracking, Content::kNothing);
  EXPECT_THAT(detail::LossesOf(atlas, FormatById("orbslam3"), {}), IsEmpty());
  atlas.maps[0].points[0].origin_map = 0;
  atlas.maps[0].points[1].found_count = 0;
  atlas.maps[0].points[1].visible_count = 4;
  EXPECT_EQ(detail::ContentOf(atlas) & Content::kTracking, Content::kTracking);
  for (const char* format : {"orbslam3", "orbslam3-text"})
    EXPECT_THAT(
        detail::LossesOf(atlas, FormatById(format), {}),
        ElementsAre(std::string(format) + " cannot hold origins and visible and found counts of map points (2)"));
  for (const char* format : {"store", "ndjson"})
    EXPECT_THAT(detail::LossesOf(atlas, FormatById(format), {}), IsEmpty());
  atlas.maps[0].points[1] = OneMapAtlas().maps[0].points[1];
  EXPECT_THAT(detail::LossesOf(atlas, FormatById("orbslam3"), {}),
              ElementsAre("orbslam3 cannot hold origins of map points (1)"));
  std::swap(atlas.maps[0].points[0].origin_map, atlas.maps[0].points[1].origin_map);
  atlas.maps[0].points[1].origin_map = MapPoint::kNoOrigin;
  atlas.maps[0].points[0].visible_count = 2;
  EXPECT_THAT(detail::LossesOf(atlas, FormatById("orbslam3"), {}),
              ElementsAre("orbslam3 cannot hold visible and found counts of map points (1)"));
}

TEST(LossesOf, AreNoneWhereEverythingFits) {
  EXPECT_THAT(detail::LossesOf(LandmarkAtlas(), FormatById("ndjson"), {}), IsEmpty());
  for (const Format& format : Formats()) EXPECT_THAT(detail::LossesOf({}, format, {}), IsEmpty()) << format.id;
}

// What claims to hold an atlas, and does not hold all of it.
TEST(WriteAtlas, TellsLosses) {
  const TemporaryFolder folder;
  Notices notices;
  WriteAtlas(LandmarkAtlas(), folder.Path("a.osa"), {}, &notices);
  EXPECT_TRUE(notices.lossy());
  EXPECT_EQ(notices.items()[0], (Notice{Notice::Kind::kLoss, "orbslam3 cannot hold landmarks (3)"}));
  EXPECT_EQ(notices.written(), "");
}

TEST(WriteAtlas, TellsWhatAnExportHolds) {
  const TemporaryFolder folder;
  for (const Format& format : Formats()) {
    if (!format.is_export) continue;
    SCOPED_TRACE(format.id);
    Notices notices;
    WriteAtlas(OneMapAtlas(), folder.Path(format.id), ForAnyFormat({.format = std::string(format.id)}), &notices);
    EXPECT_FALSE(notices.lossy());
    EXPECT_NE(notices.written(), "");
    EXPECT_FALSE(HasAll(format.writes, Content::kAtlas));
    notices.Lose("what a reader left out");
    WriteAtlas(OneMapAtlas(), folder.Path("again-" + std::string(format.id)),
               ForAnyFormat({.format = std::string(format.id)}), &notices);
    EXPECT_FALSE(notices.lossy());
    EXPECT_THAT(notices.items(), Contains(Notice{Notice::Kind::kWarning, "what a reader left out"}));
  }
  EXPECT_FALSE(FormatById("ndjson").is_export);
}

TEST(WriteAtlas, WritesNothingWhenStrict) {
  const TemporaryFolder folder;
  Notices notices;
  try {
    WriteAtlas(OneMapAtlas(), folder.Path("a.ply"), {.strict = true}, &notices);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.path(), folder.Path("a.ply"));
    EXPECT_EQ(error.kind(), ErrorKind::kNotPossible);
    EXPECT_EQ(error.problem(), "ply cannot hold keyframe poses (2); WriteOptions::strict refuses that");
  }
  EXPECT_THAT(folder.Names(), IsEmpty());
  EXPECT_THAT(notices.items(), IsEmpty());
  WriteAtlas(OneMapAtlas(), folder.Path("a.ndjson"), {.strict = true}, &notices);
  EXPECT_THAT(folder.Names(), ElementsAre("a.ndjson"));
}

}  // namespace
}  // namespace slamdb
