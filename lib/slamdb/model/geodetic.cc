// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/geodetic.h"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

// WGS84 (NIMA TR8350.2): semi-major axis in metres, flattening.
constexpr double kSemiMajor = 6378137.0, kFlattening = 1 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2 - kFlattening);
constexpr double kMostAltitude = 1e8;  // metres: beyond satellites, and no mistake for a number without a meaning
constexpr double kDegree = std::numbers::pi / 180;

// From the axis of the earth to the ellipsoid along the normal.
double NormalRadius(double sine) { return kSemiMajor / std::sqrt(1 - kEccentricity2 * sine * sine); }

}  // namespace

bool IsPlace(const Geodetic& place) {
  return std::abs(place.latitude) <= 90 && std::abs(place.longitude) <= 360 &&
         std::abs(place.altitude) <= kMostAltitude;
}

Eigen::Vector3d EcefFromGeodetic(const Geodetic& place) {
  const double sine = std::sin(place.latitude * kDegree), cosine = std::cos(place.latitude * kDegree);
  const double radius = NormalRadius(sine);
  return {(radius + place.altitude) * cosine * std::cos(place.longitude * kDegree),
          (radius + place.altitude) * cosine * std::sin(place.longitude * kDegree),
          (radius * (1 - kEccentricity2) + place.altitude) * sine};
}

Geodetic GeodeticFromEcef(const Eigen::Vector3d& ecef) {
  const double off_axis = std::hypot(ecef.x(), ecef.y());
  // Bowring's start, then a fixed point that gains three digits a step.
  double latitude = std::atan2(ecef.z(), off_axis * (1 - kEccentricity2));
  for (int step = 0; step < 8; ++step) {
    const double sine = std::sin(latitude);
    latitude = std::atan2(ecef.z() + kEccentricity2 * NormalRadius(sine) * sine, off_axis);
  }
  const double sine = std::sin(latitude), cosine = std::cos(latitude);
  // The distance along the normal, stable at the poles as well as at the equator.
  const double altitude =
      off_axis * cosine + ecef.z() * sine - kSemiMajor * std::sqrt(1 - kEccentricity2 * sine * sine);
  return {latitude / kDegree, std::atan2(ecef.y(), ecef.x()) / kDegree, altitude};
}

LocalFrame::LocalFrame(const Geodetic& origin) : origin_(origin), ecef_(EcefFromGeodetic(origin)) {
  if (!IsPlace(origin))
    throw Error(ErrorKind::kUsage, "the origin is no place on earth: latitudes reach from -90 to 90 degrees");
  const double latitude = origin.latitude * kDegree, longitude = origin.longitude * kDegree;
  const double sp = std::sin(latitude), cp = std::cos(latitude), sl = std::sin(longitude), cl = std::cos(longitude);
  enu_from_ecef_ << -sl, cl, 0,  //
      -sp * cl, -sp * sl, cp,    //
      cp * cl, cp * sl, sp;
}

Eigen::Vector3d LocalFrame::FromGeodetic(const Geodetic& place) const {
  return enu_from_ecef_ * (EcefFromGeodetic(place) - ecef_);
}

Geodetic LocalFrame::ToGeodetic(const Eigen::Vector3d& enu) const {
  return GeodeticFromEcef(ecef_ + enu_from_ecef_.transpose() * enu);
}

Geodetic ParseGeodetic(std::string_view text) {
  std::array<std::optional<double>, 3> numbers = {0, 0, 0};
  const std::size_t separator = text.find_first_of(",;\t");
  const auto cells = detail::Split(text, separator == text.npos ? ',' : text[separator]);
  const bool fits = cells.size() == 2 || cells.size() == 3;
  for (std::size_t i = 0; fits && i < cells.size(); ++i)
    numbers[i] = detail::ParseNumber<double>(detail::Trimmed(cells[i]));
  const auto [latitude, longitude, altitude] = numbers;
  if (fits && latitude && longitude && altitude)
    if (const Geodetic place{*latitude, *longitude, *altitude}; IsPlace(place)) return place;
  throw Error(ErrorKind::kUsage,
              detail::Concat("a place is LATITUDE,LONGITUDE[,ALTITUDE] in degrees and metres, not '", text, "'"));
}

}  // namespace slamdb
