// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/base/time_unit.h"
#include "slamdb/edit/frame/align_trajectory.h"
#include "slamdb/export.h"
#include "slamdb/model/geodetic.h"
#include "slamdb/model/ids.h"

namespace slamdb {

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

// The fixes as positions in the frame; not a number where a fix has no place.
[[nodiscard]] SLAMDB_EXPORT std::vector<TimedPosition> PositionsIn(const LocalFrame& frame,
                                                                   const std::vector<GpsFix>& fixes);

// Where on earth maps are, as `transform` writes it beside an atlas, which has no place for it.
struct Georeference {
  Geodetic origin;          // of their frame: east, north, up
  std::vector<MapId> maps;  // that were moved into it
};

// `map.osa.georeference.json` of `map.osa`.
[[nodiscard]] SLAMDB_EXPORT std::string GeoreferencePath(const std::string& atlas);

// Reads that file of an atlas; nullopt where there is none.
//
// Throws Error when it cannot be read, or holds no origin.
[[nodiscard]] SLAMDB_EXPORT std::optional<Georeference> FindGeoreference(const std::string& atlas);

}  // namespace slamdb
