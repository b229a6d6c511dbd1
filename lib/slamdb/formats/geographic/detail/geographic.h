// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// Georeferenced maps on the globe: path, keyframes, and some of the points: write only. Maps are in metres east, north
// and up of GeographicOptions::origin. schema/kml.md and schema/geojson.md have the elements.
extern const Format kKmlFormat;      // kml: OGC KML 2.2, for Google Earth and QGIS
extern const Format kGeojsonFormat;  // geojson: RFC 7946, for QGIS, PostGIS and web maps

}  // namespace slamdb::detail
