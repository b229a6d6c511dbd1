// SPDX-License-Identifier: BSD-3-Clause
// GPS fixes as receivers, loggers and ROS write them.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/georeference.h"
#include "tests/support/dialects.h"
#include "tests/support/message_of.h"

namespace slamdb {
namespace {

using detail::Concat;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// Two fixes: at 1700000000.25 s 47.5 N 8.25 E, 400 m, and at 1700000001.25 s 47.25 S 8.5 W, 300 m.
const std::vector<NamedTable>& Tables() {
  static const std::vector<NamedTable> tables = {
      {"plain",
       {"timestamp", "latitude", "longitude", "altitude"},
       {{"1700000000.25", "47.5", "8.25", "400"}, {"1700000001.25", "-47.25", "-8.5", "300"}}},
      {"units",
       {"timestamp_ns", "longitude [deg]", "latitude [deg]", "altitude [cm]"},
       {{"1700000000250000000", "8.25", "47.5", "40000"}, {"1700000001250000000", "-8.5", "-47.25", "30000"}}},
      {"feet",
       {"t(ms)", "lat", "lon", "altitude_ft"},
       {{"1700000000250", "47.5", "8.25", "1312.3359580052493"},
        {"1700000001250", "-47.25", "-8.5", "984.251968503937"}}},
      {"e7",
       {"time_us", "lat_e7", "lon_e7", "alt_mm"},
       {{"1700000000250000", "475000000", "82500000", "400000"},
        {"1700000001250000", "-472500000", "-85000000", "300000"}}},
      {"navsatfix",
       {"%time", "field.header.seq", "field.header.stamp", "field.header.frame_id", "field.status.status",
        "field.latitude", "field.longitude", "field.altitude", "field.position_covariance0"},
       {{"1700000000950000000", "0", "1700000000250000000", "gps", "0", "47.5", "8.25", "400", "1"},
        {"1700000000970000000", "0", "1700000000500000000", "gps", "-1", "47.5", "8.25", "400", "1"},
        {"1700000001950000000", "1", "1700000001250000000", "gps", "0", "-47.25", "-8.5", "300", "1"}}},
      {"ros2",
       {"header.stamp.sec", "header.stamp.nanosec", "status.status", "latitude", "longitude", "altitude"},
       {{"1700000000", "250000000", "0", "47.5", "8.25", "400"},
        {"1700000001", "250000000", "0", "-47.25", "-8.5", "300"}}},
      {"logger",
       {"time_since_start", "lat_std", "Time", "Lat", "Lon", "lon_std", "Elevation", "fix_quality"},
       {{"0", "9", "2023-11-14T22:13:20.25Z", "47.5", "8.25", "9", "400", "1"},
        {"0", "9", "2023-11-14T22:13:21.00Z", "0", "0", "9", "0", "0"},
        {"1", "9", "2023-11-14T22:13:21.25Z", "-47.25", "-8.5", "9", "300", "4"}}},
      {"hemispheres",
       {"time", "lat", "n/s", "lon", "e/w", "alt"},
       {{"1700000000.25", "4730.0000", "N", "00815.0000", "E", "400"},
        {"1700000001.25", "4715.0000", "S", "00830.0000", "W", "300"}},
       /*plus_signs=*/false},
      {"letters",
       {"time", "lat", "lon", "alt"},
       {{"1700000000.25", "47.5N", "8.25E", "400"}, {"1700000001.25", "47.25 S", "8.5 W", "300"}}},
  };
  return tables;
}

void ExpectFixes(std::vector<GpsFix> fixes, const std::string& text) {
  std::erase_if(fixes, [](const GpsFix& fix) { return !fix.has_place(); });
  ASSERT_EQ(fixes.size(), 2U) << text;
  const GpsFix expected[] = {{1700000000.25, {47.5, 8.25, 400}}, {1700000001.25, {-47.25, -8.5, 300}}};
  for (int i = 0; i < 2; ++i) {
    const GpsFix& fix = fixes[static_cast<std::size_t>(i)];
    EXPECT_EQ(fix.timestamp, expected[i].timestamp) << text;
    EXPECT_NEAR(fix.place.latitude, expected[i].place.latitude, 1e-12) << text;
    EXPECT_NEAR(fix.place.longitude, expected[i].place.longitude, 1e-12) << text;
    EXPECT_NEAR(fix.place.altitude, expected[i].place.altitude, 1e-9) << text;
  }
}

class EveryTable : public ::testing::TestWithParam<NamedTable> {};
INSTANTIATE_TEST_SUITE_P(Fixes, EveryTable, ::testing::ValuesIn(Tables()),
                         [](const auto& table) { return std::string(table.param.name); });

TEST_P(EveryTable, IsReadInEveryDialect) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 300; ++round) {
    const std::string text = InSomeDialect(GetParam(), random);
    ExpectFixes(ParseFixes(text), text);
  }
}

std::string Failure(std::string_view text) {
  return MessageOf([text] { static_cast<void>(ParseFixes(text)); });
}

std::string Notes(std::string_view text) {
  Notices notices;
  static_cast<void>(ParseFixes(text, {}, &notices));
  return TextOf(notices);
}

TEST(Fixes, RowsWithoutAFixAreCountedAndNamed) {
  const std::string text =
      "time,lat,lon,alt,status\n1,47,8,400,0\n2,0,0,0,0\n3,nan,nan,nan,0\n4,,,,0\n5,47,8,400,-1\n6,153,8,400,0\n7,47,8,"
      "400,0\n";
  EXPECT_THAT(
      Notes(text),
      AllOf(HasSubstr("no fix: 5 rows of 7"), HasSubstr("latitude 0 and longitude 0 (1 row, first in line 3)"),
            HasSubstr("not a number (1 row, first in line 4)"), HasSubstr("no latitude (1 row, first in line 5)"),
            HasSubstr("status -1 (1 row, first in line 6)"), HasSubstr("latitude 153 is outside -90 to 90")));
  const std::vector<GpsFix> fixes = ParseFixes(text);
  EXPECT_EQ(std::ranges::count_if(fixes, &GpsFix::has_place), 2);
  EXPECT_EQ(fixes.size(), 7U);  // what was lost at a time stays known
  EXPECT_THAT(
      Failure("time,lat,lon,alt\n1,153,47,400\n2,153.5,47,400\n"),
      HasSubstr("line 2: no row has a fix: latitude 153 is outside -90 to 90; are latitude and longitude swapped?"));
  EXPECT_THAT(Failure("time,lat,lon,alt\n1,4730.5,815.2,400\n"), HasSubstr("ddmm.mmmm"));
}

// What receivers and loggers call it when there is no fix.
TEST(Fixes, NoFixIsToldInManyWays) {
  const std::pair<const char*, const char*> columns[] = {
      {"fix", "0"},         {"gps_fix_type", "1"}, {"fix_type", "0"}, {"mode", "1"},       {"mode", "0"},
      {"valid", "False"},   {"valid", "0"},        {"num_sats", "0"}, {"status", "V"},     {"status", "-1"},
      {"gps_qual", "0"},    {"has_fix", "false"},  {"fix", "none"},   {"satellites", "0"}, {"fix", "No Fix"},
      {"fix_quality", "0"}, {"Valid", "N"}};
  for (const auto& [name, value] : columns) {
    const std::string text = Concat("time,lat,lon,alt,", name, "\n1,47,8,400,4\n2,12,33,9,", value, "\n3,47,8,400,A\n");
    EXPECT_THAT(Notes(text),
                AllOf(HasSubstr("no fix: 1 row of 3"), HasSubstr(Concat(' ', value, " (1 row, first in line 3)"))))
        << text;
  }
}

TEST(Fixes, HeightsAboveTheEllipsoidWin) {
  for (const char* name :
       {"altitude_ellipsoid_m", "alt_ellipsoid", "ellipsoidal_height", "height_above_ellipsoid", "alt_hae"})
    for (const char* other : {"altitude_msl_m", "alt", "altitude", "hMSL"}) {
      const std::string text = Concat("time,lat,lon,", other, ',', name, "\n1,47,8,350,400\n");
      EXPECT_EQ(ParseFixes(text).at(0).place.altitude, 400) << text;
      EXPECT_THAT(Notes(text), HasSubstr(Concat("those of the column ", name, ", not of "))) << text;
    }
  EXPECT_THAT(Notes("time,lat,lon,height\n1,47,8,400\n"), IsEmpty());
}

TEST(Fixes, AltitudesBesideWholeDegreesAreMillimetres) {
  const std::string text = "time,lat,lon,alt\n1,470000000,80000000,400000\n2,470000000,80000000,400500\n";
  EXPECT_EQ(ParseFixes(text).at(1).place.altitude, 400.5);
  EXPECT_THAT(Notes(text), HasSubstr("altitudes are taken as millimetres"));
  EXPECT_EQ(ParseFixes("time,lat_e7,lon_e7,alt\n1,470000000,80000000,400000\n").at(0).place.altitude, 400);
  EXPECT_EQ(ParseFixes("time,lat,lon,alt\n1,470000000,80000000,400.5\n").at(0).place.altitude, 400.5);
  EXPECT_EQ(ParseFixes("time,lat,lon,alt [m]\n1,470000000,80000000,400\n").at(0).place.altitude, 400);
  EXPECT_THAT(Failure("time,lat,lon,alt\n1,470000000,80000000,400\n"),
              HasSubstr("may be metres, the first 400 m, or millimetres, the first 0.4 m"));
}

TEST(Fixes, AltitudesBeyondAirlinersNeedAUnit) {
  EXPECT_THAT(Failure("time,lat,lon,alt\n1,47,8,400000\n2,47,8,401000\n"),
              HasSubstr("line 2: the altitudes may be metres, the first 400000 m, or millimetres, the first 400 m"));
  EXPECT_THAT(Failure("1,47,8,400000\n2,47,8,401000\n"), HasSubstr("line 1: the altitudes may be"));
  EXPECT_THAT(Failure("400,8.5,1700000000,47\n401,8.5,1700000001,47\n"), HasSubstr("longitude 1.7e+09 is outside"));
  EXPECT_EQ(ParseFixes("time,lat,lon,alt [m]\n1,47,8,30000\n").at(0).place.altitude, 30000);
  EXPECT_EQ(ParseFixes("time,lat,lon,alt\n1,47,8,11000\n2,47,8,13000\n").at(1).place.altitude, 13000);
}

TEST(Fixes, UnitsAreNeverAssumed) {
  EXPECT_THAT(Failure("time,lat,lon,altitude [furlong]\n1,47,8,400\n"), HasSubstr("found the unit 'furlong'"));
  EXPECT_THAT(Failure("time,lat [gon],lon [gon],alt\n1,47,8,400\n"), HasSubstr("found the unit 'gon'"));
  EXPECT_THAT(Failure("time,lat,lon,alt\n1,0.82,0.14,400\n"), HasSubstr("may be radians, or degrees"));
  const auto radians = ParseFixes("time,lat [rad],lon_rad,alt\n1,0.82030474843733492,0.13962634015954636,400\n");
  EXPECT_NEAR(radians.at(0).place.latitude, 47, 1e-12);
  EXPECT_NEAR(radians.at(0).place.longitude, 8, 1e-12);
  EXPECT_THAT(Notes("time,lat,lon,alt\n1,470000000,80000000,400000\n"), HasSubstr("1e-7 degrees"));
  EXPECT_THAT(Failure("time,lat,lon,alt\n1,47500000,8700000,400\n"),
              AllOf(HasSubstr("1e-6 degrees (47.5, 8.7)"), HasSubstr("1e-7 degrees (4.75, 0.87)"), HasSubstr("[e6]")));
  EXPECT_EQ(ParseFixes("time,latitudeE6,lon_e6,alt\n1,47500000,8500000,400\n").at(0).place, (Geodetic{47.5, 8.5, 400}));
  EXPECT_THAT(Notes("time,lat,lon,alt_msl\n1,47,8,400\n"), HasSubstr("above the ellipsoid"));
}

// What a column of hemispheres is called is up to whoever wrote it.
TEST(Fixes, HemispheresAreToldByTheirCells) {
  for (const char* name :
       {"LongitudeRef", "lon_ref", "E/W Indicator", "EWIndicator", "lonHemisphere", "lon_hem", "EorW", "Lon Direction",
        "longitude_dir", "longitude_hemi", "E-W", "east/west", "lon_ew", "hemi_ew", "dir", "Unnamed: 4", ""})
    for (const char* west : {"W", "w", "West", "WEST"}) {
      const std::string text =
          std::string("time,latitude,longitude,") + name + ",altitude\n1,47.5,8.5," + west + ",400\n2,47.5,0.5,E,400\n";
      EXPECT_EQ(ParseFixes(text).at(0).place, (Geodetic{47.5, -8.5, 400})) << text;
      EXPECT_EQ(ParseFixes(text).at(1).place, (Geodetic{47.5, 0.5, 400})) << text;
      EXPECT_THAT(Notes(text), HasSubstr("is taken for the hemisphere of the longitude"));
    }
  EXPECT_EQ(ParseFixes("time,Latitude,LatitudeRef,Longitude,LongitudeRef,Altitude\n1,47.5,S,8.5,W,400\n").at(0).place,
            (Geodetic{-47.5, -8.5, 400}));
  EXPECT_EQ(ParseFixes("time,latitude,longitude,altitude,lon_hem,lat_hem\n1,47.5,8.5,400,W,S\n").at(0).place,
            (Geodetic{-47.5, -8.5, 400}));
}

TEST(Fixes, LettersThatAreNoHemisphereMoveNothing) {
  const Geodetic there = {47.5, 8.5, 400};
  for (const char* text : {"time,latitude,longitude,altitude,heading\n1,47.5,8.5,400,W\n",
                           "time,latitude,longitude,altitude,way\n1,47.5,8.5,400,E\n2,47.5,8.5,400,E\n",
                           "time,latitude,longitude,altitude,way\n1,47.5,8.5,400,W\n2,47.5,8.5,400,N\n",
                           "time,latitude,longitude,altitude,ns\n1,47.5,8.5,400,12\n2,47.5,8.5,400,1\n",
                           "time,latitude,longitude,lon_ref,altitude\n1,47.5,8.5,,400\n"})
    EXPECT_EQ(ParseFixes(text).at(0).place, there) << text;
  EXPECT_THAT(Failure("time,latitude,longitude,altitude,way\n1,47.5,8.5,400,W\n"),
              AllOf(HasSubstr("'way' holds E and W"), HasSubstr("name the column of the longitude's hemisphere E/W")));
  EXPECT_THAT(Failure("time,latitude,longitude,lon_a,altitude,lon_b\n1,47.5,8.5,W,400,E\n"),
              HasSubstr("'lon_a' and 'lon_b' both hold E and W"));
  EXPECT_THAT(Failure("time,latitude,longitude,e/w,altitude\n1,47.5,8.5,5,400\n"),
              HasSubstr("line 2: expected E or W, found '5' in column e/w"));
}

TEST(Fixes, FurtherColumnsNeedNames) {
  // Easting before the altitude; mode and satellites before the place.
  for (const char* text : {"1403636579763555072,47.5,8.5,331234.5,4.1e6,401,4,12\n",
                           "1403636579763555,3,12,0.829,-0.151,401,1,0\n", "1 47.5 8.5 400 1\n"})
    EXPECT_THAT(Failure(text), HasSubstr("columns without names; name them in a first line"));
  EXPECT_EQ(ParseFixes("1,47.5,8.5,400,\n").at(0).place, (Geodetic{47.5, 8.5, 400}));
  EXPECT_THAT(Notes("1,47.5,8.5,400\n"), HasSubstr("taken as time, latitude, longitude and altitude"));
}

TEST(Fixes, NamesOfLoggers) {
  const auto logger = ParseFixes(
      "Fix,Provider,LatitudeDegrees,LongitudeDegrees,AltitudeMeters,UnixTimeMillis\nFix,gps,47.5,8.5,400,"
      "1403636579764\n");
  EXPECT_EQ(logger.at(0).timestamp, 1403636579.764);
  EXPECT_EQ(logger.at(0).place, (Geodetic{47.5, 8.5, 400}));
  const auto e7 = ParseFixes("timestampMs,latitudeE7,longitudeE7,altitude\n1403636579764,475000000,85000000,400.5\n");
  EXPECT_EQ(e7.at(0).timestamp, 1403636579.764);
  EXPECT_NEAR(e7.at(0).place.longitude, 8.5, 1e-12);
}

// Of ArduPilot 1 is no fix, of NavSatFix it is one with corrections.
TEST(Fixes, StatusCountsTwoWays) {
  EXPECT_THAT(Notes("TimeUS,Status,GMS,GWk,Lat,Lng,Alt\n0,1,0,0,10,20,0\n100000,2,0,0,47.5,8.5,400\n"),
              HasSubstr("status 1 (1 row, first in line 2)"));
  EXPECT_THAT(Notes("time,status,lat,lon,alt\n0,0,10,20,0\n0.1,3,47.5,8.5,400\n"), HasSubstr("no fix: 1 row of 2"));
  EXPECT_EQ(Notes("time,status,lat,lon,alt\n0,1,10,20,0\n0.1,0,47.5,8.5,400\n"), "");
}

TEST(Fixes, TimesOfDayStandBesideTheirDate) {
  const auto fixes = ParseFixes("date,time,lat,lon,alt\n20140624,190259.764,47.5,8.5,400\n");
  EXPECT_EQ(fixes.at(0).timestamp, 1403636579.764);
}

TEST(Fixes, ColumnsThatAreMissingAreNamed) {
  EXPECT_THAT(Failure("time,lat_std,lon,alt\n1,47,8,400\n"), HasSubstr("no column is named latitude"));
  EXPECT_THAT(Failure("time_since_start,lat,lon,alt\n1,47,8,400\n"), HasSubstr("no column is named timestamp"));
}

TEST(Fixes, DecimalCommasNeedOtherSeparators) {
  EXPECT_THAT(Notes("time;lat;lon;alt\n1,5;47,5;8,5;400\n"), HasSubstr("decimal commas"));
  EXPECT_EQ(ParseFixes("1,5 47,5 8,5 400,25\n").at(0).place, (Geodetic{47.5, 8.5, 400.25}));
  EXPECT_THAT(Failure("time;lat;lon;alt\n1.5;47,5;8,5;400\n"), HasSubstr("one decimal mark"));
  EXPECT_THAT(Failure("time;lat;lon;alt\n1;47;8;1,234,567\n"), HasSubstr("found '1,234,567' in column altitude"));
}

std::string Sentence(const std::string& text) {
  unsigned sum = 0;
  for (const char letter : text) sum ^= static_cast<unsigned char>(letter);
  const char* hex = "0123456789ABCDEF";
  return "$" + text + "*" + hex[sum / 16] + hex[sum % 16] + "\r\n";
}

TEST(Nmea, TakesTheDayFromRmc) {
  const std::string first = Sentence("GPGGA,221320.25,4730.0000,N,00815.0000,E,1,08,0.9,352.0,M,48.0,M,,");
  const std::string text = first + Sentence("GPRMC,221320.25,A,4730.0000,N,00815.0000,E,0.0,0.0,141123,,") +
                           Sentence("GNGGA,221320.50,,,,,0,,,,M,,M,,") +
                           Sentence("GPGGA,221321.25,4715.0000,S,00830.0000,W,2,08,0.9,252.0,M,48.0,M,,");
  ExpectFixes(ParseFixes(text), text);
  EXPECT_THAT(Failure(first), HasSubstr("tell the time of a day, but not which"));
  EXPECT_THAT(Failure("$GPGGA,221320.25,4730.0000,N*00\n"), HasSubstr("line 1: does not match the checksum"));
  EXPECT_THAT(Failure(Sentence("GPRMC,221320.25,A,4730.0000,N,00815.0000,E,0.0,0.0,141123,,")),
              HasSubstr("without GGA"));
}

// Logs of serial lines begin and end in the middle of a sentence, and lose letters.
TEST(Nmea, DamagedSentencesAreLeftOutCountedAndNamed) {
  const std::string first = Sentence("GPRMC,221320.25,A,4730.0000,N,00815.0000,E,0.0,0.0,141123,,") +
                            Sentence("GPGGA,221320.25,4730.0000,N,00815.0000,E,1,08,0.9,352.0,M,48.0,M,,");
  const std::string last = Sentence("GPGGA,221321.25,4715.0000,S,00830.0000,W,2,08,0.9,252.0,M,48.0,M,,");
  const std::string bad = "$GPGGA,221321.00,4755.0000,S,00830.0000,W,2,08,0.9,252.0,M,48.0,M,,*00\r\n";
  for (const std::string& text :
       {first + bad + last, first + last + "$GPGGA,221322.25,4715.0000,S,0083", first + last + "$GPGGA,2213",
        "30.0000,N,00815.0000,E*5A\r\n" + first + last, "\x80\xfegarbage\r\n\r\n" + first + last,
        "u-blox log\r\n$PUBX,00,0*00\r\n" + first + last,
        first + Sentence("GPGGA,221320.75,47x0.0000,N,00815.0000,E,1,08,0.9,352.0,M,48.0,M,,") + last}) {
    ExpectFixes(ParseFixes(text), text);
    EXPECT_THAT(Notes(text), HasSubstr("are damaged or no sentences of NMEA")) << text;
  }
  EXPECT_THAT(Notes(first + bad + last),
              HasSubstr("1 line, the first in line 3: does not match the checksum of its sentence GPGGA"));
  EXPECT_THAT(Failure(first + bad + bad + bad), HasSubstr("line 3: does not match the checksum"));
  EXPECT_THAT(Failure(Sentence("GPRMC,221320.25,A,4730.0000,N,00815.0000,E,0.0,0.0,141123,,") + bad),
              HasSubstr("line 2: does not match the checksum"));
  const std::string behind = "12:00:01 " + first + "12:00:02 " + last;
  ExpectFixes(ParseFixes(behind), behind);
}

TEST(Rtklib, PositionsAreReadInUtc) {
  const std::string rows =
      "2023/11/14 22:13:38.250   47.500000000    8.250000000   400.0000   1   8   0.0100\n"
      "2023/11/14 22:13:39.250  -47.250000000   -8.500000000   300.0000   2   8   0.0100\n";
  const std::string top = "% program   : RTKPOST\n% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float)\n";
  const std::string names = "                latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)\n";
  ExpectFixes(ParseFixes(top + "%  GPST  " + names + rows), rows);
  EXPECT_THAT(Notes(top + "%  GPST  " + names + rows),
              AllOf(HasSubstr("18 s are taken away"), Not(HasSubstr("UTC and"))));
  EXPECT_EQ(ParseFixes(top + "%  UTC  " + names + rows).at(0).timestamp, 1700000018.25);
  EXPECT_THAT(Failure(top + "%  GPST  " + names + "2288 252818.000   47.5    8.25   400   1   8 0.01\n"),
              HasSubstr("by week and second"));
  EXPECT_THAT(
      Failure(top + "%  GPST   x-ecef(m)      y-ecef(m)      z-ecef(m)   Q  ns\n2023/11/14 22:13:38.250 1 2 3 1 8\n"),
      HasSubstr("no degrees"));
}

TEST(Nmea, TellsWhenTheGeoidIsMissing) {
  const std::string day = Sentence("GPRMC,221320.25,A,4730.0000,N,00815.0000,E,0.0,0.0,141123,,");
  EXPECT_THAT(Notes(day + Sentence("GPGGA,221320.25,4730.0000,N,00815.0000,E,1,08,0.9,352.0,M,,M,,")),
              AllOf(HasSubstr("above the ellipsoid"), HasSubstr("1 sentence without the height of the geoid")));
  EXPECT_EQ(Notes(day + Sentence("GPGGA,221320.25,4730.0000,N,00815.0000,E,1,08,0.9,352.0,M,48.0,M,,")), "");
}

TEST(Nmea, GoesOnOverMidnight) {
  const auto fixes = ParseFixes(Sentence("GPRMC,235959.50,A,4730.0000,N,00815.0000,E,0.0,0.0,141123,,") +
                                Sentence("GPGGA,000000.50,4730.0000,N,00815.0000,E,1,08,0.9,352.0,M,48.0,M,,"));
  EXPECT_EQ(fixes.at(0).timestamp, 1700006400.5);
}

}  // namespace
}  // namespace slamdb
