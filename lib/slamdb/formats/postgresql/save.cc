// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/save.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/formats/postgresql/detail/catalog.h"
#include "slamdb/formats/postgresql/detail/names.h"
#include "slamdb/formats/rows/detail/keyframe_row.h"
#include "slamdb/formats/rows/detail/list_order.h"
#include "slamdb/formats/rows/detail/map_rows.h"
#include "slamdb/formats/rows/detail/match_maps.h"
#include "slamdb/formats/rows/detail/provenance.h"
#include "slamdb/formats/rows/detail/revision_names.h"
#include "slamdb/formats/rows/detail/summary_columns.h"
#include "slamdb/model/detail/record.h"
#include "slamdb/model/summary.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;

Parameter ParameterOf(const Value& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return Parameter(*integer);
  if (const auto* real = std::get_if<double>(&value)) return std::isnan(*real) ? Parameter::Null() : Parameter(*real);
  if (const auto* text = std::get_if<std::string_view>(&value)) return Parameter(*text);
  if (const auto* blob = std::get_if<Bytes>(&value)) return Parameter(*blob);
  return Parameter::Null();
}

// What a fork's file has of an entity, as a column.
class CarriedColumn {
 public:
  Value Of(const Boxed<Carried>& carried) {
    if (!carried) return {};
    bytes_.Clear();
    detail::EncodeCarried(carried, bytes_);
    return bytes_.bytes();
  }

 private:
  detail::ByteWriter bytes_;
};

// ---- the atlas' own row

constexpr const char* kSummaryColumns =
    "hash, maps, keyframes, points, observations, landmarks, sensors, has_imu, is_metric, trajectory_length, duration, "
    "begin_time, end_time";

std::vector<Value> SummaryRow(std::int64_t hash, const AtlasSummary& summary) {
  const auto time = [](std::optional<double> value) { return value ? Value(*value) : Value(); };
  std::vector<Value> row{hash};
  for (const std::uint64_t count :
       {summary.maps, summary.keyframes, summary.points, summary.observations, summary.landmarks})
    row.emplace_back(rows::ToColumn(count));
  for (const std::int64_t number :
       {rows::BitsOf(summary.sensors), std::int64_t{summary.has_imu}, std::int64_t{summary.is_metric}})
    row.emplace_back(number);
  for (const double number : {summary.trajectory_length, summary.duration}) row.emplace_back(number);
  row.push_back(time(summary.begin_time));
  row.push_back(time(summary.end_time));
  return row;
}

// When a revision of another store was saved there; NULL: now.
Parameter RecordedAt(const SaveContext& context) {
  return context.options.recorded ? Parameter(context.options.recorded->at) : Parameter::Null();
}

// Writes the row of the atlas, and sets context.atlas.
void SaveAtlasRow(SaveContext& context, const std::string& name, std::int64_t hash, const AtlasSummary& summary) {
  std::vector<Parameter> parameters;
  for (const Value& value : SummaryRow(hash, summary)) parameters.push_back(ParameterOf(value));
  std::string numbers;
  for (std::size_t i = 1; i <= parameters.size(); ++i) numbers += Concat(i == 1 ? "$" : ", $", i);
  const std::string revision = Concat("$", parameters.size() + 1), key = Concat("$", parameters.size() + 3);
  const std::string at = Concat("coalesce($", parameters.size() + 2, "::text::timestamptz, now())");
  parameters.emplace_back(context.revision);
  parameters.push_back(RecordedAt(context));
  if (context.is_new) {
    parameters.emplace_back(name);
    const Result made = context.connection.Query(
        Concat("INSERT INTO atlas (", kSummaryColumns, ", revision, name, saved_at, bytes) VALUES (", numbers, ", ",
               revision, ", ", key, ", ", at, ", 0) ON CONFLICT (name) DO NOTHING RETURNING row"),
        parameters, "table atlas");
    if (made.rows() == 0)
      throw Error(ErrorKind::kAlreadyExists, context.connection.path(), "",
                  Concat("holds an atlas named '", name, "' of a project that you do not see: take another name"));
    context.atlas = made[0].Integer(0);
    return;
  }
  parameters.emplace_back(context.atlas);
  const Result updated =
      context.connection.Query(Concat("UPDATE atlas SET (", kSummaryColumns, ", revision, saved_at) = (", numbers, ", ",
                                      revision, ", ", at, ") WHERE row = ", key),
                               parameters, "table atlas");
  RequireTaken(context.connection, "atlas", updated.changed(), 1);
}

void SaveBytes(SaveContext& context) {
  std::uint64_t bytes = 0;
  for (const PartSize& part : PartSizesOf(context.connection, context.atlas, context.partition)) bytes += part.bytes;
  context.connection.Query("UPDATE atlas SET bytes = $2 WHERE row = $1",
                           {context.atlas, static_cast<std::int64_t>(bytes)}, "table atlas");
}

// ---- cameras and irregular entries: all of them or none

void SaveCameras(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes) {
  std::vector<std::int64_t> stored;
  const Result found =
      context.connection.Query("SELECT hash FROM camera WHERE atlas = $1 AND until = 2147483647 ORDER BY position",
                               {context.atlas}, "table camera");
  for (std::size_t i = 0; i < found.rows(); ++i) stored.push_back(found[i].Integer(0));
  TableChanges& changes = context.changes["camera"];
  if (stored == hashes.cameras && !context.rewrites) {
    changes.unchanged += stored.size();
    return;
  }
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

void SaveRepeated(SaveContext& context, const Atlas& atlas, const std::vector<std::int64_t>& maps) {
  const auto rows = RepeatedRows(context.atlas, atlas, maps);
  const Result ended =
      context.connection.Query("UPDATE repeated_entry SET until = $2 WHERE atlas = $1 AND until = 2147483647",
                               {context.atlas, context.revision}, "table repeated_entry");
  if (ended.changed() == 0 && rows.empty()) return;
  TableChanges& changes = context.changes["repeated_entry"];
  changes.deleted += static_cast<std::uint64_t>(ended.changed());
  changes.inserted += rows.size();
  for (const auto& each : rows) {
    std::vector<Value> row(each.begin(), each.end());
    row.emplace_back(context.revision);
    InsertRow(context.connection, "repeated_entry (atlas, list, map, sequence, position, owner_map, entry, since)",
              row);
  }
}

// ---- maps

std::vector<rows::StoredMap> ReadStoredMaps(SaveContext& context) {
  std::vector<rows::StoredMap> maps;
  const Result found = context.connection.Query(
      "SELECT row, id, position, hash FROM map WHERE atlas = $1 AND until = 2147483647 ORDER BY position",
      {context.atlas}, "table map");
  for (std::size_t i = 0; i < found.rows(); ++i)
    maps.push_back({found[i].Integer(0), found[i].Integer(1), found[i].Integer(2), found[i].Integer(3), {}, false});
  return maps;
}

void RemoveMap(SaveContext& context, std::int64_t map) {
  const auto end = [&](std::string_view table, std::string_view key, std::string_view more = "0") {
    const Result ended = context.connection.Query(
        Concat("WITH ended AS (UPDATE ", table, " SET until = $2 WHERE atlas = $1 AND until = 2147483647 AND ", key,
               " BETWEEN $3 AND $4 RETURNING ", more,
               " AS more) SELECT count(*), coalesce(sum(more), 0)::bigint FROM ended"),
        {context.atlas, context.revision, rows::FirstRowOfMap(map), rows::LastRowOfMap(map)}, Concat("table ", table));
    context.changes[std::string(table)].deleted += static_cast<std::uint64_t>(ended[0].Integer(0));
    return std::pair(static_cast<std::uint64_t>(ended[0].Integer(0)), static_cast<std::uint64_t>(ended[0].Integer(1)));
  };
  context.map.keyframes_removed += end("keyframe", "row").first;
  end("keyframe_features", "keyframe");
  const auto [points, seen] = end("map_point", "row", "cardinality(seen_by)");
  context.map.points_removed += points;
  context.map.observations_removed += seen;
  end("landmark", "row");
  EndRows(context, "map", {map});
  ++context.changes["map"].deleted;
}

// Ends the maps that are in the atlas no more. Returns the stored map of each map of the atlas, with row 0 for none.
std::vector<rows::StoredMap> MatchMaps(SaveContext& context, const Atlas& atlas) {
  std::vector<rows::StoredMap> stored = ReadStoredMaps(context);
  if (!context.rewrites && !stored.empty())
    context.connection.CopyOut(
        Concat("SELECT row, id, timestamp FROM keyframe WHERE atlas = ", context.atlas, " AND until = ", kNewest,
               " AND timestamp IS NOT NULL"),
        [&](const Row& row) {
          const auto map = std::ranges::find(stored, rows::MapOfRow(row.Integer(0)), &rows::StoredMap::row);
          if (map != stored.end()) map->keys.push_back({row.Integer(1), row.Real(2)});
        },
        "table keyframe");
  std::vector<rows::StoredMap> matched(atlas.maps.size());
  if (!context.rewrites) {
    const std::vector<const rows::StoredMap*> match = rows::MatchMaps(atlas, stored);
    for (std::size_t i = 0; i < match.size(); ++i)
      if (match[i] != nullptr) matched[i] = *match[i];
  }
  for (const rows::StoredMap& map : stored)
    if (!map.used) RemoveMap(context, map.row);
  return matched;
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

// Writes the rows of maps anew: few, and what a search looks at may be another.
void SaveMapRows(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes,
                 const std::vector<rows::StoredMap>& stored, const std::vector<std::int64_t>& numbers,
                 const std::vector<ListPlans>& plans) {
  std::vector<std::int64_t> ended;
  for (const rows::StoredMap& map : stored)
    if (map.row != 0) ended.push_back(map.row);
  EndRows(context, "map", ended);
  for (std::size_t i = 0; i < atlas.maps.size(); ++i) {
    const bool same = stored[i].row != 0 && stored[i].hash == hashes.maps[i].header &&
                      stored[i].position == static_cast<std::int64_t>(i);
    TableChanges& changes = context.changes["map"];
    ++(same ? changes.unchanged : stored[i].row != 0 ? changes.updated : changes.inserted);
    WriteMapRow(context, numbers[i], i, atlas.maps[i], hashes.maps[i].header, plans[i]);
  }
}

// Rows of maps are never used again, and must leave room for 2^32 places.
std::vector<std::int64_t> NumbersOfMaps(SaveContext& context, const std::vector<rows::StoredMap>& stored) {
  std::int64_t next =
      context.is_new ? 1 : 1 + context.connection.Integer("SELECT max(row) FROM map WHERE atlas = $1", {context.atlas});
  std::vector<std::int64_t> numbers;
  for (const rows::StoredMap& map : stored) numbers.push_back(map.row != 0 ? map.row : next++);
  if (next > 0x7fffffff)
    throw Error(ErrorKind::kNotPossible, context.connection.path(), "table map", "no more row numbers");
  return numbers;
}

void SaveContent(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes) {
  const std::vector<rows::StoredMap> stored = MatchMaps(context, atlas);
  const std::vector<std::int64_t> numbers = NumbersOfMaps(context, stored);
  const std::vector<StoredLists> lists =
      context.is_new ? std::vector<StoredLists>(numbers.size()) : ReadStoredLists(context, numbers);
  std::vector<MapToSave> maps;
  for (std::size_t i = 0; i < atlas.maps.size(); ++i)
    maps.push_back({numbers[i], atlas.maps[i], hashes.maps[i], lists[i]});
  const std::vector<ListPlans> plans = SaveLists(context, maps);
  SaveMapRows(context, atlas, hashes, stored, numbers, plans);
  SaveCameras(context, atlas, hashes);
  SaveRepeated(context, atlas, numbers);
}

// ---- the log

// Returns its row.
std::int64_t Record(SaveContext& context, const std::string& name, const AtlasSummary& summary, std::int64_t hash,
                    bool is_unchanged) {
  TableChanges rows;
  for (const TableChanges& each : context.changes.Take()) {
    rows.inserted += each.inserted;
    rows.updated += each.updated;
    rows.deleted += each.deleted;
    rows.unchanged += each.unchanged;
  }
  const auto number = [](std::uint64_t value) { return Parameter(static_cast<std::int64_t>(value)); };
  const MapChanges& map = context.map;
  // File names in it may be any bytes, which a text of PostgreSQL may not.
  const std::string provenance = detail::Visible(context.options.provenance);
  const std::optional<Recorded>& recorded = context.options.recorded;
  std::vector<Parameter> parameters{recorded ? detail::Visible(recorded->tool) : rows::ToolName(), name, provenance,
                                    recorded ? detail::Visible(recorded->who) : rows::Who(), hash};
  for (const std::uint64_t count : {summary.maps, summary.keyframes, summary.points, summary.observations,
                                    rows.inserted, rows.updated, rows.deleted, rows.unchanged})
    parameters.push_back(number(count));
  parameters.push_back(is_unchanged ? Parameter::Null() : Parameter(context.revision));
  for (const std::uint64_t count :
       {map.keyframes_added, map.keyframes_removed, map.keyframes_moved, map.points_added, map.points_removed,
        map.points_moved, map.observations_added, map.observations_removed})
    parameters.push_back(is_unchanged ? Parameter::Null() : number(count));
  parameters.push_back(RecordedAt(context));
  // Of an INSERT with VALUES a subquery is not what every server takes (Citus).
  const Result made = context.connection.Query(
      "INSERT INTO history (at, action, tool, atlas, provenance, who, hash, maps, keyframes, points, observations, "
      "inserted, updated, deleted, unchanged, revision, keyframes_added, keyframes_removed, keyframes_moved, "
      "points_added, points_removed, points_moved, observations_added, observations_removed, project) SELECT "
      "coalesce($23::text::timestamptz, now()), 'save', $1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, "
      "$14::integer, $15::bigint, $16::bigint, $17::bigint, $18::bigint, $19::bigint, $20::bigint, $21::bigint, "
      "$22::bigint, project FROM atlas WHERE name = $2 RETURNING row",
      parameters, "table history");
  return made[0].Integer(0);
}

void AddRevision(SaveContext& context, const Atlas& atlas, std::int64_t hash, std::int64_t history) {
  std::vector<Value> row{context.atlas, context.revision, history, hash};
  const std::optional<RevisionName>& from = context.options.from;
  row.push_back(from ? Value(std::string_view(from->atlas)) : Value());
  row.push_back(from ? Value(rows::ToColumn(from->number)) : Value());
  row.push_back(from ? Value(rows::ToColumn(from->hash)) : Value());
  // Texts of files are any bytes, which PostgreSQL's are not.
  for (const Value& value : rows::HeaderRow(atlas)) {
    const auto* text = std::get_if<std::string_view>(&value);
    row.push_back(text == nullptr ? value : Value(std::as_bytes(std::span(*text))));
  }
  CarriedColumn carried;
  row.push_back(carried.Of(atlas.carried));
  InsertRow(context.connection,
            Concat("revision (atlas, number, history, hash, from_atlas, from_number, from_hash, ", rows::kHeaderColumns,
                   ", carried)"),
            row);
}

// An atlas that is there as it is makes no revision: the log alone tells of the save.
void CountUnchanged(SaveContext& context, const Atlas& atlas) {
  ++context.changes["atlas"].unchanged;
  context.changes["map"].unchanged += atlas.maps.size();
  context.changes["camera"].unchanged += atlas.cameras.size();
  for (const Map& map : atlas.maps) {
    for (const char* table : {"keyframe", "keyframe_features"})
      context.changes[table].unchanged += map.keyframes.size();
    context.changes["map_point"].unchanged += map.points.size();
    if (!map.landmarks.empty()) context.changes["landmark"].unchanged += map.landmarks.size();
  }
}

void SaveWordsAlone(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes) {
  std::vector<std::int64_t> numbers;
  for (const rows::StoredMap& map : ReadStoredMaps(context)) numbers.push_back(map.row);
  if (numbers.size() != atlas.maps.size()) return;
  const std::vector<StoredLists> lists = ReadStoredLists(context, numbers);
  std::vector<MapToSave> maps;
  for (std::size_t i = 0; i < atlas.maps.size(); ++i)
    maps.push_back({numbers[i], atlas.maps[i], hashes.maps[i], lists[i]});
  SaveWords(context, maps);
}

}  // namespace

void SaveContext::Report(std::size_t done) {
  entities_done += done;
  if (options.progress && entities > 0)
    options.progress("saving", std::min(1.0, static_cast<double>(entities_done) / static_cast<double>(entities)));
}

void RequireTaken(Connection& connection, std::string_view table, std::int64_t taken, std::int64_t wanted) {
  if (taken == wanted) return;
  throw Error(ErrorKind::kNotPossible, connection.path(), Concat("table ", table),
              Concat("took ", taken, " of ", wanted,
                     " rows: a trigger, a rule or a policy of the database keeps the others "
                     "out; nothing was saved"));
}

void InsertRow(Connection& connection, std::string_view columns, std::span<const Value> values) {
  std::vector<Parameter> parameters;
  std::string numbers;
  for (const Value& value : values) {
    parameters.push_back(ParameterOf(value));
    numbers += Concat(numbers.empty() ? "$" : ", $", parameters.size());
  }
  const std::string_view table = columns.substr(0, columns.find(' '));
  const Result made =
      connection.Query(Concat("INSERT INTO ", columns, " VALUES (", numbers, ")"), parameters, Concat("table ", table));
  RequireTaken(connection, table, made.changed(), 1);
}

SaveReport SaveAtlas(Connection& connection, const std::string& name, const Atlas& atlas, const AtlasHashes& hashes,
                     const SaveOptions& options, const LockOptions& lock, bool rewrite) {
  const Result found = connection.Query(
      "SELECT row, coalesce(number, 0), revision.hash FROM atlas LEFT JOIN revision ON revision.atlas = row WHERE name "
      "= $1 "
      "ORDER BY number DESC LIMIT 1",
      {name}, "table atlas");
  const std::int64_t hash = hashes.Combined();
  SaveContext context{.connection = connection, .options = options};
  context.is_new = found.rows() == 0;
  context.rewrites = rewrite;
  if (!context.is_new) context.atlas = found[0].Integer(0);
  const std::int64_t newest = context.is_new ? 0 : found[0].Integer(1);
  context.revision = rows::NextNumber(connection.path(), options.recorded, newest);
  for (const Map& map : atlas.maps) context.entities += 100 * map.keyframes.size() + map.points.size();
  const AtlasSummary summary = Summarize(atlas);
  SaveReport report{.hash = static_cast<std::uint64_t>(hash), .replaced = !context.is_new};
  report.unchanged = !context.is_new && !rewrite && !options.recorded && found[0].Integer(2) == hash;
  if (report.unchanged) {
    context.revision = newest;
    CountUnchanged(context, atlas);
    if (!HasAllWords(context, atlas)) SaveWordsAlone(context, atlas, hashes);
  } else {
    SaveAtlasRow(context, name, hash, summary);
    ++(context.is_new ? context.changes["atlas"].inserted : context.changes["atlas"].updated);
    context.partition = HoldPartition(connection, context.atlas, lock);
    UndoUnfinished(connection, context.partition, context.atlas, newest);
    SaveContent(context, atlas, hashes);
    SaveBytes(context);
  }
  const std::int64_t history = Record(context, name, summary, hash, report.unchanged);
  if (!report.unchanged) AddRevision(context, atlas, hash, history);
  report.tables = context.changes.Take();
  report.map = context.map;
  report.revision = static_cast<std::uint64_t>(context.revision);
  return report;
}

}  // namespace slamdb::postgresql
