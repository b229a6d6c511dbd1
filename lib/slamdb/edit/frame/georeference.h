// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/base/time_unit.h"
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

// How GPS fixes are read.
struct FixReadOptions {
  std::optional<TimeUnit> time_unit;  // by default as the table says, or its times tell
};

// The fixes of a table in any dialect of schema/tables.md, or of sentences of NMEA 0183.
// Columns by their names, in any order, or else in this one:
//   timestamp, time, header.stamp and others; a number since 1970, or date and time
//   latitude or lat; longitude, lon, lng or long; with N, S, E and W beside them also degrees and minutes (ddmm.mmmm)
//   altitude, alt, ele, elevation or height
// Units are as the names say (`altitude_ft`, `latitude [rad]`, `lat_e7`, `timestamp_ns`), otherwise degrees and metres;
// times tell their own.
// Rows of a receiver without a fix are named, and are fixes without a place: empty, not a number, 0,0, a status below
// 0, a quality of 0, a latitude beyond 90 degrees. Sentences: GGA with the day of RMC or ZDA; RMC alone has no
// altitude.
//
// Throws Error naming line, column, what is there and what was expected; also when no row has a fix, and when the unit
// of angles or times cannot be told.
[[nodiscard]] SLAMDB_EXPORT std::vector<GpsFix> ParseFixes(std::string_view text, const FixReadOptions& options = {},
                                                           Notices* notices = nullptr);

// The fixes of a file, at least one.
//
// Throws Error as ParseFixes, with the path.
[[nodiscard]] SLAMDB_EXPORT std::vector<GpsFix> ReadFixes(const std::string& path, const FixReadOptions& options = {},
                                                          Notices* notices = nullptr);

// `LAT,LON` or `LAT,LON,ALT`.
//
// Throws Error (kUsage).
[[nodiscard]] SLAMDB_EXPORT Geodetic ParseGeodetic(std::string_view text);

// The fixes as positions in the frame; not a number where a fix has no place.
[[nodiscard]] SLAMDB_EXPORT std::vector<TimedPosition> PositionsIn(const LocalFrame& frame,
                                                                   const std::vector<GpsFix>& fixes);

}  // namespace slamdb
