// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/subset.h"

#include <gmock/gmock.h>

#include "slamdb/base/error.h"
#include "slamdb/edit/ids/detail/references.h"
#include "slamdb/model/preintegration.h"
#include "tests/edit/soundness.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/equals_atlas.h"

namespace slamdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr Border kBorders[] = {Border::kStrict, Border::kCompletePoints, Border::kSmart};

// A few parts that cut in different ways: halves, gaps, single keyframes, points at random.
std::vector<Subset> Cuts(const Atlas& atlas) {
  const auto cut = [&](const auto& keeps_keyframe, const auto& keeps_point) {
    Subset subset = Subset::Nothing(atlas);
    for (auto& rows : subset.maps) {
      for (std::size_t i = 0; i < rows.keyframes.size(); ++i)
        rows.keyframes[i] = keeps_keyframe(i, rows.keyframes.size());
      for (std::size_t i = 0; i < rows.points.size(); ++i) rows.points[i] = keeps_point(i);
    }
    return subset;
  };
  const auto all = [](std::size_t, std::size_t = 0) { return true; };
  return {cut([](std::size_t i, std::size_t n) { return i < n / 2; }, all),
          cut([](std::size_t i, std::size_t n) { return i >= n / 2; }, all),
          cut([](std::size_t i, std::size_t) { return i % 3 == 1; }, all),
          cut([](std::size_t i, std::size_t) { return i % 7 != 3; }, [](std::size_t i) { return i % 3 != 0; }),
          cut([](std::size_t i, std::size_t n) { return i == n - 1; }, all),
          cut(all, [](std::size_t i) { return i % 2 == 0; })};
}

void ExpectSoundCuts(const Atlas& atlas, const std::string& name) {
  const TemporaryFolder folder;
  const std::set<std::string> known = Troubles(atlas);
  const AtlasIndex index(atlas);
  int number = 0;
  for (const Subset& cut : Cuts(atlas)) {
    for (const Border border : kBorders) {
      SCOPED_TRACE(name + ", cut " + std::to_string(number) + ", border " + std::to_string(static_cast<int>(border)));
      Subset subset = cut;
      SettleBorder(index, Border::kStrict, subset);  // the points that the part observes
      SettleBorder(index, border, subset);
      Atlas part = atlas, alone = atlas;
      const SubsetReport report = KeepSubset(part, subset);
      EXPECT_THAT(NewTroubles(known, part), IsEmpty());
      KeepSubset(alone, subset, 1);
      EXPECT_THAT(alone, EqualsAtlas(part)) << "one thread";
      Atlas again = part;
      KeepSubset(again, Subset::Everything(again));
      EXPECT_THAT(again, EqualsAtlas(part)) << "closing twice";
      std::size_t keyframes = 0;
      for (const Map& map : part.maps) keyframes += map.keyframes.size();
      EXPECT_TRUE(border == Border::kCompletePoints || report.keyframes + report.points > 0);
      EXPECT_EQ(KeyFramesThatBoostReads(part, folder.Path("part.osa")), keyframes);
    }
    ++number;
  }
}

TEST(KeepSubset, OfEverythingChangesNothing) {
  for (const SyntheticOptions& kind : SensorKinds()) {
    const Atlas atlas = SynthesizeAtlas(kind);
    Atlas same = atlas;
    const SubsetReport report = KeepSubset(same, Subset::Everything(atlas));
    EXPECT_THAT(same, EqualsAtlas(atlas)) << NameOf(kind);
    EXPECT_EQ(report.observations + report.slots + report.edges + report.new_parents + report.new_references, 0U);
  }
}

TEST(KeepSubset, LeavesASoundAtlasOfEverySensorKind) {
  for (const SyntheticOptions& kind : SensorKinds()) ExpectSoundCuts(SynthesizeAtlas(kind), NameOf(kind));
}

TEST(KeepSubset, OfNothingIsEmpty) {
  Atlas atlas = SynthesizeAtlas({.maps = 2, .keyframes = 6, .points = 100, .features = 90});
  const Counters counters = atlas.next_ids;
  EXPECT_EQ(KeepSubset(atlas, Subset::Nothing(atlas)).maps, 2U);
  EXPECT_THAT(atlas.maps, IsEmpty());
  EXPECT_THAT(atlas.cameras, IsEmpty());
  EXPECT_EQ(atlas.next_ids, counters);
}

TEST(KeepSubset, RefusesTheSubsetOfAnotherAtlas) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 100, .features = 90});
  Subset subset = Subset::Everything(atlas);
  subset.maps[0].points.pop_back();
  EXPECT_THROW(KeepSubset(atlas, subset), Error);
}

// Four keyframes 0 - 1 - 2 - 3 of a stereo pair in a chain, one point that all see, and one that 0 and 3 see.
Atlas SmallChain() {
  Atlas atlas;
  atlas.cameras.resize(2);
  atlas.cameras[0].id = CameraId(0);
  atlas.cameras[1].id = CameraId(1);
  Map& map = atlas.maps.emplace_back();
  map.id = MapId(0);
  map.first_keyframe = map.initial_keyframe = map.lowest_keyframe = KeyFrameId(0);
  map.origins = {KeyFrameId(0)};
  map.points.resize(2);
  for (std::uint64_t i = 0; i < 2; ++i) map.points[i].id = MapPointId(i);
  for (std::uint64_t i = 0; i < 4; ++i) {
    KeyFrame& keyframe = map.keyframes.emplace_back();
    keyframe.id = KeyFrameId(i);
    keyframe.camera = CameraId(i == 3 ? 1 : 0);
    if (i > 0) keyframe.parent = keyframe.previous = KeyFrameId(i - 1);
    if (i < 3) keyframe.next = KeyFrameId(i + 1);
    if (i < 3) keyframe.children = {KeyFrameId(i + 1)};
    keyframe.features.count = 2;
    keyframe.features.right_x = {10.0F, -1.0F};
    keyframe.features.map_points = {MapPointId(0), i % 3 == 0 ? MapPointId(1) : MapPointId()};
    map.points[0].observations.push_back({KeyFrameId(i), 0, -1});
    map.points[0].observation_count += 2;
    if (i % 3 == 0) map.points[1].observations.push_back({KeyFrameId(i), 1, -1});
  }
  map.points[0].reference = KeyFrameId(0);
  map.points[1].reference = KeyFrameId(0);
  map.points[1].observation_count = 2;
  map.keyframes[3].connections = {{KeyFrameId(1), 5}, {KeyFrameId(2), 9}};
  map.keyframes[3].loop_edges = {KeyFrameId(0)};
  map.keyframes[3].not_erase = true;
  return atlas;
}

TEST(KeepSubset, ClosesWhatIsLeft) {
  Atlas atlas = SmallChain();
  Subset subset = Subset::Everything(atlas);
  subset.maps[0].keyframes = {0, 1, 0, 1};
  const SubsetReport report = KeepSubset(atlas, subset);
  const Map& map = atlas.maps.at(0);
  ASSERT_THAT(map.keyframes, SizeIs(2));
  EXPECT_EQ(map.first_keyframe, KeyFrameId(1));
  EXPECT_EQ(map.initial_keyframe, KeyFrameId(1));
  EXPECT_EQ(map.lowest_keyframe, KeyFrameId(1));
  EXPECT_THAT(map.origins, ElementsAre(KeyFrameId(1)));
  EXPECT_FALSE(map.keyframes[0].parent);
  EXPECT_FALSE(map.keyframes[0].previous);
  EXPECT_EQ(map.keyframes[1].parent, KeyFrameId(1));
  EXPECT_EQ(map.keyframes[1].previous, KeyFrameId(1));
  EXPECT_EQ(map.keyframes[0].next, KeyFrameId(3));
  EXPECT_FALSE(map.keyframes[1].next);
  EXPECT_THAT(map.keyframes[1].connections, ElementsAre(Connection{KeyFrameId(1), 5}));
  EXPECT_THAT(map.keyframes[1].loop_edges, IsEmpty());
  EXPECT_FALSE(map.keyframes[1].not_erase);
  EXPECT_EQ(map.points[0].observation_count, 4);
  EXPECT_EQ(map.points[0].reference, KeyFrameId(1));
  EXPECT_THAT(map.points[1].observations, ElementsAre(Observation{KeyFrameId(3), 1, -1}));
  EXPECT_EQ(map.points[1].reference, KeyFrameId(3));
  EXPECT_EQ(report, (SubsetReport{.before = {.maps = 1, .keyframes = 4, .points = 2},
                                  .after = {.maps = 1, .keyframes = 2, .points = 2},
                                  .keyframes = 2,
                                  .observations = 3,
                                  .edges = 2,
                                  .new_references = 2,
                                  .new_parents = 1}));
  EXPECT_THAT(atlas.cameras, SizeIs(2));
}

// One part of everything that leads out of a part, so that no field of an entity is forgotten.
TEST(KeepSubset, LeavesNoReferenceOutOfThePart) {
  for (const SyntheticOptions& kind : SensorKinds()) {
    SCOPED_TRACE(NameOf(kind));
    Atlas atlas = SynthesizeAtlas(kind);
    for (Map& map : atlas.maps) {
      const KeyFrameId gone = map.keyframes[1].id, kept = map.keyframes[4].id;
      for (KeyFrame& keyframe : map.keyframes) {
        keyframe.loop_edges = keyframe.merge_edges = {gone, kept};
        keyframe.not_erase = true;
      }
      map.points[0].replaced_by = map.points[1].id;
      for (MapPoint& point : map.points) point.first_keyframe = -1;  // who made it is no link
      map.origins = {gone};
      map.initial_keyframe = map.first_keyframe = map.lowest_keyframe = gone;
    }
    Subset subset = Subset::Everything(atlas);
    std::set<std::uint64_t> gone_keyframes, gone_points;
    for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
      subset.maps[row].keyframes[1] = subset.maps[row].points[1] = 0;
      gone_keyframes.insert(atlas.maps[row].keyframes[1].id.value());
      gone_points.insert(atlas.maps[row].points[1].id.value());
    }
    KeepSubset(atlas, subset);
    detail::VisitIds(atlas, [&](auto id_kind, const auto& field) {
      if constexpr (decltype(id_kind)::value == IdKind::kKeyFrame) {
        EXPECT_FALSE(gone_keyframes.contains(detail::IdValue(field)));
      } else if constexpr (decltype(id_kind)::value == IdKind::kPoint) {
        EXPECT_FALSE(gone_points.contains(detail::IdValue(field)));
      }
    });
    for (const Map& map : atlas.maps)
      for (const KeyFrame& keyframe : map.keyframes) {
        EXPECT_THAT(keyframe.loop_edges, SizeIs(1));
        EXPECT_THAT(keyframe.merge_edges, SizeIs(1));
      }
  }
}

TEST(KeepSubset, DropsCamerasThatLoseTheirLastKeyframe) {
  Atlas atlas = SmallChain();
  atlas.cameras.emplace_back().id = CameraId(9);  // which never had one
  Subset subset = Subset::Everything(atlas);
  subset.maps[0].keyframes[3] = 0;
  EXPECT_EQ(KeepSubset(atlas, subset).cameras, 1U);
  ASSERT_THAT(atlas.cameras, SizeIs(2));
  EXPECT_EQ(atlas.cameras[1].id, CameraId(9));
}

TEST(KeepSubset, TreatsWhatDangledLikeWhatLeadsOut) {
  Atlas atlas = SmallChain();
  Map& map = atlas.maps[0];
  map.points[0].observations.push_back({KeyFrameId(77), 0, -1});
  map.points[1].replaced_by = MapPointId(5);
  map.keyframes[2].features.map_points[1] = MapPointId(8);
  map.keyframes[2].next = KeyFrameId(50);
  map.keyframes[2].parent = KeyFrameId(51);
  KeepSubset(atlas, Subset::Everything(atlas));
  EXPECT_THAT(map.points[0].observations, SizeIs(4));
  EXPECT_FALSE(map.points[1].replaced_by);
  EXPECT_FALSE(map.keyframes[2].features.map_points[1]);
  EXPECT_FALSE(map.keyframes[2].next);
  EXPECT_EQ(map.keyframes[2].parent, KeyFrameId(1));
}

TEST(SettleBorder, DecidesAboutPointsThatLoseObservers) {
  const Atlas atlas = SmallChain();
  const AtlasIndex index(atlas);
  const auto points_left = [&](Border border, std::vector<std::uint8_t> keyframes) {
    Subset subset = Subset::Everything(atlas);
    subset.maps[0].keyframes = std::move(keyframes);
    SettleBorder(index, border, subset);
    return subset.maps[0].points;
  };
  // Point 0 has depth in every keyframe, point 1 in none.
  EXPECT_THAT(points_left(Border::kStrict, {0, 0, 0, 1}), ElementsAre(1, 0));
  EXPECT_THAT(points_left(Border::kSmart, {0, 0, 0, 1}), ElementsAre(0, 0));
  EXPECT_THAT(points_left(Border::kSmart, {0, 0, 1, 1}), ElementsAre(1, 0));
  EXPECT_THAT(points_left(Border::kSmart, {1, 0, 0, 1}), ElementsAre(1, 1));  // point 1 loses nothing
  Subset subset = Subset::Everything(atlas);
  subset.maps[0] = {.keyframes = {0, 0, 0, 1}, .points = {0, 1}};
  SettleBorder(index, Border::kCompletePoints, subset);
  EXPECT_THAT(subset.maps[0].keyframes, ElementsAre(1, 0, 0, 1));
}

class RealAtlasSubset : public ::testing::TestWithParam<const char*> {};
TEST_P(RealAtlasSubset, StaysSound) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Notices notices;
  const Atlas atlas = ReadOrbslam3(path, {}, notices);
  Atlas same = atlas;
  KeepSubset(same, Subset::Everything(atlas));
  EXPECT_THAT(same, EqualsAtlas(atlas));
  ExpectSoundCuts(atlas, GetParam());
}
INSTANTIATE_TEST_SUITE_P(Files, RealAtlasSubset,
                         ::testing::Values("mono_small", "stereo_inertial", "fisheye_stereo", "multimap_rgbd"));

// What ORB-SLAM3 integrated itself comes out again.
TEST(Reintegrate, AgreesWithOrbslam3) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, "stereo_inertial");
  Notices notices;
  const Atlas atlas = ReadOrbslam3(path, {}, notices);
  int compared = 0;
  for (const KeyFrame& keyframe : atlas.maps.at(0).keyframes) {
    const ImuPreintegration& recorded = keyframe.preintegration;
    if (!keyframe.previous || recorded.measurements.empty()) continue;
    ImuPreintegration again = recorded;
    Reintegrate(again, recorded.bias);
    EXPECT_NEAR(again.duration, recorded.duration, 1e-4F);
    EXPECT_LT((again.rotation - recorded.rotation).norm(), 1e-4F);
    EXPECT_LT((again.velocity - recorded.velocity).norm(), 1e-3F);
    EXPECT_LT((again.position - recorded.position).norm(), 1e-3F);
    EXPECT_LT((again.position_by_gyro - recorded.position_by_gyro).norm(), 1e-3F);
    EXPECT_LT((again.velocity_by_acc - recorded.velocity_by_acc).norm(), 1e-3F);
    EXPECT_LT((again.rotation_by_gyro - recorded.rotation_by_gyro).norm(), 1e-3F);
    EXPECT_LT((again.covariance - recorded.covariance).norm(), 1e-3F * recorded.covariance.norm());
    ++compared;
  }
  EXPECT_GT(compared, 50);
}

// Two preintegrations over half the way each are one over all of it.
TEST(JoinPreintegrations, IsIntegratingTheWholeWay) {
  const Atlas atlas = SynthesizeAtlas({.inertial = true, .keyframes = 6, .points = 80, .features = 90});
  const auto& keyframes = atlas.maps[0].keyframes;
  ImuPreintegration joined = keyframes[3].preintegration;
  const ImuPreintegration* earlier[] = {&keyframes[2].preintegration};
  ASSERT_TRUE(JoinPreintegrations(earlier, joined));
  const ImuPreintegration &a = *earlier[0], &b = keyframes[3].preintegration;
  EXPECT_NEAR(joined.duration, a.duration + b.duration, 1e-5F);
  EXPECT_LT((joined.rotation - a.rotation * b.rotation).norm(), 1e-5F);
  EXPECT_LT((joined.velocity - (a.velocity + a.rotation * b.velocity)).norm(), 1e-4F);
  EXPECT_LT((joined.position - (a.position + a.velocity * b.duration + a.rotation * b.position)).norm(), 1e-4F);
  ImuPreintegration idle;
  const ImuPreintegration* missing[] = {&idle};
  EXPECT_FALSE(JoinPreintegrations(missing, joined));
}

}  // namespace
}  // namespace slamdb::testing
