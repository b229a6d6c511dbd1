// SPDX-License-Identifier: BSD-3-Clause
// Points whose bytes are lost come back from the slots of keyframes, close to where they were.
#include "slamdb/edit/repair/detail/triangulate.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <span>

#include "slamdb/edit/repair/recover.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/formats/salvage.h"
#include "slamdb/model/derive.h"
#include "tests/edit/repair/entity_ranges.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/corrupt.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

double Quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values.empty() ? 0 : values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

double Median(std::vector<double> values) { return Quantile(std::move(values), 0.5); }

// Takes all points away, and expects most of them back: at their places, with values of their kind.
void ExpectPointsBack(const Atlas& whole, double share) {
  Atlas atlas = whole;
  std::map<MapPointId, const MapPoint*> originals;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    for (const MapPoint& point : whole.maps[row].points) originals[point.id] = &point;
    atlas.maps[row].points.clear();
  }
  const RecoverReport report = RecoverAtlas(atlas);
  EXPECT_TRUE(report.sound());
  EXPECT_TRUE(CheckAtlas(atlas).ok());
  EXPECT_GE(static_cast<double>(report.triangulated_points.size()), share * static_cast<double>(originals.size()));
  std::vector<double> places, normals, ranges, bits;
  for (const Map& map : atlas.maps)
    for (const MapPoint& point : map.points) {
      ASSERT_TRUE(originals.contains(point.id));
      const MapPoint& original = *originals[point.id];
      places.push_back(static_cast<double>((point.position - original.position).norm() / original.max_distance));
      normals.push_back(static_cast<double>((point.normal - original.normal).norm()));
      ranges.push_back(static_cast<double>(std::abs(point.max_distance / original.max_distance - 1)));
      bits.push_back(HammingDistance(point.descriptor, original.descriptor));
    }
  EXPECT_LT(Median(places), 0.01) << "of the distance that the point is seen from";
  EXPECT_LT(Quantile(places, 0.95), 0.03);
  EXPECT_LT(Quantile(places, 0.99), 0.05);
  EXPECT_LT(Median(normals), 0.05);
  EXPECT_LT(Median(ranges), 0.1);
  EXPECT_LT(Median(bits), 40);
}

class Triangulated : public ::testing::TestWithParam<Base> {};
TEST_P(Triangulated, PointsAreWhereTheyWere) { ExpectPointsBack(SoundAtlas(GetParam()), 0.8); }
INSTANTIATE_TEST_SUITE_P(Bases, Triangulated,
                         ::testing::Values(Base::kMonocular, Base::kRgbd, Base::kFisheyeStereo, Base::kInertial,
                                           Base::kTwoMaps));

class TriangulatedReal : public ::testing::TestWithParam<const char*> {};
TEST_P(TriangulatedReal, PointsAreWhereTheyWere) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Notices notices;
  ExpectPointsBack(ReadOrbslam3(path, {}, notices), 0.95);
}
INSTANTIATE_TEST_SUITE_P(Files, TriangulatedReal,
                         ::testing::Values("session_small_a", "mono_small", "mono_dist", "stereo_inertial",
                                           "fisheye_stereo", "multimap_rgbd"));

// A keyframe whose slot is wrong does not pull the point away, and loses the slot.
TEST(TriangulatedPoint, LeavesOutAViewThatDoesNotAgree) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  const auto seen =
      std::ranges::find_if(atlas.maps[0].points, [](const MapPoint& point) { return point.observations.size() >= 3; });
  ASSERT_NE(seen, atlas.maps[0].points.end());
  const MapPoint original = *seen;
  atlas.maps[0].points.erase(seen);
  const Observation& wrong = original.observations[1];
  const auto keyframe = std::ranges::find(atlas.maps[0].keyframes, wrong.keyframe, &KeyFrame::id);
  Features& features = keyframe->features;
  const auto row = static_cast<std::size_t>(wrong.left);
  features.undistorted[row].x += 40;
  const RecoverReport report = RecoverAtlas(atlas);
  ASSERT_EQ(report.triangulated_points, std::vector{original.id});
  const MapPoint& made = *std::ranges::find(atlas.maps[0].points, original.id, &MapPoint::id);
  EXPECT_EQ(made.observations.size() + 1, original.observations.size());
  EXPECT_LT((made.position - original.position).norm(), 0.05F * original.max_distance);
  EXPECT_FALSE(features.map_points[row]);
}

// Rays of a lens whose parameters are lost would put every point at a wrong place.
TEST(TriangulatedPoint, NeedsALensThatIsKnown) {
  const Atlas& whole = SoundAtlas(Base::kFisheyeStereo);
  Atlas atlas = whole;
  for (Map& map : atlas.maps) map.points.clear();
  atlas.cameras.clear();
  Atlas with_rig = atlas;
  EXPECT_THAT(RecoverAtlas(atlas).triangulated_points, IsEmpty());
  EXPECT_FALSE(RecoverAtlas(with_rig, {.rig = &whole}).triangulated_points.empty());
}

// A depth camera at one place twice, and a point that both images show; it is taken away.
struct TwoLooks {
  Atlas atlas = SoundAtlas(Base::kRgbd);
  MapPoint lost;
  KeyFrame *first, *second;
  std::size_t first_row, second_row;

  TwoLooks() {
    Map& map = atlas.maps[0];
    const auto seen =
        std::ranges::find_if(map.points, [](const MapPoint& point) { return point.observations.size() == 2; });
    lost = *seen;
    map.points.erase(seen);
    const auto find = [&](std::size_t row) {
      return &*std::ranges::find(map.keyframes, lost.observations[row].keyframe, &KeyFrame::id);
    };
    first = find(0);
    second = find(1);
    first_row = static_cast<std::size_t>(lost.observations[0].left);
    second_row = static_cast<std::size_t>(lost.observations[1].left);
    second->camera_from_world = first->camera_from_world;
    second->camera_from_world.translation.x() += 1e-3F;
    Features &from = first->features, &to = second->features;
    to.undistorted[second_row] = from.undistorted[first_row];
    to.keypoints[second_row] = from.keypoints[first_row];
    to.depth[second_row] = from.depth[first_row] * 1.001F;
    to.undistorted[second_row].x += 0.01F;  // the rays meet far behind it
    to.undistorted[second_row].y += 0.5F;
  }
};

TEST(TriangulatedPoint, IsWhereItsDepthsPutItWithoutParallax) {
  TwoLooks looks;
  ASSERT_EQ(detail::TriangulateLostPoints(looks.atlas, {}, 1), std::vector{looks.lost.id});
  const MapPoint& made = looks.atlas.maps[0].points.back();
  EXPECT_EQ(made.observations.size(), 2u);
  const float z = (looks.first->camera_from_world * made.position).z();
  EXPECT_NEAR(z, looks.first->features.depth[looks.first_row], 0.01F * z);
}

// The rays meet where the depths do not put it, or the depths contradict each other: nothing tells who is right.
TEST(TriangulatedPoint, IsNotMadeWhereDepthsContradict) {
  TwoLooks looks;
  looks.second->features.depth[looks.second_row] *= 0.1F;
  EXPECT_THAT(detail::TriangulateLostPoints(looks.atlas, {}, 1), IsEmpty());
}

TEST(TriangulatedPoint, IsNotMadeWithoutParallaxAndDepth) {
  TwoLooks looks;
  for (Features* features : {&looks.first->features, &looks.second->features}) {
    std::ranges::fill(features->depth, -1.0F);
    std::ranges::fill(features->right_x, -1.0F);
  }
  EXPECT_THAT(detail::TriangulateLostPoints(looks.atlas, {}, 1), IsEmpty());
}

// The depth of one of three views is wrong: two tell where the point is, and the third is no observer.
TEST(TriangulatedPoint, IsWhereMostViewsPutIt) {
  Atlas atlas = SoundAtlas(Base::kRgbd);
  const auto seen =
      std::ranges::find_if(atlas.maps[0].points, [](const MapPoint& point) { return point.observations.size() == 3; });
  ASSERT_NE(seen, atlas.maps[0].points.end());
  const MapPoint original = *seen;
  atlas.maps[0].points.erase(seen);
  const Observation& wrong = original.observations[0];
  Features& features = std::ranges::find(atlas.maps[0].keyframes, wrong.keyframe, &KeyFrame::id)->features;
  const auto row = static_cast<std::size_t>(wrong.left);
  ASSERT_GT(features.depth[row], 0);
  features.depth[row] *= 2;
  ASSERT_EQ(detail::TriangulateLostPoints(atlas, {}, 1), std::vector{original.id});
  const MapPoint& made = atlas.maps[0].points.back();
  EXPECT_EQ(made.observations.size(), 2u);
  EXPECT_LT((made.position - original.position).norm(), 0.02F * original.max_distance);
  EXPECT_FALSE(features.map_points[row]);
}

// Bytes of some points are gone: they come back and are told apart, unless they are not wanted.
TEST(TriangulatedPoint, IsToldInTheReport) {
  std::string file = ReadWhole(RealAtlas("session_small_a"));
  const EntityRanges ranges = RangesOf(file);
  const std::size_t begin = ranges.points[100].begin, end = ranges.points[160].begin;
  file.replace(begin, end - begin, end - begin, '\0');
  const Bytes bytes = std::as_bytes(std::span(file));
  Salvage salvage = SalvageBytes(bytes);
  const SalvageReport report = RecoverSalvage(salvage);
  EXPECT_EQ(report.points.listed - report.points.read, 60u);
  EXPECT_EQ(report.recovery.triangulated_points.size(), 60u);
  EXPECT_EQ(salvage.atlas.maps[0].points.size(), report.points.listed);
  EXPECT_THAT(ToJson(report), HasSubstr("\"triangulated\": 60"));
  Salvage without = SalvageBytes(bytes);
  EXPECT_THAT(RecoverSalvage(without, {.triangulate = false}).recovery.triangulated_points, IsEmpty());
  EXPECT_EQ(without.atlas.maps[0].points.size() + 60, report.points.listed);
}

}  // namespace
}  // namespace slamdb
