// SPDX-License-Identifier: BSD-3-Clause
// What the picture of an alignment shows, of two real sessions.
#include "slamdb/plot/alignment.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/formats.h"
#include "slamdb/plot/detail/axis.h"
#include "tests/plot/xml.h"
#include "tests/support/kind_of.h"

namespace slamdb::plot {
namespace {

using detail::Concat;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

// What stands between two texts, from a place on, which moves behind it. Empty: nothing more.
std::string TakeBetween(const std::string& text, const std::string& begin, const std::string& end, std::size_t& at) {
  at = std::min(text.find(begin, at), text.size());
  const std::size_t from = std::min(at + begin.size(), text.size());
  at = std::min(text.find(end, from), text.size());
  return text.substr(from, at - from);
}

// The outlines of a document's letters in their order: there they have no other name.
std::string LettersOf(const std::string& svg) {
  std::map<std::string, std::string> outlines;  // by id
  std::size_t at = 0;
  for (std::string id; !(id = TakeBetween(svg, " id=\"", "\"", at)).empty();) {
    std::size_t path = at;
    outlines[id] = TakeBetween(svg, " d=\"", "\"", path);
  }
  std::string letters;
  at = 0;
  for (std::string id; !(id = TakeBetween(svg, "xlink:href=\"#", "\"", at)).empty();)
    letters += Concat("[", outlines[id], "]");
  return letters;
}

std::string LettersOf(const std::string& text, const TextStyle& style) {
  Canvas canvas(2000, 100, PlotFormat::kSvg, 1);
  canvas.Text({20, 50}, text, style);
  return LettersOf(canvas.Finish("text", "", ""));
}

// How a colour is written.
std::string NameOf(const Color& color) {
  Canvas canvas(100, 100, PlotFormat::kSvg, 1);
  canvas.Line({10, 10}, {20, 20}, color);
  const std::string svg = canvas.Finish("line", "", "");
  std::size_t at = 0;
  return TakeBetween(svg, " stroke=\"", "\"", at);
}

// The numbers of all paths in whose tag both texts are.
std::vector<std::vector<double>> PathsWith(const std::string& svg, const std::string& one, const std::string& other) {
  std::vector<std::vector<double>> paths;
  std::size_t at = 0;
  for (std::string tag; !(tag = TakeBetween(svg, "<path", "/>", at)).empty();) {
    if (tag.find(one) == std::string::npos || tag.find(other) == std::string::npos) continue;
    std::size_t inside = 0;
    std::istringstream words(TakeBetween(tag, " d=\"", "\"", inside));
    std::vector<double>& numbers = paths.emplace_back();
    for (std::string word; words >> word;)
      if (word != "M" && word != "L" && word != "Z") numbers.push_back(std::stod(word));
  }
  return paths;
}

std::string Fixture(const std::string& name) { return Concat(SLAMDB_FIXTURES, "/", name, "/", name, ".osa"); }

class DrawnAlignment : public ::testing::Test {
 protected:
  Plot Draw(const Alignment& alignment) const {
    return DrawAlignment({&first_, 0}, {&second_, 0}, alignment, {.title = "session <b> in a"});
  }

  // Where both keyframes of the strongest pair see what was matched, in the order of the matches.
  std::vector<std::array<Eigen::Vector2f, 2>> SeenByBoth() const {
    const auto place = [](const Map& map, MapPointId point, KeyFrameId keyframe, Eigen::Vector2f& at) {
      const auto found = std::ranges::find(map.points, point, &MapPoint::id);
      const auto seen = std::ranges::find(found->observations, keyframe, &Observation::keyframe);
      if (seen == found->observations.end()) return false;
      const KeyFrame& taken = *std::ranges::find(map.keyframes, keyframe, &KeyFrame::id);
      const Keypoint& keypoint = taken.features.undistorted[static_cast<std::size_t>(seen->left)];
      at = {keypoint.x, keypoint.y};
      return true;
    };
    std::vector<std::array<Eigen::Vector2f, 2>> places;
    const AlignedPair& pair = alignment_.pairs.front();
    for (const MatchedPoints& match : alignment_.matches)
      if (std::array<Eigen::Vector2f, 2> at; place(first_.maps[0], match.first, pair.first, at[0]) &&
                                             place(second_.maps[0], match.second, pair.second, at[1]))
        places.push_back(at);
    return places;
  }

  const Atlas first_ = ReadAtlas(Fixture("session_small_a")), second_ = ReadAtlas(Fixture("session_small_b"));
  const Alignment alignment_ = AlignMaps({&first_, 0}, {&second_, 0}, {.threads = 1});
  const Theme& theme_ = Theme::Light();
  const std::string lines_ = Concat("stroke=\"", NameOf(theme_.merge), "\"");
};

TEST_F(DrawnAlignment, SaysWhatItShows) {
  const Plot plot = Draw(alignment_);
  EXPECT_EQ(slamdb::testing::ProblemOfXml(plot.bytes), "");
  EXPECT_THAT(plot.bytes, HasSubstr("<title>session &lt;b&gt; in a: alignment</title>"));
  EXPECT_THAT(plot.bytes, HasSubstr(Concat("<desc>", alignment_.reason, "</desc>")));
  EXPECT_EQ(plot.text, alignment_.reason);
  const Letters styles{theme_};
  const std::string letters = LettersOf(plot.bytes);
  const TextStyle title{.color = theme_.ink, .size = 15, .bold = true}, small = styles.Tick(Anchor::kStart);
  EXPECT_THAT(letters, HasSubstr(LettersOf("session <b> in a", title)));
  const AlignedPair& pair = alignment_.pairs.front();
  for (const std::string& heading : {std::string("Before"), std::string("After"), std::string("Matches"),
                                     Concat("kf ", pair.first.value(), " and kf ", pair.second.value())})
    EXPECT_THAT(letters, HasSubstr(LettersOf(heading, styles.Heading()))) << heading;
  for (const std::string& remark :
       {std::string("as the files have them"), std::string("aligned"), std::string("first"), std::string("second"),
        Concat(alignment_.matches.size(), " of points, by their reprojection error"), alignment_.reason})
    EXPECT_THAT(letters, HasSubstr(LettersOf(remark, small))) << remark;
  EXPECT_THAT(letters, Not(HasSubstr(LettersOf("After", small)))) << "or letters tell nothing";
}

// From keypoint to keypoint of two pictures of 377 pixels, and as many as the caption says.
TEST_F(DrawnAlignment, HasALineForEachPointOfBothPictures) {
  const Plot plot = Draw(alignment_);
  const auto paths = PathsWith(plot.bytes, lines_, "fill=\"none\"");
  ASSERT_THAT(paths, SizeIs(1));
  const std::vector<double>& ends = paths[0];
  const auto seen = SeenByBoth();
  ASSERT_GE(seen.size(), 100U);
  ASSERT_THAT(ends, SizeIs(4 * seen.size()));
  EXPECT_THAT(LettersOf(plot.bytes), HasSubstr(LettersOf(Concat("the pair that agrees most: ", ends.size() / 4,
                                                                " points that were matched are in both"),
                                                         Letters{theme_}.Tick(Anchor::kStart))));
  const ImageBounds& bounds = first_.maps[0].keyframes[0].bounds;
  const double scale = 377.0 / (bounds.max_x - bounds.min_x);
  for (std::size_t i = 0; i < seen.size(); ++i)
    for (const std::size_t end : {0U, 1U}) {
      const double left = end == 0 ? 14 : 14 + 377 + 18;
      const double x = left + scale * (static_cast<double>(seen[i][end].x()) - bounds.min_x);
      EXPECT_NEAR(ends[4 * i + 2 * end], x, 0.01);
      const double below = scale * static_cast<double>(seen[i][end].y() - seen[0][0].y());
      EXPECT_NEAR(ends[4 * i + 2 * end + 1] - ends[1], below, 0.02);
    }
}

// The plan before is that of the files, the plan after that of the transform.
TEST_F(DrawnAlignment, MovesTheSecondMap) {
  Alignment still = alignment_;
  still.first_from_second = Similarity3d{};
  const std::string second = Concat("stroke=\"", NameOf(ColorOfMap(MapId(1), false)), "\"");
  for (const bool moves : {false, true}) {
    const auto paths = PathsWith(Draw(moves ? alignment_ : still).bytes, second, "stroke-width=\"1.8\"");
    ASSERT_THAT(paths, SizeIs(2));
    ASSERT_EQ(paths[0].size(), paths[1].size());
    double most = 0;  // pixels, without what lies between the two plans
    for (std::size_t i = 2; i < paths[0].size(); ++i)
      most = std::max(most, std::abs((paths[1][i] - paths[1][i % 2]) - (paths[0][i] - paths[0][i % 2])));
    EXPECT_EQ(most > 20, moves) << most;
    EXPECT_EQ(most < 0.05, !moves) << most;
  }
}

// A bar for each fifth of a sigma in which there are matches, as high as there are many.
TEST_F(DrawnAlignment, CountsMatchesByTheirErrors) {
  std::map<int, double> counts;
  for (const MatchedPoints& match : alignment_.matches)
    ++counts[std::min(24, static_cast<int>(static_cast<double>(match.error) / 5 * 25))];
  const std::string color = Concat(" fill=\"", NameOf(ColorOfMap(MapId(1), false)), "\"");
  const auto bars = PathsWith(Draw(alignment_).bytes, color, "stroke=\"none\"");
  ASSERT_EQ(bars.size(), counts.size());
  const auto height = [](const std::vector<double>& bar) { return bar[5] - bar[1]; };
  double all = 0;
  for (const auto& bar : bars) all += height(bar);
  std::size_t row = 0;
  for (const auto& [bin, count] : counts) {
    const double share = count / static_cast<double>(alignment_.matches.size());
    EXPECT_NEAR(height(bars[row]) / all, share, 1e-3) << bin;
    EXPECT_NEAR(bars[row][0], 74.5 + 708.0 / 25 * bin, 0.1);  // the diagram is 708 pixels wide
    ++row;
  }
}

TEST_F(DrawnAlignment, WithoutAPairHasNoPictures) {
  Alignment alone = alignment_;
  alone.pairs.clear();
  const Plot plot = Draw(alone);
  EXPECT_LT(plot.height, Draw(alignment_).height - 200);
  EXPECT_THAT(PathsWith(plot.bytes, lines_, ""), SizeIs(0));
  alone.first_from_second.reset();
  EXPECT_EQ(KindOf([&] { (void)Draw(alone); }), ErrorKind::kNotPossible);
}

}  // namespace
}  // namespace slamdb::plot
