// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/georeference.h"

#include <gmock/gmock.h>

#include <cmath>

#include "slamdb/base/error.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

constexpr double kSemiMajor = 6378137.0, kSemiMinor = 6356752.314245;

std::string MessageOf(std::string_view csv) {
  try {
    static_cast<void>(ParseFixes(csv));
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// On the axes the ellipsoid's radii are the answer; the others follow from the prime vertical's radius of curvature.
TEST(Georeference, KnownEarthCentredCoordinates) {
  const auto expect = [](const Geodetic& place, const Eigen::Vector3d& ecef, double tolerance) {
    EXPECT_LT((EcefFromGeodetic(place) - ecef).norm(), tolerance) << EcefFromGeodetic(place).transpose();
  };
  expect({0, 0, 0}, {kSemiMajor, 0, 0}, 1e-6);
  expect({0, 90, 10}, {0, kSemiMajor + 10, 0}, 1e-6);
  expect({90, 0, 0}, {0, 0, kSemiMinor}, 1e-6);
  expect({-90, 33, 5}, {0, 0, -kSemiMinor - 5}, 1e-6);
  // At 45 degrees: N = a / sqrt(1 - e^2 / 2) = 6388838.290121 m, (N (1 - e^2)) sin 45 = 4487348.408866 m.
  expect({45, 0, 0}, {4517590.878849, 0, 4487348.408866}, 1e-5);
}

TEST(Georeference, EarthCentredAndBack) {
  for (const double latitude : {-90.0, -89.999, -33.9, 0.0, 1e-9, 47.4, 89.9999})
    for (const double longitude : {-179.9, -12.3, 0.0, 8.5})
      for (const double altitude : {-400.0, 0.0, 8848.0, 4e5}) {
        const Geodetic place{latitude, longitude, altitude};
        const Geodetic again = GeodeticFromEcef(EcefFromGeodetic(place));
        EXPECT_NEAR(again.latitude, latitude, 1e-11);
        EXPECT_NEAR(again.altitude, altitude, 1e-6);
        if (std::abs(latitude) < 90) {
          EXPECT_NEAR(again.longitude, longitude, 1e-9);
        }
      }
}

TEST(Georeference, LocalFrameHasEastNorthAndUp) {
  const LocalFrame frame({47.3769, 8.5417, 408});
  EXPECT_LT(frame.FromGeodetic(frame.origin()).norm(), 1e-9);
  EXPECT_LT((frame.FromGeodetic({47.3769, 8.5417, 418}) - Eigen::Vector3d(0, 0, 10)).norm(), 1e-6);
  // A second of arc: along the meridian its radius of curvature M, along the parallel N cos(latitude).
  const double e2 = 1 - std::pow(kSemiMinor / kSemiMajor, 2), sine = std::sin(47.3769 * M_PI / 180);
  const double n = kSemiMajor / std::sqrt(1 - e2 * sine * sine);
  const double m = kSemiMajor * (1 - e2) / std::pow(1 - e2 * sine * sine, 1.5);
  const double second = M_PI / 180 / 3600;
  const Eigen::Vector3d north = frame.FromGeodetic({47.3769 + 1.0 / 3600, 8.5417, 408});
  const Eigen::Vector3d east = frame.FromGeodetic({47.3769, 8.5417 + 1.0 / 3600, 408});
  EXPECT_LT((north - Eigen::Vector3d(0, (m + 408) * second, 0)).norm(), 1e-3);
  EXPECT_LT((east - Eigen::Vector3d((n + 408) * std::cos(47.3769 * M_PI / 180) * second, 0, 0)).norm(), 1e-3);
}

TEST(Georeference, LocalFrameAndBack) {
  const LocalFrame frame({-33.8568, 151.2153, 20});
  const Geodetic place{-33.87, 151.2, 60};
  const Geodetic again = frame.ToGeodetic(frame.FromGeodetic(place));
  EXPECT_NEAR(again.latitude, place.latitude, 1e-11);
  EXPECT_NEAR(again.longitude, place.longitude, 1e-11);
  EXPECT_NEAR(again.altitude, place.altitude, 1e-6);
  EXPECT_THROW(LocalFrame({91, 0, 0}), Error);
  EXPECT_THROW(LocalFrame({NAN, 0, 0}), Error);
}

TEST(ParseFixes, ColumnsByPlaceOrByName) {
  const GpsFix expected{1.5, {47, 8, 400}};
  for (const char* csv :
       {"1.5,47,8,400\n", "1.5; 47; 8; 400", "# a comment\r\n\r\n1.5\t47\t8\t400\r\n",
        "timestamp,latitude,longitude,altitude\n1.5,47,8,400\n",
        "#time [s],lat [deg],lon [deg],alt [m]\n1.5,47,8,400\n", "fix,Alt,Lng,Lat,extra,\"Time\"\n3,400,8,47,x,1.5\n",
        "\xef\xbb\xbftimestamp;latitude;longitude;altitude\r\n+1.5;+47;+8;+400",
        "Time Latitude Longitude Altitude\n1.5  47  8  400\n", "%time,lat,lon,alt\n1.5,47,8,400\n",
        "lat_std,lat,long_std,long,ele_m,time_since_start,time\n9,47,9,8,400,9,1.5\n",
        "time,Lat_WGS84,Lon_WGS84,Alt_WGS84\n1.5,47,8,400\n"}) {
    const std::vector<GpsFix> fixes = ParseFixes(csv);
    ASSERT_EQ(fixes.size(), 1U) << csv;
    EXPECT_EQ(fixes[0].timestamp, expected.timestamp) << csv;
    EXPECT_EQ(fixes[0].place, expected.place) << csv;
  }
  EXPECT_TRUE(ParseFixes("").empty());
}

TEST(ParseFixes, NamesTheLineThatIsNone) {
  EXPECT_THAT(MessageOf("1,47,8,400\n2,47,8\n"), HasSubstr("line 2: expected time, latitude"));
  EXPECT_THAT(MessageOf("1,91,8,400\n"), HasSubstr("line 1"));
  EXPECT_THAT(MessageOf("1,nan,8,400\n"), HasSubstr("line 1"));
  EXPECT_THAT(MessageOf("when,where\n"), HasSubstr("found `when,where`"));
  EXPECT_THAT(MessageOf("time,lat,lon,alt\n1,47,x,400\n"),
              HasSubstr("line 2: expected a number, found 'x' in column longitude"));
  EXPECT_THAT(MessageOf("time,lat,lat,lon,alt\n1,47,47,8,400\n"), HasSubstr("columns 2 and 3 are both named latitude"));
  EXPECT_THAT(MessageOf("time,lat,lon,alt\n1,47,8\n"), HasSubstr("line 2: expected 4 cells, found 3"));
}

TEST(ReadFixes, NamesTheFile) {
  const TemporaryFolder folder;
  const std::string path = folder.Make("fixes.csv", "1.5,47,8,400\n2,x,8,400\n");
  const auto error_of = [](const std::string& file) {
    try {
      static_cast<void>(ReadFixes(file));
    } catch (const Error& error) {
      return error;
    }
    return Error(ErrorKind::kInternal, "no error");
  };
  EXPECT_EQ(error_of(path).path(), path);
  EXPECT_EQ(error_of(path).place(), "line 2");
  EXPECT_EQ(error_of(path).kind(), ErrorKind::kDamaged);
  EXPECT_THAT(error_of(folder.Make("empty.csv", "time,lat,lon,alt\n")).problem(), HasSubstr("no fix"));
  EXPECT_EQ(error_of(folder.Path("missing.csv")).kind(), ErrorKind::kNotFound);
  EXPECT_EQ(ReadFixes(folder.Make("good.csv", "1.5,47,8,400\n")).size(), 1U);
}

TEST(ParseGeodetic, TwoOrThreeNumbers) {
  EXPECT_EQ(ParseGeodetic("47.5,8.25"), (Geodetic{47.5, 8.25, 0}));
  EXPECT_EQ(ParseGeodetic("-47.5, 8.25, -3"), (Geodetic{-47.5, 8.25, -3}));
  EXPECT_EQ(ParseGeodetic("+47.5; +8.25; +3"), (Geodetic{47.5, 8.25, 3}));
  for (const char* text : {"", "47", "47,8,1,2", "95,8", "x,8", "47,8,", "47;8,1"}) {
    try {
      static_cast<void>(ParseGeodetic(text));
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage) << text;
    }
  }
}

}  // namespace
}  // namespace slamdb
