// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/las/detail/utm.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamdb::detail {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kRadius = 6378137, kFlattening = 1 / 298.257223563;  // WGS84
constexpr double kScale = 0.9996, kFalseEasting = 500'000, kFalseNorthing = 10'000'000;
constexpr double kN = kFlattening / (2 - kFlattening);  // third flattening
constexpr double kN2 = kN * kN, kN3 = kN2 * kN, kN4 = kN2 * kN2;
constexpr double kMeridian = kRadius / (1 + kN) * (1 + kN2 / 4 + kN4 / 64);  // radius of a circle as long as a meridian
constexpr double kAlpha[] = {kN / 2 - 2 * kN2 / 3 + 5 * kN3 / 16 + 41 * kN4 / 180,
                             13 * kN2 / 48 - 3 * kN3 / 5 + 557 * kN4 / 1440, 61 * kN3 / 240 - 103 * kN4 / 140,
                             49561 * kN4 / 161280};

// The tangent of the conformal latitude.
double Conformal(double latitude) {
  const double eccentricity = std::sqrt(kFlattening * (2 - kFlattening));
  const double tangent = std::tan(latitude);
  const double sigma = std::sinh(eccentricity * std::atanh(eccentricity * std::sin(latitude)));
  return tangent * std::hypot(1, sigma) - sigma * std::hypot(1, tangent);
}

// Zones of other widths: western Norway is in the zone of the rest of it, and Svalbard has every second zone.
struct WideZone {
  double south, north, west, east;
  int number;
};
constexpr WideZone kWideZones[] = {
    {56, 64, 3, 12, 32}, {72, 84, 0, 9, 31}, {72, 84, 9, 21, 33}, {72, 84, 21, 33, 35}, {72, 84, 33, 42, 37}};

}  // namespace

std::optional<UtmZone> UtmZoneOf(const Geodetic& place) {
  const auto& [latitude, longitude, altitude] = place;
  if (!(latitude >= -80 && latitude <= 84)) return std::nullopt;
  for (const WideZone& zone : kWideZones)
    if (latitude >= zone.south && (latitude < zone.north || zone.north == 84) && longitude >= zone.west &&
        longitude < zone.east)
      return UtmZone{zone.number, true};
  const double turns = std::floor((longitude + 180) / 360);
  const double east = longitude + 180 - 360 * turns;  // of the antimeridian, 0 to 360
  return UtmZone{std::clamp(static_cast<int>(east / 6) + 1, 1, 60), latitude >= 0};
}

Eigen::Vector3d UtmFromGeodetic(const UtmZone& zone, const Geodetic& place) {
  const double longitude = std::remainder(place.longitude - (6 * zone.number - 183), 360) * kDegree;
  const double tangent = Conformal(place.latitude * kDegree);
  const double xi = std::atan2(tangent, std::cos(longitude));
  const double eta = std::asinh(std::sin(longitude) / std::hypot(tangent, std::cos(longitude)));
  double north = xi, east = eta;
  for (int j = 1; j <= 4; ++j) {
    north += kAlpha[j - 1] * std::sin(2 * j * xi) * std::cosh(2 * j * eta);
    east += kAlpha[j - 1] * std::cos(2 * j * xi) * std::sinh(2 * j * eta);
  }
  return {kFalseEasting + kScale * kMeridian * east, (zone.north ? 0 : kFalseNorthing) + kScale * kMeridian * north,
          place.altitude};
}

}  // namespace slamdb::detail
