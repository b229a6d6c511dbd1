// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/postgresql/detail/save.h"
#include "slamdb/formats/rows/detail/list_order.h"
#include "slamdb/formats/rows/detail/map_rows.h"
#include "slamdb/formats/rows/detail/match_maps.h"

namespace slamdb::postgresql {

using detail::Concat;
using rows::Value;

namespace {

// ---- cameras and irregular entries

constexpr std::int64_t kLargestMap = 0x7fffffff;

// The newest revision's.
struct StoredSmall {
  std::vector<std::int64_t> cameras;  // hashes
  bool has_repeated = false;
};

StoredSmall ReadSmall(SaveContext& context) {
  StoredSmall stored;
  if (context.is_new) return stored;
  const Result found = context.connection.Query(
      "SELECT array(SELECT hash FROM camera WHERE atlas = $1 AND until = 2147483647 ORDER BY position), EXISTS (SELECT "
      "1 FROM repeated_entry WHERE atlas = $1 AND until = 2147483647)",
      {context.atlas}, "table camera");
  found[0].Integers64(0, stored.cameras);
  stored.has_repeated = found[0].Integer(1) != 0;
  return stored;
}

void SaveCameras(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes,
                 const std::vector<std::int64_t>& stored) {
  TableChanges& changes = context.changes["camera"];
  if (stored == hashes.cameras && !context.rewrites) {
    changes.unchanged += stored.size();
    return;
  }
  if (!stored.empty())
    context.connection.Query("UPDATE camera SET until = $2 WHERE atlas = $1 AND until = 2147483647",
                             {context.atlas, context.revision}, "table camera");
  changes.deleted += stored.size();
  changes.inserted += atlas.cameras.size();
  const rows::CameraRows rows(context.atlas, atlas.cameras);
  CarriedColumn carried;
  for (std::size_t i = 0; i < atlas.cameras.size(); ++i) {
    std::vector<Value> row(rows.rows()[i].begin(), rows.rows()[i].end());
    row.emplace_back(hashes.cameras[i]);
    row.push_back(carried.Of(atlas.cameras[i].carried));
    row.emplace_back(context.revision);
    InsertRow(
        context.connection,
        "camera (atlas, position, id, unique_id, model, recorded_type, parameters, precision, exact, hash, carried, "
        "since)",
        row);
  }
}

// With their rows as columns of Value, whose texts are literals.
std::vector<std::array<Value, 7>> RepeatedRows(std::int64_t row, const Atlas& atlas,
                                               const std::vector<std::int64_t>& maps) {
  std::vector<std::array<Value, 7>> rows;
  const auto add = [&](std::string_view list, std::int64_t map, const std::vector<RepeatedEntry>& entries) {
    for (std::size_t i = 0; i < entries.size(); ++i) rows.push_back(rows::RepeatedRow(row, list, map, i, entries[i]));
  };
  add("maps", 0, atlas.repeated_maps);
  add("cameras", 0, atlas.repeated_cameras);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    add("keyframes", maps[i], atlas.maps[i].repeated_keyframes);
    add("points", maps[i], atlas.maps[i].repeated_points);
  }
  return rows;
}

void SaveRepeated(SaveContext& context, const Atlas& atlas, const std::vector<std::int64_t>& maps, bool has_stored) {
  const auto rows = RepeatedRows(context.atlas, atlas, maps);
  if (!has_stored && rows.empty()) return;
  TableChanges& changes = context.changes["repeated_entry"];
  changes.inserted += rows.size();
  if (has_stored) {
    const Result ended =
        context.connection.Query("UPDATE repeated_entry SET until = $2 WHERE atlas = $1 AND until = 2147483647",
                                 {context.atlas, context.revision}, "table repeated_entry");
    changes.deleted += static_cast<std::uint64_t>(ended.changed());
  }
  for (const auto& each : rows) {
    std::vector<Value> row(each.begin(), each.end());
    row.emplace_back(context.revision);
    InsertRow(context.connection, "repeated_entry (atlas, list, map, sequence, position, owner_map, entry, since)",
              row);
  }
}

// ---- maps

// Those from one row to another, of which there are `maps`.
void RemoveMaps(SaveContext& context, std::int64_t first, std::int64_t last, std::size_t maps) {
  const auto end = [&](std::string_view table, std::string_view key, std::string_view more = "0") {
    const Result ended = context.connection.Query(
        Concat("WITH ended AS (UPDATE ", table, " SET until = $2 WHERE atlas = $1 AND until = 2147483647 AND ", key,
               " BETWEEN $3 AND $4 RETURNING ", more,
               " AS more) SELECT count(*), coalesce(sum(more), 0)::bigint FROM ended"),
        {context.atlas, context.revision, rows::FirstRowOfMap(first), rows::LastRowOfMap(last)},
        Concat("table ", table));
    context.changes[std::string(table)].deleted += static_cast<std::uint64_t>(ended[0].Integer(0));
    return std::pair(static_cast<std::uint64_t>(ended[0].Integer(0)), static_cast<std::uint64_t>(ended[0].Integer(1)));
  };
  context.map.keyframes_removed += end("keyframe", "row").first;
  end("keyframe_features", "keyframe");
  const auto [points, seen] = end("map_point", "row", "cardinality(seen_by)");
  context.map.points_removed += points;
  context.map.observations_removed += seen;
  end("landmark", "row");
  const Result ended = context.connection.Query(
      "UPDATE map SET until = $2 WHERE atlas = $1 AND until = 2147483647 AND row BETWEEN $3 AND $4",
      {context.atlas, context.revision, first, last}, "table map");
  RequireTaken(context.connection, "map", ended.changed(), static_cast<std::int64_t>(maps));
  context.changes["map"].deleted += maps;
}

// Of keyframes that have a time.
std::vector<rows::KeyframeKey> KeysOf(const StoredLists& lists) {
  std::vector<rows::KeyframeKey> keys;
  for (std::size_t k = 0; k < lists.keyframes.size(); ++k)
    if (!std::isnan(lists.features[k].timestamp)) keys.push_back({lists.keyframes[k].id, lists.features[k].timestamp});
  return keys;
}

// What a search looks at first.
struct Extent {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  void Add(double value) {
    if (!std::isfinite(value)) return;
    least = std::min(least, value);
    most = std::max(most, value);
  }
};
struct Extents {
  Extent times, x, y, z;
};

Extents ExtentsOf(const Map& map) {
  Extents extents;
  for (const KeyFrame& keyframe : map.keyframes)
    if (!keyframe.bad) extents.times.Add(keyframe.timestamp);
  const auto add = [&](double x, double y, double z) {
    extents.x.Add(x);
    extents.y.Add(y);
    extents.z.Add(z);
  };
  for (const MapPoint& point : map.points)
    if (!point.bad)
      add(static_cast<double>(point.position.x()), static_cast<double>(point.position.y()),
          static_cast<double>(point.position.z()));
  for (const Landmark& landmark : map.landmarks) add(landmark.mean.x(), landmark.mean.y(), landmark.mean.z());
  return extents;
}

std::string OrderOf(const rows::ListPlan& plan) {
  std::vector<std::int64_t> rows;
  rows.reserve(plan.entries.size());
  for (const rows::ListPlan::Entry& entry : plan.entries) rows.push_back(entry.row);
  return rows::ListOrder::Encode(rows);
}

// Writes a row of `map`, of which the newest revision has none.
void WriteMapRow(SaveContext& context, std::int64_t number, std::size_t position, const Map& map, std::int64_t hash,
                 const ListPlans& plans) {
  std::vector<Value> row;
  std::ranges::copy(rows::MapRow(number, context.atlas, position, map, hash), std::back_inserter(row));
  const std::array<std::string, 3> orders = {OrderOf(plans.keyframes), OrderOf(plans.points), OrderOf(plans.landmarks)};
  for (const std::string& order : orders)
    row.push_back(order.empty() ? Value() : Value(std::as_bytes(std::span(order))));
  CarriedColumn carried;
  row.push_back(carried.Of(map.carried));
  row.emplace_back(context.revision);
  std::vector<Parameter> parameters;
  for (const Value& value : row) parameters.push_back(ParameterOf(value));
  std::vector<std::int64_t> origins;
  for (const KeyFrameId id : map.origins) origins.push_back(rows::ToColumn(id));
  parameters.emplace_back(std::span<const std::int64_t>(origins));
  std::string values;
  for (std::size_t i = 1; i <= parameters.size(); ++i) values += Concat(i == 1 ? "$" : ", $", i);
  const Extents extents = ExtentsOf(map);
  for (const Extent& extent : {extents.times, extents.x, extents.y, extents.z}) {
    if (extent.least > extent.most) {
      values += ", NULL";
      continue;
    }
    parameters.emplace_back(extent.least);
    values += Concat(", span($", parameters.size());
    parameters.emplace_back(extent.most);
    values += Concat(", $", parameters.size(), ", '[]')");
  }
  context.connection.Query(
      Concat("INSERT INTO map (row, atlas, position, id, initial_keyframe, first_keyframe, lowest_keyframe, "
             "max_keyframe_id, big_change_index, imu_initialized, inertial, imu_ba1, imu_ba2, hash, keyframe_order, "
             "point_order, landmark_order, carried, since, origins, times, x, y, z) VALUES (",
             values, ")"),
      parameters, "table map");
}

}  // namespace

std::vector<rows::StoredMap> ReadStoredMaps(SaveContext& context) {
  std::vector<rows::StoredMap> maps;
  const Result found = context.connection.Query(
      "SELECT row, id, position, hash FROM map WHERE atlas = $1 AND until = 2147483647 ORDER BY position",
      {context.atlas}, "table map");
  for (std::size_t i = 0; i < found.rows(); ++i)
    maps.push_back({found[i].Integer(0), found[i].Integer(1), found[i].Integer(2), found[i].Integer(3), {}, false});
  return maps;
}

MatchedMaps MatchMaps(SaveContext& context, const Atlas& atlas) {
  MatchedMaps matched{std::vector<rows::StoredMap>(atlas.maps.size()), std::vector<StoredLists>(atlas.maps.size())};
  if (context.is_new) return matched;
  std::vector<rows::StoredMap> stored = ReadStoredMaps(context);
  if (context.rewrites) {  // also what has no map any more
    RemoveMaps(context, 0, kLargestMap, stored.size());
    return matched;
  }
  std::vector<std::int64_t> numbers;
  for (const rows::StoredMap& map : stored) numbers.push_back(map.row);
  std::vector<StoredLists> lists = ReadStoredLists(context, numbers);
  for (std::size_t i = 0; i < stored.size(); ++i) stored[i].keys = KeysOf(lists[i]);
  const std::vector<const rows::StoredMap*> match = rows::MatchMaps(atlas, stored);
  for (std::size_t i = 0; i < match.size(); ++i) {
    if (match[i] == nullptr) continue;
    matched.maps[i] = *match[i];
    matched.lists[i] = std::move(lists[static_cast<std::size_t>(match[i] - stored.data())]);
  }
  for (const rows::StoredMap& map : stored)
    if (!map.used) RemoveMaps(context, map.row, map.row, 1);
  return matched;
}

// Writes the rows of maps anew: few, and what a search looks at may be another.
void SaveMapRows(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes,
                 const std::vector<rows::StoredMap>& matched, const std::vector<std::int64_t>& numbers,
                 const std::vector<ListPlans>& plans) {
  std::vector<std::int64_t> ended;
  for (const rows::StoredMap& map : matched)
    if (map.row != 0) ended.push_back(map.row);
  EndRows(context, "map", ended);
  for (std::size_t i = 0; i < atlas.maps.size(); ++i) {
    rows::Count(context.changes["map"], rows::HasMap(matched[i], hashes.maps[i].header, i), matched[i].row == 0);
    WriteMapRow(context, numbers[i], i, atlas.maps[i], hashes.maps[i].header, plans[i]);
  }
}

// Rows of maps are never used again, and must leave room for 2^32 places.
std::vector<std::int64_t> NumbersOfMaps(SaveContext& context, const std::vector<rows::StoredMap>& matched) {
  std::int64_t next = 1;
  if (!context.is_new && std::ranges::any_of(matched, [](const rows::StoredMap& map) { return map.row == 0; }))
    next += context.connection.Integer("SELECT max(row) FROM map WHERE atlas = $1", {context.atlas});
  std::vector<std::int64_t> numbers;
  for (const rows::StoredMap& map : matched) numbers.push_back(map.row != 0 ? map.row : next++);
  if (next > kLargestMap)
    throw Error(ErrorKind::kNotPossible, context.connection.path(), "table map", "no more row numbers");
  return numbers;
}

bool HasAllOfThese(const SaveContext& context, const Atlas& atlas) {
  std::int64_t landmarks = 0;
  for (const Map& map : atlas.maps) landmarks += static_cast<std::int64_t>(map.landmarks.size());
  const std::vector<std::int64_t> maps(atlas.maps.size());
  const auto count = [](std::string_view table) {
    return Concat("(SELECT count(*) FROM ", table, " WHERE atlas = $1 AND until = 2147483647)");
  };
  return context.connection.Integer(
             Concat("SELECT (", count("camera"), " = $2 AND ", count("repeated_entry"), " = $3 AND ", count("landmark"),
                    " = $4)::integer"),
             {context.atlas, static_cast<std::int64_t>(atlas.cameras.size()),
              static_cast<std::int64_t>(RepeatedRows(context.atlas, atlas, maps).size()), landmarks}) != 0;
}

void SaveCamerasAndRepeated(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes,
                            const std::vector<std::int64_t>& maps) {
  const StoredSmall stored = ReadSmall(context);
  SaveCameras(context, atlas, hashes, stored.cameras);
  SaveRepeated(context, atlas, maps, stored.has_repeated);
}

}  // namespace slamdb::postgresql
