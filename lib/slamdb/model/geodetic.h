// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string_view>

#include "slamdb/export.h"

namespace slamdb {

// A place on or above the ellipsoid of WGS84.
struct Geodetic {
  double latitude = 0, longitude = 0;  // degrees, north and east positive
  double altitude = 0;                 // metres above the ellipsoid
  friend bool operator==(const Geodetic&, const Geodetic&) = default;
};

// Where a receiver was.
struct GpsFix {
  // Not a number: the receiver had no fix then, so that nothing is interpolated across that time.
  static constexpr Geodetic kNowhere{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
                                     std::numeric_limits<double>::quiet_NaN()};

  double timestamp = 0;  // seconds
  Geodetic place;

  bool has_place() const { return place.latitude == place.latitude; }
};

// Whether latitude, longitude and altitude are of a place on earth.
[[nodiscard]] SLAMDB_EXPORT bool IsPlace(const Geodetic& place);

// Earth-centred, earth-fixed coordinates in metres (EPSG:4978), and back: to a micrometre from the ground up to orbits.
[[nodiscard]] SLAMDB_EXPORT Eigen::Vector3d EcefFromGeodetic(const Geodetic& place);
[[nodiscard]] SLAMDB_EXPORT Geodetic GeodeticFromEcef(const Eigen::Vector3d& ecef);

// Local east, north, up coordinates in metres, on the plane that touches the ellipsoid's parallel surface at an origin.
class SLAMDB_EXPORT LocalFrame {
 public:
  // Throws Error (kUsage) when the origin is no place: a latitude beyond 90 degrees, or not finite.
  explicit LocalFrame(const Geodetic& origin);

  const Geodetic& origin() const { return origin_; }
  Eigen::Vector3d FromGeodetic(const Geodetic& place) const;
  Geodetic ToGeodetic(const Eigen::Vector3d& enu) const;

 private:
  Geodetic origin_;
  Eigen::Vector3d ecef_;
  Eigen::Matrix3d enu_from_ecef_;
};

// `LAT,LON` or `LAT,LON,ALT`.
//
// Throws Error (kUsage).
[[nodiscard]] SLAMDB_EXPORT Geodetic ParseGeodetic(std::string_view text);

}  // namespace slamdb
