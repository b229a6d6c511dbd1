// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "slamdb/model/geodetic.h"

namespace slamdb::detail {

// A zone of the Universal Transverse Mercator grid over WGS84.
struct UtmZone {
  int number = 1;  // 1 to 60, of 6 degrees each but around Norway
  bool north = true;

  // EPSG's code: 32632 for zone 32 north.
  std::uint16_t epsg() const { return static_cast<std::uint16_t>((north ? 32600 : 32700) + number); }
};

// The zone of a place, 32 in western Norway and 31, 33, 35 or 37 on Svalbard; nullopt above 84 degrees north and below
// 80 south, where there is none.
std::optional<UtmZone> UtmZoneOf(const Geodetic& place);

// Easting, northing and altitude, metres; also of places beside the zone. To a micrometre within 30 degrees of its
// middle. After Krueger's series as Karney has it (Journal of Geodesy 2011, equations 7 to 11 and 35).
Eigen::Vector3d UtmFromGeodetic(const UtmZone& zone, const Geodetic& place);

}  // namespace slamdb::detail
