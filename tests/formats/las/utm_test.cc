// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/las/detail/utm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slamdb::detail {
namespace {

int ZoneAt(double latitude, double longitude) { return UtmZoneOf({latitude, longitude, 0}).value().number; }

TEST(Utm, HasSixtyZones) {
  EXPECT_EQ(ZoneAt(48.15, 11.57), 32);
  EXPECT_EQ(ZoneAt(0, -180), 1);
  EXPECT_EQ(ZoneAt(0, 180), 1);
  EXPECT_EQ(ZoneAt(0, 179.999999), 60);
  EXPECT_EQ(ZoneAt(0, -0.000001), 30);
  EXPECT_EQ(ZoneAt(0, 0), 31);
  EXPECT_EQ(ZoneAt(0, 5.999999), 31);
  EXPECT_EQ(ZoneAt(0, 6), 32);
  EXPECT_EQ(ZoneAt(0, 366), 32);
}

TEST(Utm, HasOtherZonesAroundNorway) {
  EXPECT_EQ(ZoneAt(60.39, 5.32), 32) << "Bergen";
  EXPECT_EQ(ZoneAt(56, 3), 32);
  EXPECT_EQ(ZoneAt(55.999999, 3), 31);
  EXPECT_EQ(ZoneAt(60, 2.999999), 31);
  EXPECT_EQ(ZoneAt(64, 5), 31);
  EXPECT_EQ(ZoneAt(78.22, 15.65), 33) << "Longyearbyen";
  EXPECT_EQ(ZoneAt(78, 8.999999), 31);
  EXPECT_EQ(ZoneAt(78, 21), 35);
  EXPECT_EQ(ZoneAt(78, 33), 37);
  EXPECT_EQ(ZoneAt(84, 41.999999), 37);
  EXPECT_EQ(ZoneAt(78, 42), 38);
  EXPECT_EQ(ZoneAt(71.999999, 8), 32);
}

TEST(Utm, HasNoZonesAtThePoles) {
  EXPECT_TRUE(UtmZoneOf({84, 0, 0}));
  EXPECT_FALSE(UtmZoneOf({84.000001, 0, 0}));
  EXPECT_TRUE(UtmZoneOf({-80, 0, 0}));
  EXPECT_FALSE(UtmZoneOf({-80.000001, 0, 0}));
  EXPECT_FALSE(UtmZoneOf({std::nan(""), 0, 0}));
}

TEST(Utm, HasCodesOfEpsg) {
  EXPECT_EQ(UtmZoneOf({48, 11, 0})->epsg(), 32632);
  EXPECT_EQ(UtmZoneOf({-34, 151, 0})->epsg(), 32756);
  EXPECT_EQ(UtmZoneOf({0, 11, 0})->epsg(), 32632);
  EXPECT_EQ(UtmZoneOf({-1e-9, 11, 0})->epsg(), 32732);
}

struct Known {
  const char* name;
  double latitude, longitude, easting, northing;
};

// As PROJ 9.1.1's `utm` has them, which is another series; Baghdad is the example of GeographicLib's manual, the tower
// that of Wikipedia's page about the grid.
TEST(Utm, IsWherePublishedPlacesAre) {
  constexpr Known kPlaces[] = {
      {"Munich", 48.1372, 11.5756, 691611.21553, 5334758.05284},
      {"Baghdad", 33.3, 44.4, 444140.54492, 3684706.35555},
      {"Toronto, CN Tower", 43.6425667, -79.3871389, 630084.30955, 4833438.55251},
      {"Sydney Opera House", -33.8567844, 151.2152967, 334900.23431, 6252290.47757},
      {"Ushuaia", -54.8019, -68.3029, 544811.52562, 3927029.82079},
      {"Bergen in zone 32", 60.3929, 5.3241, 297473.99485, 6700820.20388},
      {"Longyearbyen", 78.2232, 15.6267, 514278.71511, 8683355.46947},
      {"the edge of a zone at the equator", 0, 6, 166021.44308, 0.00000},
      {"McMurdo's parallel", -77.85, 166.67, 539232.45178, 1357811.41331},
      {"Quito, south", -0.1807, -78.4678, 781861.45746, 9980007.56689},
      {"Fiji, by the antimeridian", -17.7134, 178.065, 612929.75126, 8041202.94304},
  };
  for (const auto& [name, latitude, longitude, easting, northing] : kPlaces) {
    const Geodetic place{latitude, longitude, 12.5};
    const Eigen::Vector3d found = UtmFromGeodetic(UtmZoneOf(place).value(), place);
    EXPECT_NEAR(found.x(), easting, 1e-4) << name;
    EXPECT_NEAR(found.y(), northing, 1e-4) << name;
    EXPECT_EQ(found.z(), 12.5) << name;
  }
}

// On the middle of a zone the northing is the way along the meridian, shortened; here by a sum over thin slices.
TEST(Utm, MeasuresTheMeridian) {
  constexpr double kRadius = 6378137, kFlattening = 1 / 298.257223563;
  constexpr double kSquare = kFlattening * (2 - kFlattening);
  constexpr int kSlices = 200'000;
  for (const double latitude : {-80.0, -33.5, 12.0, 45.0, 84.0}) {
    const double step = latitude * std::numbers::pi / 180 / kSlices;
    double length = 0;
    for (int slice = 0; slice < kSlices; ++slice) {
      const double sine = std::sin((slice + 0.5) * step);
      length += kRadius * (1 - kSquare) / std::pow(1 - kSquare * sine * sine, 1.5) * step;
    }
    const UtmZone zone{33, latitude >= 0};
    const Eigen::Vector3d found = UtmFromGeodetic(zone, {latitude, 15, 0});
    EXPECT_NEAR(found.x(), 500'000, 1e-6);
    EXPECT_NEAR(found.y(), 0.9996 * length + (zone.north ? 0 : 10'000'000), 1e-4) << latitude;
  }
}

TEST(Utm, GoesOnBesideItsZone) {
  const UtmZone zone{32, true};
  const Eigen::Vector3d west = UtmFromGeodetic(zone, {50, 5.9, 0}), east = UtmFromGeodetic(zone, {50, 12.1, 0});
  EXPECT_NEAR(west.x() - 500'000, 500'000 - east.x(), 1e-6) << "the same on both sides of the middle";
  EXPECT_NEAR(west.y(), east.y(), 1e-6);
  const Eigen::Vector3d across = UtmFromGeodetic({1, true}, {10, 179.9, 0});
  EXPECT_NEAR(across.x(), UtmFromGeodetic({1, true}, {10, -180.1, 0}).x(), 1e-6) << "across the antimeridian";
}

}  // namespace
}  // namespace slamdb::detail
