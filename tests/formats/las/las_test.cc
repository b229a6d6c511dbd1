// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/las/detail/las.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "slamdb/base/error.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/geographic/options.h"
#include "slamdb/formats/las/detail/utm.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

constexpr Geodetic kOrigin{48.15, 11.57, 519};
constexpr std::size_t kPoints = 227 + 54 + 40, kRecord = 26;

WriteOptions At(const Geodetic& origin) { return WriteOptions{}.With(GeographicOptions{.origin = origin}); }

template <class Number>
Number NumberAt(const std::string& bytes, std::size_t at) {
  Number number{};
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

std::string Written(const Atlas& atlas, const Geodetic& origin = kOrigin) {
  return Encoded(detail::kLasFormat, atlas, At(origin));
}

// Where a point of the file lies, metres in UTM.
Eigen::Vector3d PlaceOf(const std::string& las, std::size_t row) {
  Eigen::Vector3d place;
  for (int axis = 0; axis < 3; ++axis)
    place[axis] =
        NumberAt<std::int32_t>(las, kPoints + row * kRecord + 4 * axis) * NumberAt<double>(las, 131 + 8 * axis) +
        NumberAt<double>(las, 155 + 8 * axis);
  return place;
}

TEST(Las, WritesTheHeaderOfVersion12) {
  const std::string las = Written(SmallAtlas());
  EXPECT_EQ(las.substr(0, 4), "LASF");
  EXPECT_EQ(NumberAt<std::uint8_t>(las, 24), 1);
  EXPECT_EQ(NumberAt<std::uint8_t>(las, 25), 2);
  EXPECT_EQ(NumberAt<std::uint16_t>(las, 94), 227);
  EXPECT_EQ(NumberAt<std::uint32_t>(las, 96), kPoints);
  EXPECT_EQ(NumberAt<std::uint32_t>(las, 100), 1U) << "variable length records";
  EXPECT_EQ(NumberAt<std::uint8_t>(las, 104), 2) << "point data format";
  EXPECT_EQ(NumberAt<std::uint16_t>(las, 105), kRecord);
  EXPECT_EQ(NumberAt<std::uint32_t>(las, 107), 3U);
  EXPECT_EQ(las.size(), kPoints + 3 * kRecord);
}

TEST(Las, SaysWhichZoneItIsIn) {
  const auto epsg_at = [](const Geodetic& origin) {
    return NumberAt<std::uint16_t>(Written(SmallAtlas(), origin), 227 + 54 + 8 + 8 + 6);
  };
  EXPECT_EQ(epsg_at(kOrigin), 32632);
  EXPECT_EQ(epsg_at({-33.86, 151.2, 0}), 32756);
}

TEST(Las, PutsPointsWhereTheyAre) {
  for (const Geodetic& origin :
       {kOrigin, Geodetic{-33.86, 151.2, 20}, Geodetic{60.39, 5.32, 0}, Geodetic{0, -78.5, 2850}}) {
    Atlas atlas = OneMapAtlas();
    atlas.maps[0].points[0].position = {1234.5F, -987.25F, 33.125F};
    const std::string las = Written(atlas, origin);
    const Geodetic place = LocalFrame(origin).ToGeodetic({1234.5, -987.25, 33.125});
    const Eigen::Vector3d expected = detail::UtmFromGeodetic(detail::UtmZoneOf(origin).value(), place);
    EXPECT_LE((PlaceOf(las, 0) - expected).cwiseAbs().maxCoeff(), 0.5001e-4) << origin.latitude;
  }
}

TEST(Las, ItsBoundsAreThoseOfItsPoints) {
  const std::string las = Written(SmallAtlas());
  for (int axis = 0; axis < 3; ++axis) {
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (std::size_t row = 0; row < 3; ++row) {
      least = std::min(least, PlaceOf(las, row)[axis]);
      most = std::max(most, PlaceOf(las, row)[axis]);
    }
    EXPECT_EQ(NumberAt<double>(las, 179 + 16 * axis), most);
    EXPECT_EQ(NumberAt<double>(las, 187 + 16 * axis), least);
  }
}

TEST(Las, TellsMapsAndObservations) {
  Atlas atlas = SmallAtlas();
  atlas.maps[1].id = MapId(65535);
  std::string las = Written(atlas);
  EXPECT_EQ(NumberAt<std::uint8_t>(las, kPoints + 17), 2) << "keyframes that see point 10";
  EXPECT_EQ(NumberAt<std::uint16_t>(las, kPoints + 18), 0);
  EXPECT_EQ(NumberAt<std::uint16_t>(las, kPoints + 2 * kRecord + 18), 65535);
  EXPECT_EQ(NumberAt<std::uint8_t>(las, kPoints + 14), 9) << "the only return";
  atlas.maps[1].id = MapId(65536);
  atlas.maps[1].points[0].observations.resize(256);
  Notices notices;
  las = Encoded(detail::kLasFormat, atlas, At(kOrigin), notices);
  EXPECT_EQ(NumberAt<std::uint16_t>(las, kPoints + 2 * kRecord + 18), 0) << "no map of 16 bits";
  EXPECT_EQ(NumberAt<std::uint8_t>(las, kPoints + 2 * kRecord + 17), 255);
  ASSERT_EQ(notices.items().size(), 3U);  // the first: of several maps
  EXPECT_THAT(notices.items()[1].text, HasSubstr("ids beyond 65,535, for which it has no place: 1 point"));
  EXPECT_THAT(notices.items()[2].text, HasSubstr("observations above 255 are written as that: 1 point"));
}

TEST(Las, NamesPointsThatItCannotHold) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].points[0].position = {200'001, 0, 0};
  atlas.maps[0].points[2].position.x() = std::nanf("");
  Notices notices;
  const std::string las = Encoded(detail::kLasFormat, atlas, At(kOrigin), notices);
  EXPECT_EQ(NumberAt<std::uint32_t>(las, 107), 0U);
  EXPECT_EQ(las.size(), kPoints);
  EXPECT_EQ(NumberAt<double>(las, 179), 0);
  ASSERT_EQ(notices.items().size(), 2U);
  EXPECT_THAT(notices.items()[0].text, HasSubstr("not finite: 1 point"));
  EXPECT_THAT(notices.items()[1].text, HasSubstr("more than 200 km from the origin: 1 point"));
  EXPECT_EQ(notices.written(), "0 points of 1 point, 1 bad one left out");
}

TEST(Las, HoldsPointsAsFarAsItSays) {
  Atlas atlas = OneMapAtlas();
  const Geodetic edge{0, 6, 0};  // where the scale of the grid is greatest
  for (const Eigen::Vector3f& far : {Eigen::Vector3f(199'999, 0, 0), Eigen::Vector3f(-199'999, 0, 0),
                                     Eigen::Vector3f(0, 199'999, 0), Eigen::Vector3f(0, 0, -199'999)}) {
    atlas.maps[0].points[0].position = far;
    const Geodetic place = LocalFrame(edge).ToGeodetic(far.cast<double>());
    const Eigen::Vector3d expected = detail::UtmFromGeodetic(detail::UtmZoneOf(edge).value(), place);
    EXPECT_LE((PlaceOf(Written(atlas, edge), 0) - expected).cwiseAbs().maxCoeff(), 0.51e-4);
  }
}

TEST(Las, NeedsAPlaceWithAZone) {
  const auto error = [](const WriteOptions& options) {
    try {
      (void)Encoded(detail::kLasFormat, SmallAtlas(), options);
    } catch (const Error& found) {
      return std::string(found.what());
    }
    return std::string("was written");
  };
  EXPECT_THAT(error({}), HasSubstr("places on earth need"));
  EXPECT_THAT(error(At({84.5, 0, 0})), HasSubstr("no zone above 84 degrees north"));
  EXPECT_THAT(error(At({-80.5, 0, 0})), HasSubstr("no zone above 84 degrees north"));
}

}  // namespace
}  // namespace slamdb
