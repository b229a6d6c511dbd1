// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

// Every field of an entity as JSON, by the names of the model's headers.
// schema/ndjson.md and schema/ndjson.schema.json describe the objects.
// Formats() reads the lines of ndjson back.
//
// Thread-safe.
namespace slamdb {

// One object.
// indent < 0: on one line, as in ndjson.
// Otherwise members on lines of their own, `indent` spaces deeper per level, with arrays of plain values kept on one
// line.
SLAMDB_EXPORT std::string ToJson(const KeyFrame& keyframe, int indent = 2);
SLAMDB_EXPORT std::string ToJson(const MapPoint& point, int indent = 2);
SLAMDB_EXPORT std::string ToJson(const Camera& camera, int indent = 2);
SLAMDB_EXPORT std::string ToJson(const Landmark& landmark, int indent = 2);
SLAMDB_EXPORT std::string ToJson(const Map& map, int indent = 2);      // without its keyframes, points and landmarks
SLAMDB_EXPORT std::string ToJson(const Atlas& atlas, int indent = 2);  // without its maps and cameras: their ids

// The same on one line, appended to a buffer: what ndjson writes.
// `map` becomes the member "map" of the object.
SLAMDB_EXPORT void AppendJson(std::string& out, const KeyFrame& keyframe, std::optional<MapId> map = std::nullopt);
SLAMDB_EXPORT void AppendJson(std::string& out, const MapPoint& point, std::optional<MapId> map = std::nullopt);
SLAMDB_EXPORT void AppendJson(std::string& out, const Landmark& landmark, std::optional<MapId> map = std::nullopt);
SLAMDB_EXPORT void AppendJson(std::string& out, const Camera& camera);
SLAMDB_EXPORT void AppendJson(std::string& out, const Map& map);
SLAMDB_EXPORT void AppendJson(std::string& out, const Atlas& atlas);

}  // namespace slamdb
