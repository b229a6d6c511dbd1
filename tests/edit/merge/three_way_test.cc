// SPDX-License-Identifier: BSD-3-Clause
// Two robots continue one atlas, edit it at random, and come back.
#include "slamdb/edit/merge/three_way.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <set>

#include "slamdb/edit/frame/transform.h"
#include "slamdb/edit/ids/renumber.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/part/subset.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/counters.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/digest.h"
#include "slamdb/model/index.h"
#include "tests/edit/merge/branched.h"
#include "tests/edit/worlds.h"
#include "tests/support/corrupt.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"

namespace slamdb {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

using Random = std::mt19937_64;
std::size_t Below(Random& random, std::size_t count) { return static_cast<std::size_t>(random() % count); }

// What mapping does to a map at random: keyframes and points culled, points fused, sightings lost, poses moved.
void Edit(Random& random, Atlas& atlas) {
  Map& map = atlas.maps[0];
  std::vector<std::pair<MapPointId, MapPointId>> pairs;
  for (int i = 0; i < 4; ++i) {
    const MapPoint& point = map.points[Below(random, map.points.size())];
    const auto distance = [&](const MapPoint& other) {
      return &other == &point ? 1e9F : (other.position - point.position).norm();
    };
    pairs.emplace_back(point.id, std::ranges::min(map.points, {}, distance).id);
  }
  FusePairs(map, pairs);
  Subset subset = Subset::Everything(atlas);
  for (int i = 0; i < 5; ++i) subset.maps[0].points[Below(random, map.points.size())] = 0;
  if (random() % 2 == 0) subset.maps[0].keyframes[1 + Below(random, kOld - 2)] = 0;
  SettleBorder(AtlasIndex(atlas), Border::kSmart, subset);
  KeepSubset(atlas, subset);
  std::normal_distribution<float> noise(0, 0.003F);
  for (KeyFrame& keyframe : atlas.maps[0].keyframes)
    if (keyframe.id != atlas.maps[0].initial_keyframe)
      for (float& length : keyframe.camera_from_world.translation) length += noise(random);
  for (MapPoint& point : atlas.maps[0].points)
    for (float& length : point.position) length += noise(random);
}

Branched EditedBranch(const World& world, std::uint64_t seed) {
  Branched branched = Branch(world, seed);
  Random random(seed);
  Edit(random, branched.ours);
  Edit(random, branched.theirs);
  return branched;
}

ThreeWayResult Merged(const Branched& branched, const ThreeWayOptions& options = {}) {
  return MergeThreeWays(branched.base, branched.ours, branched.theirs, options);
}

// Structure whatever the ids: which keypoints of which image see one point, and how keyframes are tied.
std::multiset<std::vector<std::pair<double, std::size_t>>> PointsBySightings(const Atlas& atlas) {
  std::multiset<std::vector<std::pair<double, std::size_t>>> points;
  for (const Map& map : atlas.maps) {
    const IdTable rows = KeyFrameTable(map);
    for (const MapPoint& point : map.points) {
      std::vector<std::pair<double, std::size_t>> sightings;
      for (const Observation& observation : point.observations)
        for (const std::int32_t slot : {observation.left, observation.right})
          if (slot >= 0) sightings.emplace_back(map.keyframes[rows.Find(observation.keyframe.value())].timestamp, slot);
      std::ranges::sort(sightings);
      points.insert(sightings);
    }
  }
  return points;
}

std::set<std::tuple<double, double, std::int32_t>> Covisibility(const Atlas& atlas) {
  std::set<std::tuple<double, double, std::int32_t>> edges;
  for (const Map& map : atlas.maps) {
    const IdTable rows = KeyFrameTable(map);
    for (const KeyFrame& keyframe : map.keyframes)
      for (const Connection& connection : keyframe.connections)
        edges.emplace(keyframe.timestamp, map.keyframes[rows.Find(connection.keyframe.value())].timestamp,
                      connection.weight);
  }
  return edges;
}

class ThreeWays : public ::testing::TestWithParam<World> {};
INSTANTIATE_TEST_SUITE_P(All, ThreeWays, ::testing::ValuesIn(kWorlds), NameOfWorld);

TEST_P(ThreeWays, TheBranchesAreSound) {
  const Branched branched = EditedBranch(GetParam(), 1);
  for (const Atlas* atlas : {&branched.base, &branched.ours, &branched.theirs})
    EXPECT_THAT(TroubleCounts(*atlas), IsEmpty());
  std::size_t collisions = 0;
  const AtlasIndex ours(branched.ours);
  for (const KeyFrame& keyframe : branched.theirs.maps[0].keyframes)
    if (const EntityRow row = ours.LocateKeyFrame(keyframe.id))
      collisions += branched.ours.maps[0].keyframes[row.row].timestamp != keyframe.timestamp;
  EXPECT_EQ(collisions, kNew);
}

TEST_P(ThreeWays, WhatOneSideLeftAsItWasIsTheOther) {
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    const auto [base, ours, theirs] = EditedBranch(GetParam(), seed);
    EXPECT_EQ(HashOf(MergeThreeWays(base, ours, base).atlas), HashOf(ours));
    EXPECT_EQ(HashOf(MergeThreeWays(base, base, theirs).atlas), HashOf(theirs));
    EXPECT_EQ(HashOf(MergeThreeWays(base, ours, ours).atlas), HashOf(ours));
    EXPECT_EQ(HashOf(MergeThreeWays(base, base, base).atlas), HashOf(base));
  }
}

// The same without the short cut of whole atlases: theirs differs from the base in what no merge takes.
TEST_P(ThreeWays, NothingOfTheirsLeavesOursToTheByte) {
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    const auto [base, ours, theirs] = EditedBranch(GetParam(), seed);
    Atlas reordered = base;
    std::ranges::reverse(reordered.maps[0].points);
    std::ranges::reverse(reordered.maps[0].keyframes);
    const ThreeWayResult merged = MergeThreeWays(base, ours, reordered);
    EXPECT_FALSE(merged.report.unchanged);
    EXPECT_THAT(merged.atlas, EqualsAtlas(ours));
    EXPECT_THAT(merged.report.conflicts, IsEmpty());
  }
}

TEST_P(ThreeWays, HoldsBothAndIsSound) {
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    const Branched branched = EditedBranch(GetParam(), seed);
    const ThreeWayResult merged = Merged(branched, {.threads = 3});
    EXPECT_THAT(TroubleCounts(merged.atlas), IsEmpty());
    const BranchLedger& keyframes = merged.report.keyframes;
    EXPECT_EQ(keyframes.added_by_ours, kNew);
    EXPECT_EQ(keyframes.added_by_theirs, kNew);
    EXPECT_EQ(keyframes.result, merged.atlas.maps.at(0).keyframes.size());
    EXPECT_EQ(merged.report.points.result, merged.atlas.maps[0].points.size());
    EXPECT_GT(merged.report.points.deleted_by_ours + merged.report.points.deleted_by_theirs, 0U);
    EXPECT_EQ(merged.report.dangling, 0U);
    EXPECT_EQ(HashOf(Merged(branched, {.threads = 1}).atlas), HashOf(merged.atlas));
  }
}

TEST_P(ThreeWays, OnceMoreChangesNothing) {
  for (const BranchGeometry geometry : {BranchGeometry::kOurs, BranchGeometry::kTheirs, BranchGeometry::kAlign})
    for (const BranchSide prefer : {BranchSide::kOurs, BranchSide::kTheirs})
      for (std::uint64_t seed = 1; seed < 4; ++seed) {
        SCOPED_TRACE(testing::Message() << seed << " " << NameOf(geometry) << " " << NameOf(prefer));
        const Branched branched = EditedBranch(GetParam(), seed);
        const ThreeWayOptions options{.geometry = geometry, .prefer = prefer};
        const Atlas merged = Merged(branched, options).atlas;
        const ThreeWayResult again = MergeThreeWays(branched.base, merged, branched.theirs, options);
        EXPECT_THAT(again.atlas, EqualsAtlas(merged));
        EXPECT_EQ(again.report.contains, BranchSide::kOurs);
        const Atlas other = MergeThreeWays(branched.base, branched.ours, merged, options).atlas;
        EXPECT_EQ(PointsBySightings(other), PointsBySightings(merged));
      }
}

TEST_P(ThreeWays, TheOrderOfTheSidesDoesNotMatter) {
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    const auto [base, ours, theirs] = EditedBranch(GetParam(), seed);
    ThreeWayOptions options{.prefer = BranchSide::kOurs, .fuse = std::nullopt};
    const ThreeWayResult one = MergeThreeWays(base, ours, theirs, options);
    options.prefer = BranchSide::kTheirs;
    const ThreeWayResult other = MergeThreeWays(base, theirs, ours, options);
    EXPECT_EQ(PointsBySightings(one.atlas), PointsBySightings(other.atlas));
    EXPECT_EQ(Covisibility(one.atlas), Covisibility(other.atlas));
    EXPECT_EQ(one.report.conflicts.size(), other.report.conflicts.size());
    std::map<double, Eigen::Vector3f> centers;
    for (const KeyFrame& keyframe : one.atlas.maps[0].keyframes) centers[keyframe.timestamp] = CameraCenter(keyframe);
    ASSERT_EQ(centers.size(), other.atlas.maps[0].keyframes.size());
    for (const KeyFrame& keyframe : other.atlas.maps[0].keyframes)
      EXPECT_LT((centers.at(keyframe.timestamp) - CameraCenter(keyframe)).norm(), 1e-4F);
  }
}

// As of one session in parts, whose points keep their ids: many have one keypoint in the base and others beyond it.
TEST(ThreeWayPoints, NewOnesOfEqualIdsThatAKeypointSeesAreOne) {
  const Atlas whole = ReadAtlas(SLAMDB_FIXTURES "/session_small_a/session_small_a.osa");
  const Atlas base = Part(whole, [](std::size_t row) { return row < 7; }),
              ours = Part(whole, [](std::size_t row) { return row < 8; }),
              theirs = Part(whole, [](std::size_t row) { return row < 7 || row == 8; });
  const ThreeWayResult merged = MergeThreeWays(base, ours, theirs);
  EXPECT_THAT(merged.report.dropped_points, IsEmpty());
  EXPECT_THAT(merged.report.conflicts, IsEmpty());
}

// ---- one thing at a time

class OneThing : public ::testing::Test {
 protected:
  OneThing() : branched_(Branch(kWorlds[4])) {}

  Map& ours() { return branched_.ours.maps[0]; }
  Map& theirs() { return branched_.theirs.maps[0]; }
  static KeyFrame* Find(Map& map, KeyFrameId id) {
    const std::uint32_t row = KeyFrameTable(map).Find(id.value());
    return row == kNoRow ? nullptr : &map.keyframes[row];
  }
  static MapPoint* Find(Map& map, MapPointId id) {
    const std::uint32_t row = PointTable(map).Find(id.value());
    return row == kNoRow ? nullptr : &map.points[row];
  }
  static void Remove(Atlas& atlas, KeyFrameId keyframe) {
    Subset subset = Subset::Everything(atlas);
    subset.maps[0].keyframes[KeyFrameTable(atlas.maps[0]).Find(keyframe.value())] = 0;
    KeepSubset(atlas, subset);
  }
  static void Remove(Atlas& atlas, MapPointId point) {
    Subset subset = Subset::Everything(atlas);
    subset.maps[0].points[PointTable(atlas.maps[0]).Find(point.value())] = 0;
    KeepSubset(atlas, subset);
  }
  // A point of the base that only keyframes of the base see, in both sides; or one that new keyframes see, too.
  MapPointId PointOf(Map& side, bool extended) {
    for (const MapPoint& point : branched_.base.maps[0].points) {
      const MapPoint* now = Find(side, point.id);
      if (now != nullptr && point.observations.size() > 2 &&
          extended == (now->observations.size() > point.observations.size()))
        return point.id;
    }
    return {};
  }
  ThreeWayResult Merge(const ThreeWayOptions& options = {}) { return Merged(branched_, options); }
  static std::vector<std::string> Conflicts(const ThreeWayReport& report, std::string_view what) {
    std::vector<std::string> conflicts;
    for (const BranchConflict& conflict : report.conflicts)
      if (conflict.what == what) conflicts.push_back(ToString(conflict.place) + ": " + MessageOf(conflict));
    return conflicts;
  }

  Branched branched_;
};

TEST_F(OneThing, NewIdsOfTheirsGoBehindOurs) {
  const ThreeWayResult merged = Merge({.id_maps = true});
  const Counters base = branched_.base.next_ids, our_next = branched_.ours.next_ids;
  EXPECT_EQ(merged.report.shift[static_cast<std::size_t>(IdKind::kKeyFrame)], our_next.keyframe - base.keyframe);
  ASSERT_THAT(merged.report.id_maps, SizeIs(2));
  for (const IdPair& pair : merged.report.id_maps[0][IdKind::kKeyFrame]) EXPECT_EQ(pair.before, pair.after);
  const AtlasIndex index(merged.atlas);
  for (const KeyFrame& keyframe : theirs().keyframes) {
    const IdPair* pair = FindPair(merged.report.id_maps[1][IdKind::kKeyFrame], keyframe.id.value());
    ASSERT_NE(pair, nullptr);
    const EntityRow row = index.LocateKeyFrame(KeyFrameId(pair->after));
    ASSERT_TRUE(row);
    EXPECT_EQ(merged.atlas.maps[0].keyframes[row.row].timestamp, keyframe.timestamp);
  }
}

TEST_F(OneThing, IdsThatDoNotMeetStay) {
  RenumberOptions apart{.kinds = {IdKind::kKeyFrame}};
  IdMap ids;
  for (const KeyFrame& keyframe : theirs().keyframes)
    ids[IdKind::kKeyFrame].push_back(
        {keyframe.id.value(), keyframe.id.value() < kOld ? keyframe.id.value() : keyframe.id.value() + 100});
  ApplyIdMap(branched_.theirs, ids);
  const ThreeWayResult merged = Merge();
  EXPECT_EQ(merged.report.shift[static_cast<std::size_t>(IdKind::kKeyFrame)], 0U);
  EXPECT_TRUE(AtlasIndex(merged.atlas).LocateKeyFrame(KeyFrameId(kOld + 100)));
}

TEST_F(OneThing, ARenumberedSideIsRecognised) {
  const ThreeWayResult before = Merge();
  Renumber(branched_.theirs, {.start = 5000});
  const ThreeWayResult after = Merge();
  EXPECT_EQ(PointsBySightings(after.atlas), PointsBySightings(before.atlas));
  EXPECT_EQ(after.report.keyframes, before.report.keyframes);
  EXPECT_EQ(after.report.points.result, before.report.points.result);
}

// Ids of keyframes that were dense are the same when they are made dense again; those of points are not.
TEST_F(OneThing, RenumberedPointsAreRecognisedWhateverKeyframesAreCalled) {
  branched_ = EditedBranch(kWorlds[4], 2);
  const ThreeWayResult before = Merge({.fuse = std::nullopt});
  const Branched plain = branched_;
  for (const bool of_ours : {false, true})
    for (const bool of_theirs : {false, true}) {
      branched_ = plain;
      if (of_ours) Renumber(branched_.ours, {.kinds = {IdKind::kPoint}});
      if (of_theirs) Renumber(branched_.theirs, {.kinds = {IdKind::kPoint}});
      SCOPED_TRACE(testing::Message() << of_ours << of_theirs);
      const ThreeWayResult after = Merge({.fuse = std::nullopt});
      EXPECT_EQ(PointsBySightings(after.atlas), PointsBySightings(before.atlas));
      EXPECT_EQ(after.report.points.deleted_by_ours, before.report.points.deleted_by_ours);
      EXPECT_EQ(after.report.points.deleted_by_theirs, before.report.points.deleted_by_theirs);
      EXPECT_THAT(TroubleCounts(after.atlas), IsEmpty());
    }
}

TEST_F(OneThing, AnotherImageOfTheSameIdIsAnotherKeyframe) {
  Find(theirs(), KeyFrameId(5))->timestamp += 0.001;
  const ThreeWayResult merged = Merge();
  EXPECT_EQ(merged.report.other_images, 1U);
  EXPECT_EQ(merged.report.keyframes.added_by_theirs, kNew + 1);
  Notices notices;
  TellWarnings(merged.report, notices);
  ASSERT_THAT(notices.items(), SizeIs(1));
  EXPECT_THAT(notices.items()[0].text, HasSubstr("1 keyframe of a side has an id of base and another image"));
}

TEST_F(OneThing, AKeyframeThatOneSideCulledGoes) {
  const KeyFrameId old(2);
  Remove(branched_.theirs, old);
  ThreeWayResult merged = Merge();
  EXPECT_EQ(Find(merged.atlas.maps[0], old), nullptr);
  EXPECT_EQ(merged.report.keyframes.deleted_by_theirs, 1U);
  EXPECT_THAT(merged.report.conflicts, IsEmpty());
  EXPECT_THAT(TroubleCounts(merged.atlas), IsEmpty());
}

// Though the other has all that this one has that is new.
TEST_F(OneThing, AKeyframeThatOneSideCulledGoesFromWhatContinuesIt) {
  const KeyFrameId old(2);
  branched_.theirs = branched_.ours;
  Remove(branched_.ours, old);
  for (const bool swapped : {false, true}) {
    if (swapped) std::swap(branched_.ours, branched_.theirs);
    ThreeWayResult merged = Merge();
    EXPECT_EQ(Find(merged.atlas.maps[0], old), nullptr);
    EXPECT_EQ(merged.atlas.maps[0].keyframes.size(), kOld + kNew - 1);
  }
}

TEST_F(OneThing, AKeyframeThatTheOtherWentOnWithStays) {
  const KeyFrameId last(kOld - 1);  // on which new ones hang
  for (const bool is_ours : {true, false}) {
    Branched branched = branched_;
    Remove(is_ours ? branched.ours : branched.theirs, last);
    ThreeWayResult merged = Merged(branched);
    ASSERT_NE(Find(merged.atlas.maps[0], last), nullptr);
    EXPECT_EQ(merged.report.keyframes.kept, 1U);
    EXPECT_THAT(Conflicts(merged.report, "deletion"),
                Contains("map 0, kf 11: deleted by " + std::string(is_ours ? "ours" : "theirs") + ", extended by " +
                         (is_ours ? "theirs" : "ours") + ": kept"));
    EXPECT_THAT(TroubleCounts(merged.atlas), IsEmpty());
  }
}

TEST_F(OneThing, APointThatOneSideCulledGoesUnlessTheOtherSeesMoreOfIt) {
  const MapPointId old = PointOf(ours(), false), extended = PointOf(ours(), true);
  ASSERT_TRUE(old && extended);
  Remove(branched_.theirs, old);
  Remove(branched_.theirs, extended);
  const std::size_t sightings = Find(ours(), extended)->observations.size();
  ThreeWayResult merged = Merge({.fuse = std::nullopt});
  EXPECT_EQ(Find(merged.atlas.maps[0], old), nullptr);
  ASSERT_NE(Find(merged.atlas.maps[0], extended), nullptr);
  EXPECT_EQ(Find(merged.atlas.maps[0], extended)->observations.size(), sightings);
  EXPECT_THAT(Conflicts(merged.report, "deletion"),
              Contains("map 0, " + ToString(extended) + ": deleted by theirs, extended by ours: kept"));
}

TEST_F(OneThing, ObservationsFollowAPointIntoTheOneThatReplacedIt) {
  const MapPointId gone = PointOf(ours(), true);
  const MapPointId kept = NeverSeenWith(gone, branched_);
  ASSERT_EQ(FusePairs(theirs(), {{kept, gone}}).fused, 1U);
  const std::size_t of_gone = Find(ours(), gone)->observations.size(),
                    of_kept = Find(ours(), kept)->observations.size();
  ThreeWayResult merged = Merge({.fuse = std::nullopt});
  const MapPointId name = std::min(gone, kept);
  const MapPoint* point = Find(merged.atlas.maps[0], name);
  ASSERT_NE(point, nullptr);
  EXPECT_GE(point->observations.size(), of_gone + of_kept);
  EXPECT_EQ(Find(merged.atlas.maps[0], std::max(gone, kept)), nullptr);
  EXPECT_THAT(merged.report.fused, Contains(std::pair(std::max(gone, kept), name)));
}

TEST_F(OneThing, WhatBothChangedIsAConflictThatPreferDecides) {
  KeyFrame &mine = *Find(ours(), KeyFrameId(7)), &other = *Find(theirs(), KeyFrameId(7));
  mine.parent = KeyFrameId(5);
  other.parent = KeyFrameId(4);
  mine.merge_scale = 2;
  other.merge_scale = 3;
  other.not_erase = true;
  for (const BranchSide prefer : {BranchSide::kOurs, BranchSide::kTheirs}) {
    const bool is_ours = prefer == BranchSide::kOurs;
    ThreeWayResult merged = Merge({.prefer = prefer});
    const KeyFrame& keyframe = *Find(merged.atlas.maps[0], KeyFrameId(7));
    EXPECT_EQ(keyframe.parent, KeyFrameId(is_ours ? 5 : 4));
    EXPECT_EQ(keyframe.merge_scale, is_ours ? 2 : 3);
    EXPECT_TRUE(keyframe.not_erase);  // one side alone
    EXPECT_THAT(Conflicts(merged.report, "parent"),
                Contains("map 0, kf 7: parent: that of " + std::string(NameOf(prefer)) + " is taken"));
    EXPECT_THAT(TroubleCounts(merged.atlas), IsEmpty());
  }
}

TEST_F(OneThing, EdgesOfBothAreThere) {
  const auto add = [](Map& map, std::uint64_t a, std::uint64_t b) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      KeyFrame& keyframe = *Find(map, KeyFrameId(from));
      keyframe.loop_edges.push_back(KeyFrameId(to));
      keyframe.not_erase = true;
    }
  };
  add(branched_.base.maps[0], 0, 9);
  add(theirs(), 0, 9);
  add(ours(), 1, 8);
  add(theirs(), 2, 7);
  ThreeWayResult merged = Merge();
  EXPECT_THAT(Find(merged.atlas.maps[0], KeyFrameId(0))->loop_edges, IsEmpty());  // ours has taken it back
  EXPECT_THAT(Find(merged.atlas.maps[0], KeyFrameId(1))->loop_edges, Contains(KeyFrameId(8)));
  EXPECT_THAT(Find(merged.atlas.maps[0], KeyFrameId(7))->loop_edges, Contains(KeyFrameId(2)));
  EXPECT_EQ(merged.report.edges.result, 2U);
  EXPECT_EQ(merged.report.edges.deleted_by_ours, 1U);
}

// ---- geometry

Similarity3d WorldFromCamera(const KeyFrame& keyframe) {
  const Rigid3f pose = keyframe.camera_from_world.Normalized().Inverse();
  return {1, pose.rotation.cast<double>(), pose.translation.cast<double>()};
}

TEST_F(OneThing, ThePartOfTheirsHangsOnWhatIsKept) {
  // Theirs lies bodily elsewhere, by less than another frame would.
  const Similarity3d moved{
      1, Eigen::Quaterniond(Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitZ())), {0.05, -0.03, 0.02}};
  Branched branched = branched_;
  TransformMap(branched.theirs.maps[0], moved);
  for (const BranchGeometry geometry : {BranchGeometry::kOurs, BranchGeometry::kTheirs, BranchGeometry::kAlign}) {
    SCOPED_TRACE(NameOf(geometry));
    ThreeWayResult merged = Merged(branched, {.geometry = geometry});
    const Similarity3d frame = geometry == BranchGeometry::kOurs ? Similarity3d() : moved;
    for (const KeyFrame& keyframe : branched_.ours.maps[0].keyframes)
      EXPECT_LT(((frame * WorldFromCamera(keyframe)).translation -
                 WorldFromCamera(*Find(merged.atlas.maps[0], keyframe.id)).translation)
                    .norm(),
                1e-4);
    const ThreeWayResult straight = Merged(branched_);
    for (const KeyFrame& keyframe : straight.atlas.maps[0].keyframes)
      EXPECT_LT(((frame * WorldFromCamera(keyframe)).translation -
                 WorldFromCamera(*Find(merged.atlas.maps[0], keyframe.id)).translation)
                    .norm(),
                1e-4);
    EXPECT_THAT(TroubleCounts(merged.atlas), IsEmpty());
  }
}

TEST_F(OneThing, OursKeepsEveryPoseOfOursToTheBit) {
  Random random(3);
  Edit(random, branched_.theirs);
  ThreeWayResult merged = Merge({.geometry = BranchGeometry::kOurs});
  for (const KeyFrame& keyframe : ours().keyframes)
    if (const KeyFrame* kept = Find(merged.atlas.maps[0], keyframe.id)) {
      EXPECT_EQ(kept->camera_from_world.translation, keyframe.camera_from_world.translation);
      EXPECT_EQ(kept->camera_from_world.rotation.coeffs(), keyframe.camera_from_world.rotation.coeffs());
    }
}

TEST_F(OneThing, AlignTakesWhatOneSideAloneMoved) {
  KeyFrame &mine = *Find(ours(), KeyFrameId(3)), &other = *Find(theirs(), KeyFrameId(6));
  mine.camera_from_world.translation.x() += 0.01F;
  other.camera_from_world.translation.y() += 0.02F;
  ThreeWayResult merged = Merge();
  EXPECT_LT((CameraCenter(*Find(merged.atlas.maps[0], KeyFrameId(3))) - CameraCenter(mine)).norm(), 1e-6F);
  EXPECT_LT((CameraCenter(*Find(merged.atlas.maps[0], KeyFrameId(6))) - CameraCenter(other)).norm(), 1e-6F);
}

TEST_F(OneThing, AnotherFrameIsTakenAsAWhole) {
  const Similarity3d turned{1, Eigen::Quaterniond(Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitY())), {7, -3, 4}};
  const ThreeWayResult straight = Merge();
  TransformMap(theirs(), turned);
  for (const BranchGeometry geometry : {BranchGeometry::kOurs, BranchGeometry::kAlign}) {
    ThreeWayResult merged = Merge({.geometry = geometry});
    const Similarity3d frame = geometry == BranchGeometry::kOurs ? Similarity3d() : turned;  // theirs alone left it
    for (const KeyFrame& keyframe : straight.atlas.maps[0].keyframes)
      EXPECT_LT(((frame * WorldFromCamera(keyframe)).translation -
                 WorldFromCamera(*Find(merged.atlas.maps[0], keyframe.id)).translation)
                    .norm(),
                1e-3);
  }
}

// A map without scale of its own, of which one side lies in another one.
TEST(ThreeWayScale, IsThatOfTheKeptSide) {
  Branched branched = Branch(kWorlds[0]);
  const ThreeWayResult straight = Merged(branched);
  TransformMap(branched.theirs.maps[0], {1.05, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()});
  const ThreeWayResult merged = Merged(branched, {.geometry = BranchGeometry::kOurs});
  const IdTable rows = KeyFrameTable(merged.atlas.maps[0]);
  for (const KeyFrame& keyframe : straight.atlas.maps[0].keyframes)
    EXPECT_LT(
        (CameraCenter(keyframe) - CameraCenter(merged.atlas.maps[0].keyframes[rows.Find(keyframe.id.value())])).norm(),
        0.02F);
}

// A base from before keyframes that both sides have: what one side alone tells of these stands.
TEST_P(ThreeWays, KeyframesThatBothMadeAreTiedAsEitherHasThem) {
  const Branched branched = Branch(GetParam());
  const Atlas older = Part(branched.base, [](std::size_t row) { return row < kOld - 4; });
  for (const bool swapped : {false, true}) {
    const ThreeWayResult merged = swapped ? MergeThreeWays(older, branched.theirs, branched.ours)
                                          : MergeThreeWays(older, branched.ours, branched.theirs);
    EXPECT_EQ(merged.report.keyframes.added_by_both, 4U);
    EXPECT_EQ(merged.atlas.maps.at(0).keyframes.size(), kOld + 2 * kNew);
    auto troubles = TroubleCounts(merged.atlas);
    if (swapped) troubles.erase("timestamp-order");  // those of theirs, which are earlier, have the later ids
    EXPECT_THAT(troubles, IsEmpty());
    // In time one behind the other, but for where both went on from one.
    std::size_t ends = 0;
    for (const KeyFrame& keyframe : merged.atlas.maps[0].keyframes) ends += keyframe.next ? 0 : 1;
    if (GetParam().inertial) {
      EXPECT_EQ(ends, 2U);
    }
  }
}

// What points say and keypoints do not is no fault of the merge, also where fusing makes both agree.
TEST_P(ThreeWays, ObservationsThatNoKeypointConfirmsMayBeFused) {
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    Branched branched = EditedBranch(GetParam(), seed);
    Random random(seed);
    for (Atlas* side : {&branched.ours, &branched.theirs})
      for (KeyFrame& keyframe : side->maps[0].keyframes)
        for (MapPointId& point : keyframe.features.map_points)
          if (random() % 8 == 0) point = MapPointId();
    const FuseOptions wide{.radius = 30, .hamming = 100};
    EXPECT_NO_THROW((void)Merged(branched, {.fuse = wide}));
    std::swap(branched.ours, branched.theirs);
    EXPECT_NO_THROW((void)Merged(branched, {.fuse = wide}));
  }
}

// ---- what is refused

TEST(ThreeWayRefusals, SayWhatToDo) {
  const Branched branched = Branch(kWorlds[4]);
  const Atlas stranger = MakeWorld(kWorlds[4], 1, 99);
  const Atlas &base = branched.base, &ours = branched.ours, &theirs = branched.theirs;
  EXPECT_THAT(ErrorOf([&] { (void)MergeThreeWays(stranger, ours, theirs); }),
              AllOf(HasSubstr("ours: none of its 17 keyframes is one of base"), HasSubstr("`MergeAligned`")));
  EXPECT_THAT(ErrorOf([&] { (void)MergeThreeWays(base, ours, stranger); }),
              HasSubstr("theirs: none of its 12 keyframes"));
  Atlas empty;
  EXPECT_THAT(ErrorOf([&] { (void)MergeThreeWays(empty, ours, theirs); }),
              AllOf(HasSubstr("base: has no keyframes"), HasSubstr("`MergeAtlases`")));
  empty.vocabulary = base.vocabulary;
  EXPECT_THAT(ErrorOf([&] { (void)MergeThreeWays(base, ours, empty); }), HasSubstr("theirs: has no keyframes"));
  Atlas other = theirs;
  other.vocabulary.checksum = "0123456789abcdef0123456789abcdef";
  EXPECT_THAT(ErrorOf([&] { (void)MergeThreeWays(base, ours, other); }), HasSubstr("vocabulary"));
  EXPECT_THAT(MergeThreeWays(base, ours, other, {.ignore_vocabulary = true}).report.warnings, SizeIs(1));
  Atlas twice = theirs;
  twice.maps[0].keyframes[3].id = twice.maps[0].keyframes[4].id;
  EXPECT_THAT(ErrorOf([&] { (void)MergeThreeWays(base, ours, twice); }),
              AllOf(HasSubstr("theirs: ids are there more than once"), HasSubstr("`RepairAtlas`")));
}

// Whatever is broken in one of the three: it is refused, or merged, and never the merge's own fault.
TEST(ThreeWayRefusals, DamageIsNoFaultOfTheMerge) {
  for (const Twin& twin : Twins()) {
    const Atlas sound = SoundAtlas(twin.base);
    Atlas broken = sound, other = sound;
    twin.corrupt(broken);
    for (KeyFrame& keyframe : other.maps[0].keyframes) keyframe.camera_from_world.translation.x() += 0.001F;
    other.maps[0].points[5].position.x() += 0.01F;
    Subset subset = Subset::Everything(other);
    subset.maps[0].points[7] = 0;
    KeepSubset(other, subset);
    SCOPED_TRACE(twin.rule);
    for (const BranchGeometry geometry : {BranchGeometry::kOurs, BranchGeometry::kAlign}) {
      const ThreeWayOptions options{.geometry = geometry};
      const auto kinds = ::testing::AnyOf(std::nullopt, ErrorKind::kNotPossible);
      EXPECT_THAT(KindOf([&] { (void)MergeThreeWays(sound, other, broken, options); }), kinds);
      EXPECT_THAT(KindOf([&] { (void)MergeThreeWays(sound, broken, other, options); }), kinds);
      EXPECT_THAT(KindOf([&] { (void)MergeThreeWays(broken, other, sound, options); }), kinds);
    }
  }
}

}  // namespace
}  // namespace slamdb
