// SPDX-License-Identifier: BSD-3-Clause
// What only a fork has of an entity travels with it: through stores, ndjson and every edit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slamdb/checks/check.h"
#include "slamdb/edit/diff/diff.h"
#include "slamdb/edit/ids/renumber.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/part/extract.h"
#include "slamdb/edit/part/split.h"
#include "slamdb/edit/repair/journal.h"
#include "slamdb/edit/repair/repair.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/model/index.h"
#include "tests/formats/orbslam3/fork_files.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Extra members in every class; each entity's tell whose they are.
std::string Everywhere() {
  return Changed(
      R"({"class": "Atlas", "after": "mnLastInitKFidMap", "add": [["xAtlas", "u64"]]},
         {"class": "Map", "after": "mnId", "add": [["xMap", "u64"]]},
         {"class": "KeyFrame", "after": "mnFrameId", "add": [["xKeyFrame", "u64"], ["xNames", "vec<string>"]]},
         {"class": "MapPoint", "after": "mbBad", "add": [["xPoint", "u64"]]},
         {"class": "GeometricCamera", "after": "mnType", "add": [["xCamera", "u64"]]})");
}

template <class Entity>
std::uint64_t MarkOf(const Entity& entity) {
  std::uint64_t mark = 0;
  if (entity.carried) std::memcpy(&mark, entity.carried->members.data(), sizeof(mark));
  return mark;
}
void Mark(Boxed<Carried>& carried, std::uint64_t mark) {
  std::memcpy(carried.Make().members.data(), &mark, sizeof(mark));
}

constexpr std::uint64_t kKeyFrames = 1000, kPoints = 2000;

// Marked by their ids.
Atlas MarkedAtlas(const std::string& layout = Everywhere(), std::uint64_t seed = 1) {
  Atlas atlas = ReadFork(WriteFork(SmallWorld(seed), layout), layout);
  if (atlas.carried) Mark(atlas.carried, 7);
  for (Camera& camera : atlas.cameras) Mark(camera.carried, 300 + camera.id.value());
  for (Map& map : atlas.maps) {
    Mark(map.carried, 100 + map.id.value());
    for (KeyFrame& keyframe : map.keyframes) Mark(keyframe.carried, kKeyFrames + keyframe.id.value());
    for (MapPoint& point : map.points) Mark(point.carried, kPoints + point.id.value());
  }
  return atlas;
}

void ExpectMarks(const Atlas& atlas) {
  for (const Camera& camera : atlas.cameras) EXPECT_EQ(MarkOf(camera), 300 + camera.id.value());
  for (const Map& map : atlas.maps) {
    EXPECT_EQ(MarkOf(map), 100 + map.id.value());
    for (const KeyFrame& keyframe : map.keyframes) EXPECT_EQ(MarkOf(keyframe), kKeyFrames + keyframe.id.value());
    for (const MapPoint& point : map.points) EXPECT_EQ(MarkOf(point), kPoints + point.id.value());
  }
}

TEST(CarriedMembers, ComeBackFromAFile) {
  const Atlas atlas = MarkedAtlas();
  const std::string bytes = EncodeOrbslam3(atlas);
  const Atlas read = ReadFork(bytes, Everywhere());
  EXPECT_EQ(FirstDifference(read, atlas), "");
  EXPECT_EQ(MarkOf(read), 7U);
  ExpectMarks(read);
}

TEST(CarriedMembers, ComeBackFromAStore) {
  const TemporaryFolder folder;
  const Atlas atlas = MarkedAtlas();
  WriteAtlas(atlas, folder.Path("a.db#fork"));
  const Atlas stored = ReadAtlas(folder.Path("a.db#fork"));
  EXPECT_EQ(FirstDifference(stored, atlas), "");
  EXPECT_EQ(EncodeOrbslam3(stored), EncodeOrbslam3(atlas));
}

// The second save writes what changed alone.
TEST(CarriedMembers, AreSavedAnewWhereTheyChanged) {
  const TemporaryFolder folder;
  Atlas atlas = MarkedAtlas();
  const std::string path = folder.Path("a.db");
  {
    Store store = Store::OpenForWriting(path, {.sync = false});
    (void)store.Save("fork", atlas);
    Mark(atlas.maps[1].keyframes[2].carried, 5);
    Mark(atlas.maps[0].points[3].carried, 6);
    atlas.maps[0].points[4].carried.Reset();
    atlas.maps[0].carried.Reset();
    (void)store.Save("fork", atlas);
  }
  EXPECT_EQ(FirstDifference(Store::Open(path).Load("fork"), atlas), "");
  Store::OpenForWriting(path, {.sync = false}).Remove("fork");
}

TEST(CarriedMembers, ComeBackFromNdjson) {
  const Atlas atlas = MarkedAtlas();
  const std::string lines = EncodeAtlas(atlas, {.format = "ndjson"});
  const Atlas read = DecodeAtlas(lines);
  EXPECT_EQ(FirstDifference(read, atlas), "");
}

TEST(CarriedMembers, StayWithWhatIsExtracted) {
  Atlas atlas = MarkedAtlas();
  ExtractOptions options;
  options.part.map = MapId(1);
  (void)Extract(atlas, options);
  ASSERT_EQ(atlas.maps.size(), 1U);
  ExpectMarks(atlas);
  EXPECT_EQ(MarkOf(atlas), 7U);
  const Atlas read = ReadFork(EncodeOrbslam3(atlas), Everywhere());
  EXPECT_EQ(FirstDifference(read, atlas), "");
}

TEST(CarriedMembers, StayWithWhatIsSplit) {
  const Atlas atlas = MarkedAtlas();
  const AtlasIndex index(atlas);
  for (const Part& part : SplitAtlas(index)) {
    SubsetReport report;
    const Atlas own = TakePart(index, part, Border::kSmart, report, 1);
    EXPECT_EQ(own.layout, atlas.layout);
    EXPECT_EQ(MarkOf(own), 7U);
    ExpectMarks(own);
  }
}

TEST(CarriedMembers, GoWithTheirEntitiesIntoAMergedAtlas) {
  std::vector<Atlas> inputs = {MarkedAtlas(Everywhere(), 1), MarkedAtlas(Everywhere(), 2)};
  for (Map& map : inputs[1].maps)
    for (KeyFrame& keyframe : map.keyframes) Mark(keyframe.carried, 9000);
  const MergeResult merged = MergeAtlases(inputs);
  EXPECT_EQ(merged.atlas.layout, inputs[0].layout);
  EXPECT_THAT(merged.report.other_layouts, IsEmpty());
  EXPECT_EQ(merged.report.dropped_members, 1U) << "those of the second atlas itself";
  EXPECT_EQ(MarkOf(merged.atlas), 7U);
  EXPECT_EQ(MarkOf(merged.atlas.maps[0].keyframes[1]), kKeyFrames + merged.atlas.maps[0].keyframes[1].id.value());
  EXPECT_EQ(MarkOf(merged.atlas.maps[2].keyframes[1]), 9000U);
  const Atlas read = ReadFork(EncodeOrbslam3(merged.atlas), Everywhere());
  EXPECT_EQ(FirstDifference(read, merged.atlas), "");
}

TEST(CarriedMembers, OfOneLayoutStayWhereAtlasesOfSeveralAreMerged) {
  Atlas other = ReadFork(WriteFork(SmallWorld(2), "gnss"), "gnss");
  const MergeResult merged =
      MergeAtlases({SmallWorld(3), MarkedAtlas(), std::move(other)}, {.names = {"own", "marked", "gnss"}});
  EXPECT_EQ(merged.atlas.layout, Everywhere());
  EXPECT_THAT(merged.report.other_layouts, ElementsAre("gnss"));
  EXPECT_EQ(merged.report.dropped_members, 8U) << "of as many keyframes";
  EXPECT_EQ(MarkOf(merged.atlas.maps[2]), 100U);
  Notices notices;
  (void)WriteFork(merged.atlas, merged.atlas.layout, &notices);
  EXPECT_FALSE(notices.lossy()) << "what the others lack is zeros";
  EXPECT_THAT(TextOf(notices), HasSubstr("zeros stand for what the atlas does not have"));
}

TEST(CarriedMembers, StayWhenIdsChange) {
  Atlas atlas = MarkedAtlas();
  std::vector<std::uint64_t> before, after;
  for (const MapPoint& point : atlas.maps[1].points) before.push_back(MarkOf(point));
  (void)Renumber(atlas);
  for (const MapPoint& point : atlas.maps[1].points) after.push_back(MarkOf(point));
  EXPECT_EQ(before, after);
}

TEST(CarriedMembers, AreADifference) {
  const Atlas before = MarkedAtlas();
  Atlas after = before;
  Mark(after.maps[0].keyframes[1].carried, 1);
  EXPECT_NE(DiffAtlases(before, after).verdict(), AtlasDiff::Verdict::kSame);
  after = before;
  after.layout = "gnss";
  EXPECT_NE(DiffAtlases(before, after).verdict(), AtlasDiff::Verdict::kSame);
  EXPECT_EQ(DiffAtlases(before, before).verdict(), AtlasDiff::Verdict::kSame);
}

TEST(CarriedMembers, SurviveRepairAndItsUndoing) {
  Atlas atlas = MarkedAtlas();
  atlas.maps[0].points[2].normal.setConstant(std::nanf(""));
  atlas.maps[0].keyframes[1].parent = KeyFrameId(999999);
  const Atlas broken = atlas;
  const RepairReport report = RepairAtlas(atlas);
  EXPECT_FALSE(report.applied.empty());
  ExpectMarks(atlas);
  (void)UndoRepair(atlas, ParseJournal(ToJson(report.journal)));
  EXPECT_EQ(FirstDifference(atlas, broken), "");
}

TEST(CarriedMembers, AreSoundWithTheRules) { EXPECT_TRUE(CheckAtlas(MarkedAtlas()).ok()); }

// ---- descriptors that are not ORB's

TEST(OtherDescriptors, AreSoundAndStayWhenAnAtlasIsRepaired) {
  const Atlas atlas = WithFloatDescriptors();
  EXPECT_THAT(CheckAtlas(atlas).results, IsEmpty());
  Atlas repaired = atlas;
  (void)RepairAtlas(repaired);
  EXPECT_EQ(FirstDifference(repaired, atlas), "");
}

TEST(OtherDescriptors, ComeBackFromStoresAndNdjson) {
  const TemporaryFolder folder;
  const Atlas atlas = WithFloatDescriptors();
  WriteAtlas(atlas, folder.Path("a.db#superpoint"));
  EXPECT_EQ(FirstDifference(ReadAtlas(folder.Path("a.db#superpoint")), atlas), "");
  EXPECT_EQ(FirstDifference(DecodeAtlas(EncodeAtlas(atlas, {.format = "ndjson"})), atlas), "");
}

TEST(OtherDescriptors, OfMoreRowsThanTheyHaveAreFound) {
  Atlas atlas = WithFloatDescriptors();
  atlas.maps[0].keyframes[0].carried.Make().descriptors.rows = -5;
  EXPECT_FALSE(CheckAtlas(atlas).ok());
  atlas.maps[0].keyframes[0].carried.Make().descriptors.rows = 2147483647;
  EXPECT_FALSE(CheckAtlas(atlas).ok());
}

// ---- what is said

TEST(CarriedMembers, AreNamedWhereTheyAreDropped) {
  Notices notices;
  (void)WriteFork(MarkedAtlas(), "v1.0", &notices);
  EXPECT_TRUE(notices.lossy());
  EXPECT_THAT(TextOf(notices), HasSubstr("the layout v1.0 cannot hold xKeyFrame, xNames of 8 keyframes; xPoint of 40 "
                                         "map points; xAtlas, xCamera, xMap of 5 others"));
}

TEST(CarriedMembers, AreRefusedWhereNothingMayBeLost) {
  WriteOptions options{.format = "orbslam3", .strict = true};
  options.of<Orbslam3WriteOptions>().layout = "v1.0";
  EXPECT_THAT(MessageOf([&] { (void)EncodeAtlas(MarkedAtlas(), options); }),
              HasSubstr("cannot hold xKeyFrame, xNames of 8 keyframes"));
  options.of<Orbslam3WriteOptions>().layout.reset();
  EXPECT_NO_THROW((void)EncodeAtlas(MarkedAtlas(), options));
}

TEST(CarriedMembers, OfAnotherLayoutAreNotWrittenAsIfTheyWereOfThis) {
  Atlas atlas = MarkedAtlas();
  Notices notices;
  const Atlas read = ReadFork(WriteFork(atlas, "gnss", &notices), "gnss");
  EXPECT_TRUE(notices.lossy());
  for (const KeyFrame& keyframe : read.maps[0].keyframes) EXPECT_EQ(MarkOf(keyframe), 0U);
}

TEST(CarriedMembers, ThatAreNotOfTheLayoutAreRefusedWithTheirPlace) {
  Atlas atlas = MarkedAtlas();
  atlas.maps[0].keyframes[1].carried.Make().members.pop_back();
  EXPECT_THAT(
      MessageOf([&] { (void)EncodeOrbslam3(atlas); }),
      HasSubstr(ToString(atlas.maps[0].keyframes[1].id) + ", xNames: the carried members are not of this layout"));
  atlas = MarkedAtlas();
  atlas.maps[0].points[1].carried.Make().members.push_back(std::byte{0});
  EXPECT_THAT(MessageOf([&] { (void)EncodeOrbslam3(atlas); }), HasSubstr("1 bytes are left over"));
}

}  // namespace
}  // namespace slamdb
