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
#include "slamdb/model/counters.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/digest.h"
#include "slamdb/model/index.h"
#include "tests/edit/worlds.h"
#include "tests/support/corrupt.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"

namespace slamdb {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr std::size_t kOld = 12, kNew = 5;  // keyframes of the base, and that each side makes

// The keyframes of a map that `keeps(row)` says, with counters that are not above what is left.
template <class Keeps>
Atlas Part(const Atlas& atlas, const Keeps& keeps) {
  Atlas part = atlas;
  Subset subset = Subset::Everything(part);
  for (std::size_t row = 0; row < part.maps[0].keyframes.size(); ++row)
    subset.maps[0].keyframes[row] = keeps(row) ? 1 : 0;
  SettleBorder(AtlasIndex(part), Border::kSmart, subset);
  KeepSubset(part, subset);
  part.next_ids = {};
  RaiseCounters(part);
  part.next_ids.initial_keyframe = 0;
  return part;
}

// New keyframes and points get the ids that come next after the base, as a robot that goes on with it gives them.
void NumberAsContinued(const Atlas& base, Atlas& side) {
  IdMap ids;
  const AtlasIndex index(base);
  for (const IdKind kind : {IdKind::kKeyFrame, IdKind::kPoint, IdKind::kFrame}) {
    std::set<std::uint64_t> all;
    for (const Map& map : side.maps) {
      for (const KeyFrame& keyframe : map.keyframes)
        if (kind != IdKind::kPoint) all.insert(kind == IdKind::kFrame ? keyframe.frame_id : keyframe.id.value());
      for (const MapPoint& point : map.points)
        if (kind == IdKind::kPoint) all.insert(point.id.value());
    }
    std::uint64_t next = NextId(base.next_ids, kind);
    for (const std::uint64_t id : all) {
      const bool is_old = kind == IdKind::kPoint      ? static_cast<bool>(index.LocatePoint(MapPointId(id)))
                          : kind == IdKind::kKeyFrame ? static_cast<bool>(index.LocateKeyFrame(KeyFrameId(id)))
                                                      : id < NextId(base.next_ids, kind);
      ids[kind].push_back({id, is_old ? id : next++});
    }
  }
  // What the whole world named and the part has not.
  for (Map& map : side.maps)
    for (MapPoint& point : map.points) {
      point.first_keyframe = static_cast<std::int64_t>(point.reference.value());
      point.first_frame = 0;
    }
  ApplyIdMap(side, ids);
  side.next_ids = {};
  RaiseCounters(side);
}

struct Branched {
  Atlas base, ours, theirs;
};

Branched Branch(const World& world, std::uint64_t seed = 1) {
  const Atlas whole = SynthesizeAtlas({.sensor = world.sensor,
                                       .inertial = world.inertial,
                                       .keyframes = kOld + 2 * kNew,
                                       .points = 300,
                                       .features = 200,
                                       .loops = false,
                                       .seed = seed});
  Branched branched{Part(whole, [](std::size_t row) { return row < kOld; }),
                    Part(whole, [](std::size_t row) { return row < kOld + kNew; }),
                    Part(whole, [](std::size_t row) { return row < kOld || row >= kOld + kNew; })};
  for (Map& map : branched.base.maps)
    for (MapPoint& point : map.points) {
      point.first_keyframe = static_cast<std::int64_t>(point.reference.value());
      point.first_frame = 0;
    }
  for (Atlas* side : {&branched.ours, &branched.theirs}) NumberAsContinued(branched.base, *side);
  for (Atlas* side : {&branched.ours, &branched.theirs}) {
    const AtlasIndex base(branched.base);
    for (MapPoint& point : side->maps[0].points)
      if (const EntityRow row = base.LocatePoint(point.id))
        point.first_keyframe = branched.base.maps[0].points[row.row].first_keyframe;
  }
  return branched;
}

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

}  // namespace
}  // namespace slamdb
