// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/plot.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <thread>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/evaluate/evaluate.h"
#include "slamdb/model/derive.h"
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

// Poses of the path itself, moved.
std::vector<TrajectoryPose> MovedPath(const Map& map) {
  std::vector<TrajectoryPose> poses;
  for (const KeyFrame& keyframe : map.keyframes)
    poses.push_back({keyframe.timestamp, CameraCenter(keyframe).cast<double>() + Eigen::Vector3d(100, 200, 300)});
  return poses;
}

PlotOptions Against(const Map& map, std::vector<TrajectoryPose> reference) {
  Estimate estimate{.map = map.id};
  for (const KeyFrame& keyframe : map.keyframes)
    estimate.poses.push_back({keyframe.timestamp, CameraCenter(keyframe).cast<double>()});
  EvaluationReport report = EvaluateTrajectories({estimate}, reference);
  return {.kind = PlotKind::kTrajectory,
          .format = PlotFormat::kPng,
          .reference = PlotReference{std::move(reference), std::move(report)}};
}

const Map& Walk() {
  static const Map map = MapAt({{0, 0, 0}, {4, 0, 1}, {8, 0, 0}, {8, 0, 3}, {8, 1, 6}});
  return map;
}

TEST(Trajectory, TellsTheErrorOfTheEvaluation) {
  std::vector<TrajectoryPose> reference = MovedPath(Walk());
  reference[2].position.z() += 3;
  PlotOptions options = Against(Walk(), reference);
  const double rmse = options.reference->evaluation.evaluations.at(0).absolute.translation.rmse;
  ASSERT_GT(rmse, 0.1);
  EXPECT_THAT(DrawPlot(AtlasOf(Walk()), options).text, HasSubstr("; rmse " + detail::Digits(rmse, 4) + " m"));
  options.reference->unit = "map units";
  options.format = PlotFormat::kSvg;
  const Plot plot = DrawPlot(AtlasOf(Walk()), options);
  EXPECT_THAT(plot.text, HasSubstr(detail::Digits(rmse, 4) + " map units"));
  EXPECT_EQ(ProblemOfXml(plot.bytes), "");
}

TEST(Trajectory, DrawsTheReferenceWholeAndWhereTheTrajectoryBeginsAndEnds) {
  std::vector<TrajectoryPose> reference = MovedPath(Walk());
  const auto pixels_of = [&](const plot::Color& color) {
    const Picture picture = Picture::Of(DrawPlot(AtlasOf(Walk()), Against(Walk(), reference)).bytes);
    std::size_t count = 0;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) count += picture.At(x, y) == Pixel(color) ? 1 : 0;
    return count;
  };
  const plot::Theme& theme = plot::Theme::Light();
  const std::size_t paired = pixels_of(theme.reference);
  EXPECT_GT(pixels_of(theme.start), 80U);  // the mark, and the legend's
  EXPECT_GT(pixels_of(theme.end), 100U);
  for (int i = 1; i < 6; ++i)
    reference.push_back({reference.back().timestamp + 1, reference.back().position + Eigen::Vector3d(-1, 0, 0)});
  EXPECT_GT(pixels_of(theme.reference), paired + 200);
}

TEST(Trajectory, WithoutAnEvaluationIsRefused) {
  PlotOptions options = Against(Walk(), MovedPath(Walk()));
  options.reference->evaluation.evaluations.clear();
  EXPECT_EQ(KindOf([&] { static_cast<void>(DrawPlot(AtlasOf(Walk()), options)); }), ErrorKind::kNotPossible);
}

TEST(Plots, OfOneAtlasAreThoseOfEachAlone) {
  std::vector<PlotOptions> pictures;
  for (const PlotKind kind : PlotKinds())
    for (const bool dark : {false, true}) pictures.push_back({.kind = kind, .dark = dark});
  const std::vector<Plot> plots = DrawPlots(Sample(), pictures);
  ASSERT_EQ(plots.size(), pictures.size());
  for (std::size_t i = 0; i < plots.size(); ++i)
    EXPECT_EQ(plots[i].bytes, DrawPlot(Sample(), pictures[i]).bytes) << NameOf(pictures[i].kind);
}

// Track lengths, reprojection errors and covisibility are a row of 230 pixels and the space below it.
TEST(Overview, LeavesOutDiagramsThatWouldBeEmptyAndPutsThemBelowEachOtherOnANarrowPage) {
  const Atlas path = AtlasOf(Walk());
  const auto rows = [&](const Atlas& atlas, int width) {
    double rest = DrawPlot(atlas, {.width = width}).height + 28;
    for (const PlotKind kind : {PlotKind::kPlan, PlotKind::kSide, PlotKind::kTimeline})
      rest -= DrawPlot(atlas, {.kind = kind, .width = width}).height;
    return static_cast<int>(std::lround(rest / 248));
  };
  EXPECT_EQ(rows(path, 800), 0);
  EXPECT_EQ(rows(Sample(), 800), 1);
  EXPECT_EQ(rows(Sample(), 600), 2);
  EXPECT_EQ(rows(Sample(), 400), 3);
}

TEST(Thumbnail, HasColoursForADarkPage) {
  EXPECT_NE(DrawThumbnail(Sample(), 240, 150).bytes, DrawThumbnail(Sample(), 240, 150, /*dark=*/true).bytes);
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
