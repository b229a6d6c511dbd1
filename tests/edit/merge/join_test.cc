// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/join.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "slamdb/base/error.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/edit/merge/anchors.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/model/content.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/covisibility.h"
#include "tests/edit/worlds.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// Yaw alone, so that gravity stays; with a scale only where nothing has the unit fixed.
Similarity3d Turn(const World& world) {
  return {world.sensor == Sensor::kMonocular && !world.inertial ? 1.7 : 1.0,
          Eigen::Quaterniond(Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitZ())),
          {3, -2, 0.5}};
}

// The same map twice, the second in a frame of its own: joining them with Turn fits exactly.
std::vector<Atlas> Twins(const World& world) {
  std::vector<Atlas> atlases = {MakeWorld(world, 1), MakeWorld(world, 1)};
  TransformMap(atlases[1].maps[0], Turn(world).Inverse());
  return atlases;
}

MergeResult JoinTwins(const World& world, JoinOptions join) {
  return MergeAtlases(Twins(world), {.id_maps = true, .join = std::move(join)});
}

const KeyFrame& Find(const Map& map, KeyFrameId id) { return *std::ranges::find(map.keyframes, id, &KeyFrame::id); }

class JoinWorld : public ::testing::TestWithParam<World> {};
INSTANTIATE_TEST_SUITE_P(All, JoinWorld, ::testing::ValuesIn(kWorlds), NameOfWorld);

TEST_P(JoinWorld, LinksTheTrees) {
  const Atlas original = MakeWorld(GetParam(), 1);
  const MergeResult result = JoinTwins(GetParam(), {.first_from_second = Turn(GetParam())});
  ASSERT_THAT(result.atlas.maps, SizeIs(1));
  const Map& map = result.atlas.maps[0];
  EXPECT_EQ(map.keyframes.size(), 24U);
  EXPECT_EQ(map.points.size(), 2 * original.maps[0].points.size());
  EXPECT_EQ(map.id, original.maps[0].id);
  EXPECT_EQ(map.first_keyframe, original.maps[0].first_keyframe);
  EXPECT_THAT(TroubleCounts(result.atlas), IsEmpty());
  const JoinReport& join = *result.report.join;
  EXPECT_LT(join.link_distance, 1e-4);  // the twin of the keyframe
  const KeyFrame &first = Find(map, join.link.first), &second = Find(map, join.link.second);
  EXPECT_EQ(second.parent, first.id);
  EXPECT_THAT(first.merge_edges, ElementsAre(second.id));
  EXPECT_THAT(second.merge_edges, ElementsAre(first.id));
  EXPECT_TRUE(first.not_erase && second.not_erase);
  EXPECT_EQ(map.keyframes.front().origin_map, 0U);
  EXPECT_EQ(map.keyframes.back().origin_map, 1U);
  for (const IdPair& pair : result.report.id_maps[1][IdKind::kMap]) EXPECT_EQ(pair.after, map.id.value());
}

// As ORB-SLAM3's MapPoint::Replace; a count that one of the two has is the count of both.
TEST_P(JoinWorld, FusedPointsAddTheirCounts) {
  std::vector<Atlas> twins = Twins(GetParam());
  std::int64_t visible = 0, found = 0;
  for (Atlas& atlas : twins)
    for (MapPoint& point : atlas.maps[0].points) {
      point.visible_count = 5;
      point.found_count = &atlas == &twins[0] ? MapPoint::kNoCount : 3;
      visible += 5;
      found += &atlas == &twins[0] ? 0 : 3;
    }
  const MergeResult result = MergeAtlases(
      std::move(twins), {.join = JoinOptions{.first_from_second = Turn(GetParam()), .fuse = FuseOptions()}});
  ASSERT_GT(result.report.join->fused->fused, 0U);
  for (const MapPoint& point : result.atlas.maps[0].points) {
    visible -= point.visible_count;
    found -= std::max(point.found_count, 0);
  }
  EXPECT_EQ(visible, 0);
  EXPECT_EQ(found, 0);
}

TEST_P(JoinWorld, FusesEveryPointWithItsTwin) {
  const Atlas original = MakeWorld(GetParam(), 1);
  const MergeResult result = JoinTwins(GetParam(), {.first_from_second = Turn(GetParam()), .fuse = FuseOptions()});
  const Map &map = result.atlas.maps[0], &before = original.maps[0];
  const FuseReport& fused = *result.report.join->fused;
  EXPECT_THAT(TroubleCounts(result.atlas), IsEmpty());
  EXPECT_GE(fused.fused, before.points.size() * 98 / 100);  // a point may prefer a neighbour that looks like it
  EXPECT_EQ(map.points.size(), 2 * before.points.size() - fused.fused);
  EXPECT_EQ(CountContent(map).observations, 2 * CountContent(before).observations);
  EXPECT_EQ(CountContent(map).slots + fused.cleared_slots, 2 * CountContent(before).slots);
  for (std::size_t row = 0; row < before.points.size(); ++row) {
    EXPECT_EQ(map.points[row].position, before.points[row].position);
    std::int32_t count = 0;
    for (const Observation& observation : map.points[row].observations)
      count += ObservationWeight(Find(map, observation.keyframe), observation);
    EXPECT_EQ(map.points[row].observation_count, count);
  }
  EXPECT_THAT(result.report.id_maps[1][IdKind::kPoint],
              Contains(IdPair{before.points[0].id.value(), before.points[0].id.value()}));
}

// Nothing tells what sensor made landmarks, so nothing is said of it.
TEST(Join, LandmarksAloneAreOfNoSensor) {
  Atlas landmarks;
  landmarks.maps.resize(1);
  landmarks.maps[0].id = MapId(0);
  landmarks.next_ids.map = 1;
  landmarks.maps[0].landmarks.resize(2);
  const JoinOptions join{.first_from_second = Similarity3d()};
  EXPECT_THAT(MergeAtlases({landmarks, landmarks}, {.join = join}).report.join->warnings, IsEmpty());
}

TEST(Join, LandmarksFollowTheirPoints) {
  const World& world = kWorlds[0];
  Atlas first = MakeWorld(world, 1), second = first;
  MakeLandmarks(first, {});
  MakeLandmarks(second, {});
  second.maps[0].landmarks.emplace_back();  // without id: of no point
  const std::vector<Landmark> in_first = second.maps[0].landmarks;
  TransformMap(second.maps[0], Turn(world).Inverse());
  double away = 0;
  for (std::size_t row = 0; row + 1 < in_first.size(); ++row)
    away += (second.maps[0].landmarks[row].mean - in_first[row].mean).norm();
  EXPECT_GT(away, static_cast<double>(in_first.size())) << "really elsewhere";
  JoinOptions join{.first_from_second = Turn(world)};
  const MergeResult apart = MergeAtlases({first, second}, {.join = join});
  EXPECT_EQ(apart.report.join->fused_landmarks, 0U);
  EXPECT_EQ(apart.atlas.maps[0].landmarks.size(), 2 * first.maps[0].landmarks.size() + 1);
  EXPECT_EQ(apart.report.result.landmarks, apart.atlas.maps[0].landmarks.size()) << "counted as conserved";
  for (std::size_t row = 0; row + 1 < in_first.size(); ++row)
    EXPECT_LT((apart.atlas.maps[0].landmarks[in_first.size() - 1 + row].mean - in_first[row].mean).norm(), 1e-5);
  join.fuse = FuseOptions();
  const MergeResult fused = MergeAtlases({first, second}, {.join = join});
  const std::vector<Landmark>&before = first.maps[0].landmarks, &after = fused.atlas.maps[0].landmarks;
  EXPECT_EQ(fused.report.join->fused_landmarks, fused.report.join->fused->fused);
  EXPECT_EQ(after.size(), 2 * before.size() + 1 - fused.report.join->fused_landmarks);
  for (std::size_t row = 0; row < before.size(); ++row) {
    if (after[row].seen_count == before[row].seen_count) continue;  // a neighbour looked more alike
    EXPECT_EQ(after[row].seen_count, 2 * before[row].seen_count);
    EXPECT_LT(after[row].cov_33, 0.51 * before[row].cov_33) << "known twice as well";
  }
}

TEST_P(JoinWorld, AnchorsSolveTheTransform) {
  const Atlas original = MakeWorld(GetParam(), 1);
  JoinOptions join;
  for (const KeyFrame& keyframe : original.maps[0].keyframes) join.anchors.push_back({keyframe.id, keyframe.id});
  join.anchors.push_back({join.anchors[0].first, join.anchors[6].second});  // is wrong
  join.outlier_distance = 0.1;
  const MergeResult result = JoinTwins(GetParam(), join);
  const Similarity3d error = result.report.join->first_from_second * Turn(GetParam()).Inverse();
  EXPECT_NEAR(error.scale, 1, 1e-4);
  EXPECT_LT(error.translation.norm(), 1e-3);
  EXPECT_NEAR(std::abs(error.rotation.w()), 1, 1e-6);
  const AnchorFit& fit = *result.report.join->fit;
  EXPECT_EQ(fit.inliers.back(), 0);
  EXPECT_GT(fit.residuals.back(), 0.1);
  EXPECT_LT(fit.max, 1e-3);
  EXPECT_EQ(result.report.join->link.first.value() + 12, result.report.join->link.second.value());
}

TEST_P(JoinWorld, DoesNotDependOnThreads) {
  MergeOptions options{.join = JoinOptions{.first_from_second = Turn(GetParam()), .fuse = FuseOptions()}};
  options.threads = 1;
  const MergeResult one = MergeAtlases(Twins(GetParam()), options);
  options.threads = 4;
  EXPECT_THAT(MergeAtlases(Twins(GetParam()), options).atlas, EqualsAtlas(one.atlas));
}

TEST(Join, TwoMapsOfOneAtlas) {
  Atlas atlas = MakeWorld(kWorlds[4], 2);
  const MergeResult result = MergeAtlases({atlas}, {.join = JoinOptions{.first_from_second = Similarity3d()}});
  ASSERT_THAT(result.atlas.maps, SizeIs(1));
  EXPECT_EQ(result.atlas.maps[0].keyframes.size(), 24U);
  EXPECT_EQ(result.atlas.maps[0].keyframes.back().origin_map, 1U);
}

TEST(Join, WarnsOfWhatLooksWrong) {
  const auto warnings = [](JoinOptions join) {
    Atlas atlas = MakeWorld(kWorlds[4], 2);
    join.first = atlas.maps[0].id;
    join.second = atlas.maps[1].id;
    for (std::size_t row = 0; row < join.anchors.size(); ++row)
      join.anchors[row] = {atlas.maps[0].keyframes[row].id, atlas.maps[1].keyframes[5 * row % 7].id};
    return JoinMaps(atlas, join).warnings;
  };
  EXPECT_THAT(warnings({.first_from_second = Similarity3d()}), IsEmpty());
  Similarity3d far;
  far.translation = {0, 500, 0};
  EXPECT_THAT(warnings({.first_from_second = far}), ElementsAre(HasSubstr("the maps lie far apart")));
  EXPECT_THAT(warnings({.anchors = std::vector<KeyFramePair>(7)}), Contains(HasSubstr("the fit is poor")));
}

// ---- what does not go together, whichever comes first

// Both orders of joining; what is refused without force is forced.
std::vector<std::string> JoinWarnings(const Atlas& atlas, bool turned, bool force) {
  Atlas both = atlas;
  JoinOptions join{.first_from_second = Similarity3d(), .force = force};
  join.first = both.maps[turned ? 1 : 0].id;
  join.second = both.maps[turned ? 0 : 1].id;
  const JoinReport report = JoinMaps(both, join);
  EXPECT_EQ(bool{both.maps[0].imu_initialized},
            bool{atlas.maps[0].imu_initialized} && bool{atlas.maps[1].imu_initialized});
  return report.warnings;
}

void SetImu(Map& map, bool inertial, bool initialised) {
  map.inertial = inertial;
  map.imu_initialized = map.imu_ba1 = map.imu_ba2 = initialised;
}

void MakeMonocular(Map& map) {
  for (KeyFrame& keyframe : map.keyframes) {
    keyframe.intrinsics.baseline_fx = keyframe.intrinsics.baseline = 0;
    std::ranges::fill(keyframe.features.right_x, -1.0F);
    std::ranges::fill(keyframe.features.depth, -1.0F);
  }
}

TEST(Join, WarnsOfTheImuInEveryOrder) {
  Atlas atlas = MakeWorld(kWorlds[4], 2);
  for (const bool turned : {false, true}) {
    SetImu(atlas.maps[0], true, true);
    SetImu(atlas.maps[1], true, false);
    EXPECT_THAT(JoinWarnings(atlas, turned, false), ElementsAre(HasSubstr("counts as not initialised")));
    SetImu(atlas.maps[1], false, false);
    EXPECT_THAT(JoinWarnings(atlas, turned, false), ElementsAre(HasSubstr("counts as not inertial")));
    SetImu(atlas.maps[0], true, false);
    EXPECT_THAT(JoinWarnings(atlas, turned, false), ElementsAre(HasSubstr("has an IMU, map 1 has none")));
    SetImu(atlas.maps[0], true, true);
    SetImu(atlas.maps[1], true, true);
    atlas.maps[1].imu_ba2 = false;
    EXPECT_THAT(JoinWarnings(atlas, turned, false), ElementsAre(HasSubstr("has come further in map 0")));
    SetImu(atlas.maps[0], false, false);
    SetImu(atlas.maps[1], false, false);
    EXPECT_THAT(JoinWarnings(atlas, turned, false), IsEmpty());
  }
}

TEST(Join, RefusesAnArbitraryScaleWithAMetricOneInEveryOrder) {
  Atlas atlas = MakeWorld(kWorlds[4], 2);
  SetImu(atlas.maps[0], false, false);
  SetImu(atlas.maps[1], false, false);
  MakeMonocular(atlas.maps[1]);
  for (const bool turned : {false, true}) {
    const Atlas original = atlas;
    EXPECT_THAT(ErrorOf([&] { JoinWarnings(atlas, turned, false); }),
                HasSubstr("the scale of map 1, which is monocular without initialised IMU, is arbitrary, that of map 0 "
                          "is metric"));
    EXPECT_THAT(atlas, EqualsAtlas(original));
    EXPECT_THAT(JoinWarnings(atlas, turned, true),
                ElementsAre(HasSubstr("is arbitrary"), HasSubstr("map 0 has stereo or depth, map 1 is monocular")));
  }
  MakeMonocular(atlas.maps[0]);
  EXPECT_THAT(JoinWarnings(atlas, false, false), ElementsAre(HasSubstr("right only where both are the same")));
  SetImu(atlas.maps[0], true, true);
  EXPECT_THAT(ErrorOf([&] { JoinWarnings(atlas, true, false); }), HasSubstr("is metric"));
}

TEST(Join, RefusesAScaleBetweenMetricMaps) {
  for (const World& world : {kWorlds[2], kWorlds[4], kWorlds[6]}) {
    SCOPED_TRACE(world.name);
    const Atlas original = MakeWorld(world, 2);
    JoinOptions join{.first = original.maps[0].id, .second = original.maps[1].id};
    for (const double scale : {2.0, 0.5, 1.01}) {
      Atlas atlas = original;
      join.first_from_second = Similarity3d{.scale = scale};
      join.force = false;
      EXPECT_THAT(ErrorOf([&] { JoinMaps(atlas, join); }), HasSubstr("are metric both, and the transform has a scale"));
      EXPECT_THAT(atlas, EqualsAtlas(original));
      join.force = true;
      EXPECT_THAT(JoinMaps(atlas, join).warnings, Contains(HasSubstr("are metric both")));
    }
    Atlas atlas = original;
    join.first_from_second = Similarity3d{.scale = 1.0000001};
    join.force = false;
    EXPECT_NO_THROW(JoinMaps(atlas, join));
  }
}

// Places of the second map are half as far apart: the solved scale is 2.
TEST(Join, RefusesASolvedScaleBetweenMetricMaps) {
  Atlas atlas = MakeWorld(kWorlds[4], 2);
  JoinOptions join{.first = atlas.maps[0].id, .second = atlas.maps[1].id, .with_scale = true};
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 1)})
    join.places.push_back({.first = 2 * place, .second = place});
  EXPECT_THAT(ErrorOf([&] { JoinMaps(atlas, join); }), HasSubstr("a scale of 2"));
}

TEST(Join, WarnsOfOtherCameras) {
  Atlas atlas = MakeWorld(kWorlds[4], 2);
  for (KeyFrame& keyframe : atlas.maps[1].keyframes) keyframe.intrinsics.fx *= 2;
  for (const bool turned : {false, true})
    EXPECT_THAT(JoinWarnings(atlas, turned, false), ElementsAre(HasSubstr("have other intrinsics")));
  for (KeyFrame& keyframe : atlas.maps[1].keyframes) keyframe.camera = keyframe.right_camera = CameraId(77);
  EXPECT_THAT(JoinWarnings(atlas, true, false), ElementsAre(HasSubstr("have other cameras")));
}

TEST(Merge, WarnsOfWhatMapsSideBySideDoNotShare) {
  const Atlas stereo = MakeWorld(kWorlds[4], 1, 1);
  Atlas mono = MakeWorld(kWorlds[4], 1, 2);
  EXPECT_THAT(MergeAtlases({stereo, mono}).report.warnings, IsEmpty());
  MakeMonocular(mono.maps[0]);
  SetImu(mono.maps[0], true, false);
  for (const auto& inputs : {std::vector{stereo, mono, mono}, std::vector{mono, stereo}}) {
    const std::vector<std::string> warnings = MergeAtlases(inputs).report.warnings;
    EXPECT_THAT(warnings, ElementsAre(HasSubstr("has an IMU"), HasSubstr("is monocular"), HasSubstr("is arbitrary")));
  }
}

TEST(Join, BadInputChangesNothing) {
  const Atlas original = MakeWorld(kWorlds[4], 2);
  const auto error = [&](const JoinOptions& join) {
    Atlas atlas = original;
    const std::string text = ErrorOf([&] { JoinMaps(atlas, join); });
    EXPECT_THAT(atlas, EqualsAtlas(original));
    return text;
  };
  const MapId a = original.maps[0].id, b = original.maps[1].id;
  EXPECT_THAT(error({.first = a, .second = b}), HasSubstr("needs a transform, or anchors"));
  EXPECT_THAT(error({.first = a, .second = a, .first_from_second = Similarity3d()}), HasSubstr("with itself"));
  EXPECT_THAT(error({.first = a, .second = MapId(9), .first_from_second = Similarity3d()}),
              HasSubstr("there is no map 9; maps are 0, 1"));
  EXPECT_THAT(error({.first = a, .second = b, .anchors = {{KeyFrameId(0), KeyFrameId(0)}}}),
              HasSubstr("kf 0 is not in map 1"));
  EXPECT_THAT(error({.first = a, .second = b, .anchors = {{KeyFrameId(0), original.maps[1].keyframes[0].id}}}),
              HasSubstr("at least 3 pairs"));
  Similarity3d flat;
  flat.scale = 0;
  EXPECT_THAT(error({.first = a, .second = b, .first_from_second = flat}), HasSubstr("scale"));
}

TEST(Join, RefusesToGuess) {
  const Atlas a = MakeWorld(kWorlds[4], 2, 1), b = MakeWorld(kWorlds[4], 1, 2);
  const JoinOptions join{.first_from_second = Similarity3d()};
  EXPECT_THAT(ErrorOf([&] { return MergeAtlases({a, b}, {.join = join}); }), HasSubstr("several maps to choose from"));
  EXPECT_THAT(ErrorOf([&] { return MergeAtlases({b, b, b}, {.join = join}); }), HasSubstr("at a time"));
}

// Two keyframes that see one point each, at one place.
Map TwoPoints(float apart, std::uint8_t descriptor) {
  Map map = MakeWorld(kWorlds[4], 1).maps[0];
  map.points.erase(map.points.begin() + 1, map.points.end());
  map.keyframes.erase(map.keyframes.begin() + 2, map.keyframes.end());
  MapPoint& point = map.points[0];
  const MapPointId id = point.id;
  for (KeyFrame& keyframe : map.keyframes) {
    std::ranges::fill(keyframe.features.map_points, MapPointId());
    keyframe.connections.clear();
  }
  point.observations = {{map.keyframes[0].id, 5, -1}};
  point.observation_count = ObservationWeight(map.keyframes[0], point.observations[0]);
  point.reference = map.keyframes[0].id;
  point.max_distance = map.keyframes[0].intrinsics.fx * 0.01F;  // an uncertainty of 0.01
  point.descriptor = {};
  map.keyframes[0].features.map_points[5] = id;
  MapPoint other = point;
  other.id = MapPointId(id.value() + 1000);
  other.position.x() += apart;
  other.observations[0].keyframe = other.reference = map.keyframes[1].id;
  other.descriptor[0] = descriptor;
  map.keyframes[1].features.map_points[5] = other.id;
  map.points.push_back(other);
  return map;
}

TEST(Fuse, ByPlaceAndLooks) {
  Map near = TwoPoints(0.02F, 3);
  const FuseReport report = FusePoints(near, 1, {});
  EXPECT_EQ(report.fused, 1U);
  EXPECT_NEAR(report.mean_distance, 0.02, 1e-6);
  ASSERT_THAT(near.points, SizeIs(1));
  EXPECT_THAT(near.points[0].observations, SizeIs(2));
  EXPECT_EQ(near.keyframes[1].features.map_points[5], near.points[0].id);
  EXPECT_THAT(near.keyframes[0].connections, ElementsAre(Connection{near.keyframes[1].id, 1}));
  EXPECT_THAT(near.keyframes[1].connections, ElementsAre(Connection{near.keyframes[0].id, 1}));
  Map far = TwoPoints(0.04F, 3);
  EXPECT_EQ(FusePoints(far, 1, {}).fused, 0U);
  EXPECT_EQ(FusePoints(far, 1, {.radius = 5}).fused, 1U);
  Map unlike = TwoPoints(0.01F, 3);
  EXPECT_EQ(FusePoints(unlike, 1, {.hamming = 1}).fused, 0U);
  EXPECT_EQ(FusePoints(unlike, 1, {.hamming = 2}).fused, 1U);
}

TEST(Fuse, NotWhatOneKeyframeSeesTwice) {
  Map map = TwoPoints(0.01F, 0);
  map.points[1].observations[0] = {map.keyframes[0].id, 6, -1};
  map.keyframes[0].features.map_points[6] = map.points[1].id;
  const FuseReport report = FusePoints(map, 1, {});
  EXPECT_EQ(report.fused, 0U);
  EXPECT_EQ(report.seen_together, 1U);
}

TEST(Covisibility, IsWhatSynthesisMade) {
  Map map = MakeWorld(kWorlds[0], 1).maps[0];
  const auto expected = map.keyframes[3].connections;
  map.keyframes[3].connections = {{map.keyframes[4].id, 999}};
  const std::uint32_t row = 3;
  detail::UpdateCovisibility(map, {&row, 1});
  EXPECT_EQ(map.keyframes[3].connections, expected);
}

TEST(Anchors, FromText) {
  EXPECT_THAT(ParseAnchors("12:7,30:41").keyframes,
              ElementsAre(KeyFramePair{KeyFrameId(12), KeyFrameId(7)}, KeyFramePair{KeyFrameId(30), KeyFrameId(41)}));
  EXPECT_THAT(ErrorOf([] { return ParseAnchors("12-7"); }), HasSubstr("FIRST:SECOND"));
}

TEST(Anchors, FromATable) {
  const Anchors anchors = ParseAnchorsCsv(
      "name,first,second,first_x,first_y,first_z,second_x,second_y,second_z\na,1,2,,,,,,\nb,,,1,2,3,4,5,6.5\n");
  EXPECT_THAT(anchors.keyframes, ElementsAre(KeyFramePair{KeyFrameId(1), KeyFrameId(2)}));
  ASSERT_THAT(anchors.places, SizeIs(1));
  EXPECT_EQ(anchors.places[0].second, Eigen::Vector3d(4, 5, 6.5));
  EXPECT_THAT(ErrorOf([] { return ParseAnchorsCsv("a,b\n1,2\n"); }), HasSubstr("line 1: expected the columns"));
  EXPECT_THAT(ErrorOf([] { return ParseAnchorsCsv("first,second\n1,x\n"); }),
              HasSubstr("line 2: expected a number, found 'x' in column second"));
  EXPECT_THAT(ErrorOf([] { return ParseAnchorsCsv("first,second\n1,2,3\n"); }),
              HasSubstr("line 2: expected 2 cells, found 3"));
  EXPECT_THAT(ErrorOf([] { return ParseAnchorsCsv("1,2\n1.5,2\n"); }), HasSubstr("line 2: expected a number"));
}

TEST(Anchors, FromATableInAnyDialect) {
  const auto pairs =
      ElementsAre(KeyFramePair{KeyFrameId(0), KeyFrameId(9)}, KeyFramePair{KeyFrameId(2), KeyFrameId(7)});
  for (const char* text : {"first, second\n0, 9\n2, 7\n",
                           "\xef\xbb\xbf"
                           "first,second\r\n0,9\r\n2,7\r\n",
                           "first;second\n0;9\n2;7", "0,9\n2,7\n", "# by hand\n0 9\n2  7\n",
                           "Second\tFirst\n9\t0\n7\t2\n", "\"first\",\"second\"\n\"0\",\"9\"\n+2,+7\n"})
    EXPECT_THAT(ParseAnchorsCsv(text).keyframes, pairs) << text;
  const Anchors places = ParseAnchorsCsv("1 2 3 4 5 6.5\n");
  EXPECT_TRUE(places.keyframes.empty());
  ASSERT_THAT(places.places, SizeIs(1));
  EXPECT_EQ(places.places[0].first, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(places.places[0].second, Eigen::Vector3d(4, 5, 6.5));
}

TEST(Anchors, OfATextOrAFile) {
  const TemporaryFolder folder;
  EXPECT_THAT(ReadAnchors("12:7").keyframes, SizeIs(1));
  EXPECT_THAT(ReadAnchors(folder.Make("good.csv", "12,7\n")).keyframes, SizeIs(1));
  const auto error_of = [](const std::string& text_or_path) {
    try {
      static_cast<void>(ReadAnchors(text_or_path));
    } catch (const Error& error) {
      return error;
    }
    return Error(ErrorKind::kInternal, "no error");
  };
  const std::string bad = folder.Make("bad.csv", "first,second\n1,x\n");
  EXPECT_EQ(error_of(bad).path(), bad);
  EXPECT_EQ(error_of(bad).kind(), ErrorKind::kDamaged);
  EXPECT_EQ(error_of("12:7,30").kind(), ErrorKind::kUsage);
}

}  // namespace
}  // namespace slamdb
