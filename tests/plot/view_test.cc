// SPDX-License-Identifier: BSD-3-Clause
// Where places of a map come to lie on the page.
#include "slamdb/plot/detail/view.h"

#include <gmock/gmock.h>

#include "slamdb/edit/frame/transform.h"
#include "tests/plot/picture.h"
#include "tests/plot/worlds.h"

namespace slamdb::plot {
namespace {

using slamdb::testing::AtlasOf;
using slamdb::testing::MapAt;
using slamdb::testing::Picture;
using slamdb::testing::Pixel;
using ::testing::SizeIs;

TEST(Cell, HasTheSamePixelsToAMetreInBothDirections) {
  Eigen::Matrix<double, 2, 3> axes;
  axes << 1, 0, 0, 0, 0, 1;
  // 10 by 5 with 6 % of 10 around it: 11.2 by 6.2 metres, of which the height decides.
  const Cell cell = FitCell({0, 0, 1000, 500}, {0, 10}, {0, 5}, axes);
  EXPECT_NEAR(cell.scale, 500 / 6.2, 1e-9);
  EXPECT_NEAR(cell({5, 9, 2.5}).x(), 500, 1e-9);
  EXPECT_NEAR(cell({5, 9, 2.5}).y(), 250, 1e-9);
  EXPECT_NEAR(cell({0, 0, 0}).x(), 500 - 5 * 500 / 6.2, 1e-9);
  EXPECT_NEAR(cell({0, 0, 5}).y(), 250 - 2.5 * 500 / 6.2, 1e-9);
}

TEST(RangeOfMost, LeavesOutWhatIsFarOff) {
  std::vector<double> values{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  EXPECT_DOUBLE_EQ(RangeOfMost(values).high, 9);
  values.back() = 1e30;
  EXPECT_LT(RangeOfMost(values).high, 20);
  EXPECT_GE(RangeOfMost(values).high, 8);
  std::vector<double> none;
  EXPECT_DOUBLE_EQ(RangeOfMost(none).size(), 0);
}

TEST(Frame, IsLevelWithTheLargestSpreadToTheRight) {
  // Along z most, along x less; cameras have y down, so that up is -y.
  const Atlas atlas = AtlasOf(MapAt({{0, 0, 0}, {2, 0, 5}, {0, 0.1F, 10}, {-2, 0, 20}}));
  const Frame frame = SceneOf(atlas, {}).maps.at(0).frame;
  EXPECT_GT(std::abs(frame.axes_from_world(0, 2)), 0.95);
  EXPECT_LT(frame.axes_from_world(2, 1), -0.999);
  EXPECT_NEAR(frame.axes_from_world.determinant(), 1, 1e-9);
  EXPECT_THAT(frame.names[0], ::testing::HasSubstr("largest level spread"));
  EXPECT_EQ(frame.how, "up by the cameras");
}

// A camera on its way down a stairwell: the two largest spreads of its path are those of a front view.
TEST(Frame, IsAPlanWherePathsClimb) {
  const Atlas atlas = AtlasOf(MapAt({{0, 0, 0}, {0, 4, 0.2F}, {0.1F, 8, 0}, {1, 12, 0.1F}}));
  const Frame frame = SceneOf(atlas, {}).maps.at(0).frame;
  EXPECT_LT(frame.axes_from_world(2, 1), -0.999);
}

TEST(Frame, OfPlacesOnALevelLineHasTheAxesOfTheMap) {
  const Frame frame = SceneOf(AtlasOf(MapAt({{0, 0, 0}, {0, 0, 3}})), {}).maps.at(0).frame;
  EXPECT_THAT(frame.names, ::testing::ElementsAre("x of the map", "z of the map", "\u2212y of the map"));
}

TEST(Frame, IsTheSameAfterTheMapWasMoved) {
  Atlas atlas = AtlasOf(MapAt({{0, 0, 0}, {2, 0, 5}, {0, 1, 10}, {-2, 0, 20}}));
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.7, 0.5, -0.4, 0.2).normalized();
  const Eigen::RowVector3d before = SceneOf(atlas, {}).maps.at(0).frame.axes_from_world.row(2);
  TransformMap(atlas.maps[0], {1, turn, {1, 2, 3}});
  const Eigen::RowVector3d after = SceneOf(atlas, {}).maps.at(0).frame.axes_from_world.row(2);
  EXPECT_TRUE((turn * before.transpose()).isApprox(after.transpose(), 1e-5));
}

TEST(Frame, OfMapsDrawnTogetherHasOneUp) {
  Atlas atlas = AtlasOf(MapAt({{0, 0, 0}, {2, 0, 5}, {0, 1, 10}, {-2, 0, 20}}));
  atlas.maps.push_back(MapAt({{0, 0, 0}, {1, 0, 5}}));
  TransformMap(atlas.maps[1], {1, Eigen::Quaterniond(0.7, 0.5, -0.4, 0.2).normalized()});
  const auto ups = [&](bool together) {
    const PlotOptions options{.together = together};
    std::vector<Eigen::RowVector3d> rows;
    for (const MapScene& map : SceneOf(atlas, options).maps) rows.emplace_back(map.frame.axes_from_world.row(2));
    return rows;
  };
  EXPECT_FALSE(ups(false)[0].isApprox(ups(false)[1], 0.1));
  EXPECT_TRUE(ups(true)[0].isApprox(ups(true)[1], 1e-9));
}

TEST(Frame, StandsUprightWhereTheImuTells) {
  const Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kStereo, .inertial = true, .keyframes = 12, .points = 200});
  const Frame frame = SceneOf(atlas, {}).maps.at(0).frame;
  EXPECT_EQ(frame.how, "up by gravity");
  EXPECT_EQ(frame.names[0], "x");
}

TEST(Cells, AreOneForEachMapOfOneScaleOrOneForAll) {
  Atlas atlas = AtlasOf(MapAt({{0, 0, 0}, {10, 0, 0}, {10, 0, 5}, {0, 0, 5}}));
  atlas.maps.push_back(MapAt({{0, 0, 0}, {1, 0, 0}, {1, 0, 2}}));
  const Box box{0, 0, 800, 400};
  const std::vector<Cell> cells = LayCells(SceneOf(atlas, {}), View::kPlan, box);
  ASSERT_THAT(cells, SizeIs(2));
  EXPECT_DOUBLE_EQ(cells[0].scale, cells[1].scale);
  EXPECT_LE(cells[0].box.right(), cells[1].box.left);
  EXPECT_LE(cells[1].box.right(), box.right() + 1e-6);
  const std::vector<Cell> one = LayCells(SceneOf(atlas, {.together = true}), View::kPlan, box);
  ASSERT_THAT(one, SizeIs(1));
  EXPECT_THAT(one[0].maps, SizeIs(2));
}

// Start, way and end of a path in their colours, at the pixels where they must be.
TEST(Plan, DrawsKeyFramesWhereTheyAre) {
  const Atlas atlas = AtlasOf(MapAt({{0, 0, 0}, {4, 0, 0}, {8, 0, 0}, {8, 0, 3}, {8, 0, 6}}));
  const PlotOptions options{.kind = PlotKind::kPlan, .format = PlotFormat::kPng, .width = 600};
  const Plot plot = DrawPlot(atlas, options);
  const Picture picture = Picture::Of(plot.bytes);
  const Scene scene = SceneOf(atlas, options);
  const Box page{14, 14, 600 - 28, plot.height - 28};
  const Box inside = page.Without(kYTickSpace, kHeadingHeight, 1, kTickSpace + kNameSpace);
  const Cell cell = LayCells(scene, View::kPlan, inside).at(0);
  const auto at = [&](const Eigen::Vector3d& place) {
    const Spot spot = cell(place);
    return picture.At(spot.x(), spot.y());
  };
  EXPECT_EQ(at({0, 0, 0}), Pixel(scene.theme.start));
  EXPECT_EQ(at({8, 0, 6}), Pixel(scene.theme.end));
  EXPECT_EQ(at({4, 0, 0}), Pixel(ColorOfMap(MapId(0), false)));
  EXPECT_EQ(at({8, 0, 3}), Pixel(ColorOfMap(MapId(0), false)));
  EXPECT_EQ(at({2, 0, 3.3}), Pixel(scene.theme.paper));
}

TEST(Plan, CountsPointsInsideAndThoseThatAreTooFarOff) {
  Map map = MapAt({{0, 0, 0}, {4, 0, 0}, {8, 0, 0}, {8, 0, 6}});
  for (int i = 0; i < 100; ++i)
    map.points.push_back(
        slamdb::testing::PointSeenBy(2, {0.08F * static_cast<float>(i), 0, 0.06F * static_cast<float>(i)}));
  map.points.push_back(slamdb::testing::PointSeenBy(2, {1e9F, 0, 0}));
  map.points.push_back(slamdb::testing::PointSeenBy(2, {NAN, 0, 0}));
  const Atlas atlas = AtlasOf(std::move(map));
  const Plot plot = DrawPlot(atlas, {.kind = PlotKind::kPlan});
  EXPECT_EQ(plot.points, 100);
  EXPECT_EQ(plot.left_out, 2);
}

TEST(Plan, OfAShortPathShowsThePointsFarFromIt) {
  Map map = MapAt({{0, 0, 0}, {0.1F, 0, 0}, {0.1F, 0, 0.1F}});
  for (int i = 0; i < 200; ++i)  // a wall ten metres away, a hundred times as far as the path is long
    map.points.push_back(slamdb::testing::PointSeenBy(2, {0.05F * static_cast<float>(i) - 5, 0, 10}));
  const Plot plot = DrawPlot(AtlasOf(std::move(map)), {.kind = PlotKind::kPlan});
  EXPECT_EQ(plot.points, 200);
  EXPECT_EQ(plot.left_out, 0);
}

TEST(Plan, SaysHowManyPointsAreOutside) {
  const auto letters = [](float far) {
    Map map = MapAt({{0, 0, 0}, {4, 0, 0}, {8, 0, 6}});
    for (float i = 0; i < 100; ++i) map.points.push_back(slamdb::testing::PointSeenBy(2, {0.08F * i, 0, 0.06F * i}));
    map.points.push_back(slamdb::testing::PointSeenBy(2, {far, 0, 0}));
    return DrawPlot(AtlasOf(std::move(map)), {.kind = PlotKind::kPlan}).bytes;
  };
  const auto count = [](const std::string& svg) {
    std::size_t uses = 0;
    for (std::size_t at = svg.find("<use"); at != std::string::npos; at = svg.find("<use", at + 1)) ++uses;
    return uses;
  };
  EXPECT_EQ(count(letters(1e6F)) - count(letters(4)), std::string("1 of 101 points outside").size());
}

}  // namespace
}  // namespace slamdb::plot
