// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "slamdb/base/detail/markup.h"
#include "slamdb/plot/plot.h"
#include "slamdb/report/pages.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/corrupt.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kHostile = "</title><script>alert(1)</script>\"onload='x'&lt;\x1b[31m\xff";

std::size_t CountOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

Atlas BrokenBy(std::string_view rule) {
  for (const Twin& twin : Twins()) {
    if (twin.rule != rule) continue;
    Atlas atlas = SoundAtlas(twin.base);
    twin.corrupt(atlas);
    return atlas;
  }
  return {};
}

std::string PageOf(const Atlas& atlas, const CheckOptions& options = {}, const std::string& name = "lab.osa") {
  return ReportPage(atlas, ReportOn(atlas, name, options), {.threads = 1});
}

TEST(ReportPage, HoldsNumbersPlotsFindingsAndGates) {
  const Atlas atlas = SynthesizeAtlas({.maps = 2, .keyframes = 8, .points = 400});
  const std::string page = PageOf(atlas);
  EXPECT_THAT(page, HasSubstr("<span class=\"badge good\">sound"));
  EXPECT_THAT(page, HasSubstr("<dt>keyframes</dt><dd>16</dd>"));
  EXPECT_THAT(page, HasSubstr("map 1"));
  EXPECT_THAT(page, HasSubstr("<td>keyframes</td><td class=\"number\">16</td>"));
  EXPECT_EQ(CountOf(page, "<div class=\"light\"><svg "), CanPlot() ? 7U : 0U);
  EXPECT_EQ(CountOf(page, "<div class=\"dark\"><svg "), CanPlot() ? 7U : 0U);
  EXPECT_THAT(page, Not(HasSubstr("invert("))) << "colours tell amounts";
  EXPECT_EQ(CountOf(page, "<script"), 0U);
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page, Not(HasSubstr("unsafe")));
  EXPECT_THAT(page, Not(HasSubstr("http://www.w3.org/1999/xhtml")));
}

TEST(ReportPage, HasNoIdTwice) {
  const std::string page = PageOf(SynthesizeAtlas({.keyframes = 6, .points = 200}));
  static const std::regex id(" id=\"([^\"]*)\"");
  std::set<std::string> seen;
  for (std::sregex_iterator found(page.begin(), page.end(), id), end; found != end; ++found)
    EXPECT_TRUE(seen.insert((*found)[1]).second) << (*found)[1];
}

TEST(ReportPage, SaysOfEachRuleWhatComesOfItAndWhatToDo) {
  const std::string page = PageOf(BrokenBy("observation-target"));
  const Rule& rule = *FindRule("observation-target");
  EXPECT_THAT(page, HasSubstr("not sound</span>"));
  EXPECT_THAT(page, HasSubstr("<code>observation-target</code>"));
  EXPECT_THAT(page, HasSubstr(detail::EscapedMarkup(rule.consequence)));
  EXPECT_THAT(page, HasSubstr("slamdb repair mends it (" + std::string(rule.fix.name)));
  EXPECT_THAT(page, HasSubstr("which does not exist"));
}

TEST(ReportPage, SpeaksInTheWordsOfItsProgram) {
  const Atlas atlas = BrokenBy("point-support");
  const AtlasReport report = ReportOn(atlas, "lab.osa");
  EXPECT_THAT(ReportPage(atlas, report), HasSubstr("`Cull` removes such points"));
  const Wording loud = [](std::string_view sentence) { return "WORDED " + std::string(sentence); };
  const std::string page = ReportPage(atlas, report, {.wording = loud});
  EXPECT_THAT(page, HasSubstr("What to do:</strong> WORDED There is no repair"));
  EXPECT_THAT(page, HasSubstr("</code>: WORDED "));
}

TEST(ReportPage, TellsWhichGatesWerePassed) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 8, .points = 200});
  const std::string page = PageOf(atlas, {.gates = {{"min-keyframes", 5}, {"max-points", 10}}});
  EXPECT_THAT(page, HasSubstr("at least 5</td><td><span class=\"badge good\">passed"));
  EXPECT_THAT(page, HasSubstr("at most 10</td><td><span class=\"badge error\">not passed"));
  EXPECT_EQ(CountOf(page, "badge error\">not passed"), 1U);
  EXPECT_EQ(CountOf(page, "<tr><td>keyframes</td>"), 1U) << "asked, so not among those without a limit";
  EXPECT_THAT(PageOf(atlas), Not(HasSubstr("<th>verdict</th>"))) << "nothing was asked";
}

TEST(ReportPage, KeepsHostileTextsAsText) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 4, .points = 50});
  atlas.vocabulary.name = kHostile;
  atlas.vocabulary.checksum = kHostile;
  const std::string page = PageOf(atlas, {}, kHostile);
  EXPECT_EQ(CountOf(page, "<script"), 0U);
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;alert(1)&lt;/script&gt;&quot;onload=&#39;x&#39;&amp;lt;\\e[31m\\xff"));
  EXPECT_THAT(page, Not(HasSubstr("\x1b")));
}

TEST(ReportPage, OfAnAtlasOfNothingIsAPage) {
  EXPECT_THAT(PageOf({}), HasSubstr("</html>"));
  Atlas atlas;
  atlas.maps.emplace_back();
  EXPECT_THAT(PageOf(atlas), HasSubstr("</html>"));
}

TEST(ReportIndex, HasARowForEachAndRunsOneScriptOnly) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 200});
  std::vector<AtlasReport> reports{ReportOn(atlas, "a.osa"), ReportOn(atlas, kHostile)};
  reports[0].page = "a.html";
  reports[0].bytes = 2'500'000;
  reports.emplace_back();
  reports.back().checked.name = "bad.osa";
  reports.back().checked.failure = "bad.osa: byte 12: <b>cut</b>";
  const std::string index = ReportIndex(reports, kHostile);
  EXPECT_EQ(CountOf(index, "<script"), 1U);
  EXPECT_EQ(CountOf(index, "<tr data-verdict"), 3U);
  EXPECT_THAT(index, HasSubstr("<tr data-verdict=\"not readable\">"));
  EXPECT_THAT(index, HasSubstr("bad.osa: byte 12: &lt;b&gt;cut&lt;/b&gt;"));
  EXPECT_THAT(index, HasSubstr("<a href=\"a.html\">a.osa</a>"));
  EXPECT_THAT(index, HasSubstr("data-value=\"2500000\">2.5 MB"));
  EXPECT_THAT(index, HasSubstr("2 of 3 atlases are sound"));
}

TEST(ReportIndex, TellsTheUnitOfEachRow) {
  const std::vector<AtlasReport> reports{
      ReportOn(SynthesizeAtlas({.keyframes = 6, .points = 200}), "mono.osa"),
      ReportOn(SynthesizeAtlas({.sensor = Sensor::kRgbd, .keyframes = 6, .points = 200}), "d.osa")};
  const std::string index = ReportIndex(reports, "maps");
  const std::size_t second = index.find("d.osa");
  EXPECT_THAT(index.substr(0, second), HasSubstr(" units</td>"));
  EXPECT_THAT(index.substr(second), HasSubstr(" m</td>"));
}

// The style shows the one that suits the page.
TEST(ReportIndex, HasThumbnailsForLightAndDarkPages) {
  const std::string index =
      ReportIndex(std::vector{ReportOn(SynthesizeAtlas({.keyframes = 6, .points = 200}), "a.osa")}, "maps");
  EXPECT_EQ(CountOf(index, "class=\"light\" src=\"data:image/png;base64,"), CanPlot() ? 1U : 0U);
  EXPECT_EQ(CountOf(index, "class=\"dark\" src=\"data:image/png;base64,"), CanPlot() ? 1U : 0U);
}

// A browser runs the script only when its hash is that of the policy.
TEST(ReportIndex, AllowsItsOwnScriptAndStyle) {
  const std::string index = ReportIndex({}, "none");
  for (const char* tag : {"script", "style"}) {
    const std::string open = std::string("<") + tag + ">", close = std::string("</") + tag + ">";
    const std::size_t begin = index.find(open) + open.size();
    EXPECT_THAT(index, HasSubstr(detail::PolicySource(index.substr(begin, index.find(close) - begin))));
  }
}

TEST(ReportJson, HoldsWhatTheIndexHolds) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 200});
  std::vector<AtlasReport> reports{ReportOn(atlas, "a.osa")};
  reports[0].page = "a.html";
  reports.emplace_back().checked = {.name = "b.osa", .failure = "gone"};
  const auto json = nlohmann::json::parse(ToJson(reports, "out"));
  EXPECT_EQ(json.at("report"), "slamdb-report-2");
  EXPECT_EQ(json.at("output"), "out");
  EXPECT_EQ(json.at("inputs").at(0).at("keyframes"), 6);
  EXPECT_EQ(json.at("inputs").at(0).at("sound"), true);
  EXPECT_EQ(json.at("inputs").at(1).at("failure"), "gone");
  EXPECT_TRUE(json.at("inputs").at(1).at("page").is_null());
}

TEST(Reports, AreTheSameForTheSameAtlas) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 200});
  EXPECT_EQ(ReportPage(atlas, ReportOn(atlas, "a", {.threads = 1}), {.threads = 1}),
            ReportPage(atlas, ReportOn(atlas, "a"), {.threads = 3}));
}

}  // namespace
}  // namespace slamdb::testing
