// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/edit/frame/align_trajectory.h"
#include "slamdb/export.h"

namespace slamdb {

// A place on or above the ellipsoid of WGS84.
struct Geodetic {
  double latitude = 0, longitude = 0;  // degrees, north and east positive
  double altitude = 0;                 // metres above the ellipsoid
  friend bool operator==(const Geodetic&, const Geodetic&) = default;
};

struct GpsFix {
  double timestamp = 0;  // seconds
  Geodetic place;
};

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

// The fixes of a table in any dialect of schema/tables.md.
// Columns, with anything behind the name where no column has exactly it (`lat [deg]`):
//   timestamp, time, t or seconds
//   latitude or lat
//   longitude, lon, lng or long
//   altitude, alt, ele, elevation or height
// Without names they stand in this order.
//
// Units: seconds, degrees, metres; a unit that a name states is not looked at.
//
// Throws Error (kDamaged) naming the line that is none, and the column when a cell is no number.
[[nodiscard]] SLAMDB_EXPORT std::vector<GpsFix> ParseFixes(std::string_view csv);

// The fixes of a file, at least one.
//
// Throws Error as ParseFixes, with the path.
[[nodiscard]] SLAMDB_EXPORT std::vector<GpsFix> ReadFixes(const std::string& path);

// `LAT,LON` or `LAT,LON,ALT`.
//
// Throws Error (kUsage).
[[nodiscard]] SLAMDB_EXPORT Geodetic ParseGeodetic(std::string_view text);

// The fixes as positions in the frame.
[[nodiscard]] SLAMDB_EXPORT std::vector<TimedPosition> PositionsIn(const LocalFrame& frame,
                                                                   const std::vector<GpsFix>& fixes);

}  // namespace slamdb
