// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/plot.h"

#include <gmock/gmock.h>

#include <random>
#include <thread>

#include "slamdb/base/error.h"
#include "slamdb/edit/frame/align_trajectory.h"
#include "slamdb/plot/detail/axis.h"
#include "slamdb/plot/detail/theme.h"
#include "tests/plot/picture.h"
#include "tests/plot/worlds.h"
#include "tests/plot/xml.h"
#include "tests/support/kind_of.h"

namespace slamdb::testing {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

const Atlas& Sample() {
  static const Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kRgbd, .maps = 2, .keyframes = 15, .points = 400});
  return atlas;
}

class EveryKind : public ::testing::TestWithParam<PlotKind> {};

TEST_P(EveryKind, GivesTheSameBytesWhateverWasDrawnBeforeAndByHowManyThreads) {
  for (const PlotFormat format : {PlotFormat::kSvg, PlotFormat::kPng}) {
    const PlotOptions options{.kind = GetParam(), .format = format, .title = "lab", .threads = 1};
    PlotOptions threads = options;
    threads.threads = 3;
    const std::string first = DrawPlot(Sample(), options).bytes;
    static_cast<void>(DrawPlot(Sample(), {.kind = PlotKind::kOverview}));
    EXPECT_EQ(first, DrawPlot(Sample(), threads).bytes);
    std::string beside;
    std::thread other([&] { beside = DrawPlot(Sample(), options).bytes; });
    const std::string here = DrawPlot(Sample(), options).bytes;
    other.join();
    EXPECT_EQ(first, here);
    EXPECT_EQ(first, beside);
  }
}

TEST_P(EveryKind, IsWellFormedSvgThatStandsAlone) {
  const std::string svg = DrawPlot(Sample(), {.kind = GetParam(), .title = "lab"}).bytes;
  EXPECT_EQ(ProblemOfXml(svg), "");
  EXPECT_THAT(svg, HasSubstr("role=\"img\""));
  EXPECT_THAT(svg, Not(HasSubstr("style=")));
  EXPECT_THAT(svg, Not(HasSubstr("id=\"surface")));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST_P(EveryKind, IsAPngOfTheSizeThatWasAskedFor) {
  const PlotOptions options{.kind = GetParam(), .format = PlotFormat::kPng, .width = 500, .scale = 2};
  const Plot plot = DrawPlot(Sample(), options);
  const Picture picture = Picture::Of(plot.bytes);
  EXPECT_EQ(picture.width, 1000);
  EXPECT_NEAR(picture.height, 2 * plot.height, 1);
  EXPECT_GT(picture.Colors(), 10U);
  EXPECT_EQ(picture.At(1, 1), Pixel(plot::Theme::Light().paper));
}

TEST_P(EveryKind, IsDarkWhenAskedFor) {
  const Plot plot = DrawPlot(Sample(), {.kind = GetParam(), .format = PlotFormat::kPng, .dark = true});
  EXPECT_EQ(Picture::Of(plot.bytes).At(1, 1), Pixel(plot::Theme::Dark().paper));
}

INSTANTIATE_TEST_SUITE_P(Plots, EveryKind, ::testing::ValuesIn(PlotKinds().begin(), PlotKinds().end()),
                         [](const auto& kind) { return std::string(NameOf(kind.param)); });

TEST(Plot, NamesItsKinds) {
  EXPECT_EQ(PlotKindByName("plan"), PlotKind::kPlan);
  EXPECT_EQ(PlotKindByName("plans"), std::nullopt);
  EXPECT_EQ(PlotKinds().size(), 9U);
  EXPECT_TRUE(CanPlot());
}

TEST(Plot, TellsItsTimeAsInfoDoes) {
  Atlas atlas = AtlasOf(MapAt({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}));
  EXPECT_THAT(DrawPlot(atlas, {.kind = PlotKind::kTimeline}).text, EndsWith(" in 2 s"));
  atlas.maps[0].keyframes.back().timestamp = 100 + 39'971;
  EXPECT_THAT(DrawPlot(atlas, {.kind = PlotKind::kTimeline}).text, EndsWith(" in 11 h 6 min"));
}

// It has a line of its own, and is not set across the name of the axis.
TEST(Timeline, HasRoomForWhatIsLeftOut) {
  Atlas atlas = AtlasOf(MapAt({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}));
  const double without = DrawPlot(atlas, {.kind = PlotKind::kTimeline}).height;
  atlas.maps[0].keyframes.back().timestamp = 100 + 112;
  EXPECT_EQ(DrawPlot(atlas, {.kind = PlotKind::kTimeline}).height, without + plot::kNameSpace);
}

TEST(Plot, RefusesSizesThatMakeNoPicture) {
  EXPECT_EQ(KindOf([] { static_cast<void>(DrawPlot(Sample(), {.width = 100})); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([] { static_cast<void>(DrawPlot(Sample(), {.width = 100000})); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([] { static_cast<void>(DrawPlot(Sample(), {.scale = 9})); }), ErrorKind::kUsage);
}

TEST(Plot, OfHundredThousandsOfPointsIsASmallFile) {
  Map map = MapAt({{0, 0, 0}, {50, 0, 0}, {50, 0, 50}});
  std::mt19937 random(1);  // NOLINT: the same each time
  for (int i = 0; i < 300'000; ++i)
    map.points.push_back(PointSeenBy(
        0, {static_cast<float>(random() % 60000) / 1000 - 5, 0, static_cast<float>(random() % 60000) / 1000 - 5}));
  const Plot plot = DrawPlot(AtlasOf(std::move(map)), {.kind = PlotKind::kPlan});
  EXPECT_EQ(plot.points, 300'000);
  EXPECT_LT(plot.bytes.size(), 1'000'000);
}

// A reference that is the path itself, moved, but for one place that is 3 m beside it in z.
TEST(Trajectory, IsLaidOntoItsReference) {
  const Map map = MapAt({{0, 0, 0}, {4, 0, 1}, {8, 0, 0}, {8, 0, 3}, {8, 1, 6}});
  PlotOptions options{.kind = PlotKind::kTrajectory};
  for (const KeyFrame& keyframe : map.keyframes)
    options.reference.push_back({keyframe.timestamp, (-keyframe.camera_from_world.translation).cast<double>() +
                                                         Eigen::Vector3d(100, 200, 300)});
  const Atlas atlas = AtlasOf(map);
  const std::string exact = DrawPlot(atlas, options).bytes;
  EXPECT_EQ(ProblemOfXml(exact), "");
  options.reference[2].position.z() += 3;
  EXPECT_NE(DrawPlot(atlas, options).bytes, exact);
  for (TimedPosition& position : options.reference) position.timestamp += 1000;
  EXPECT_EQ(KindOf([&] { static_cast<void>(DrawPlot(atlas, options)); }), ErrorKind::kNotPossible);
}

TEST(Thumbnail, IsASmallPictureWithoutWords) {
  const Plot plot = DrawThumbnail(Sample(), 240, 150);
  const Picture picture = Picture::Of(plot.bytes);
  EXPECT_EQ(picture.width, 240);
  EXPECT_EQ(picture.height, 150);
  EXPECT_GT(picture.Colors(), 5U);
  EXPECT_LT(plot.bytes.size(), 40'000U);
}

}  // namespace
}  // namespace slamdb::testing
