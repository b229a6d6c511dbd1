// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "slamdb/export.h"
#include "slamdb/model/geodetic.h"

namespace slamdb {

// How KML, GeoJSON and LAS are written, of maps whose frames are east, north, up.
struct SLAMDB_EXPORT GeographicOptions {
  std::optional<Geodetic> origin;    // of the maps' frame; without it they are refused
  std::size_t most_points = 10'000;  // map points, taken evenly from all; 0: none. LAS has all of them
};

}  // namespace slamdb
