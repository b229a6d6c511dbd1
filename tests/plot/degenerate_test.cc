// SPDX-License-Identifier: BSD-3-Clause
// Atlases of which there is little or nothing sensible to draw: every plot of them is a picture all the same.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "slamdb/plot/plot.h"
#include "tests/plot/picture.h"
#include "tests/plot/worlds.h"
#include "tests/plot/xml.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

struct Odd {
  const char* name;
  Atlas (*make)();
};

Atlas Nothing() { return {}; }
Atlas EmptyMap() { return AtlasOf(Map{}); }
Atlas PointsAlone() {
  Map map = MapAt({});
  map.points.push_back(PointSeenBy(3));
  return AtlasOf(map);
}
Atlas OneKeyFrame() { return AtlasOf(MapAt({{1, 2, 3}})); }
Atlas AllInOnePlace() {
  Map map = MapAt({{5, 5, 5}, {5, 5, 5}, {5, 5, 5}, {5, 5, 5}});
  for (int i = 0; i < 10; ++i) map.points.push_back(PointSeenBy(2, {5, 5, 5}));
  return AtlasOf(map);
}
Atlas OnALine() { return AtlasOf(MapAt({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}})); }
Atlas NotNumbers() {
  Map map = MapAt({{kNone, 0, 0}, {0, kNone, 0}, {1, 1, 1}, {kNone, kNone, kNone}});
  map.keyframes[2].timestamp = std::numeric_limits<double>::quiet_NaN();
  map.points.push_back(PointSeenBy(2, {kNone, kNone, kNone}));
  map.points.push_back(PointSeenBy(2, {INFINITY, 0, -INFINITY}));
  return AtlasOf(map);
}
Atlas FarAway() {
  Map map = MapAt({{1e30F, 0, 0}, {-1e30F, 1e30F, 0}, {0, 0, 3e38F}, {1, 1, 1}});
  for (int i = 0; i < 8; ++i) map.points.push_back(PointSeenBy(2, {1e30F * static_cast<float>(i), 0, -1e30F}));
  return AtlasOf(map);
}
Atlas OneFarAway() {
  Map map = MapAt({{0, 0, 0}, {1, 0, 0}, {2, 0, 1}, {3, 0, 0}, {4, 0, 0}, {5, 0, 1}, {1e30F, 0, 0}});
  for (int i = 0; i < 200; ++i) map.points.push_back(PointSeenBy(2, {0.03F * static_cast<float>(i), 0, 2}));
  return AtlasOf(map);
}
Atlas OddTimes() {
  Map map = MapAt({{0, 0, 0}, {1, 0, 0}, {2, 0, 1}, {3, 0, 0}});
  map.keyframes[0].timestamp = -1e300;
  map.keyframes[3].timestamp = 1e300;
  return AtlasOf(map);
}
Atlas DaysApart() {
  Map map = MapAt({{0, 0, 0}, {1, 0, 0}, {2, 0, 1}, {3, 0, 0}});
  map.keyframes[2].timestamp += 86400;
  map.keyframes[3].timestamp += 86400;
  return AtlasOf(map);
}
Atlas OneTime() {
  Map map = MapAt({{0, 0, 0}, {1, 0, 0}, {2, 0, 1}});
  for (KeyFrame& keyframe : map.keyframes) keyframe.timestamp = 7;
  return AtlasOf(map);
}
Atlas AllBad() {
  Atlas atlas = SynthesizeAtlas({.keyframes = 5, .points = 50});
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) keyframe.bad = true;
  for (MapPoint& point : atlas.maps[0].points) point.bad = true;
  return atlas;
}
Atlas HundredsOfMaps() {
  Atlas atlas;
  for (std::uint64_t i = 0; i < 300; ++i) {
    atlas.maps.push_back(MapAt({{0, 0, 0}, {1, 0, 0}, {2, 0, 1}}));
    atlas.maps.back().id = MapId(i);
  }
  return atlas;
}
Atlas Dangling() {
  Atlas atlas = SynthesizeAtlas({.keyframes = 5, .points = 50});
  Map& map = atlas.maps[0];
  map.keyframes[0].connections.push_back({KeyFrameId(12345), 7});
  map.keyframes[1].connections.push_back({map.keyframes[0].id, -2000000000});
  map.keyframes[1].connections.push_back({map.keyframes[0].id, 2147483647});
  map.points[0].observations.push_back({.keyframe = KeyFrameId(999), .left = 3});
  map.points[1].observations[0].left = 1'000'000;
  atlas.cameras.clear();
  return atlas;
}

class OddAtlas : public ::testing::TestWithParam<Odd> {};

TEST_P(OddAtlas, IsDrawnAllTheSame) {
  const Atlas atlas = GetParam().make();
  for (const PlotKind kind : PlotKinds())
    for (const bool together : {false, true})
      for (const int width : {320, 800}) {
        const std::string svg = DrawPlot(atlas, {.kind = kind, .width = width, .together = together}).bytes;
        EXPECT_EQ(ProblemOfXml(svg), "") << NameOf(kind);
        EXPECT_THAT(svg, Not(HasSubstr("nan"))) << NameOf(kind);
        EXPECT_THAT(svg, Not(HasSubstr("\"inf"))) << NameOf(kind);
        EXPECT_LT(svg.size(), 2'000'000U) << NameOf(kind);
      }
  const Picture picture = Picture::Of(DrawThumbnail(atlas, 240, 150).bytes);
  EXPECT_EQ(picture.width, 240);
}

constexpr Odd kOdd[] = {{"Nothing", Nothing},
                        {"EmptyMap", EmptyMap},
                        {"PointsAlone", PointsAlone},
                        {"OneKeyFrame", OneKeyFrame},
                        {"AllInOnePlace", AllInOnePlace},
                        {"OnALine", OnALine},
                        {"NotNumbers", NotNumbers},
                        {"FarAway", FarAway},
                        {"OneFarAway", OneFarAway},
                        {"OddTimes", OddTimes},
                        {"DaysApart", DaysApart},
                        {"OneTime", OneTime},
                        {"AllBad", AllBad},
                        {"HundredsOfMaps", HundredsOfMaps},
                        {"Dangling", Dangling}};

INSTANTIATE_TEST_SUITE_P(Plots, OddAtlas, ::testing::ValuesIn(kOdd), [](const auto& odd) { return odd.param.name; });

TEST(OddAtlas, OneKeyFrameFarAwayDoesNotHideTheOthers) {
  const Plot plot = DrawPlot(OneFarAway(), {.kind = PlotKind::kPlan});
  EXPECT_EQ(plot.points, 200U);
}

}  // namespace
}  // namespace slamdb::testing
