// SPDX-License-Identifier: BSD-3-Clause
// The page around the data: one file that loads nothing, in which no name is markup.
#include <gmock/gmock.h>

#include <algorithm>
#include <regex>

#include "slamdb/base/detail/concat.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/corrupt.h"
#include "tests/view/page_data.h"

namespace slamdb::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

class ViewPageOf : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!HasViewPage()) GTEST_SKIP() << "built without esbuild";
  }
  const Atlas& atlas = SoundAtlas(Base::kMonocular);
};

std::size_t Count(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

// The page without the letters of its blocks.
std::string Markup(const std::string& html) {
  return std::regex_replace(html, std::regex("(<script type=\"text/plain\"[^>]*>)[^<]*"), "$1");
}

// What a page would load, ask for or lead to beyond itself: addresses in attributes and in properties that scripts set,
// in styles, and all with a scheme or a host, but those that begin with # or data:, and the name of SVG's elements.
std::vector<std::string> ForeignAddresses(const std::string& html) {
  static const std::string kHolders = "(?:src|srcset|href|action|formaction|poster|background|ping)";
  static const std::regex kForeign("\\b" + kHolders + R"re(\s*=\s*["'`](?!#|data:))re" +                   // quoted
                                       R"re(|[\s"'])re" + kHolders + R"re(\s*=\s*(?!["'`#\s]|data:))re" +  // not quoted
                                       R"re(|\burl\(\s*["']?(?!["']?(?:#|data:))|@import\b)re" +
                                       R"re(|\b(?!http://www\.w3\.org/2000/svg["'`])[a-z]+://|["'`]//\w)re",
                                   std::regex::icase);
  std::vector<std::string> found;
  for (std::sregex_iterator match(html.begin(), html.end(), kForeign), end; match != end; ++match)
    found.push_back(html.substr(static_cast<std::size_t>(match->position()), 60));
  return found;
}

// Of so many keypoints that a column of theirs has two parts.
const Atlas& Crowded() {
  static const Atlas atlas =
      SynthesizeAtlas({.sensor = Sensor::kStereo, .keyframes = 55, .points = 1000, .features = 40000});
  return atlas;
}

TEST_F(ViewPageOf, AllowsItsOwnScriptAndStyleAlone) {
  const std::string html = Markup(PageOf(atlas).html);
  EXPECT_THAT(html, StartsWith("<!DOCTYPE html>"));
  std::smatch policy;
  ASSERT_TRUE(std::regex_search(html, policy, std::regex("Content-Security-Policy\" content=\"([^\"]*)\"")));
  const std::string text = policy[1];
  EXPECT_THAT(text, StartsWith("default-src 'none'; script-src 'sha256-"));
  EXPECT_THAT(text, HasSubstr("connect-src 'none'"));
  EXPECT_THAT(text, Not(HasSubstr("unsafe")));
  EXPECT_EQ(Count(html, "{{"), 0U) << "a placeholder is left";
  EXPECT_EQ(Count(html, "<script>"), 1U);
  EXPECT_EQ(Count(html, "<style"), 1U);
  EXPECT_THAT(ForeignAddresses(html), IsEmpty());
}

// The search that this rests on, in a page that is not by itself.
TEST_F(ViewPageOf, AddressesElsewhereWouldBeFound) {
  const std::string html = PageOf(atlas).html;
  const std::string head = html.substr(0, html.find("<style"));  // the rest was looked at above, and is long
  ASSERT_THAT(head, Not(IsEmpty()));
  const auto with = [&](const std::string& more) { return ForeignAddresses(head + more); };
  for (const char* more :
       {"<img src=\"https://example.org/a/longer/address.png?with=a&query=1#part\">", "<img src=\"picture.png\">",
        "<img src=''>", "<img src=picture.png>", "<img srcset=\"a.png 2x\">", "<a href=\"/\">",
        "<a href = '//example.org'>", "<a HREF=\"javascript:alert(1)\">", "<form action=\"send\">",
        "<p style=\"background:url(a.png)\">", "<p style=\"background:url('a.png')\">",
        "<style>@import \"a.css\";</style>", "<p title=\"wss://example.org\">", "<script>x.src=\"a.js\"</script>",
        "<script>fetch('//example.org')</script>", "<p title=\"http://www.w3.org/2000/svg/x\">"}) {
    EXPECT_THAT(with(more), Not(IsEmpty())) << more;
  }
  for (const char* more : {"<img src=\"data:image/png;base64,AA==\">", "<a href=\"#top\">", "<a href='#'>",
                           "<a href=#top>", "<p style=\"fill:url(#a)\">", "<p style=\"fill:url('data:,')\">"}) {
    EXPECT_THAT(with(more), IsEmpty()) << more;
  }
}

TEST_F(ViewPageOf, NamesAreTextOnly) {
  const std::string evil = "</script><script>alert(1)</script>{{DATA}}\"'&\xff\x1b[2J\u202e<!--";
  const ViewInput input{.atlas = &atlas, .name = evil, .format = evil, .facts = [&](const AtlasStatistics&) {
                          return std::vector<ViewFact>{{evil, evil}};
                        }};
  const std::string plain = PageOf(atlas).html;
  for (const std::string& title : {std::string(), evil}) {
    const std::string html = MakeViewPage({&input, 1}, {.title = title}).html;
    EXPECT_EQ(Count(html, "alert(1)<"), 0U);
    for (const std::string tag : {"<script", "</script", "<!--"}) EXPECT_EQ(Count(html, tag), Count(plain, tag)) << tag;
    EXPECT_EQ(Markup(html).find("\x1b"), std::string::npos);
    EXPECT_THAT(html, HasSubstr("<title>&lt;/script&gt;&lt;script&gt;alert(1)"));
    const PageData page(html);
    EXPECT_THAT(page.header.at("title").get<std::string>(), StartsWith("</script><script>alert(1)</script>{{DATA}}"));
    EXPECT_THAT(page.header.at("/atlases/0/info/0/value"_json_pointer).get<std::string>(), HasSubstr("\\xff\\e[2J"));
  }
}

TEST_F(ViewPageOf, IsTheSameForAnyThreads) {
  const Atlas big = SynthesizeAtlas({.maps = 2, .keyframes = 30, .points = 9000, .features = 1500});
  const std::string once = PageOf(big, {.normals = true, .threads = 1}).html;
  EXPECT_EQ(PageOf(big, {.normals = true, .threads = 4}).html, once);
  EXPECT_EQ(PageOf(big, {.normals = true, .threads = 7}).html, once);
}

TEST_F(ViewPageOf, TellsWhatItHolds) {
  const ViewPage page = PageOf(atlas);
  EXPECT_EQ(page.report.bytes, page.html.size());
  EXPECT_EQ(page.report.points, atlas.maps[0].points.size());
  EXPECT_EQ(page.report.keyframes, atlas.maps[0].keyframes.size());
  EXPECT_EQ(page.report.maps, 1U);
  EXPECT_GT(page.report.keypoints, 0U);
  EXPECT_THAT(page.report.left_out, IsEmpty());
  const PageData data(page.html);
  EXPECT_EQ(data.header.at("fixed_part"), page.report.fixed_part);
  std::size_t blocks = 0;
  for (const std::string& name : data.order) {
    const std::size_t at = page.html.find("data-name=\"" + name.substr(0, name.rfind('/')) + "\"");
    blocks += page.html.find("</script>\n", at) + 10 - page.html.rfind("<script", at);
  }
  EXPECT_EQ(page.report.fixed_part + blocks, page.html.size());
}

TEST_F(ViewPageOf, TitleIsTheNamesUnlessItIsGiven) {
  EXPECT_EQ(DataOf({&atlas, &atlas}).header.at("title"), "atlas 0, atlas 1");
  EXPECT_EQ(DataOf(atlas, {.title = "The lab"}).header.at("title"), "The lab");
}

TEST_F(ViewPageOf, LargeColumnsAreInParts) {
  const PageData page = DataOf(Crowded(), {.keypoints = ViewKeypoints::kAll, .check = false});
  ASSERT_GT(page.columns.at("keypoints/x").size(), std::size_t{4} << 20);
  EXPECT_THAT(page.order, Contains("keypoints/x/1"));
  EXPECT_EQ(page.Keypoints().size(), 55U);
}

TEST_F(ViewPageOf, KeypointsGiveWayToSize) {
  const ViewPage page = PageOf(Crowded(), {.check = false});
  EXPECT_LE(page.report.bytes, page.report.fixed_part + kViewBytesPerPoint * page.report.points + kViewAllowance);
  const std::uint64_t all = PageOf(Crowded(), {.keypoints = ViewKeypoints::kAll, .check = false}).report.keypoints;
  const std::uint64_t matched =
      PageOf(Crowded(), {.keypoints = ViewKeypoints::kMatched, .check = false}).report.keypoints;
  EXPECT_EQ(page.report.keypoints, matched);
  EXPECT_THAT(page.report.left_out, ElementsAre(HasSubstr(detail::Thousands(all - matched) + " of ")));
  EXPECT_EQ(PageData(page.html).header.at("left_out"), page.report.left_out);
}

// What a point takes, without its keyframes' keypoints: positions, ids, observers, error.
TEST_F(ViewPageOf, TakesFewBytesAPoint) {
  const auto bytes = [](std::size_t points) {
    const Atlas world = SynthesizeAtlas({.keyframes = 40, .points = points, .features = 7000});
    return static_cast<double>(PageOf(world, {.keypoints = ViewKeypoints::kNone, .check = false}).report.bytes);
  };
  EXPECT_LT((bytes(60000) - bytes(20000)) / 40000, kViewBytesPerPoint);
}

TEST_F(ViewPageOf, CamerasHaveTheImageOfTheirKeyframes) {
  Atlas moved = atlas;
  for (KeyFrame& keyframe : moved.maps[0].keyframes) {
    keyframe.bounds.min_x = -10;
    keyframe.bounds.min_y = -20;
    keyframe.bounds.max_x = 650;
    keyframe.bounds.max_y = 500;
  }
  const auto camera = DataOf(moved).header.at("cameras").at(0);
  EXPECT_EQ(camera.at("width"), 660);
  EXPECT_EQ(camera.at("height"), 520);
  EXPECT_FLOAT_EQ(camera.at("cx").get<float>(), moved.cameras[0].parameters[2] + 10);
  EXPECT_FLOAT_EQ(camera.at("cy").get<float>(), moved.cameras[0].parameters[3] + 20);
  EXPECT_THAT(camera.at("text").get<std::string>(), StartsWith("pinhole  fx "));
  moved.cameras[0].parameters.resize(1);
  EXPECT_TRUE(DataOf(moved).header.at("cameras").at(0).at("cy").is_null());
}

TEST_F(ViewPageOf, SpeaksInTheWordsOfItsProgram) {
  Atlas with = atlas;
  with.maps[0].landmarks.resize(2);
  with.maps[0].points[0].observations = {};  // that point-observed finds
  const Wording loud = [](std::string_view sentence) { return "WORDED " + std::string(sentence); };
  const ViewPage page = PageOf(with, {.wording = loud});
  EXPECT_THAT(page.report.left_out, Contains("WORDED 2 landmarks of MRPT; `MakePoints` makes points of them"));
  const auto header = PageData(page.html).header;
  EXPECT_THAT(header.at("left_out").get<std::vector<std::string>>(), Contains(StartsWith("WORDED ")));
  ASSERT_FALSE(header.at("findings").empty());
  for (const auto& finding : header.at("findings"))
    EXPECT_THAT(finding.at("text").get<std::string>(), StartsWith("WORDED "));
}

TEST_F(ViewPageOf, AMergedMapSaysWhatItWasMadeOf) {
  EXPECT_THAT(DataOf(atlas).header.at("merged_from"), IsEmpty());
  Atlas merged = atlas;
  merged.maps[0].keyframes[0].origin_map = 7;
  const auto origins = DataOf(merged).header.at("merged_from");
  ASSERT_EQ(origins.size(), 2U);
  EXPECT_EQ(origins.at(1).at("id"), 7);
  EXPECT_EQ(origins.at(1).at("label"), "map 7, 1 keyframe");
  const auto both = DataOf({&merged, &merged}).header.at("merged_from");
  EXPECT_EQ(both.at(1).at("label"), "map 7") << "each atlas has keyframes of its own";
}

}  // namespace
}  // namespace slamdb::testing
