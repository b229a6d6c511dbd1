// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/geographic/detail/geographic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "slamdb/base/error.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/geographic/options.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"

namespace slamdb {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

WriteOptions At(double latitude, double longitude, std::size_t most_points = 10) {
  return WriteOptions{}.With(
      GeographicOptions{.origin = Geodetic{latitude, longitude, 100}, .most_points = most_points});
}

json Features(const Atlas& atlas, const WriteOptions& options) {
  return json::parse(Encoded(detail::kGeojsonFormat, atlas, options))["features"];
}

TEST(Geographic, NeedsAnOrigin) {
  for (const Format* format : {&detail::kKmlFormat, &detail::kGeojsonFormat}) try {
      static_cast<void>(Encoded(*format, SmallAtlas()));
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
      EXPECT_THAT(error.problem(), HasSubstr("GeographicOptions::origin, which georeferencing finds"));
    }
}

// A metre east at the equator is 180 / pi / 6378137 degrees; keyframe 3 is there.
TEST(Geojson, PlacesAreEastNorthUpOfTheOrigin) {
  const json features = Features(OneMapAtlas(), At(0, 10));
  ASSERT_EQ(features.size(), 1U + 2 + 2);
  EXPECT_EQ(features[0]["geometry"],
            json::parse(R"({"type":"LineString","coordinates":[[10,0,100],[10.000008983,0,100]]})"));
  EXPECT_EQ(features[0]["properties"], json::parse(R"({"kind":"trajectory","map":0,"stroke":"#3f90da",
                            "coordTimes":["1970-01-01T00:00:00.5Z","1970-01-01T00:00:01.5Z"]})"));
  EXPECT_EQ(features[2]["properties"],
            json::parse(R"({"kind":"keyframe","map":0,"id":3,"timestamp":1.5,"time":"1970-01-01T00:00:01.5Z"})"));
  EXPECT_EQ(features[3]["geometry"]["coordinates"], json({10, 0, 102}));
  EXPECT_EQ(features[3]["properties"],
            json::parse(R"({"kind":"point","map":0,"id":10,"observations":2,"reprojection_error":2.5})"));
  EXPECT_FALSE(features[4]["properties"].contains("reprojection_error"));
}

TEST(Geojson, LinesAreCutAtTheAntimeridian) {
  const double metre = 180 / 3.14159265358979 / 6378137;
  const json features = Features(OneMapAtlas(), At(0, 180 - metre / 4));
  const json& geometry = features[0]["geometry"];
  EXPECT_EQ(geometry["type"], "MultiLineString");
  EXPECT_EQ(geometry["coordinates"][0].back()[0], 180);
  EXPECT_EQ(geometry["coordinates"][1].front()[0], -180);
  EXPECT_NEAR(geometry["coordinates"][1].back()[0], -180 + 0.75 * metre, 1e-9);
  EXPECT_EQ(features[0]["properties"]["coordTimes"][0].back(), features[0]["properties"]["coordTimes"][1].front());
  EXPECT_THAT(std::string(features[0]["properties"]["coordTimes"][1].front()), HasSubstr("1970-01-01T00:00:00.7"));
}

TEST(Geojson, PointsAreThinnedEvenly) {
  Atlas atlas = OneMapAtlas();
  MapPoint point = atlas.maps[0].points[0];
  atlas.maps[0].points.clear();
  for (std::uint64_t id = 0; id < 100; ++id) {
    point.id = MapPointId(id);
    atlas.maps[0].points.push_back(point);
  }
  Notices notices;
  const json features = json::parse(Encoded(detail::kGeojsonFormat, atlas, At(0, 0, 4), notices))["features"];
  std::vector<int> ids;
  for (const json& feature : features)
    if (feature["properties"]["kind"] == "point") ids.push_back(feature["properties"]["id"]);
  EXPECT_EQ(ids, (std::vector<int>{0, 25, 50, 75}));
  EXPECT_EQ(notices.written(), "2 poses; 100 points, of which 4 are written");
  EXPECT_EQ(Features(atlas, At(0, 0, 0)).size(), 3U);
}

TEST(Geojson, IsValidWhateverTheAtlasHolds) {
  EXPECT_TRUE(Features({}, At(0, 0)).empty());
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].id = MapId();
  atlas.maps[0].points[0].id = MapPointId(~std::uint64_t{1});
  atlas.maps[0].points[2].position.z() = std::numeric_limits<float>::quiet_NaN();
  atlas.maps[0].keyframes[1].timestamp = 1e18;  // no date
  const json features = Features(atlas, At(0, 0));
  ASSERT_EQ(features.size(), 4U);
  EXPECT_FALSE(features[0]["properties"].contains("coordTimes"));
  EXPECT_EQ(features[0]["properties"]["map"], nullptr);
  EXPECT_FALSE(features[2]["properties"].contains("time"));
  EXPECT_EQ(features[3]["properties"]["id"], "18446744073709551614");
}

TEST(Kml, HasATrackWithTimes) {
  const std::string text = Encoded(detail::kKmlFormat, OneMapAtlas(), At(0, 10));
  EXPECT_THAT(text, HasSubstr("<gx:Track>\n<altitudeMode>absolute</altitudeMode>\n"
                              "<when>1970-01-01T00:00:00.5Z</when>\n<when>1970-01-01T00:00:01.5Z</when>\n"
                              "<gx:coord>10.000000000 0.000000000 100.0000</gx:coord>\n"
                              "<gx:coord>10.000008983 0.000000000 100.0000</gx:coord>\n</gx:Track>"));
  EXPECT_THAT(text, HasSubstr("<Placemark><name>kf 3</name><TimeStamp><when>1970-01-01T00:00:01.5Z</when></TimeStamp>"
                              "<styleUrl>#map-0</styleUrl>"));
  EXPECT_THAT(text, HasSubstr("<coordinates>10.000000000,0.000000000,102.0000</coordinates></Point>\n"));
  EXPECT_THAT(text, HasSubstr("<Style id=\"map-0\"><IconStyle><color>ffda903f</color>")) << "#3f90da as aabbggrr";
}

// Also where none is left.
TEST(Kml, NamesPointsThatAreNowhere) {
  Atlas atlas = OneMapAtlas();
  for (MapPoint& point : atlas.maps[0].points) point.position.x() = std::nanf("");
  Notices notices;
  Encoded(detail::kKmlFormat, atlas, At(48, 11), notices);
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_THAT(notices.items()[0].text, HasSubstr("the position is not finite: 2 points"));
}

TEST(Kml, WithoutTimesAPathIsALine) {
  Atlas atlas = OneMapAtlas();
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) keyframe.timestamp = 0;
  const std::string text = Encoded(detail::kKmlFormat, atlas, At(0, 10));
  EXPECT_THAT(text, HasSubstr("<LineString>\n<altitudeMode>absolute</altitudeMode>\n<coordinates>\n10.000000000,"));
  EXPECT_THAT(text, Not(HasSubstr("gx:Track>")));
}

TEST(Kml, HasTheMapsOneByOne) {
  const std::string text = Encoded(detail::kKmlFormat, SmallAtlas(), At(48, 11));
  EXPECT_THAT(text, HasSubstr("<name>map 0 points</name>"));
  EXPECT_THAT(text, HasSubstr("</MultiGeometry>\n</Placemark>\n<Placemark>\n<name>map 1 points</name>"));
  const std::string one = Encoded(detail::kKmlFormat, SmallAtlas(), At(48, 11).With(ExportOptions{.map = MapId(1)}));
  EXPECT_THAT(one, Not(HasSubstr("map 0")));
}

}  // namespace
}  // namespace slamdb
