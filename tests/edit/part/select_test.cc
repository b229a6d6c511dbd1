// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/select.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "slamdb/base/error.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/edit/part/extract.h"
#include "slamdb/edit/part/split.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/up.h"
#include "tests/edit/soundness.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"

namespace slamdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

// Two maps of four keyframes in a row along x, a second apart, ids 0 to 3 and 10 to 13; point i at the place of
// keyframe i, 5 m in front, seen by it and the next.
Atlas Rows() {
  Atlas atlas;
  for (std::uint64_t m = 0; m < 2; ++m) {
    Map& map = atlas.maps.emplace_back();
    map.id = MapId(m);
    for (std::uint64_t i = 0; i < 4; ++i) {
      KeyFrame& keyframe = map.keyframes.emplace_back();
      keyframe.id = KeyFrameId(10 * m + i);
      keyframe.timestamp = static_cast<double>(10 * m + i);
      keyframe.camera_from_world.translation.x() = -static_cast<float>(i);
      keyframe.origin_map = i < 2 ? 0 : 7;
      if (i > 0 && i != 2) keyframe.connections = {{KeyFrameId(10 * m + i - 1), 20}};
      MapPoint& point = map.points.emplace_back();
      point.id = MapPointId(10 * m + i);
      point.position = {static_cast<float>(i), 0, 5};
      point.observations = {{keyframe.id, 0, -1}};
      if (i < 3) point.observations.push_back({KeyFrameId(10 * m + i + 1), 1, -1});
    }
  }
  return atlas;
}

std::vector<int> Flagged(const Subset& subset, std::vector<std::uint8_t> Subset::MapRows::*list) {
  std::vector<int> flagged;
  for (std::size_t map = 0; map < subset.maps.size(); ++map)
    for (std::size_t row = 0; row < (subset.maps[map].*list).size(); ++row)
      if ((subset.maps[map].*list)[row]) flagged.push_back(static_cast<int>(10 * map + row));
  return flagged;
}
std::vector<int> KeyFrames(const SelectOptions& options) {
  const Atlas atlas = Rows();
  return Flagged(Select(AtlasIndex(atlas), options), &Subset::MapRows::keyframes);
}
std::vector<int> Points(const SelectOptions& options) {
  const Atlas atlas = Rows();
  return Flagged(Select(AtlasIndex(atlas), options), &Subset::MapRows::points);
}

Eigen::AlignedBox3f Box(float x0, float z0, float x1, float z1) {
  return {Eigen::Vector3f(x0, -1, z0), Eigen::Vector3f(x1, 1, z1)};
}

TEST(Select, ByMapIdsTimeSessionAndOrder) {
  EXPECT_THAT(KeyFrames({.map = MapId(1)}), ElementsAre(10, 11, 12, 13));
  EXPECT_THAT(KeyFrames({.first_keyframe = 2, .last_keyframe = 10}), ElementsAre(2, 3, 10));
  EXPECT_THAT(KeyFrames({.keyframes = {KeyFrameId(3), KeyFrameId(11)}}), ElementsAre(3, 11));
  EXPECT_THAT(KeyFrames({.begin_time = 3, .end_time = 10}), ElementsAre(3, 10));
  EXPECT_THAT(KeyFrames({.session = 7}), ElementsAre(2, 3, 12, 13));
  EXPECT_THAT(KeyFrames({.map = MapId(0), .session = 7}), ElementsAre(2, 3));
  EXPECT_THAT(KeyFrames({.every = 3}), ElementsAre(0, 3, 10, 13));
  EXPECT_THAT(KeyFrames({.first_keyframe = 1, .every = 2}), ElementsAre(1, 3, 10, 12));
}

TEST(Select, ComponentsByTheirSize) {
  Atlas atlas = Rows();
  atlas.maps[1].keyframes[2].connections = {{KeyFrameId(11), 15}};  // all of map 1 hangs together
  const AtlasIndex index(atlas);
  const std::vector<Component> components = FindComponents(index);
  ASSERT_THAT(components, SizeIs(3));
  EXPECT_EQ(components[0].map, 1U);
  EXPECT_THAT(components[1].keyframes, ElementsAre(0, 1));
  EXPECT_THAT(Flagged(Select(index, {.component = 3}), &Subset::MapRows::keyframes), ElementsAre(2, 3));
  EXPECT_THAT(Flagged(Select(index, {.map = MapId(0), .component = 1}), &Subset::MapRows::keyframes),
              ElementsAre(0, 1));
}

TEST(Select, TakesThePointsThatItsKeyframesObserve) {
  EXPECT_THAT(Points({.first_keyframe = 2, .last_keyframe = 2}), ElementsAre(1, 2));
  EXPECT_THAT(Points({.map = MapId(1)}), ElementsAre(10, 11, 12, 13));
}

TEST(Select, CutsByRegion) {
  const Eigen::AlignedBox3f cameras = Box(0.5F, -1, 2.5F, 1), points = Box(0.5F, 4, 2.5F, 6), all = Box(0.5F, -1, 9, 9);
  EXPECT_THAT(KeyFrames({.map = MapId(0), .box = cameras, .region = RegionOf::kCameras}), ElementsAre(1, 2));
  EXPECT_THAT(Points({.map = MapId(0), .box = cameras, .region = RegionOf::kCameras}), ElementsAre(0, 1, 2));
  EXPECT_THAT(Points({.map = MapId(0), .box = points, .region = RegionOf::kPoints}), ElementsAre(1, 2));
  EXPECT_THAT(KeyFrames({.map = MapId(0), .box = points, .region = RegionOf::kPoints}), ElementsAre(1, 2, 3));
  EXPECT_THAT(KeyFrames({.map = MapId(0), .box = all}), ElementsAre(1, 2, 3));
  EXPECT_THAT(Points({.map = MapId(0), .box = all}), ElementsAre(1, 2, 3));
  // Points alone: the border may bring the keyframes that observe them.
  EXPECT_THAT(KeyFrames({.map = MapId(0), .box = points}), IsEmpty());
  EXPECT_THAT(Points({.map = MapId(0), .box = points}), ElementsAre(1, 2));
}

TEST(Select, CutsByPolygonInThePlan) {
  const std::vector<Eigen::Vector2f> triangle = {{0.5F, -1}, {2.5F, -1}, {2.5F, 9}};  // x and z
  EXPECT_THAT(Points({.map = MapId(0), .polygon = triangle, .region = RegionOf::kPoints}), ElementsAre(2));
  EXPECT_THAT(KeyFrames({.map = MapId(0), .polygon = triangle, .region = RegionOf::kCameras}), ElementsAre(1, 2));
  const SelectOptions in_xy{.map = MapId(0), .polygon = triangle, .plane = PlanPlane::kXy, .region = RegionOf::kPoints};
  EXPECT_THAT(Points(in_xy), ElementsAre(1, 2));
}

// Turned so that z is up, what was z is y, and what was ahead of the cameras is still inside.
TEST(Select, ThePlanIsLevelWhateverFrameTheMapWasMovedInto) {
  const std::vector<Eigen::Vector2f> triangle = {{0.5F, -1}, {2.5F, -1}, {2.5F, 9}};
  Atlas atlas = Rows();
  TransformMap(atlas.maps[0], {1, UprightFromMap(-Eigen::Vector3d::UnitY())});
  const SelectOptions in_plan{.map = MapId(0), .polygon = triangle, .region = RegionOf::kPoints};
  EXPECT_THAT(Flagged(Select(AtlasIndex(atlas), in_plan), &Subset::MapRows::points), ElementsAre(2));
}

TEST(Select, EverythingElse) {
  EXPECT_THAT(KeyFrames({.first_keyframe = 1, .except = true}), ElementsAre(0));
  EXPECT_THAT(Points({.begin_time = 1, .end_time = 1, .except = true}), SizeIs(8));  // as long as others observe them
  const SelectOptions hole{.box = Box(0.5F, 4, 2.5F, 6), .region = RegionOf::kPoints, .except = true};
  EXPECT_THAT(KeyFrames(hole), SizeIs(8));
  EXPECT_THAT(Points(hole), ElementsAre(0, 3, 10, 13));
}

TEST(Select, RefusesWhatIsNotThere) {
  const Atlas atlas = Rows();
  const AtlasIndex index(atlas);
  const auto expect = [&](const SelectOptions& options, const char* text) {
    EXPECT_THAT([&] { return Select(index, options); }, ThrowsMessage<Error>(HasSubstr(text)));
  };
  expect({.map = MapId(5)}, "there is no map 5; there are 0, 1");
  expect({.keyframes = {KeyFrameId(99)}}, "no keyframe 99");
  expect({.session = 3}, "session 3; sessions are 0, 7");
  expect({.component = 5}, "no component 5; the covisibility graph has 4");
  expect({.polygon = {{0, 0}, {1, 1}}}, "three corners or more, found 2");
  expect({.begin_time = 100}, "nothing is selected");
  expect({.first_keyframe = 0, .except = true}, "nothing is left");
  expect({.every = 0}, "every 0th");
}

// Map 0 has landmarks at x = 0 to 3; map 2 is landmarks alone, at x = 2 and 3.
Atlas RowsWithLandmarks() {
  Atlas atlas = Rows();
  const auto add = [&](std::size_t map, double x) {
    Landmark& landmark = atlas.maps[map].landmarks.emplace_back();
    landmark.mean = {x, 0, 5};
  };
  for (int x = 0; x < 4; ++x) add(0, x);
  atlas.maps.emplace_back().id = MapId(2);
  for (int x = 2; x < 4; ++x) add(2, x);
  return atlas;
}

TEST(SplitAtlas, ByMapSessionAndComponent) {
  const Atlas atlas = Rows();
  const AtlasIndex index(atlas);
  const auto names = [&](SplitBy by) {
    std::vector<std::string> found;
    for (const Part& part : SplitAtlas(index, {.by = by})) found.push_back(part.name);
    return found;
  };
  EXPECT_THAT(names(SplitBy::kMap), ElementsAre("map-0", "map-1"));
  EXPECT_THAT(names(SplitBy::kSession), ElementsAre("session-0", "session-7"));
  EXPECT_THAT(names(SplitBy::kComponent),
              ElementsAre("map-0-component-1", "map-0-component-2", "map-1-component-1", "map-1-component-2"));
}

TEST(SplitAtlas, LeavesOutSmallParts) {
  const Atlas atlas = RowsWithLandmarks();
  const AtlasIndex index(atlas);
  std::size_t largest = 0;
  for (const Map& map : atlas.maps) largest = std::max(largest, map.keyframes.size());
  std::vector<std::string> found;
  for (const Part& part : SplitAtlas(index, {.min_keyframes = largest})) found.push_back(part.name);
  for (const Map& map : atlas.maps) {
    const bool stays = map.keyframes.size() >= largest || map.keyframes.empty();
    EXPECT_EQ(std::ranges::count(found, "map-" + std::to_string(map.id.value())), stays ? 1 : 0) << map.id.value();
  }
  EXPECT_EQ(KindOf([&] { return SplitAtlas(index, {.by = SplitBy::kSession, .min_keyframes = 100}); }),
            ErrorKind::kNotPossible);
}

TEST(Extract, SelectsSettlesAndKeeps) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 12, .points = 200, .features = 150});
  const AtlasIndex index(atlas);
  const SelectOptions part{.first_keyframe = 4, .last_keyframe = 8};
  for (const Border border : {Border::kStrict, Border::kCompletePoints, Border::kSmart}) {
    Atlas extracted = atlas, expected = atlas;
    const ExtractReport report = Extract(extracted, {.part = part, .border = border, .threads = 1});
    Subset subset = Select(index, part);
    SettleBorder(index, border, subset);
    EXPECT_EQ(report.removed, KeepSubset(expected, subset));
    EXPECT_THAT(extracted, EqualsAtlas(expected));
    EXPECT_EQ(report.coverage.covered, MeasureCoverage(index, subset).covered);
  }
}

TEST(Extract, ChangesNothingWhenItRefuses) {
  const Atlas atlas = Rows();
  Atlas same = atlas;
  EXPECT_EQ(
      KindOf([&] { Extract(same, {.part = {.map = MapId(0), .except = true}, .border = Border::kCompletePoints}); }),
      ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { Extract(same, {.part = {.component = 0}}); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { Extract(same, {.part = {.map = MapId(99)}}); }), ErrorKind::kNotPossible);
  EXPECT_THAT(same, EqualsAtlas(atlas));
}

TEST(TakePart, IsWhatKeepingTheSubsetLeaves) {
  const Atlas atlas = SynthesizeAtlas({.maps = 3, .keyframes = 8, .points = 150, .features = 120});
  const AtlasIndex index(atlas);
  for (const Part& part : SplitAtlas(index, {.by = SplitBy::kMap})) {
    SubsetReport taken, kept;
    const Atlas own = TakePart(index, part, Border::kSmart, taken);
    Atlas whole = atlas;
    Subset subset = Select(index, {.map = atlas.maps[part.maps.at(0).map].id});
    SettleBorder(index, Border::kSmart, subset);
    kept = KeepSubset(whole, subset);
    EXPECT_THAT(own, EqualsAtlas(whole)) << part.name;
    EXPECT_EQ(taken.maps, 2U);
    EXPECT_EQ(taken.keyframes, kept.keyframes);
    EXPECT_EQ(taken.points, kept.points);
    EXPECT_EQ(taken.before, CountEntities(atlas));
    EXPECT_EQ(taken.after, CountEntities(own));
    EXPECT_THAT(Troubles(own), IsEmpty());
  }
}

TEST(TakePart, TakesSessionsThroughSeveralMaps) {
  const Atlas atlas = Rows();
  const AtlasIndex index(atlas);
  for (const Part& part : SplitAtlas(index, {.by = SplitBy::kSession})) {
    SubsetReport taken, kept;
    const Atlas own = TakePart(index, part, Border::kSmart, taken);
    Atlas whole = atlas;
    const std::uint32_t session = atlas.maps[part.maps[0].map].keyframes[part.maps[0].keyframes.at(0)].origin_map;
    Subset subset = Select(index, {.session = session});
    SettleBorder(index, Border::kSmart, subset);
    kept = KeepSubset(whole, subset);
    EXPECT_THAT(own, EqualsAtlas(whole)) << part.name;
    EXPECT_EQ(taken.after, kept.after) << part.name;
  }
}

// Parts that interleave in time: preintegrations are joined over keyframes that are in no part of their own.
TEST(TakePart, CopiesWhatKeepingTheSubsetNeeds) {
  for (const bool inertial : {false, true}) {
    Atlas atlas = SynthesizeAtlas({.inertial = inertial, .maps = 2, .keyframes = 30, .points = 300, .features = 120});
    for (KeyFrame& keyframe : atlas.maps[1].keyframes)
      keyframe.origin_map = static_cast<std::uint32_t>(keyframe.id.value() % 7 / 3);
    const AtlasIndex index(atlas);
    for (const Part& part : SplitAtlas(index, {.by = SplitBy::kSession}))
      for (const Border border : {Border::kStrict, Border::kCompletePoints, Border::kSmart}) {
        Subset subset = Subset::Nothing(atlas);
        for (const Part::OfMap& of : part.maps)
          for (const std::uint32_t row : of.keyframes) subset.maps[of.map].keyframes[row] = 1;
        for (const Part::OfMap& of : part.maps)
          for (std::size_t row = 0; row < atlas.maps[of.map].points.size(); ++row)
            for (const Observation& observation : atlas.maps[of.map].points[row].observations)
              if (subset.maps[of.map].keyframes[index.KeyFrameRow(of.map, observation.keyframe)])
                subset.maps[of.map].points[row] = 1;
        SettleBorder(index, border, subset);
        Atlas whole = atlas;
        SubsetReport taken, kept = KeepSubset(whole, subset);
        const Atlas own = TakePart(index, part, border, taken);
        EXPECT_THAT(own, EqualsAtlas(whole)) << part.name;
        EXPECT_EQ(taken.keyframes, kept.keyframes);
        EXPECT_EQ(taken.points, kept.points);
        EXPECT_EQ(taken.joined, kept.joined);
      }
  }
}

TEST(TakePart, RefusesPartsOfAnotherAtlas) {
  const Atlas atlas = Rows(), other;
  const std::vector<Part> parts = SplitAtlas(AtlasIndex(atlas), {.by = SplitBy::kMap});
  SubsetReport taken;
  EXPECT_EQ(KindOf([&] { return TakePart(AtlasIndex(other), parts[0], Border::kSmart, taken); }), ErrorKind::kUsage);
}

// A flag for each row of the atlas in each part would take memory by the square of their number.
TEST(SplitAtlas, ListsRowsOnceHoweverManyPartsThereAre) {
  Atlas atlas;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    Map& map = atlas.maps.emplace_back();
    map.id = MapId(i);
    map.keyframes.emplace_back().id = KeyFrameId(i);
    map.keyframes[0].origin_map = i;
  }
  const AtlasIndex index(atlas);
  for (const SplitBy by : {SplitBy::kMap, SplitBy::kSession, SplitBy::kComponent}) {
    const std::vector<Part> parts = SplitAtlas(index, {.by = by});
    EXPECT_THAT(parts, SizeIs(3000));
    for (const Part& part : parts) {
      ASSERT_THAT(part.maps, SizeIs(1));
      EXPECT_THAT(part.maps[0].keyframes, SizeIs(1));
    }
  }
}

TEST(Select, LandmarksByRegionOrWithTheirMap) {
  const Atlas atlas = RowsWithLandmarks();
  const auto landmarks = [&](const SelectOptions& options) {
    return Flagged(Select(AtlasIndex(atlas), options), &Subset::MapRows::landmarks);
  };
  EXPECT_THAT(landmarks({.keyframes = {KeyFrameId(3)}}), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(landmarks({.map = MapId(0)}), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(landmarks({.map = MapId(1)}), IsEmpty());
  EXPECT_THAT(landmarks({.map = MapId(2)}), ElementsAre(20, 21));
  EXPECT_THAT(landmarks({.map = MapId(0), .except = true}), ElementsAre(20, 21));
  const Eigen::AlignedBox3f box = Box(1.5F, 4, 2.5F, 6);
  EXPECT_THAT(landmarks({.box = box}), ElementsAre(2, 20));
  EXPECT_THAT(landmarks({.box = box, .except = true}), ElementsAre(0, 1, 3, 21));
  EXPECT_THAT(landmarks({.map = MapId(0), .box = box}), ElementsAre(2));
  EXPECT_THAT(landmarks({.box = Box(0.5F, -1, 1.5F, 1), .region = RegionOf::kCameras}), ElementsAre(0, 1, 2, 3));
}

TEST(Select, MapsOfLandmarksAloneStayWithThem) {
  const Atlas atlas = RowsWithLandmarks();
  const AtlasIndex index(atlas);
  Atlas part = atlas;
  const SubsetReport removed = KeepSubset(part, Select(index, {.map = MapId(2), .box = Box(1.5F, 4, 2.5F, 6)}));
  ASSERT_THAT(part.maps, SizeIs(1));
  EXPECT_EQ(part.maps[0].id, MapId(2));
  ASSERT_THAT(part.maps[0].landmarks, SizeIs(1));
  EXPECT_EQ(part.maps[0].landmarks[0].mean.x(), 2);
  EXPECT_EQ(removed.landmarks, 5U);
  const std::vector<Part> parts = SplitAtlas(index, {.by = SplitBy::kMap});
  ASSERT_THAT(parts, SizeIs(3));
  SubsetReport taken;
  EXPECT_THAT(TakePart(index, parts[2], Border::kSmart, taken).maps[0].landmarks, SizeIs(2));
  EXPECT_EQ(taken.landmarks, 4U);
  Atlas whole = atlas;
  KeepSubset(whole, Subset::Everything(whole));
  ASSERT_THAT(whole.maps, SizeIs(3));
  EXPECT_THAT(whole.maps[0].landmarks, SizeIs(4));
  EXPECT_THAT(whole.maps[2].landmarks, SizeIs(2));
}

// Many parts of an atlas, none of which may be less sound than the whole.
void ExpectSoundParts(const Atlas& atlas, const std::string& name) {
  const AtlasIndex index(atlas);
  const std::set<std::string> known = Troubles(atlas);
  const Map& map = *std::ranges::max_element(atlas.maps, {}, [](const Map& each) { return each.keyframes.size(); });
  const KeyFrame& middle = map.keyframes[map.keyframes.size() / 2];
  const Eigen::Vector3f center = CameraCenter(middle);
  const Eigen::Vector3f reach = Eigen::Vector3f::Constant(2);
  const SelectOptions parts[] = {{.map = map.id},
                                 {.last_keyframe = middle.id.value()},
                                 {.begin_time = middle.timestamp},
                                 {.every = 2},
                                 {.every = 5},
                                 {.component = 1},
                                 {.session = middle.origin_map},
                                 {.keyframes = {middle.id}},
                                 {.box = {{center - reach, center + reach}}, .region = RegionOf::kCameras},
                                 {.box = {{center - reach, center + reach}}, .region = RegionOf::kPoints},
                                 {.begin_time = middle.timestamp, .except = true}};
  int number = 0;
  for (const SelectOptions& options : parts) {
    for (const Border border : {Border::kStrict, Border::kCompletePoints, Border::kSmart}) {
      SCOPED_TRACE(name + ", part " + std::to_string(number) + ", border " + std::to_string(static_cast<int>(border)));
      Subset subset;
      try {
        subset = Select(index, options);
      } catch (const Error&) {
        continue;  // the box may hold no point
      }
      SettleBorder(index, border, subset);
      Atlas part = atlas;
      KeepSubset(part, subset);
      EXPECT_THAT(NewTroubles(known, part), IsEmpty());
    }
    ++number;
  }
}

TEST(Select, LeavesSoundPartsOfEverySensorKind) {
  for (const SyntheticOptions& kind : SensorKinds()) ExpectSoundParts(SynthesizeAtlas(kind), NameOf(kind));
}

class RealAtlasParts : public ::testing::TestWithParam<const char*> {};
TEST_P(RealAtlasParts, AreSound) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Notices notices;
  ExpectSoundParts(ReadOrbslam3(path, {}, notices), GetParam());
}
INSTANTIATE_TEST_SUITE_P(Files, RealAtlasParts,
                         ::testing::Values("stereo_inertial", "fisheye_stereo", "multimap_rgbd", "race_mono"));

}  // namespace
}  // namespace slamdb::testing
