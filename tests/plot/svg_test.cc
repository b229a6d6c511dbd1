// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/detail/svg.h"

#include <gmock/gmock.h>

#include "tests/plot/xml.h"

namespace slamdb::plot {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kCairos =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg width=\"10px\" version=\"1.1\">\n<defs>\n<g>\n"
    "<symbol overflow=\"visible\" id=\"glyph7-1\">\n<path style=\"stroke:none;\" d=\"M 1.23456 2 Z M 1.23456 2 \"/>\n"
    "</symbol>\n</g>\n<clipPath id=\"clip9\">\n</clipPath>\n</defs>\n<g id=\"surface81\">\n"
    "<use xlink:href=\"#glyph7-1\" x=\"10.126\" y=\"3\"/>\n<g clip-path=\"url(#clip9)\" clip-rule=\"nonzero\">\n</g>\n"
    "</g>\n</svg>\n";

TEST(TidySvg, CountsIdsFromNothing) {
  const std::string svg = TidySvg(kCairos, "plan", "t", "");
  EXPECT_THAT(svg, HasSubstr("id=\"plan0\""));
  EXPECT_THAT(svg, HasSubstr("xlink:href=\"#plan0\""));
  EXPECT_THAT(svg, HasSubstr("<clipPath id=\"plan1\">"));
  EXPECT_THAT(svg, HasSubstr("clip-path=\"url(#plan1)\""));
  EXPECT_THAT(svg, HasSubstr("<g id=\"plan2\">"));
}

TEST(TidySvg, MakesAttributesOfStylesAndRoundsNumbers) {
  const std::string svg = TidySvg(kCairos, "plan", "t", "");
  EXPECT_THAT(svg, HasSubstr("<path stroke=\"none\" d=\"M 1.23 2 Z\"/>"));
  EXPECT_THAT(svg, HasSubstr("x=\"10.13\" y=\"3\""));
  EXPECT_THAT(svg, HasSubstr("version=\"1.1\""));
  EXPECT_THAT(svg, Not(HasSubstr("style=")));
}

TEST(TidySvg, NamesThePictureWithoutLettingTheNameBeMarkup) {
  const std::string svg = TidySvg(kCairos, "a", "</title><script>alert(1)</script>", "\"&'\x01");
  EXPECT_THAT(svg, HasSubstr("<title>&lt;/title&gt;&lt;script&gt;alert(1)&lt;/script&gt;</title>"));
  EXPECT_THAT(svg, HasSubstr("<desc>&quot;&amp;&#39;\\x01</desc>"));
  EXPECT_EQ(slamdb::testing::ProblemOfXml(svg), "");
}

TEST(Xml, IsToldFromWhatIsNone) {
  const std::string begin = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  EXPECT_EQ(slamdb::testing::ProblemOfXml(begin + "<a b=\"1\"><c/>x &amp; y</a>\n"), "");
  for (const char* bad : {"<a>", "<a></b>", "<a b=1/>", "<a>&nbsp;</a>", "<a/><b/>", "<a b=\"<\"/>", "<a>\x01</a>", ""})
    EXPECT_NE(slamdb::testing::ProblemOfXml(begin + bad), "") << bad;
}

}  // namespace
}  // namespace slamdb::plot
